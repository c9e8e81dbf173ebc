//! What was confirmed of a plan, as `calipose certify --json` prints it.

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};

/// What was recomputed of a plan, and agrees with it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Certified {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// What the plan optimises, as in the plan.
    pub criterion: String,
    /// Number of poses of the plan.
    pub count: usize,
    /// Views that the bound is over.
    pub views: usize,
    /// The plan's value, in the criterion's own unit as in the plan.
    pub value: f64,
    /// The bound that the plan's matrix proves.
    pub bound: f64,
    /// The efficiency that these two prove.
    pub efficiency: f64,
    /// The bound over all joint values, in the same unit; `null` where the plan states none.
    pub continuum_bound: Option<f64>,
    /// The efficiency by it.
    pub continuum_efficiency: Option<f64>,
    /// Fewer poses than this are proven not to reach the accuracies; `null` unless some were requested and a matrix alone
    /// proves it.
    pub least_count: Option<usize>,
    /// The plan's numbers agree to this share.
    pub tolerance: f64,
    /// The fields of the plan that are not checked.
    pub not_checked: Vec<NotChecked>,
}

/// A field of a plan that is not checked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NotChecked {
    /// Its key, with those above it, as in `search.nodes`.
    pub field: String,
    /// Why not.
    pub reason: String,
}

impl Document for Certified {
    const FORMAT: &'static str = "calipose.certified";
    const VERSION: u32 = 3;
}
