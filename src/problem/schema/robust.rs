//! `[robust]`: what a plan must withstand.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::Named;
use crate::problem::RobustGoal;

/// How far the set-up may be from what is stated, as standard deviations, and what the plan makes of it. The plan is made for
/// scenarios: set-ups drawn from these, the stated one first.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Robust {
    /// What is made great over the scenarios: "mean" the geometric mean of the criterion, "worst" the least; "worst" for
    /// accuracies, which every scenario must reach, and "mean" otherwise when left out.
    pub(crate) goal: Option<Named<RobustGoal>>,
    /// Number of scenarios, the stated set-up among them.
    #[schemars(range(min = 2))]
    pub(crate) scenarios: u64,
    /// Number of set-ups drawn, the scenarios among them, to try the views in.
    pub(crate) draws: u64,
    /// Minimum share of these in which a configuration must be a view, by every condition.
    pub(crate) seen_share: f64,
    /// Standard deviation of the focal length in percent, one factor for fx and fy.
    pub(crate) focal_length_percent: f64,
    /// Standard deviation of cx and cy in px.
    pub(crate) principal_point_px: f64,
    /// Standard deviations of other intrinsics by name, in their own units, as in `{ k1 = 0.02 }`.
    pub(crate) intrinsics: BTreeMap<String, f64>,
    /// Standard deviation of the camera mount's position along each axis, in mm.
    pub(crate) mount_translation_mm: f64,
    /// Standard deviation of the camera mount's rotation about each axis, in degrees.
    pub(crate) mount_rotation_deg: f64,
    /// Standard deviation of the board's position along each axis, in mm.
    pub(crate) board_translation_mm: f64,
    /// Standard deviation of the board's rotation about each axis, in degrees.
    pub(crate) board_rotation_deg: f64,
    /// Standard deviation of the zero of every revolute joint, in degrees.
    pub(crate) joint_zero_deg: f64,
    /// Standard deviation of the zero of every prismatic joint, in mm.
    pub(crate) joint_zero_mm: f64,
}

impl Default for Robust {
    fn default() -> Self {
        Self {
            goal: None,
            scenarios: 8,
            draws: 500,
            seen_share: 0.995,
            focal_length_percent: 0.0,
            principal_point_px: 0.0,
            intrinsics: BTreeMap::new(),
            mount_translation_mm: 0.0,
            mount_rotation_deg: 0.0,
            board_translation_mm: 0.0,
            board_rotation_deg: 0.0,
            joint_zero_deg: 0.0,
            joint_zero_mm: 0.0,
        }
    }
}
