//! The poses to take next: `next.json`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::plan::document::plan::{PlannedPose, is_one};

/// What the views taken so far tell, and the poses that would tell most beside them.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct NextDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// Number of views taken so far.
    pub views: usize,
    /// Pictures to take at each pose; 1 where it is not said.
    #[serde(skip_serializing_if = "is_one")]
    pub pictures: usize,
    /// The estimated intrinsics by these views.
    pub intrinsics: super::EstimatedIntrinsics,
    /// Map error by what they tell, px.
    pub known_map_error_px: Option<f64>,
    /// Map error expected after the poses, px, linearised about the camera found so far.
    pub expected_map_error_px: Option<f64>,
    /// Map errors of simulated calibrations with the poses, with cameras drawn from what is known; `null` without poses, and where
    /// too little is known to simulate.
    pub simulated_map_error_px: Option<SimulatedMapError>,
    /// Whether the poses are as many, or as good, as was asked for.
    pub fulfilled: bool,
    /// Names of the joints, in the order of the poses' joint values.
    pub joints: Vec<String>,
    /// The poses, as in plans; none if what is known suffices.
    pub poses: Vec<PlannedPose>,
    /// For each pose the name of the view taken that it would repeat, or `null`.
    pub repeats: Vec<Option<String>>,
}

/// What simulated calibrations came to, px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SimulatedMapError {
    /// Calibrations simulated.
    pub trials: usize,
    /// Those that gave no camera.
    pub failed: usize,
    /// Half of the map errors are below this.
    pub median: f64,
    /// Nine tenths are.
    pub percentile_90: f64,
    /// Root mean square of all.
    pub rms: f64,
}

impl Document for NextDocument {
    const FORMAT: &'static str = "calipose.next";
    const VERSION: u32 = 2;
}
