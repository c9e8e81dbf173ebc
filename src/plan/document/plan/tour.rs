//! The order in which a plan's poses take least time, and the moves between them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::PlannedPose;
use crate::motion::Danger;
use crate::motion::journey::{Blocked, Clear, Journey, Move};
use crate::plan::choose::{Choice, Chooser, Decision, GaveWay, Trade};
use crate::problem::{MotionSettings, Problem};
use crate::robot::Tree;

/// The order of the poses in which the arm's moves take least time, as far as was found: all joints start and stop together, along
/// straight lines in joint space, as fast as the greatest speeds and accelerations allow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TourDocument {
    /// Ids of the poses in this order.
    pub order: Vec<usize>,
    /// Joint values, rad (m for prismatic joints), of the home that the tour begins at; left out where it begins at the first pose.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub home_rad: Option<Vec<f64>>,
    /// Whether the tour ends at home too.
    pub returns: bool,
    /// The moves one after the other: from home to the first pose where there is a home, from pose to pose, and back where the tour
    /// returns.
    pub moves: Vec<MoveDocument>,
    /// Time of all moves.
    pub moving_s: f64,
    /// What the moves of no order take less than.
    pub least_moving_s: f64,
    /// Time of straight moves, safe or not, if the poses were taken by ascending id.
    pub moving_by_id_s: f64,
    /// Time for the pictures at each pose.
    pub dwell_s: f64,
    /// Time of all moves and pictures.
    pub total_s: f64,
    /// What the poses were chosen for beside their information; left out where their tour did not count.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub trade: Option<TradeDocument>,
    /// Views that were chosen first and gave way to others, because no safe move leads to them.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub gave_way: Vec<GaveWayDocument>,
    /// Joints of which no greatest speed is stated, and for which a slow one was assumed.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub assumed_speeds: Vec<String>,
}

/// What poses were chosen for beside their information. Times are those of straight moves, with pictures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TradeDocument {
    /// Share of the information of the best set of poses found that the plan has, where that set has a longer tour; where accuracies
    /// are to be reached in the least time, of the fewest poses found that do.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub kept: Option<f64>,
    /// Time of the tour of that set.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub best_total_s: Option<f64>,
    /// What the tour of no set of the views takes less than that is as good as was asked for: as many poses with no less of the best
    /// information found than may be given up, or any number of poses that reach the accuracies in the least time.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub least_total_s: Option<f64>,
    /// Most poses whose tour may keep the time that was asked for; the bound is on sets of so many.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub most_poses: Option<usize>,
}

/// A view that gave way to another one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GaveWayDocument {
    /// Its id.
    pub id: usize,
    /// What stands in the way to it: the names of two links; empty for the tip-over margin.
    pub endangered: Vec<String>,
}

/// A move from pose to pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MoveDocument {
    /// Its time, with a stop at every turn.
    pub seconds: f64,
    /// Joint values, rad (m for prismatic joints), at which it turns; left out where it is straight.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub via_rad: Vec<Vec<f64>>,
    /// Whether it is proven that all along the move tested links keep the clearance, and the robot the tip-over margin, less a
    /// millimetre, or half of them where that is less; left out where neither is tested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub safe: Option<bool>,
    /// What the distance of tested links does not sink below on the move, where it is safe and they are tested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub clearance_m: Option<f64>,
    /// What the tip-over margin does not sink below, where the move is safe and that is tested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub tip_over_margin_m: Option<f64>,
    /// What came nearest to failing where margins were measured on a safe move, or stands in the way of one that is not: the names of
    /// two links; empty for the tip-over margin.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub endangered: Option<Vec<String>>,
}

impl TourDocument {
    /// Of poses in the order of their ids, as they were decided for.
    pub(super) fn new(chooser: &Chooser, poses: &[PlannedPose], decision: &Decision) -> Self {
        Self {
            trade: decision.trade.as_ref().map(|trade| TradeDocument::new(trade, &decision.choice)),
            gave_way: decision.gave_way.iter().map(|gone| GaveWayDocument::new(chooser, gone)).collect(),
            ..Self::through(chooser.problem(), poses, &decision.journey)
        }
    }

    /// Of poses by a journey through them as they are listed.
    pub(crate) fn through(problem: &Problem, poses: &[PlannedPose], journey: &Journey) -> Self {
        let MotionSettings { greatest: _, share: _, assumed, home, dwell } = &problem.motion;
        let joints = &problem.robot.chain.joints;
        let Journey { order, moves, least, as_numbered } = journey;
        let tree = &problem.robot.tree;
        let moving: f64 = moves.iter().map(|found| found.seconds).sum();
        Self {
            order: order.iter().filter_map(|&stop| poses.get(stop)).map(|pose| pose.id).collect(),
            home_rad: home.as_ref().map(|home| home.q.clone()),
            returns: home.as_ref().is_some_and(|home| home.returns),
            moves: moves.iter().map(|found| MoveDocument::new(found, tree)).collect(),
            moving_s: moving,
            // Where all is straight and the order proven best, the two are summed in another order.
            least_moving_s: least.min(moving),
            moving_by_id_s: *as_numbered,
            dwell_s: *dwell,
            total_s: moving + dwell * poses.len() as f64,
            trade: None,
            gave_way: vec![],
            assumed_speeds: assumed.iter().map(|&j| joints[j].name.clone()).collect(),
        }
    }

    /// The move to the pose of that place in the order; none to the first where there is no home.
    pub fn move_to(&self, place: usize) -> Option<&MoveDocument> {
        let first = usize::from(self.home_rad.is_none());
        place.checked_sub(first).and_then(|place| self.moves.get(place))
    }

    /// The moves that are not proven safe though something is tested, by their places.
    pub fn blocked(&self) -> impl Iterator<Item = (usize, &MoveDocument)> {
        self.moves.iter().enumerate().filter(|(_, way)| way.safe == Some(false))
    }
}

/// Poses in the order of their tour, as they are listed where there is none.
pub(super) fn in_order<'p>(poses: &'p [PlannedPose], tour: Option<&TourDocument>) -> Vec<&'p PlannedPose> {
    let Some(tour) = tour else { return poses.iter().collect() };
    tour.order.iter().filter_map(|id| poses.iter().find(|pose| pose.id == *id)).collect()
}

impl TradeDocument {
    fn new(Trade { best, least_seconds, most_poses }: &Trade, choice: &Choice) -> Self {
        Self {
            kept: best.as_ref().map(|best| (choice.log_value - best.choice.log_value).exp()),
            best_total_s: best.as_ref().map(|best| best.seconds),
            least_total_s: *least_seconds,
            most_poses: *most_poses,
        }
    }
}

impl GaveWayDocument {
    fn new(chooser: &Chooser, GaveWay { view, danger }: &GaveWay) -> Self {
        let tree = &chooser.problem().robot.tree;
        Self { id: chooser.survey().views[*view].id, endangered: names(*danger, tree) }
    }
}

/// The links in danger; none where the robot may tip over.
fn names(danger: Danger, tree: &Tree) -> Vec<String> {
    match danger {
        Danger::Contact(links) => links.map(|link| tree.links[link].name.clone()).to_vec(),
        Danger::TippingOver => vec![],
    }
}

impl MoveDocument {
    /// Of a move of a robot with those links.
    pub(crate) fn new(Move { via, seconds, safety }: &Move, tree: &Tree) -> Self {
        // Moves that take the same time say so to the last digit.
        let seconds = (seconds * 1e9).round() / 1e9;
        Self { seconds, via_rad: via.clone(), ..Self::of_safety(safety.as_ref(), tree) }
    }

    /// What is known of the safety of a move that takes no time.
    pub(crate) fn of_safety(safety: Option<&Result<Clear, Blocked>>, tree: &Tree) -> Self {
        let clear = safety.and_then(|safety| safety.as_ref().ok());
        let danger = safety.and_then(|safety| match safety {
            Ok(clear) => clear.nearest,
            Err(blocked) => Some(blocked.danger),
        });
        Self {
            seconds: 0.0,
            via_rad: vec![],
            safe: safety.map(Result::is_ok),
            clearance_m: clear.and_then(|clear| clear.clearance),
            tip_over_margin_m: clear.and_then(|clear| clear.tip_over_margin),
            endangered: danger.map(|danger| names(danger, tree)),
        }
    }
}
