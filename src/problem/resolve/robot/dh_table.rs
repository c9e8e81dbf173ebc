//! The arm as a Denavit–Hartenberg table.

use crate::problem::fault::{Allowed, Reason};
use crate::problem::resolve::check::{ANGLE, Check, LENGTH};
use crate::problem::schema::{self, RangeOrSets};
use crate::problem::text::{At, Optional, key};
use crate::robot::dh::{self, Convention, Row};
use crate::robot::{JointKind, Limits, Robot};
use crate::spatial::Pose;

/// Speeds in degrees or mm per second.
const SPEED: Allowed = Allowed::positive(1e6);

impl Check<'_, '_> {
    /// The robot, or none if its limits cannot be swept.
    pub(super) fn table_robot(&mut self, file: &At<schema::File>) -> Option<Robot> {
        let faults = self.faults.len();
        let robot = key!(file, robot);
        let (joints, set) = (key!(robot, joints), key!(robot, limits));
        if joints.value.is_empty() {
            self.fault(&joints.path, Reason::NoArm);
        }
        self.without_urdf(file);
        let mut rows: Vec<Row> = Vec::with_capacity(joints.value.len());
        for joint in joints.elements() {
            let name = key!(joint, name);
            if name.value.trim().is_empty() {
                self.fault(&name.path, Reason::Empty);
            } else if rows.iter().any(|row| row.name == *name.value) {
                self.fault(&name.path, Reason::Duplicate { name: name.value.clone() });
            }
            rows.push(self.row(&joint, &set));
        }
        let in_sets = |limits: &Option<RangeOrSets>| matches!(limits, Some(RangeOrSets::Sets(_)));
        if !joints.value.iter().any(|joint| in_sets(&joint.limits_deg) || in_sets(&joint.limits_mm)) {
            self.refused(&[&set], "joints that give one range each", "leave it out");
        }
        let X_nF = key!(robot, flange).given().map_or_else(Pose::identity, |flange| self.pose(&flange));
        let X_FC = self.mount(&key!(file, camera));
        let convention = robot.value.convention.map_or(Convention::Standard, |named| named.0);
        let chain = dh::chain(&rows, convention, X_nF);
        let mut tree = dh::tree(&rows, convention, X_nF);
        let frames = rows.iter().enumerate().map(|(i, row)| (row.name.as_str(), dh::frame_link(i + 1)));
        let links = std::iter::once(("base", 0)).chain(frames).collect();
        let camera_link = tree.links.len() - 1;
        self.carried(file, X_FC, camera_link, &links, &mut tree);
        let obstacles = Vec::new();
        (self.faults.len() == faults).then_some(Robot { chain, X_FC, tree, board_link: 0, camera_link, obstacles })
    }

    /// Refuses what only a URDF gives a meaning to.
    fn without_urdf(&mut self, file: &At<schema::File>) {
        let robot = key!(file, robot);
        let to = format!("a robot without `{}`", key!(robot, urdf).path.name());
        self.refused(
            &[
                &key!(robot, srdf),
                &key!(robot, package_folders),
                &key!(robot, base_link),
                &key!(robot, camera_link),
                &key!(robot, joint_values_deg),
                &key!(robot, joint_values_mm),
                &key!(robot, exceed_urdf_limits),
            ],
            &to,
            "leave it out",
        );
        for limits in [key!(robot, limits_deg), key!(robot, limits_mm)] {
            let (limit, joints) = (limits.path.name(), key!(robot, joints).path);
            self.refused(&[&limits], &to, &format!("give `{limit}` to each of `{joints}`"));
        }
        self.refused(&[&key!(file, target.link)], &to, "leave it out; the board is in the base frame");
    }

    fn row(&mut self, joint: &At<schema::Joint>, set: &At<Option<String>>) -> Row {
        let (limits_deg, limits_mm) = (key!(joint, limits_deg), key!(joint, limits_mm));
        let (max_speed_deg_s, max_speed_mm_s) = (key!(joint, max_speed_deg_s), key!(joint, max_speed_mm_s));
        let instead = |key: &dyn Optional| format!("use `{}`", key.path().name());
        let kind = joint.value.kind.0;
        let (limits, max_speed) = match kind {
            JointKind::Revolute => {
                self.refused(&[&limits_mm], "a revolute joint", &instead(&limits_deg));
                self.refused(&[&max_speed_mm_s], "a revolute joint", &instead(&max_speed_deg_s));
                let limits = self.limits(limits_deg, set, ANGLE);
                (limits, max_speed_deg_s.given().map(|speed| self.angle(&speed, SPEED)))
            }
            JointKind::Prismatic => {
                self.refused(&[&limits_deg], "a prismatic joint", &instead(&limits_mm));
                self.refused(&[&max_speed_deg_s], "a prismatic joint", &instead(&max_speed_mm_s));
                let limits = self.limits(limits_mm, set, LENGTH);
                (limits, max_speed_mm_s.given().map(|speed| self.length(&speed, SPEED)))
            }
        };
        let [min, max] = limits.map(|limit| kind.in_si(limit));
        Row {
            name: joint.value.name.clone(),
            kind,
            a: self.length(&key!(joint, a_mm), LENGTH),
            alpha: self.angle(&key!(joint, alpha_deg), ANGLE),
            d: self.length(&key!(joint, d_mm), LENGTH),
            theta: self.angle(&key!(joint, theta_deg), ANGLE),
            limits: Limits { min, max },
            max_speed,
        }
    }

    /// The range to use, in the file's unit; of several that which the key `set` of the robot names.
    fn limits(&mut self, limits: At<Option<RangeOrSets>>, set: &At<Option<String>>, allowed: Allowed) -> [f64; 2] {
        const NONE: [f64; 2] = [0.0, 0.0];
        let Some(limits) = self.required(limits, &[]) else { return NONE };
        let sets = match limits.value {
            RangeOrSets::Range(range) => return self.range(&limits.with(range), allowed),
            RangeOrSets::Sets(sets) => limits.with(sets),
        };
        // The sets that are not used must be right too: another run may select them.
        for (_, range) in sets.entries() {
            self.range(&range, allowed);
        }
        let names: Vec<String> = sets.value.keys().cloned().collect();
        let reason = match set.value {
            None => Reason::Missing { allowed: names },
            Some(name) => match sets.value.get(name) {
                Some(range) => return range.0,
                None => Reason::UnknownName { name: name.clone(), allowed: names },
            },
        };
        // Every joint would say the same.
        if !self.faults.iter().any(|fault| fault.key == set.path.to_string()) {
            self.fault(&set.path, reason);
        }
        NONE
    }
}
