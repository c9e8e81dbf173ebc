//! One cell of a study.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header, ProblemReference, by_name, from_names};

/// What was found in one cell of a study: one setting of all factors, by every method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// SHA-256 of all that the rows follow from, in hexadecimal: the version of calipose, the problem as it was understood, and
    /// what was to be chosen and simulated. Cells of the same fingerprint have the same rows.
    pub fingerprint: String,
    /// The problem, with the setting of the factors.
    pub problem: ProblemReference,
    /// The rows.
    pub rows: Vec<CellRow>,
    /// How long it took; alone here, not the same in every run.
    pub seconds: CellSeconds,
}

/// One method's choice of so many poses by one criterion, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellRow {
    /// What is optimised, as in plans.
    pub criterion: String,
    /// The method.
    pub method: String,
    /// Number of poses asked for; none where accuracies are.
    pub count: Option<usize>,
    /// Seed of a method that depends on one.
    pub seed: Option<u64>,
    /// What was found; none where there is no choice.
    pub outcome: Option<CellOutcome>,
    /// Why there is no choice.
    pub reason: Option<String>,
}

/// What a choice is worth. Numbers that are infinite or undefined are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellOutcome {
    /// Configurations swept.
    pub configurations: usize,
    /// Those that passed the axis test.
    pub candidates: usize,
    /// Those that can be taken and see the board.
    pub views: usize,
    /// Number of poses.
    pub poses: usize,
    /// The criterion's value, in its own unit.
    pub value: Option<f64>,
    /// The best value that any choice of as many poses can have, in the same unit.
    pub bound: Option<f64>,
    /// Share of the best possible information that the choice has at least.
    pub efficiency: Option<f64>,
    /// Predicted map error, px.
    pub map_error_px: Option<f64>,
    /// Predicted standard deviations by the names of the intrinsics, in their order; empty if one is undetermined.
    #[serde(serialize_with = "by_name", deserialize_with = "from_names")]
    #[schemars(with = "std::collections::BTreeMap<String, Option<f64>>")]
    pub sigma: Vec<(String, f64)>,
    /// What simulated calibrations came to, if there were any.
    pub simulated: Option<SimulatedOutcome>,
}

/// What simulated calibrations came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SimulatedOutcome {
    /// Calibrations simulated.
    pub trials: usize,
    /// Those that gave no camera.
    pub failed: usize,
    /// RMS map error of the others, px.
    pub map_error_px: Option<f64>,
    /// Its standard error, px.
    pub standard_error_px: Option<f64>,
}

/// Wall-clock times of a cell, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct CellSeconds {
    /// Sweep, views and their information; 0 where another cell's were used.
    pub survey: f64,
    /// Choosing, certificates and simulations.
    pub rows: f64,
}

impl Document for CellDocument {
    const FORMAT: &'static str = "calipose.cell";
    const VERSION: u32 = 1;
}
