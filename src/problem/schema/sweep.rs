//! `[sweep]`: the joint configurations to try.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::{Named, NumberOrList};
use crate::sweep::AxisRule;

/// The joint configurations to try: a grid (`step_deg`, `step_mm`) or a low-discrepancy sample (`sample`). A sample of
/// 200 000 when nothing is given.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sweep {
    /// Step of the revolute joints in degrees: one number for all, or a list with one per revolute joint.
    pub(crate) step_deg: Option<NumberOrList>,
    /// Step of the prismatic joints in mm: one number for all, or a list with one per prismatic joint.
    pub(crate) step_mm: Option<NumberOrList>,
    /// Number of configurations of a Halton sample, instead of a grid.
    #[schemars(range(min = 1))]
    pub(crate) sample: Option<u64>,
    /// Rounds of refinement: each tries configurations around the poses that selection picks, closer in each round; none when left
    /// out.
    #[serde(default)]
    pub(crate) refine: u64,
    /// Number of configurations that each round of refinement tries; 20 000 when left out.
    #[schemars(range(min = 1))]
    pub(crate) refine_sample: Option<u64>,
    /// Where the optical axis must go: "any" keeps all configurations, "zone" those whose axis meets the zone.
    #[serde(default = "any_axis")]
    pub(crate) axis: Named<AxisRule>,
    /// Published counts for this sweep, which `calipose sweep` shows beside its own.
    #[serde(default)]
    pub(crate) published: Vec<Published>,
}

/// Published counts of a sweep.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Published {
    /// Step of all joints in degrees.
    pub(crate) step_deg: f64,
    /// Number of configurations.
    pub(crate) swept: u64,
    /// Number of those whose optical axis meets the zone.
    pub(crate) in_zone: u64,
}

fn any_axis() -> Named<AxisRule> {
    Named(AxisRule::Any)
}

impl Default for Named<AxisRule> {
    fn default() -> Self {
        any_axis()
    }
}
