//! A design file.
#![expect(clippy::struct_field_names, reason = "the units are part of the keys")]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Factor;
use crate::problem::Numbers;

/// The design of a set-up: a problem, what of it is free, and where the board may lie.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "calipose design")]
pub(crate) struct DesignFile {
    /// Name of the design; the file's name without its extension when left out.
    pub(crate) name: Option<String>,
    /// Problem file, relative to the design file's folder. All of its checks hold for every set-up.
    pub(crate) problem: String,
    /// Values in place of the problem file's, in all set-ups, each `KEY=VALUE`, as `--set` takes them.
    #[serde(default)]
    pub(crate) set: Vec<String>,
    /// What is free: keys of the problem file with the values that they may have.
    pub(crate) free: Vec<Factor>,
    /// Where the whole printed board must lie; anywhere when left out.
    pub(crate) surface: Option<Surface>,
    /// How much is tried.
    #[serde(default)]
    pub(crate) search: Search,
    /// Where results go.
    #[serde(default)]
    pub(crate) output: super::study::Output,
}

/// Where the board may lie: ranges of the coordinates, in the frame that `target.pose` is in, of all that is printed.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Surface {
    /// Least and greatest x, in mm.
    pub(crate) x_mm: Option<Numbers<2>>,
    /// Least and greatest y, in mm.
    pub(crate) y_mm: Option<Numbers<2>>,
    /// Least and greatest z, in mm.
    pub(crate) z_mm: Option<Numbers<2>>,
}

/// How much is tried. Numbers, not times, so that the result does not depend on the machine.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Search {
    /// Set-ups all over the ranges that are tried on a coarser sweep.
    #[schemars(range(min = 1, max = 60_000))]
    pub(crate) screened: u32,
    /// The best of them that are tried on the problem's own sweep.
    #[schemars(range(min = 1, max = 10_000))]
    pub(crate) finalists: u32,
    /// Rounds of trying neighbours of the best.
    #[schemars(range(min = 0, max = 1000))]
    pub(crate) rounds: u32,
    /// Points along each side of the map over the first two free coordinates of the board's position; 0 for no map.
    #[schemars(range(min = 0, max = 100))]
    pub(crate) map: u32,
    /// Seed of all draws.
    pub(crate) seed: u32,
}

impl Default for Search {
    fn default() -> Self {
        Self { screened: 256, finalists: 16, rounds: 6, map: 9, seed: 0 }
    }
}
