//! What to select, and which sets are allowed.

use std::collections::BTreeMap;
use std::time::Duration;

use super::{Check, owned};
use crate::camera::Camera;
use crate::information::{Criterion, Unknowns};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::schema::{Numbers, Range, TextOrTable};
use crate::problem::text::KeyPath;
use crate::problem::{Accuracy, Goal, JointRegion, Method, PoseConstraints, PoseGroup, SelectionSettings};
use crate::robot::{Joint, JointKind, Limits};

/// Number of poses where the file does not say.
const DEFAULT_COUNT: usize = 10;

/// Standard deviations wished for: far from any that can be had, but such that their squares are numbers.
const WISHED: Allowed = Allowed::between(1e-9, 1e9);

/// Greatest standard deviation known beforehand.
const VAGUEST: f64 = 1e9;

/// What moves the image by so little, in units of the noise of a corner, is known, not estimated.
const KNOWN: f64 = 1e-4;

impl Check<'_, '_> {
    pub(super) fn selection(&mut self, selection: &schema::Selection, estimated: &[&str]) -> SelectionSettings {
        let at = KeyPath::section("selection");
        let time_limit = self.number(&at.key("time_limit_s"), selection.time_limit_s, Allowed::between(0.0, 1e6));
        let nodes = Allowed::between(0.0, 1e12);
        SelectionSettings {
            goal: self.goal(selection, estimated),
            seed: selection.seed,
            tolerance: self.number(&at.key("tolerance"), selection.tolerance, Allowed::between(1e-12, 0.1)),
            time_limit: Duration::try_from_secs_f64(time_limit).unwrap_or_default(),
            node_limit: self.number(&at.key("node_limit"), selection.node_limit as f64, nodes) as usize,
        }
    }

    /// Either accuracies or criteria: what only one of them has a use for is refused beside the other.
    fn goal(&mut self, selection: &schema::Selection, estimated: &[&str]) -> Goal {
        let at = KeyPath::section("selection");
        let Some(accuracy) = &selection.accuracy else {
            return Goal::Best {
                criteria: match &selection.criterion {
                    Some(criterion) => self.criteria(&at.key("criterion"), criterion),
                    None => vec![(Criterion::V, 1.0)],
                },
                count: selection.count.map_or(DEFAULT_COUNT, |count| count as usize),
                method: selection.method.map_or(Method::Best, |method| method.0),
            };
        };
        for (key, given) in [
            ("criterion", selection.criterion.is_some()),
            ("count", selection.count.is_some()),
            ("method", selection.method.is_some()),
        ] {
            if given {
                self.fault(&at.key(key), Reason::Conflict { with: "selection.accuracy".into() });
            }
        }
        Goal::Fewest { accuracies: self.accuracies(&at.key("accuracy"), accuracy, estimated) }
    }

    /// Shares are normalised to add up to one.
    fn criteria(
        &mut self,
        path: &KeyPath,
        criterion: &TextOrTable<schema::Named<Criterion>, BTreeMap<String, f64>>,
    ) -> Vec<(Criterion, f64)> {
        let shares = match criterion {
            TextOrTable::Text(criterion) => return vec![(criterion.0, 1.0)],
            TextOrTable::Table(shares) => shares,
        };
        if shares.is_empty() {
            self.fault(path, Reason::Empty);
        }
        let sum: f64 = shares.values().sum();
        let mut criteria = Vec::new();
        for (name, &share) in shares {
            let key = path.key(name);
            if let Ok(criterion) = name.parse() {
                criteria.push((criterion, part(self.number(&key, share, Allowed::positive(1e6)), sum)));
            } else {
                let allowed = Criterion::ALL.map(Criterion::name);
                self.fault(&key, Reason::UnknownName { name: name.clone(), allowed: owned(&allowed) });
            }
        }
        criteria.sort_by_key(|&(criterion, _)| criterion);
        criteria
    }

    fn accuracies(
        &mut self,
        path: &KeyPath,
        wished: &BTreeMap<String, f64>,
        estimated: &[&str],
    ) -> Vec<(Accuracy, f64)> {
        if wished.is_empty() {
            self.fault(path, Reason::Empty);
        }
        let mut accuracies = Vec::new();
        for (name, &sigma) in wished {
            let key = path.key(name);
            let sigma = self.number(&key, sigma, WISHED);
            if name == Accuracy::MAP_ERROR {
                accuracies.push((Accuracy::MapError, sigma));
            } else if let Some(j) = estimated.iter().position(|known| known == name) {
                accuracies.push((Accuracy::Intrinsic(j), sigma));
            } else {
                let allowed =
                    std::iter::once(&Accuracy::MAP_ERROR).chain(estimated).map(|&name| name.to_owned()).collect();
                self.fault(&key, Reason::UnknownName { name: name.clone(), allowed });
            }
        }
        accuracies
    }

    /// `camera` is none where something is wrong with it.
    pub(super) fn prior_sigma(
        &mut self,
        estimate: &schema::Estimate,
        camera: Option<&Camera>,
        estimated: &[usize],
        names: &[&str],
        noise: f64,
    ) -> Vec<(usize, f64)> {
        let path = KeyPath::section("estimate").key("prior_sigma");
        let mut known = Vec::new();
        for (name, &sigma) in &estimate.prior_sigma {
            let key = path.key(name);
            let Some(j) = names.iter().position(|estimated| estimated == name) else {
                self.fault(&key, Reason::UnknownName { name: name.clone(), allowed: owned(names) });
                continue;
            };
            // An intrinsic that moves no pixel has no unit.
            let alone = |camera| Unknowns { camera, estimated: &estimated[j..=j] };
            let unit = camera.map(|camera| alone(camera).pixel_units()[0]).filter(|unit| unit.is_finite());
            let least = unit.map_or(f64::MIN_POSITIVE, |unit| KNOWN * noise * unit);
            if sigma < least && sigma > 0.0 {
                self.fault(&key, Reason::KnownExactly { value: sigma, least });
            } else {
                self.number(&key, sigma, Allowed::positive(VAGUEST));
            }
            known.push((j, sigma));
        }
        known
    }

    pub(super) fn constraints(&mut self, constraints: &schema::Constraints, joints: &[Joint]) -> PoseConstraints {
        let at = KeyPath::section("constraints");
        let ids = |ids: &[u64]| ids.iter().map(|&id| id as usize).collect::<Vec<_>>();
        let required = ids(&constraints.require);
        for (i, id) in constraints.forbid.iter().enumerate() {
            if constraints.require.contains(id) {
                self.fault(&at.key("forbid").at(i), Reason::Conflict { with: "constraints.require".into() });
            }
        }
        let captured = constraints.captured.iter().enumerate();
        let captured = captured.map(|(i, q)| self.configuration(&at.key("captured").at(i), q, joints)).collect();
        let keep_out = constraints.keep_out.iter().enumerate();
        let keep_out =
            keep_out.map(|(i, region)| self.region(&at.key("keep_out").at(i).key("joints"), &region.joints, joints));
        let keep_out = keep_out.collect();
        let mut groups: Vec<PoseGroup> = Vec::new();
        for (i, group) in constraints.groups.iter().enumerate() {
            let at = at.key("groups").at(i);
            let name = group.name.trim().to_owned();
            if name.is_empty() {
                self.fault(&at.key("name"), Reason::Empty);
            } else if groups.iter().any(|other| other.name == name) {
                self.fault(&at.key("name"), Reason::Duplicate { name: name.clone() });
            }
            let region = self.region(&at.key("joints"), &group.joints, joints);
            groups.push(PoseGroup { name, region, most: group.most as usize });
        }
        let turns = joints.is_empty() || joints.iter().any(|joint| joint.kind == JointKind::Revolute);
        if constraints.joint_separation_deg.is_some() && !turns {
            let to = "an arm without revolute joints".into();
            let reason = Reason::NotApplicable { to, instead: "use `view_separation_deg`".into() };
            self.fault(&at.key("joint_separation_deg"), reason);
        }
        let mut separation = |key: &str, degrees: Option<f64>, most: f64| {
            degrees.map_or(0.0, |degrees| self.angle(&at.key(key), degrees, Allowed::between(0.0, most)))
        };
        PoseConstraints {
            required,
            forbidden: ids(&constraints.forbid),
            captured,
            keep_out,
            groups,
            joint_separation: separation("joint_separation_deg", constraints.joint_separation_deg, 3600.0),
            view_separation: separation("view_separation_deg", constraints.view_separation_deg, 180.0),
        }
    }

    /// Baselines choose without looking at constraints.
    pub(super) fn unconstrained_method(&mut self, method: Method, constraints: &PoseConstraints) {
        if !method.heeds_constraints() && !constraints.allow_all() {
            let reason = Reason::NotApplicable {
                to: format!("method \"{}\"", method.name()),
                instead: "take another method, or leave the constraints out".into(),
            };
            self.fault(&KeyPath::section("constraints"), reason);
        }
    }

    fn configuration(&mut self, path: &KeyPath, q: &[f64], joints: &[Joint]) -> Vec<f64> {
        if q.len() != joints.len() && !joints.is_empty() {
            self.fault(path, Reason::Length { found: q.len(), expected: joints.len(), per: "joint" });
        }
        q.iter().zip(joints).map(|(&value, joint)| joint.kind.in_si(value)).collect()
    }

    fn region(&mut self, path: &KeyPath, ranges: &BTreeMap<String, Range>, joints: &[Joint]) -> JointRegion {
        if ranges.is_empty() {
            self.fault(path, Reason::Empty);
        }
        let mut region = Vec::new();
        for (name, &Numbers([min, max])) in ranges {
            let key = path.key(name);
            // Without a robot there is nothing to name.
            if joints.is_empty() {
                continue;
            }
            let Some(j) = joints.iter().position(|joint| joint.name == *name) else {
                let allowed = joints.iter().map(|joint| joint.name.clone()).collect();
                self.fault(&key, Reason::UnknownName { name: name.clone(), allowed });
                continue;
            };
            if !(min <= max && min.is_finite() && max.is_finite()) {
                self.fault(&key, Reason::Reversed { min, max });
            }
            region.push((j, Limits { min: joints[j].kind.in_si(min), max: joints[j].kind.in_si(max) }));
        }
        JointRegion(region)
    }
}

/// The share `part / whole` to fifteen decimals: 0.7 of 0.7, 0.2 and 0.1 is 0.7, though their sum in binary is not 1.
fn part(part: f64, whole: f64) -> f64 {
    let share = part / whole;
    let rounded = (share * 1e15).round() / 1e15;
    if rounded > 0.0 { rounded } else { share }
}
