//! What a plan's poses were chosen from, in numbers.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::feasibility::Rejection;
use crate::plan::survey::Survey;

/// How many configurations were swept, how many of them are candidates, and how many of these are views.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SurveyCounts {
    /// Configurations swept.
    pub swept: usize,
    /// Optical axes that fall inside the zone.
    pub axis_inside: usize,
    /// Optical axes that fall on the zone's edge.
    pub axis_edge: usize,
    /// Configurations tried around picked poses, beside the swept ones.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub refined: usize,
    /// Views, which passed every check: what the poses were chosen from.
    pub views: usize,
    /// How many of the views are off the grid.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub off_grid: usize,
    /// Candidates rejected, by reason.
    pub rejected: BTreeMap<String, usize>,
}

impl SurveyCounts {
    pub(crate) fn new(survey: &Survey) -> Self {
        Self {
            swept: survey.sweep.swept,
            axis_inside: survey.sweep.inside,
            axis_edge: survey.sweep.edge,
            refined: survey.refined,
            views: survey.views.len(),
            off_grid: survey.off_grid,
            rejected: rejected_by_name(&survey.rejected),
        }
    }
}

/// By the reasons' names; whether a view is certain is a question of robust plans alone.
pub(crate) fn rejected_by_name(rejected: &[usize; Rejection::ALL.len()]) -> BTreeMap<String, usize> {
    let counted = Rejection::ALL.iter().zip(rejected);
    let counted = counted.filter(|&(&reason, &count)| reason != Rejection::Uncertain || count > 0);
    counted.map(|(reason, &count)| (reason.name().into(), count)).collect()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(number: &usize) -> bool {
    *number == 0
}
