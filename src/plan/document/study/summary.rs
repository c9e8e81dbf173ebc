//! What a study comes to.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header, ProblemReference};

/// What a study comes to: marginal means, and levels compared where all else is equal. The rows themselves are in tables beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Name of the study.
    pub name: String,
    /// SHA-256 of the study file's bytes, in hexadecimal.
    pub sha256: String,
    /// The base problems, with what the study sets in all cells.
    pub problems: Vec<ProblemReference>,
    /// Cells.
    pub cells: usize,
    /// Rows of the table.
    pub rows: usize,
    /// Why rows have no choice, the most frequent reason first.
    pub reasons: Vec<ReasonCount>,
    /// What varies.
    pub axes: Vec<StudyAxis>,
    /// Each outcome asked for.
    pub outcomes: Vec<OutcomeSummary>,
}

/// A reason why there is no choice.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ReasonCount {
    /// The reason.
    pub reason: String,
    /// Rows that have it.
    pub rows: usize,
}

/// What varies over the rows: a factor, the problem, the criterion, the number of poses or the method.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct StudyAxis {
    /// Its name: the factor's, `problem`, `criterion`, `count` or `method`.
    pub name: String,
    /// Its levels, in their order; numbers that were drawn are put together in intervals.
    pub levels: Vec<String>,
}

/// An outcome over all rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OutcomeSummary {
    /// Name of the outcome: a column of the table.
    pub outcome: String,
    /// Its means at the levels of each axis.
    pub means: Vec<AxisMeans>,
    /// Levels of each axis against its first, all else being equal.
    pub compared: Vec<ComparedLevels>,
}

/// Means of an outcome at the levels of an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AxisMeans {
    /// The axis.
    pub axis: String,
    /// The means, for each series level by level.
    pub means: Vec<Mean>,
}

/// The mean of an outcome over the rows of one level and series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mean {
    /// Problem, criterion, number of poses and method, as far as they vary and are not the axis.
    pub series: String,
    /// The level.
    pub level: String,
    /// The level as a number, if it is one; the middle of an interval.
    pub number: Option<f64>,
    /// Rows that have the outcome.
    pub rows: usize,
    /// Rows without.
    pub without: usize,
    /// The mean; `null` without rows.
    pub mean: Option<f64>,
    /// Its 95 % confidence interval (Student's t); `null` with fewer than two rows.
    pub interval: Option<[f64; 2]>,
    /// Least and greatest; `null` without rows.
    pub range: Option<[f64; 2]>,
    /// The median; `null` without rows.
    pub median: Option<f64>,
}

/// Levels of an axis against its first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedLevels {
    /// The axis.
    pub axis: String,
    /// Its first level, which the others are held against.
    pub against: String,
    /// The others.
    pub differences: Vec<Difference>,
}

/// A level against the first: the mean over pairs of rows that differ in nothing else. Rows that differ in the seed alone count
/// as one, their mean, unless there is only one such pair; then each is paired.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// Problem, criterion, number of poses and method, as far as they vary and are not the axis.
    pub series: String,
    /// The level.
    pub level: String,
    /// Pairs.
    pub pairs: usize,
    /// The mean difference, this level less the first.
    pub difference: f64,
    /// Its 95 % confidence interval (Student's t); `null` with fewer than two pairs.
    pub interval: Option<[f64; 2]>,
    /// The geometric mean of the ratios, this level to the first; `null` where a number is not positive.
    pub ratio: Option<f64>,
    /// Its 95 % confidence interval; `null` with fewer than two pairs.
    pub ratio_interval: Option<[f64; 2]>,
}

impl Document for StudyDocument {
    const FORMAT: &'static str = "calipose.study";
    const VERSION: u32 = 1;
}
