//! Every method side by side, as `calipose compare --json` prints it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header, ProblemReference, by_name, from_names};

/// What every method chooses at several numbers of poses. Numbers that are infinite or undefined are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: ProblemReference,
    /// What is optimised, as in plans.
    pub criterion: String,
    /// For each number of poses, a row per method.
    pub rows: Vec<ComparisonRow>,
    /// How many k-means poses do what the best plan does.
    pub equivalents: Vec<ComparisonEquivalent>,
}

/// One method at one number of poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonRow {
    /// The method; `best-off-grid` where the poses could leave the grid.
    pub method: String,
    /// Number of poses.
    pub count: usize,
    /// The criterion's value, in its own unit.
    pub value: Option<f64>,
    /// Predicted map error, px.
    pub map_error_px: Option<f64>,
    /// Predicted standard deviations by the names of the intrinsics, in their order; empty if one is undetermined.
    #[serde(serialize_with = "by_name", deserialize_with = "from_names")]
    #[schemars(with = "BTreeMap<String, Option<f64>>")]
    pub sigma: Vec<(String, f64)>,
    /// What simulated calibrations came to; `null` if there were none.
    pub measured: Option<MeasuredRow>,
    /// Share of the best possible information that the choice has at least.
    pub efficiency: Option<f64>,
    /// Time to choose, s.
    pub seconds: f64,
}

/// What simulated calibrations came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredRow {
    /// Calibrations simulated.
    pub trials: usize,
    /// Those that gave no camera.
    pub failed: usize,
    /// RMS map error of the others, px.
    pub map_error_px: Option<f64>,
    /// Standard deviations of the others by the names of the intrinsics.
    pub sigma: BTreeMap<String, Option<f64>>,
}

/// How many poses clustered by k-means do what a plan does.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonEquivalent {
    /// Number of poses of the plan.
    pub count: usize,
    /// The clustering.
    pub method: String,
    /// Number of its poses, to a twentieth; `null` if none that was tried suffices.
    pub equivalent_count: Option<usize>,
    /// The greatest number tried.
    pub tried: usize,
}

impl Document for ComparisonDocument {
    const FORMAT: &'static str = "calipose.comparison";
    const VERSION: u32 = 2;
}
