//! How the robot goes from pose to pose.

use std::collections::BTreeMap;

use super::check::Check;
use crate::motion::JointLimits;
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, key};
use crate::problem::{Home, MotionSettings};
use crate::robot::{Joint, JointKind};

/// Speeds, accelerations and jerks, in the units of the keys.
const SPEED: Allowed = Allowed::positive(1e6);
const ACCELERATION: Allowed = Allowed::positive(1e6);
const JERK: Allowed = Allowed::positive(1e9);
const PERCENT: Allowed = Allowed::between(0.1, 100.0);
const DWELL: Allowed = Allowed::between(0.0, 3600.0);

/// Time in s in which a joint reaches its greatest speed whose acceleration nobody states.
const RAMP: f64 = 1.0;

/// Two keys that hold a number for joints by name, `NAME_deg_sORDER` and `NAME_mm_sORDER`.
struct ByName {
    name: &'static str,
    order: usize,
    allowed: Allowed,
}

impl Check<'_, '_> {
    pub(super) fn motion(&mut self, motion: &At<schema::Motion>, joints: &[Joint]) -> MotionSettings {
        let revolute = self.angle(&key!(motion, default_speed_deg_s), SPEED);
        let prismatic = self.length(&key!(motion, default_speed_mm_s), SPEED);
        let accelerations = self.by_name(
            [&key!(motion, max_acceleration_deg_s2), &key!(motion, max_acceleration_mm_s2)],
            &ByName { name: "max_acceleration", order: 2, allowed: ACCELERATION },
            joints,
        );
        let jerks = self.by_name(
            [&key!(motion, max_jerk_deg_s3), &key!(motion, max_jerk_mm_s3)],
            &ByName { name: "max_jerk", order: 3, allowed: JERK },
            joints,
        );
        let greatest = joints.iter().zip(accelerations.iter().zip(&jerks)).map(|(joint, (acceleration, jerk))| {
            let assumed = if joint.kind == JointKind::Revolute { revolute } else { prismatic };
            let speed = joint.max_speed.unwrap_or(assumed);
            let acceleration = acceleration.unwrap_or(speed / RAMP);
            JointLimits { speed, acceleration, jerk: jerk.unwrap_or(f64::INFINITY) }
        });
        MotionSettings {
            greatest: greatest.collect(),
            share: self.number(&key!(motion, speed_percent), PERCENT) / 100.0,
            assumed: (0..joints.len()).filter(|&j| joints[j].max_speed.is_none()).collect(),
            home: self.home(motion, joints),
            dwell: self.number(&key!(motion, dwell_s), DWELL),
        }
    }

    fn home(&mut self, motion: &At<schema::Motion>, joints: &[Joint]) -> Option<Home> {
        let home = key!(motion, home).given()?;
        let q = self.configuration(&home, joints);
        for ((value, joint), stated) in q.iter().zip(joints).zip(home.elements()) {
            if !joint.limits.holds(*value) {
                let [low, high] = [joint.limits.min, joint.limits.max].map(|limit| joint.kind.to_display(limit));
                self.within(&stated.path, *stated.value, Allowed::between(low, high));
            }
        }
        Some(Home { q, returns: motion.value.return_home })
    }

    /// What the file states of joints by their names, in SI units: of revolute ones in one table, of prismatic ones in another.
    fn by_name(
        &mut self,
        [revolute, prismatic]: [&At<BTreeMap<String, f64>>; 2],
        keys: &ByName,
        joints: &[Joint],
    ) -> Vec<Option<f64>> {
        let mut found = vec![None; joints.len()];
        // Without a robot there is nothing to name.
        if joints.is_empty() {
            return found;
        }
        let stated = [(revolute, JointKind::Revolute), (prismatic, JointKind::Prismatic)];
        let stated = stated.into_iter().flat_map(|(table, kind)| table.entries().map(move |entry| (kind, entry)));
        for (kind, (name, value)) in stated {
            let greatest = kind.in_si(self.number(&value, keys.allowed));
            match joints.iter().position(|joint| joint.name == *name) {
                Some(j) if joints[j].kind == kind => found[j] = Some(greatest),
                Some(j) => {
                    let to = format!("a {} joint", joints[j].kind.adjective());
                    let ByName { name, order, .. } = keys;
                    let unit = joints[j].kind.display_unit();
                    self.not_applicable(&value.path, &to, &format!("give it in `{name}_{unit}_s{order}`"));
                }
                None => {
                    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
                    self.unknown(&value.path, name, &names);
                }
            }
        }
        found
    }
}
