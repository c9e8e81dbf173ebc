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

pub(crate) use local_search::{Candidate, LocalSearch, TRIES};
pub use poses::PolishSettings;
pub(crate) use poses::{Moved, Poses, add, moved};

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256Plus;
use rayon::prelude::*;

use super::choice::Choice;
use super::chooser::Chooser;
use super::error::PlanError;
use crate::plan::survey::Survey;
use crate::problem::{Goal, Method, Problem};
pub(crate) use columns::SAMPLED;
use columns::columns;

/// The survey's views of the greatest scores that choices on the way are made from, at least, and for each pose.
const SHORTLIST: usize = 1500;
const SHORTLIST_PER_POSE: usize = 50;

/// Most times that poses are chosen and moved.
const ROUNDS: usize = 4;

/// Random halves of the swept views that other choices to begin with are made from.
const HALVES: usize = 6;

/// Gain in log Φ below which a round is the last.
const LEAST_GAIN: f64 = 1e-4;

/// Most poses by which fewer are tried than what is found to suffice.
const FEWER: usize = 3;

/// Adds views off the grid to a survey, for choices of `count` poses, where the problem lets poses leave it.
///
/// # Errors
/// When the views do not give what a criterion needs.
pub(crate) fn leave_grid(problem: &Problem, mut survey: Survey, count: usize) -> Result<Survey, PlanError> {
    if !problem.selection.leaves_grid() {
        return Ok(survey);
    }
    let count = count.min(survey.views.len());
    let Found { columns, sets } = {
        let chooser = Chooser::new(problem, &survey)?;
        // Where nothing can be chosen there is nothing to improve; the selection itself says why.
        let Ok(certificate) = chooser.certificate(count) else { return Ok(survey) };
        let most = SHORTLIST.max(SHORTLIST_PER_POSE * count);
        let shortlist = chooser.highest(&certificate, count, most)?;
        // The short list may leave less room than all views do.
        let Ok(found) = found(problem, shortlist, count) else { return Ok(survey) };
        found
    };
    survey.add_off_grid(problem, &columns)?;
    for set in sets {
        survey.add_off_grid(problem, &set)?;
        survey.good = survey.places_of(&set);
    }
    Ok(survey)
}

/// Joint values of views off the grid, and of poses that are good together, some of which may be swept.
struct Found {
    columns: Vec<Vec<f64>>,
    sets: Vec<Vec<Vec<f64>>>,
}

/// Poses that were moved: log Φ and their joint values.
struct Improved {
    log_value: f64,
    joints: Vec<Vec<f64>>,
}

/// What is found from a short list of swept views.
fn found(problem: &Problem, mut shortlist: Survey, count: usize) -> Result<Found, PlanError> {
    let swept = shortlist.views.len();
    let columns = columns(problem, &Chooser::new(problem, &shortlist)?, count)?;
    shortlist.add_off_grid(problem, &columns)?;
    let mut sets = Vec::new();
    match &problem.selection.goal {
        Goal::Best { .. } | Goal::Within { .. } => {
            sets.extend(improved(problem, &mut shortlist, swept, count)?.map(|best| best.joints));
        }
        Goal::Fewest { .. } => {
            let most = enough(&Chooser::new(problem, &shortlist)?, count).unwrap_or(0);
            for count in (1..=most).rev().take(1 + FEWER) {
                let Some(Improved { log_value, joints }) = improved(problem, &mut shortlist, swept, count)? else {
                    break;
                };
                sets.push(joints);
                if log_value < 0.0 {
                    break;
                }
            }
        }
    }
    Ok(Found { columns, sets })
}

/// Chooses `count` poses and moves them, as long as that gains, and adds where they end to the survey, whose first views are `swept`.
/// Gives log Φ and the joint values of the best of them. Where poses end depends on where they begin, so the first choice is not
/// the only one that is moved.
fn improved(problem: &Problem, survey: &mut Survey, swept: usize, count: usize) -> Result<Option<Improved>, PlanError> {
    let mut best: Option<Improved> = None;
    for round in 0..ROUNDS {
        let ends = {
            let chooser = Chooser::new(problem, survey)?;
            let Ok((choice, _)) = chooser.best(count, problem.selection.seed) else { break };
            if best.as_ref().is_some_and(|best| choice.log_value < best.log_value + LEAST_GAIN) {
                break;
            }
            let mut starts = if round == 0 { others(problem, &chooser, swept, count) } else { vec![] };
            starts.push(choice);
            let settings = PolishSettings { least_gain: LEAST_GAIN, ..PolishSettings::default() };
            let ends = starts.par_iter().map(|start| moved(problem, &chooser, start, &settings, &mut |_| {}));
            ends.collect::<Result<Vec<_>, _>>()?
        };
        for end in ends {
            let joints: Vec<Vec<f64>> = end.poses.views().map(|view| view.q.clone()).collect();
            survey.add_off_grid(problem, &joints)?;
            if best.as_ref().is_none_or(|best| end.log_value > best.log_value) {
                best = Some(Improved { log_value: end.log_value, joints });
            }
        }
    }
    Ok(best)
}

/// Other choices to begin with: the best of the swept views, and of random halves of them.
fn others(problem: &Problem, chooser: &Chooser, swept: usize, count: usize) -> Vec<Choice> {
    let mut rng = Xoshiro256Plus::seed_from_u64(problem.selection.seed);
    let all = (0..swept).collect();
    let halves = (0..HALVES).map(|_| (0..swept).filter(|_| rng.gen_bool(0.5)).collect());
    let parts: Vec<Vec<usize>> = std::iter::once(all).chain(halves).collect();
    let of_part = |places: &Vec<usize>| {
        let part = chooser.survey().only(places);
        let (choice, _) = Chooser::new(problem, &part).ok()?.best(count, problem.selection.seed).ok()?;
        Some(chooser.assess(choice.selected.iter().map(|&place| places[place]).collect()))
    };
    parts.par_iter().filter_map(of_part).collect()
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
