//! The order in which a plan's poses take least time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::PlannedPose;
use crate::motion::timing::duration;
use crate::motion::tour::{Costs, Ends, cost, tour};
use crate::problem::{MotionSettings, Problem};

/// The order of the poses in which the arm's moves take least time: all joints start and stop together, along straight lines in joint
/// space, as fast as the greatest speeds and accelerations allow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TourDocument {
    /// Ids of the poses in this order.
    pub order: Vec<usize>,
    /// Joint values, rad (m for prismatic joints), of the home that the tour begins at; left out where it begins at the first pose.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub home_rad: Option<Vec<f64>>,
    /// Whether the tour ends at home too.
    pub returns: bool,
    /// Times of the moves one after the other: from home to the first pose where there is a home, from pose to pose, and back where
    /// the tour returns.
    pub moves_s: Vec<f64>,
    /// Time of all moves.
    pub moving_s: f64,
    /// What the moves of no order take less than.
    pub least_moving_s: f64,
    /// Time of all moves if the poses were taken by ascending id.
    pub moving_by_id_s: f64,
    /// Time for the pictures at each pose.
    pub dwell_s: f64,
    /// Time of all moves and pictures.
    pub total_s: f64,
    /// Joints of which no greatest speed is stated, and for which a slow one was assumed.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub assumed_speeds: Vec<String>,
}

impl TourDocument {
    /// Of poses in the order of their ids; the seed decides where good orders are sought.
    pub(super) fn new(problem: &Problem, poses: &[PlannedPose], seed: u64) -> Self {
        let MotionSettings { greatest: _, share: _, assumed, home, dwell } = &problem.motion;
        let limits = problem.motion.limits();
        // Home comes after the poses.
        let stops: Vec<&[f64]> = poses
            .iter()
            .map(|pose| &pose.joints_rad)
            .chain(home.iter().map(|home| &home.q))
            .map(Vec::as_slice)
            .collect();
        let costs = Costs::from_fn(stops.len(), |i, j| duration(stops[i], stops[j], &limits));
        let ends = match home {
            None => Ends::Open,
            Some(home) if home.returns => Ends::Round(poses.len()),
            Some(_) => Ends::From(poses.len()),
        };
        let found = tour(&costs, ends, seed);
        let by_id: Vec<usize> = ends.home().into_iter().chain(0..poses.len()).collect();
        let back = found.order.first().filter(|_| matches!(ends, Ends::Round(_)));
        let way: Vec<usize> = found.order.iter().chain(back).copied().collect();
        let names = assumed.iter().map(|&j| problem.robot.chain.joints[j].name.clone());
        Self {
            order: found.order.iter().filter_map(|&stop| poses.get(stop)).map(|pose| pose.id).collect(),
            home_rad: home.as_ref().map(|home| home.q.clone()),
            returns: back.is_some(),
            moves_s: way.windows(2).map(|pair| costs.between(pair[0], pair[1])).collect(),
            moving_s: found.cost,
            least_moving_s: found.bound,
            moving_by_id_s: cost(&costs, ends, &by_id),
            dwell_s: *dwell,
            total_s: found.cost + dwell * poses.len() as f64,
            assumed_speeds: names.collect(),
        }
    }
}
