//! Which sets of poses are allowed.

use std::collections::BTreeMap;

use super::check::Check;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema::{self, Range};
use crate::problem::text::{At, key};
use crate::problem::{JointRegion, Method, PoseConstraints, PoseGroup};
use crate::robot::{Joint, JointKind, Limits};

impl Check<'_, '_> {
    pub(super) fn constraints(&mut self, constraints: &At<schema::Constraints>, joints: &[Joint]) -> PoseConstraints {
        let (require, forbid) = (key!(constraints, require), key!(constraints, forbid));
        for id in forbid.elements().filter(|id| require.value.contains(id.value)) {
            self.fault(&id.path, Reason::Conflict { with: require.path.to_string() });
        }
        let captured = key!(constraints, captured).elements().map(|q| self.configuration(&q, joints)).collect();
        let region = |region: At<schema::Region>| self.region(&key!(region, joints), joints);
        let keep_out = key!(constraints, keep_out).elements().map(region).collect();
        let groups = self.groups(&key!(constraints, groups), joints);
        let (joint, view) = (key!(constraints, joint_separation_deg), key!(constraints, view_separation_deg));
        let turns = joints.is_empty() || joints.iter().any(|joint| joint.kind == JointKind::Revolute);
        if !turns {
            let instead = format!("use `{}`", view.path.name());
            self.refused(&[&joint], "an arm without revolute joints", &instead);
        }
        let ids = |ids: &[u64]| ids.iter().map(|&id| id as usize).collect();
        PoseConstraints {
            required: ids(require.value),
            forbidden: ids(forbid.value),
            captured,
            keep_out,
            groups,
            joint_separation: self.angle(&joint.or(&0.0), Allowed::between(0.0, 3600.0)),
            view_separation: self.angle(&view.or(&0.0), Allowed::between(0.0, 180.0)),
            picture_separation: key!(constraints, picture_separation_px)
                .given()
                .map(|least| self.number(&least, Allowed::between(0.0, 1e5))),
        }
    }

    /// Baselines choose without looking at constraints.
    pub(super) fn unconstrained_method(
        &mut self,
        method: Method,
        section: &At<schema::Constraints>,
        constraints: &PoseConstraints,
    ) {
        if !method.heeds_constraints() && !constraints.allow_all() {
            let to = format!("method \"{}\"", method.name());
            self.not_applicable(&section.path, &to, "choose another method, or leave the constraints out");
        }
    }

    /// Joint values in degrees (mm), one for each joint.
    pub(super) fn configuration(&mut self, q: &At<Vec<f64>>, joints: &[Joint]) -> Vec<f64> {
        let (found, expected) = (q.value.len(), joints.len());
        if found != expected && !joints.is_empty() {
            self.fault(&q.path, Reason::Length { found, expected, per: "joint" });
        }
        q.value.iter().zip(joints).map(|(&value, joint)| joint.kind.in_si(value)).collect()
    }

    fn groups(&mut self, groups: &At<Vec<schema::Group>>, joints: &[Joint]) -> Vec<PoseGroup> {
        let mut resolved: Vec<PoseGroup> = Vec::new();
        for group in groups.elements() {
            let at = key!(group, name);
            let name = at.value.trim().to_owned();
            if name.is_empty() {
                self.fault(&at.path, Reason::Empty);
            } else if resolved.iter().any(|other| other.name == name) {
                self.fault(&at.path, Reason::Duplicate { name: name.clone() });
            }
            let region = self.region(&key!(group, joints), joints);
            resolved.push(PoseGroup { name, region, most: group.value.most as usize });
        }
        resolved
    }

    fn region(&mut self, ranges: &At<BTreeMap<String, Range>>, joints: &[Joint]) -> JointRegion {
        if ranges.value.is_empty() {
            self.fault(&ranges.path, Reason::Empty);
        }
        let mut region = Vec::new();
        // Without a robot there is nothing to name.
        for (name, range) in ranges.entries().filter(|_| !joints.is_empty()) {
            let Some(j) = joints.iter().position(|joint| joint.name == *name) else {
                let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
                self.unknown(&range.path, name, &names);
                continue;
            };
            let [min, max] = range.value.0;
            if !(min <= max && min.is_finite() && max.is_finite()) {
                self.fault(&range.path, Reason::Reversed { min, max });
            }
            region.push((j, Limits { min: joints[j].kind.in_si(min), max: joints[j].kind.in_si(max) }));
        }
        JointRegion(region)
    }
}
