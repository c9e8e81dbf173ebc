//! What a plan must withstand.

use super::check::Check;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::text::{At, key};
use crate::problem::{Goal, RobustGoal, Robustness, Uncertainty};

/// Standard deviations of a set-up, in the units of the keys: where they are as large as that nothing is known of it.
const DEVIATION: Allowed = Allowed::between(0.0, 1e3);
const ANGLE: Allowed = Allowed::between(0.0, 90.0);
const PERCENT: Allowed = Allowed::between(0.0, 50.0);

impl Check<'_, '_> {
    /// `names` are those of the lens's intrinsics.
    pub(super) fn robust(&mut self, robust: &At<schema::Robust>, names: &[&str], goal: &Goal) -> Robustness {
        let faults = self.faults.len();
        let mut intrinsics = Vec::new();
        for (name, deviation) in key!(robust, intrinsics).entries() {
            let value = self.number(&deviation, Allowed::between(0.0, 1e6));
            match names.iter().position(|known| known == name) {
                Some(index) => intrinsics.push((index, value)),
                None => self.unknown(&deviation.path, name, names),
            }
        }
        let uncertainty = Uncertainty {
            focal_length: self.number(&key!(robust, focal_length_percent), PERCENT) / 100.0,
            principal_point: self.number(&key!(robust, principal_point_px), DEVIATION),
            intrinsics,
            mount_translation: self.length(&key!(robust, mount_translation_mm), DEVIATION),
            mount_rotation: self.angle(&key!(robust, mount_rotation_deg), ANGLE),
            board_translation: self.length(&key!(robust, board_translation_mm), DEVIATION),
            board_rotation: self.angle(&key!(robust, board_rotation_deg), ANGLE),
            revolute_zero: self.angle(&key!(robust, joint_zero_deg), ANGLE),
            prismatic_zero: self.length(&key!(robust, joint_zero_mm), DEVIATION),
        };
        if uncertainty.is_none() && self.faults.len() == faults {
            self.fault(&robust.path, Reason::NothingUncertain);
        }
        let stated = key!(robust, goal);
        let accuracies = matches!(goal, Goal::Fewest { .. });
        if accuracies && stated.value.is_some_and(|goal| goal.0 == RobustGoal::Mean) {
            self.not_applicable(&stated.path, "accuracies, which every scenario must reach", "leave it out");
        }
        let usual = if accuracies { RobustGoal::Worst } else { RobustGoal::Mean };
        let scenarios = self.count(&key!(robust, scenarios), Allowed::between(2.0, 100.0));
        Robustness {
            uncertainty,
            goal: stated.value.map_or(usual, |goal| goal.0),
            scenarios,
            draws: self.count(&key!(robust, draws), Allowed::between(scenarios as f64, 1e5)),
            seen_share: self.number(&key!(robust, seen_share), Allowed::between(0.0, 1.0)),
        }
    }
}
