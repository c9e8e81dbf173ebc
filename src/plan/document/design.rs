//! The design of a set-up, as `calipose design` finds it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::header::{Document, Header, ProblemReference};

/// The best set-up that was found, and what is known of the others. Numbers that are infinite or undefined are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Name of the design.
    pub name: String,
    /// SHA-256 of the design file's bytes, in hexadecimal.
    pub sha256: String,
    /// The problem, with what the design sets in all set-ups.
    pub problem: ProblemReference,
    /// What is optimised, as in plans.
    pub criterion: String,
    /// Number of poses.
    pub count: usize,
    /// The set-up of the problem file by itself, without what the design sets in all set-ups; `null` if it has no plan.
    pub as_given: Option<SetUp>,
    /// The best set-up.
    pub best: SetUp,
    /// What is proven.
    pub proof: DesignProof,
    /// The best set-ups that have a plan, the best first.
    pub ranking: Vec<SetUp>,
    /// What it costs to change one thing about the best set-up.
    pub sensitivity: Vec<Sensitivity>,
    /// The best set-up with the board elsewhere, if two coordinates of its position are free.
    pub map: Option<DesignMap>,
}

/// A set-up and its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SetUp {
    /// The values of what is free, in the order of the design file.
    pub values: Vec<FreeValue>,
    /// Views to choose from.
    pub views: usize,
    /// The criterion's value of its plan, in its own unit.
    pub value: Option<f64>,
    /// The best value that any plan of as many of its views can have, in the same unit.
    pub bound: Option<f64>,
    /// Share of the best possible information that its plan has at least.
    pub efficiency: Option<f64>,
    /// Predicted map error of its plan, px.
    pub map_error_px: Option<f64>,
    /// Least distance from the camera to the board's centre in its plan, mm.
    pub nearest_mm: f64,
}

/// A value of something free.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FreeValue {
    /// What is free.
    pub name: String,
    /// The value.
    pub value: String,
    /// The value as a number, if it is one.
    pub number: Option<f64>,
    /// What sets it, `KEY=VALUE` each.
    pub set: Vec<String>,
}

/// What is proven of a family of set-ups: those that were examined on the problem's own sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignProof {
    /// Set-ups tried on a coarser sweep, of which nothing is proven.
    pub screened: usize,
    /// Set-ups examined: the family.
    pub examined: usize,
    /// Those of them that no plan of so many poses is possible for.
    pub without_plan: usize,
    /// Set-ups beside the family that no plan was found for, of which nothing is proven.
    pub undecided: usize,
    /// Those of which a bound on all their plans is worse than the best plan.
    pub proven_worse: usize,
    /// No plan for any set-up of the family has a better value, in the criterion's own unit.
    pub bound: Option<f64>,
    /// The least map error that this bound allows, px; of the criterion `v` alone.
    pub map_error_bound_px: Option<f64>,
}

/// What it costs to change one thing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensitivity {
    /// What is changed.
    pub name: String,
    /// The changes, in order; the best set-up is among them.
    pub points: Vec<SensitivityPoint>,
}

/// The best set-up with one other value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensitivityPoint {
    /// The value.
    pub value: String,
    /// The value as a number, if it is one.
    pub number: Option<f64>,
    /// Predicted map error of the best plan found for it, px; `null` if there is none.
    pub map_error_px: Option<f64>,
}

/// The predicted map error over two coordinates of the board's position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignMap {
    /// Name of the first coordinate.
    pub x: String,
    /// Name of the second.
    pub y: String,
    /// Values of the first.
    pub x_values: Vec<f64>,
    /// Values of the second.
    pub y_values: Vec<f64>,
    /// The map error, px, for each value of the second in a row by the first; `null` where the board is off the surface, or no
    /// plan is possible.
    pub map_error_px: Vec<Vec<Option<f64>>>,
}

/// What a search for the best set-up would take.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignCheckDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Name of the design.
    pub name: String,
    /// SHA-256 of the design file's bytes, in hexadecimal.
    pub sha256: String,
    /// The problem, with what the design sets in all set-ups.
    pub problem: ProblemReference,
    /// Names of what is free.
    pub free: Vec<String>,
    /// Set-ups that would be screened on a coarser sweep.
    pub screened: usize,
    /// Set-ups that would be examined on the problem's own sweep, at most.
    pub examined_at_most: usize,
    /// Seconds that it takes on this machine, about.
    pub seconds: f64,
    /// Folder for the results.
    pub output: PathBuf,
}

impl Document for DesignCheckDocument {
    const FORMAT: &'static str = "calipose.design-check";
    const VERSION: u32 = 1;
}

impl Document for DesignDocument {
    const FORMAT: &'static str = "calipose.design";
    const VERSION: u32 = 1;
}
