//! The joint configurations to sweep.

use super::check::{Check, file_unit};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema::NumberOrList;
use crate::problem::text::{At, KeyPath, Optional, key};
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
    pub(super) fn space(&mut self, sweep: &At<schema::Sweep>, robot: &Robot) -> Option<JointSpace> {
        let faults = self.faults.len();
        let joints = &robot.chain.joints;
        let spans = robot.spans();
        self.turns(&sweep.path, joints, &spans);
        let most = most_configurations(sweep.value.axis.0);
        let (sample, step_deg, step_mm) = (key!(sweep, sample), key!(sweep, step_deg), key!(sweep, step_mm));
        let (path, space) = if step_deg.is_given() || step_mm.is_given() {
            let path = if step_deg.is_given() { step_deg.path.clone() } else { step_mm.path.clone() };
            self.excluded(&[&sample], path.name());
            let mut steps = vec![1.0; joints.len()];
            self.steps(step_deg, joints, JointKind::Revolute, &mut steps);
            self.steps(step_mm, joints, JointKind::Prismatic, &mut steps);
            if self.faults.len() > faults {
                return None;
            }
            (path, JointSpace::Grid(JointGrid::of(&spans, &steps)))
        } else {
            let sample = sample.or(&DEFAULT_SAMPLE);
            if *sample.value == 0 {
                self.count(&sample, Allowed::between(1.0, most as f64));
            }
            if joints.len() > HaltonSample::MOST_JOINTS {
                let reason = Reason::TooManyJoints { joints: joints.len(), most: HaltonSample::MOST_JOINTS };
                self.fault(&sample.path, reason);
                return None;
            }
            let limits: Vec<Limits> = spans.iter().map(|span| span.limits).collect();
            (sample.path, JointSpace::Sample(HaltonSample::new(&limits, *sample.value as usize)))
        };
        if space.len() > most {
            self.fault(&path, Reason::TooManyConfigurations { configurations: space.size(), most });
        }
        (self.faults.len() == faults).then_some(space)
    }

    /// Notes which joints are swept over one turn of several.
    fn turns(&mut self, path: &KeyPath, joints: &[Joint], spans: &[Span]) {
        for (joint, span) in joints.iter().zip(spans).filter(|(joint, span)| span.limits != joint.limits) {
            let [from, to] = [span.limits.min, span.limits.max].map(|limit| file_unit(joint.kind, limit));
            let range = file_unit(joint.kind, joint.limits.max - joint.limits.min);
            let text = format!(
                "joint \"{}\" can turn through {range}°; only the turn from {from}° to {to}° is swept, which contains every position",
                joint.name
            );
            self.note(path, text);
        }
    }

    /// The rounds of refinement.
    pub(super) fn refinement(&mut self, sweep: &At<schema::Sweep>, joints: &[Joint]) -> Refinement {
        let refine = key!(sweep, refine);
        let rounds = self.count(&refine, Allowed::between(0.0, 20.0));
        let sample = key!(sweep, refine_sample).or(&DEFAULT_REFINEMENT);
        let sample = self.count(&sample, Allowed::between(1.0, 1e7));
        if rounds > 0 && joints.len() > HaltonSample::MOST_JOINTS {
            let reason = Reason::TooManyJoints { joints: joints.len(), most: HaltonSample::MOST_JOINTS };
            self.fault(&refine.path, reason);
        }
        Refinement { rounds, sample }
    }

    /// The published counts.
    pub(super) fn published(&mut self, sweep: &At<schema::Sweep>) -> Vec<PublishedSweep> {
        let resolve = |published: At<schema::Published>| PublishedSweep {
            step: self.angle(&key!(published, step_deg), STEP),
            swept: published.value.swept as usize,
            in_zone: published.value.in_zone as usize,
        };
        key!(sweep, published).elements().map(resolve).collect()
    }

    /// Fills in the steps (rad or m) of the joints of one kind.
    fn steps(&mut self, given: At<Option<NumberOrList>>, joints: &[Joint], kind: JointKind, steps: &mut [f64]) {
        let of_kind: Vec<&mut f64> =
            joints.iter().zip(steps).filter(|(joint, _)| joint.kind == kind).map(|(_, step)| step).collect();
        let (robot, per) = match kind {
            JointKind::Revolute => ("a robot without revolute joints", "revolute joint"),
            JointKind::Prismatic => ("a robot without prismatic joints", "prismatic joint"),
        };
        if of_kind.is_empty() {
            self.refused(&[&given], robot, "leave it out");
            return;
        }
        let Some(given) = self.required(given, &[]) else { return };
        let si = |check: &mut Self, step: &At<f64>| match kind {
            JointKind::Revolute => check.angle(step, STEP),
            JointKind::Prismatic => check.length(step, STEP),
        };
        match given.value {
            NumberOrList::Number(step) => {
                let step = si(self, &given.with(step));
                for slot in of_kind {
                    *slot = step;
                }
            }
            NumberOrList::List(list) => {
                let (found, expected) = (list.len(), of_kind.len());
                if found != expected {
                    self.fault(&given.path, Reason::Length { found, expected, per });
                }
                for (slot, step) in of_kind.into_iter().zip(given.with(list).elements()) {
                    *slot = si(self, &step);
                }
            }
        }
    }
}
