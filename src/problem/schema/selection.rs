//! `[selection]` and `[constraints]`: what to choose.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::{Named, Range, TextOrTable};
use crate::information::Criterion;
use crate::problem::{Least, Method};

/// Which poses to choose, and how.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Selection {
    /// What to optimise: "v" the mean variance of the calibrated projection over the image, "d" the volume of the confidence
    /// ellipsoid, "a" the sum of the intrinsics' variances and "e" their worst combination, in units that move the image
    /// by 1 px, "zhang" the worst direction of the closed-form solution, "diversity" the spread over angle and distance; or
    /// a table of several with their shares, as in `{ v = 0.8, diversity = 0.2 }`; "v" when left out.
    pub(crate) criterion: Option<TextOrTable<Named<Criterion>, BTreeMap<String, f64>>>,
    /// How to choose; "best" when left out.
    pub(crate) method: Option<Named<Method>>,
    /// Number of poses; 10 when left out.
    #[schemars(range(min = 1))]
    pub(crate) count: Option<u64>,
    /// Number of pictures taken at each pose. They average the corners' noise; what errs alike in all of them stays.
    #[schemars(range(min = 1, max = 1000))]
    pub(crate) pictures: u64,
    /// Accuracies to reach with as few poses as possible, in place of `criterion`, `method` and `count`: `map_error_px` and names of
    /// estimated intrinsics, each with the requested standard deviation, as in `{ map_error_px = 2, fx = 1.5 }`.
    pub(crate) accuracy: Option<BTreeMap<String, f64>>,
    /// Beside `accuracy`: what is to be as little as possible, "poses" or the "time" of the tour; "poses" when left out.
    pub(crate) least: Option<Named<Least>>,
    /// The time that the tour may take, dwells and all, in place of `method`, `count` and `accuracy`: the best plan of as many poses as
    /// then serve, as in `{ most_s = 120 }`.
    pub(crate) time: Option<TimeLimit>,
    /// Share of the best information found that may be given up for a shorter tour; when left out, 0.01 for "best" and for accuracies,
    /// which are reached all the same, and 0 for other methods.
    #[schemars(range(min = 0, max = 1))]
    pub(crate) tour_tolerance: Option<f64>,
    /// Whether poses may leave the sweep's configurations for better ones at any joint values; false for a plan of swept poses, which
    /// robust plans always are.
    pub(crate) off_grid: bool,
    /// Boxes of joint values that are bounded at most for the certificate over all joint values; 0 for none. The bound reached by then
    /// is stated.
    pub(crate) continuum_boxes: u64,
    /// Relative gap at which that bound suffices.
    pub(crate) continuum_tolerance: f64,
    /// Seed of everything random.
    pub(crate) seed: u64,
    /// Relative gap at which the relaxation stops.
    pub(crate) tolerance: f64,
    /// Seconds after which a search for the proven best set ends with the best set so far.
    pub(crate) time_limit_s: f64,
    /// Nodes of the search tree after which a search ends with the best set so far.
    pub(crate) node_limit: u64,
}

/// The time of a tour.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TimeLimit {
    /// Seconds that it takes at most.
    pub(crate) most_s: f64,
}

/// The sets of poses that are allowed.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Constraints {
    /// Poses that must be in the plan, by their ids in plan.json or views.csv.
    pub(crate) require: Vec<u64>,
    /// Poses that must not be in the plan, by their ids.
    pub(crate) forbid: Vec<u64>,
    /// Joint values of views taken already, in degrees (mm for prismatic joints), one list per view. Their
    /// information counts as known before the first pose is chosen.
    pub(crate) captured: Vec<Vec<f64>>,
    /// Joint regions that must contain no poses.
    pub(crate) keep_out: Vec<Region>,
    /// Joint regions with a maximum number of poses.
    pub(crate) groups: Vec<Group>,
    /// Minimum distance between two poses in joint space, in degrees: the Euclidean norm over the revolute joints.
    pub(crate) joint_separation_deg: Option<f64>,
    /// Minimum angle between the directions from which two poses see the board's centre, in the board's frame, in degrees.
    pub(crate) view_separation_deg: Option<f64>,
    /// Minimum distance between the board's pictures from two poses, in px: the root mean square over its outer corners. When left out, 0
    /// for swept poses, which are apart by their steps, and 20 for polished ones.
    pub(crate) picture_separation_px: Option<f64>,
}

/// A region of joint space.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Region {
    /// Ranges [min, max] of some joints by name, in degrees (mm for prismatic joints), ends included; the others are free.
    pub(crate) joints: BTreeMap<String, Range>,
}

/// A region of joint space with a maximum number of poses.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Group {
    /// Name of the group.
    pub(crate) name: String,
    /// Ranges [min, max] of some joints by name, as in `keep_out`.
    pub(crate) joints: BTreeMap<String, Range>,
    /// Maximum number of the plan's poses in the region.
    pub(crate) most: u64,
}

impl Default for Selection {
    fn default() -> Self {
        Self {
            criterion: None,
            method: None,
            count: None,
            pictures: 1,
            accuracy: None,
            least: None,
            time: None,
            tour_tolerance: None,
            off_grid: true,
            continuum_boxes: 0,
            continuum_tolerance: 0.02,
            seed: 0,
            tolerance: 1e-9,
            time_limit_s: 60.0,
            node_limit: 10_000_000,
        }
    }
}
