//! The poses to go to, and the ways between them.

use crate::feasibility::Collision;
use crate::motion::Safety;
use crate::motion::journey::{Arm, Journey};
use crate::motion::tour::Ends;
use crate::plan::document::{AddedPose, MoveDocument, Plan, PlannedPose};
use crate::problem::Problem;

/// A pose of the tour and the move to it from the one before.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leg {
    pub(super) pose: PlannedPose,
    /// None to the first pose where there is no home; of plans without a tour to none.
    pub(super) way: Option<MoveDocument>,
}

/// The legs of a plan, in the order of its tour.
pub(super) fn legs(plan: &Plan) -> Vec<Leg> {
    let way = |place| plan.tour.as_ref().and_then(|tour| tour.move_to(place)).cloned();
    let poses = plan.in_order().into_iter().enumerate();
    poses.map(|(place, pose)| Leg { pose: pose.clone(), way: way(place) }).collect()
}

/// Ways that are found now, for the problem's arm.
pub(super) struct Ways<'a> {
    problem: &'a Problem,
    collision: Collision,
}

impl<'a> Ways<'a> {
    pub(super) fn new(problem: &'a Problem) -> Self {
        Self { problem, collision: Collision::new(&problem.robot, problem.clearance) }
    }

    /// The move from one place to another, joint values in rad or m: proven safe if a safe one is found.
    pub(super) fn between(&self, from: &[f64], to: &[f64]) -> Option<MoveDocument> {
        self.through(&[from, to]).map(|(_, mut moves)| moves.remove(0))
    }

    /// The moves from place to place of the first of the `added` poses' order that takes least time, beginning at `from`.
    pub(super) fn to_all(&self, from: &[f64], added: Vec<PlannedPose>) -> Vec<AddedPose> {
        let places: Vec<Vec<f64>> = added.iter().map(|pose| pose.joints_rad.clone()).collect();
        let stops: Vec<&[f64]> = std::iter::once(from).chain(places.iter().map(Vec::as_slice)).collect();
        let Some((order, moves)) = self.through(&stops) else { return Vec::new() };
        let mut added: Vec<Option<PlannedPose>> = added.into_iter().map(Some).collect();
        let poses = order.iter().skip(1).filter_map(|&stop| added[stop - 1].take());
        poses.zip(moves).map(|(pose, way)| AddedPose { pose, way }).collect()
    }

    /// The order in which all stops are gone to from the first, and the moves; none where there is nowhere to go.
    fn through(&self, stops: &[&[f64]]) -> Option<(Vec<usize>, Vec<MoveDocument>)> {
        let Problem { robot, motion, stability, selection, .. } = self.problem;
        let arm = Arm::new(robot, motion.limits(), Safety::new(robot, &self.collision, stability.as_ref()));
        let Journey { order, moves, .. } = Journey::new(&arm, stops, Ends::From(0), selection.seed);
        let moves: Vec<MoveDocument> = moves.iter().map(|found| MoveDocument::new(found, &robot.tree)).collect();
        (!moves.is_empty()).then_some((order, moves))
    }
}

/// The same move the other way.
pub(super) fn reversed(way: &MoveDocument) -> MoveDocument {
    MoveDocument { via_rad: way.via_rad.iter().rev().cloned().collect(), ..way.clone() }
}
