//! Off the grid: views at any joint values, where they help most, join those of the sweep.
//!
//! Two steps. The first is column generation for the relaxation over all joint values, `max log Φ(M₀ + k Σ wᵢ Mᵢ)` over weights that
//! add up to one: with the gradient Y of log Φ at its weights, `s(q) = ⟨Y, M(q)⟩` is climbed from the views of the greatest scores,
//! and what scores more than any view in hand joins. The second chooses poses from all views in hand and moves them together, so that
//! they keep the separations; where they end joins too, and the choice is made again.
//!
//! What comes out are views like any others: choices, bounds and searches go on as with the swept ones.

mod columns;
mod local_search;
mod poses;

pub(crate) use local_search::{LocalSearch, ranges};
pub use poses::PolishSettings;
pub(crate) use poses::{Moved, Poses, moved};

use super::choice::Choice;
use super::chooser::Chooser;
use super::error::PlanError;
use super::refined_survey::{PICKS, refined_survey};
use crate::plan::survey::Survey;
use crate::problem::{Goal, Method, Problem};
use columns::columns;

/// The survey's views of the greatest scores that choices on the way are made from, at least, and for each pose.
const SHORTLIST: usize = 1500;
const SHORTLIST_PER_POSE: usize = 50;

/// Most times that poses are chosen and moved.
const ROUNDS: usize = 3;

/// Gain in log Φ below which a round is the last.
const LEAST_GAIN: f64 = 1e-4;

/// Most poses by which fewer are tried than what is found to suffice.
const FEWER: usize = 3;

/// The candidates of a plan: the [`refined_survey`] of `problem`, and views off the grid where the problem lets poses leave it.
/// `observe` as in [`survey`](crate::plan::survey::survey).
///
/// # Errors
/// As [`refined_survey`].
pub fn plan_survey(problem: &Problem, observe: &(dyn Fn(usize) + Sync)) -> Result<Survey, PlanError> {
    leave_grid(problem, refined_survey(problem, observe)?)
}

/// Adds views off the grid to a survey, where the problem lets poses leave it.
///
/// # Errors
/// When the views do not give what a criterion needs.
pub(crate) fn leave_grid(problem: &Problem, mut survey: Survey) -> Result<Survey, PlanError> {
    if !problem.selection.leaves_grid() {
        return Ok(survey);
    }
    let found = {
        let chooser = Chooser::new(problem, &survey)?;
        let count = problem.selection.goal.count().unwrap_or(PICKS).min(survey.views.len());
        // Where nothing can be chosen there is nothing to improve; the selection itself says why.
        let Ok(certificate) = chooser.certificate(count) else { return Ok(survey) };
        let most = SHORTLIST.max(SHORTLIST_PER_POSE * count);
        let shortlist = chooser.highest(&certificate, count, most)?;
        found(problem, shortlist, count)?
    };
    survey.add_off_grid(problem, &found)?;
    Ok(survey)
}

/// Joint values of the views found from a short list of swept ones.
fn found(problem: &Problem, mut shortlist: Survey, count: usize) -> Result<Vec<Vec<f64>>, PlanError> {
    let swept = shortlist.views.len();
    let columns = columns(problem, &Chooser::new(problem, &shortlist)?, count)?;
    shortlist.add_off_grid(problem, &columns)?;
    match &problem.selection.goal {
        Goal::Best { .. } => {
            improve(problem, &mut shortlist, count)?;
        }
        Goal::Fewest { .. } => {
            let Some(most) = enough(&Chooser::new(problem, &shortlist)?, count) else {
                return Ok(joints(&shortlist, swept));
            };
            for fewer in 0..=FEWER.min(most - 1) {
                let reached = improve(problem, &mut shortlist, most - fewer)?;
                if reached < 0.0 {
                    break;
                }
            }
        }
    }
    Ok(joints(&shortlist, swept))
}

fn joints(survey: &Survey, swept: usize) -> Vec<Vec<f64>> {
    survey.views[swept..].iter().map(|view| view.q.clone()).collect()
}

/// Chooses `count` poses and moves them, as long as that gains, and adds where they end to the survey. Gives log Φ of the best of them.
fn improve(problem: &Problem, survey: &mut Survey, count: usize) -> Result<f64, PlanError> {
    let mut best = f64::NEG_INFINITY;
    for _ in 0..ROUNDS {
        let moved = {
            let chooser = Chooser::new(problem, survey)?;
            let Ok((choice, _)) = chooser.best(count, problem.selection.seed) else { break };
            if choice.log_value < best + LEAST_GAIN {
                break;
            }
            let settings = PolishSettings { least_gain: LEAST_GAIN, ..PolishSettings::default() };
            let moved = moved(problem, &chooser, &choice, &settings, &mut |_| {})?;
            best = moved.log_value;
            moved.poses.views().map(|view| view.q.clone()).collect::<Vec<_>>()
        };
        survey.add_off_grid(problem, &moved)?;
    }
    Ok(best)
}

/// How many poses reach the accuracies requested, before any is moved; `None` if all views together do not. `near` is where to
/// begin.
fn enough(chooser: &Chooser, near: usize) -> Option<usize> {
    let most = chooser.survey().views.len();
    let reaches = |choice: &Choice| choice.log_value >= 0.0;
    let of = |count: usize| chooser.choose(Method::Exchange, count, 0).ok();
    let mut count = near.clamp(1, most);
    // Information grows as the number of poses does, a little slower.
    let mut choice = of(count)?;
    while !reaches(&choice) {
        if count == most {
            return None;
        }
        count = ((count as f64 * (-choice.log_value).exp()).ceil().min(most as f64) as usize).max(count + 1).min(most);
        choice = of(count)?;
    }
    while count > 1 {
        match of(count - 1) {
            Some(choice) if reaches(&choice) => count -= 1,
            _ => break,
        }
    }
    Some(count)
}
