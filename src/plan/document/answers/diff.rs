//! What differs between two plans, as `calipose diff --json` prints it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header, ProblemReference};

/// Two plans, A and B, held against each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiffDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The plan A.
    pub a: ComparedPlan,
    /// The plan B.
    pub b: ComparedPlan,
    /// Whether both answer the same problem: the file's bytes, and the values given in place of its own, but for what was to be selected.
    pub same_problem: bool,
    /// Whether their values are of the same thing: of one problem, by one criterion. Where they are not they may not compare.
    pub comparable: bool,
    /// The standard deviations of every intrinsic that either estimates.
    pub sigma: Vec<SigmaChange>,
    /// Names of the joints, in the order of the joint values: that of A.
    pub joints: Vec<String>,
    /// Ids, in A and in B, of the poses that both have.
    pub same: Vec<[usize; 2]>,
    /// The poses that B has near those of A.
    pub moved: Vec<MovedPose>,
    /// The poses that A alone has.
    pub only_a: Vec<LonePose>,
    /// The poses that B alone has.
    pub only_b: Vec<LonePose>,
}

/// A plan in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedPlan {
    /// Its file.
    pub file: String,
    /// The problem that it answers.
    pub problem: ProblemReference,
    /// Version of calipose that made it.
    pub calipose: String,
    /// What is optimised, as in plans.
    pub criterion: String,
    /// Name of the method.
    pub method: String,
    /// Number of poses.
    pub count: usize,
    /// Pictures at each pose.
    pub pictures: usize,
    /// The criterion's value.
    pub value: f64,
    /// What no other set can surpass.
    pub bound: f64,
    /// Certified efficiency.
    pub efficiency: f64,
    /// Predicted map error, px.
    pub map_error_px: f64,
    /// Time of all moves, s; `null` where the plan has no tour.
    pub moving_s: Option<f64>,
    /// Time of all moves and pictures, s.
    pub total_s: Option<f64>,
}

/// The standard deviations of an intrinsic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SigmaChange {
    /// Name of the intrinsic.
    pub name: String,
    /// By A; `null` where it does not estimate it.
    pub a: Option<f64>,
    /// By B.
    pub b: Option<f64>,
}

/// A pose that is elsewhere in B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MovedPose {
    /// Its id in A.
    pub id_a: usize,
    /// Its id in B.
    pub id_b: usize,
    /// Joint values in A, degrees (mm for prismatic joints).
    pub joints_a_deg: Vec<f64>,
    /// Joint values in B.
    pub joints_b_deg: Vec<f64>,
    /// How far it is in joint space: the root of the sum of squares of rad and m.
    pub distance_rad: f64,
}

/// A pose that one plan alone has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LonePose {
    /// Its id.
    pub id: usize,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_deg: Vec<f64>,
    /// Id of the pose of the other plan that is nearest in joint space.
    pub nearest: usize,
    /// How far that is, as of poses that moved.
    pub distance_rad: f64,
}

impl Document for DiffDocument {
    const FORMAT: &'static str = "calipose.diff";
    const VERSION: u32 = 1;
}
