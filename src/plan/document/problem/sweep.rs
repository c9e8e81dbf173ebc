//! Counts of sweeps, as `calipose sweep --json` prints them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::feasibility::Rejection;
use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::plan::document::plan::rejected_by_name;
use crate::problem::{Problem, PublishedSweep};
use crate::sweep::Sweep;

/// How many configurations, candidates and views a problem has at one or several steps.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SweepDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: ProblemReference,
    /// A sweep for each step.
    pub sweeps: Vec<SweepCounts>,
}

/// Counts of one sweep.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SweepCounts {
    /// Step of the revolute joints; `null` for the file's own.
    pub step_deg: Option<f64>,
    /// Configurations swept.
    pub swept: usize,
    /// Optical axes that fall inside the zone.
    pub axis_inside: usize,
    /// Optical axes that fall on the zone's edge.
    pub axis_edge: usize,
    /// Optical axes that miss the zone.
    pub axis_outside: usize,
    /// What others published for this step; `null` if nobody did.
    pub published: Option<PublishedCounts>,
    /// Configurations whose axis passes.
    pub candidates: usize,
    /// Candidates that can be taken and see the board.
    pub views: usize,
    /// Candidates rejected, by reason.
    pub rejected: BTreeMap<String, usize>,
    /// How long the sweep took.
    pub seconds: f64,
}

/// Counts that others published.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct PublishedCounts {
    /// Configurations swept.
    pub swept: usize,
    /// Optical axes inside the zone or on its edge.
    pub in_zone: usize,
}

impl Document for SweepDocument {
    const FORMAT: &'static str = "calipose.sweep";
    const VERSION: u32 = 2;
}

impl SweepDocument {
    /// The document of sweeps of `problem`.
    pub fn new(problem: &Problem, sweeps: Vec<SweepCounts>) -> Self {
        Self { header: Self::header(), problem: ProblemReference::new(problem), sweeps }
    }
}

impl SweepCounts {
    /// The counts of a sweep with that step (degrees), the views among its candidates and those rejected.
    pub fn new(
        step_deg: Option<f64>,
        found: &Sweep,
        published: Option<&PublishedSweep>,
        views: usize,
        rejected: [usize; Rejection::ALL.len()],
        seconds: f64,
    ) -> Self {
        Self {
            step_deg,
            swept: found.swept,
            axis_inside: found.inside,
            axis_edge: found.edge,
            axis_outside: found.outside(),
            published: published.map(|&PublishedSweep { swept, in_zone, .. }| PublishedCounts { swept, in_zone }),
            candidates: found.candidates.len(),
            views,
            rejected: rejected_by_name(&rejected),
            seconds,
        }
    }
}
