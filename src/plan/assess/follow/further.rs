//! More poses where those of the plan do not suffice.

use crate::plan::assess::next::{Request, next};
use crate::plan::choose::PlanError;
use crate::plan::document::AddedPose;
use crate::problem::Problem;

use super::knowledge::Known;
use super::until::Until;
use super::ways::Ways;

/// At most so many poses that show the board where no view so far does: the fewest that bring the map error down to what is to be
/// reached, if that is all, else as many as are allowed; in an order that takes little time from the place `from`, rad or m.
pub(super) fn further(
    problem: &Problem,
    known: &Known,
    until: &Until,
    most: usize,
    from: &[f64],
    observe: &(dyn Fn(usize) + Sync),
) -> Result<Vec<AddedPose>, PlanError> {
    let mut problem = problem.clone();
    // These were among the poses of the plan.
    problem.constraints.required.clear();
    let request = match until.map_error_alone() {
        Some(map_error) => Request::Accuracy { map_error, most },
        None => Request::Count(most),
    };
    let proposal = next(&problem, &known.observations, &known.calibration, request, true, observe)?;
    Ok(Ways::new(&problem).to_all(from, proposal.poses))
}
