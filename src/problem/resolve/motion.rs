//! How the robot goes from pose to pose.

use std::collections::BTreeMap;

use super::check::Check;
use crate::motion::JointLimits;
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, key};
use crate::problem::{Home, MotionSettings};
use crate::robot::{Joint, JointKind};

/// Speeds and accelerations, in the units of the keys.
const SPEED: Allowed = Allowed::positive(1e6);
const ACCELERATION: Allowed = Allowed::positive(1e6);
const PERCENT: Allowed = Allowed::between(0.1, 100.0);
const DWELL: Allowed = Allowed::between(0.0, 3600.0);

/// Time in s in which a joint reaches its greatest speed whose acceleration nobody states.
const RAMP: f64 = 1.0;

impl Check<'_, '_> {
    pub(super) fn motion(&mut self, motion: &At<schema::Motion>, joints: &[Joint]) -> MotionSettings {
        let revolute = self.angle(&key!(motion, default_speed_deg_s), SPEED);
        let prismatic = self.length(&key!(motion, default_speed_mm_s), SPEED);
        let mut accelerations = vec![None; joints.len()];
        self.accelerations(&key!(motion, max_acceleration_deg_s2), JointKind::Revolute, joints, &mut accelerations);
        self.accelerations(&key!(motion, max_acceleration_mm_s2), JointKind::Prismatic, joints, &mut accelerations);
        let greatest = joints.iter().zip(accelerations).map(|(joint, acceleration)| {
            let assumed = if joint.kind == JointKind::Revolute { revolute } else { prismatic };
            let speed = joint.max_speed.unwrap_or(assumed);
            JointLimits { speed, acceleration: acceleration.unwrap_or(speed / RAMP) }
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

    /// Takes down what the file states of the joints of one kind.
    fn accelerations(
        &mut self,
        stated: &At<BTreeMap<String, f64>>,
        kind: JointKind,
        joints: &[Joint],
        accelerations: &mut [Option<f64>],
    ) {
        // Without a robot there is nothing to name.
        for (name, value) in stated.entries().filter(|_| !joints.is_empty()) {
            let acceleration = kind.in_si(self.number(&value, ACCELERATION));
            match joints.iter().position(|joint| joint.name == *name) {
                Some(j) if joints[j].kind == kind => accelerations[j] = Some(acceleration),
                Some(j) => {
                    let to = format!("a {} joint", joints[j].kind.adjective());
                    let unit = joints[j].kind.display_unit();
                    self.not_applicable(&value.path, &to, &format!("give it in `max_acceleration_{unit}_s2`"));
                }
                None => {
                    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
                    self.unknown(&value.path, name, &names);
                }
            }
        }
    }
}
