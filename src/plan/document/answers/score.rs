//! What poses of anyone's are worth, as `calipose score --json` prints it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::CombinationTerm;
use crate::plan::document::header::{Document, Header, ProblemReference, by_name};
use crate::plan::document::plan::is_one;

/// A list of poses, or of pictures taken, held against what the problem could have had. Numbers that are infinite or undefined are
/// `null`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ScoreDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: ProblemReference,
    /// The format that the list was read as.
    pub read_as: String,
    /// Number of poses that the list has.
    pub listed: usize,
    /// Places of the list that the robot only passes, without a picture; they are no poses.
    pub passed: usize,
    /// Number of poses that can be used: the robot can take them, and the camera sees the board.
    pub count: usize,
    /// Pictures counted at each pose; 1 where it is not said.
    #[serde(skip_serializing_if = "is_one")]
    pub pictures: usize,
    /// What is optimised, as in plans.
    pub criterion: String,
    /// Names of the joints, in the order of the joint values.
    pub joints: Vec<String>,
    /// The poses, as they are listed.
    pub poses: Vec<ScoredPose>,
    /// What the usable poses are worth together; `null` if there are none.
    pub set: Option<ScoredSet>,
    /// The best as many poses; `null` if none can be chosen.
    pub best: Option<BestOfAsMany>,
    /// Why none can be chosen, if so.
    pub no_best: Option<String>,
    /// What the poses have, at least, of the most information that as many of the views could give. It may exceed 1 where they are beyond
    /// the views or the constraints that the bound is of.
    pub efficiency: Option<f64>,
    /// The fewest of the best poses that are worth as much; `null` if that takes more than there are in the list, or nothing is known.
    pub equal_best_count: Option<usize>,
    /// The swaps of one pose that gain most, of different poses, the best first; none that gains nothing.
    pub swaps: Vec<ScoredSwap>,
    /// Swaps one after the other, each the best after those before it.
    pub exchange: Vec<ScoredSwap>,
}

/// A pose of a list.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ScoredPose {
    /// What the list calls it: a label, an id, the name of a picture, or its number.
    pub name: String,
    /// Joint values, rad (m for prismatic joints); `null` where only a picture is known.
    pub joints_rad: Option<Vec<f64>>,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_deg: Option<Vec<f64>>,
    /// Why it cannot be used: a reason as in plans, `unreached` where no joint values take it, `pose_undetermined` where its corners do not
    /// tell where the board is; `null` if it can.
    pub reason: Option<String>,
    /// The same in words, with what was measured.
    pub why: Option<String>,
    /// Why no plan of the problem could have it though it can be used: `axis`, `limit_margin`, `keep_out`, `uncertain`, `repeated`, or `taken` of a picture
    /// whose joint values are not known; `null` if one could.
    pub excluded: Option<String>,
    /// Share of the information that is lost without it; `null` where it cannot be used.
    pub loss: Option<f64>,
    /// Map error without it, px.
    pub map_error_without_px: Option<f64>,
    /// Whether so little is lost without it that it is redundant.
    pub redundant: bool,
}

/// What poses are worth together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ScoredSet {
    /// The criterion's value, in its own unit.
    pub value: Option<f64>,
    /// Predicted map error, px.
    pub map_error_px: Option<f64>,
    /// Predicted standard deviations by the names of the intrinsics, in their order; empty if one is undetermined.
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "BTreeMap<String, Option<f64>>")]
    pub sigma: Vec<(String, f64)>,
    /// A combination of the intrinsics that the poses leave undetermined; none if they determine all.
    pub undetermined: Vec<CombinationTerm>,
    /// A pose is redundant where less than this share of the information is lost without it.
    pub redundant_below: f64,
    /// Map error without all redundant poses, px; `null` if none is redundant.
    pub map_error_without_redundant_px: Option<f64>,
}

/// The best poses found, as many as are usable in the list.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BestOfAsMany {
    /// Views that the bound is of, the usable poses of the list among them.
    pub views: usize,
    /// The criterion's value, in its own unit.
    pub value: Option<f64>,
    /// What no choice of as many of the views can surpass.
    pub bound: Option<f64>,
    /// Share of the most information possible that they certainly have.
    pub efficiency: f64,
    /// Predicted map error, px.
    pub map_error_px: Option<f64>,
    /// Predicted standard deviations by the names of the intrinsics, in their order.
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "BTreeMap<String, Option<f64>>")]
    pub sigma: Vec<(String, f64)>,
    /// Joint values of the poses, degrees (mm for prismatic joints).
    pub joints_deg: Vec<Vec<f64>>,
}

/// A pose of the list that gives place to another.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ScoredSwap {
    /// Name of the pose that leaves.
    pub out: String,
    /// Joint values of the pose that takes its place, rad (m for prismatic joints).
    pub joints_rad: Vec<f64>,
    /// The same in degrees (mm for prismatic joints).
    pub joints_deg: Vec<f64>,
    /// Information that is gained beside the list as it is, with the swaps before: 0.1 is a tenth more; `null` where the list determines
    /// nothing.
    pub gain: Option<f64>,
    /// The criterion's value after it.
    pub value: Option<f64>,
    /// Predicted map error after it, px.
    pub map_error_px: Option<f64>,
}

impl Document for ScoreDocument {
    const FORMAT: &'static str = "calipose.score";
    const VERSION: u32 = 1;
}
