//! The candidates of a plan.

use super::chooser::Chooser;
use super::error::PlanError;
use super::off_grid::leave_grid;
use super::refined_survey::{PICKS, refined_survey};
use super::tours::pull_together;
use crate::plan::survey::Survey;
use crate::problem::{Goal, Problem};

/// The candidates of a plan: the [`refined_survey`] of `problem`, and views off the grid where the problem lets poses leave it.
/// `observe` as in [`survey`](crate::plan::survey::survey).
///
/// # Errors
/// As [`refined_survey`].
pub fn plan_survey(problem: &Problem, observe: &(dyn Fn(usize) + Sync)) -> Result<Survey, PlanError> {
    let survey = refined_survey(problem, observe)?;
    if !problem.selection.leaves_grid() {
        return Ok(survey);
    }
    let count = match problem.selection.goal {
        // Where no swept poses keep the time, others may.
        Goal::Within { seconds, .. } => {
            let swept = Chooser::new(problem, &survey)?.within(seconds);
            swept.map_or(PICKS, |found| found.choice.selected.len())
        }
        ref goal => goal.count().unwrap_or(PICKS),
    };
    let mut survey = leave_grid(problem, survey, count)?;
    pull_together(problem, &mut survey)?;
    Ok(survey)
}
