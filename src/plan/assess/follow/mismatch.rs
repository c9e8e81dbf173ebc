//! Whether what is kept of a tour is of the plan at hand.

use thiserror::Error;

use crate::plan::document::FollowState;
use crate::problem::Problem;

use super::picture::{fault, pictures};
use super::ways::Leg;

/// A state that is not of the plan.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Mismatch {
    /// It is of another plan.
    #[error("it is of another plan")]
    Plan,
    /// Its poses are not the plan's.
    #[error("its poses are not those of the plan in their order")]
    Poses,
    /// It is at no pose.
    #[error("its `place` is {place}, but it has {visits} visits")]
    Place {
        /// What it says.
        place: usize,
        /// Its visits.
        visits: usize,
    },
    /// A picture that no calibration takes.
    #[error("its picture {name} is refused: {fault}")]
    Picture {
        /// Name of the picture.
        name: String,
        /// What is wrong with it.
        fault: String,
    },
}

/// That the state is one of the plan with those legs.
pub(super) fn fits(state: &FollowState, problem: &Problem, plan_sha256: &str, legs: &[Leg]) -> Result<(), Mismatch> {
    let FollowState { visits, place, .. } = state;
    if state.plan_sha256 != plan_sha256 {
        return Err(Mismatch::Plan);
    }
    let are_planned = visits.len() >= legs.len()
        && visits.iter().enumerate().all(|(place, visit)| match (legs.get(place), &visit.added) {
            (Some(leg), None) => visit.id == leg.pose.id,
            (None, Some(added)) => {
                visit.id == added.pose.id && added.pose.joints_rad.len() == problem.robot.chain.dof()
            }
            _ => false,
        });
    if !are_planned {
        return Err(Mismatch::Poses);
    }
    if *place > visits.len() {
        return Err(Mismatch::Place { place: *place, visits: visits.len() });
    }
    for (_, picture) in pictures(visits) {
        if let Some(fault) = fault(problem, picture) {
            return Err(Mismatch::Picture { name: picture.name.clone(), fault: fault.to_string() });
        }
    }
    Ok(())
}
