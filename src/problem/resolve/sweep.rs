//! The joint configurations to sweep.

use super::{Check, file_unit};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema::NumberOrList;
use crate::problem::text::KeyPath;
use crate::problem::{PublishedSweep, Refinement, most_configurations, schema};
use crate::robot::{Joint, JointKind, Limits, Robot, Span};
use crate::sweep::{HaltonSample, JointGrid, JointSpace};

/// Steps in degrees and mm. The least is far below any encoder's and keeps the counts within range.
const STEP: Allowed = Allowed::between(1e-3, 1e4);
/// Size of the sample where the file gives neither grid nor sample.
const DEFAULT_SAMPLE: u64 = 200_000;
/// Configurations tried in each round of refinement where the file does not say how many.
const DEFAULT_REFINEMENT: u64 = 20_000;

impl Check<'_, '_> {
    /// The configurations, or none if something is wrong with them.
    pub(super) fn space(&mut self, sweep: &schema::Sweep, robot: &Robot) -> Option<JointSpace> {
        let faults = self.faults.len();
        let at = KeyPath::section("sweep");
        let joints = &robot.chain.joints;
        let spans = robot.spans();
        self.turns(&at, joints, &spans);
        let (path, space) = if sweep.step_deg.is_none() && sweep.step_mm.is_none() {
            let path = at.key("sample");
            let len = sweep.sample.unwrap_or(DEFAULT_SAMPLE);
            if len == 0 {
                self.number(&path, 0.0, Allowed::between(1.0, most_configurations(sweep.axis.0) as f64));
            }
            if joints.len() > HaltonSample::MOST_JOINTS {
                let reason = Reason::TooManyJoints { joints: joints.len(), most: HaltonSample::MOST_JOINTS };
                self.fault(&path, reason);
                return None;
            }
            let limits: Vec<Limits> = spans.iter().map(|span| span.limits).collect();
            (path, JointSpace::Sample(HaltonSample::new(&limits, len as usize)))
        } else {
            if sweep.sample.is_some() {
                let with = if sweep.step_deg.is_some() { "step_deg" } else { "step_mm" };
                self.fault(&at.key("sample"), Reason::Conflict { with: with.into() });
            }
            let mut steps = vec![1.0; joints.len()];
            self.steps(&at.key("step_deg"), sweep.step_deg.as_ref(), joints, JointKind::Revolute, &mut steps);
            self.steps(&at.key("step_mm"), sweep.step_mm.as_ref(), joints, JointKind::Prismatic, &mut steps);
            if self.faults.len() > faults {
                return None;
            }
            let path = at.key(if sweep.step_deg.is_some() { "step_deg" } else { "step_mm" });
            (path, JointSpace::Grid(JointGrid::of(&spans, &steps)))
        };
        let most = most_configurations(sweep.axis.0);
        if space.len() > most {
            self.fault(&path, Reason::TooManyConfigurations { configurations: space.size(), most });
        }
        (self.faults.len() == faults).then_some(space)
    }

    /// Notes which joints are swept over one turn of several.
    fn turns(&mut self, at: &KeyPath, joints: &[Joint], spans: &[Span]) {
        for (joint, span) in joints.iter().zip(spans).filter(|(joint, span)| span.limits != joint.limits) {
            let [from, to] = [span.limits.min, span.limits.max].map(|limit| file_unit(joint.kind, limit));
            let range = file_unit(joint.kind, joint.limits.max - joint.limits.min);
            let text = format!(
                "joint \"{}\" can turn through {range}°; the turn from {from}° to {to}° is swept, which has every place of it",
                joint.name
            );
            self.note(at, text);
        }
    }

    /// The rounds of refinement.
    pub(super) fn refinement(&mut self, sweep: &schema::Sweep, joints: &[Joint]) -> Refinement {
        let at = KeyPath::section("sweep");
        let rounds = self.number(&at.key("refine"), sweep.refine as f64, Allowed::between(0.0, 20.0)) as usize;
        let sample = sweep.refine_sample.unwrap_or(DEFAULT_REFINEMENT) as f64;
        let sample = self.number(&at.key("refine_sample"), sample, Allowed::between(1.0, 1e7)) as usize;
        if rounds > 0 && joints.len() > HaltonSample::MOST_JOINTS {
            let reason = Reason::TooManyJoints { joints: joints.len(), most: HaltonSample::MOST_JOINTS };
            self.fault(&at.key("refine"), reason);
        }
        Refinement { rounds, sample }
    }

    /// The published counts.
    pub(super) fn published(&mut self, sweep: &schema::Sweep) -> Vec<PublishedSweep> {
        let at = KeyPath::section("sweep").key("published");
        let counts = sweep.published.iter().enumerate();
        let resolve = |(i, published): (usize, &schema::Published)| PublishedSweep {
            step: self.angle(&at.at(i).key("step_deg"), published.step_deg, STEP),
            swept: published.swept as usize,
            in_zone: published.in_zone as usize,
        };
        counts.map(resolve).collect()
    }

    /// Fills in the steps (rad or m) of the joints of one kind.
    fn steps(
        &mut self,
        path: &KeyPath,
        given: Option<&NumberOrList>,
        joints: &[Joint],
        kind: JointKind,
        steps: &mut [f64],
    ) {
        let mut of_kind: Vec<&mut f64> =
            joints.iter().zip(steps).filter(|(joint, _)| joint.kind == kind).map(|(_, step)| step).collect();
        let (joint, per) = match kind {
            JointKind::Revolute => ("a robot without revolute joints", "revolute joint"),
            JointKind::Prismatic => ("a robot without prismatic joints", "prismatic joint"),
        };
        let si = |check: &mut Self, path: &KeyPath, step| match kind {
            JointKind::Revolute => check.angle(path, step, STEP),
            JointKind::Prismatic => check.length(path, step, STEP),
        };
        match given {
            None if of_kind.is_empty() => {}
            None => self.fault(path, Reason::Missing { allowed: Vec::new() }),
            Some(_) if of_kind.is_empty() => {
                self.fault(path, Reason::NotApplicable { to: joint.into(), instead: "leave it out".into() });
            }
            Some(&NumberOrList::Number(step)) => {
                let step = si(self, path, step);
                for slot in of_kind {
                    *slot = step;
                }
            }
            Some(NumberOrList::List(list)) => {
                if list.len() != of_kind.len() {
                    self.fault(path, Reason::Length { found: list.len(), expected: of_kind.len(), per });
                }
                for (i, (slot, &step)) in of_kind.iter_mut().zip(list).enumerate() {
                    **slot = si(self, &path.at(i), step);
                }
            }
        }
    }
}
