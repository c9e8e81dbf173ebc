//! Column generation over all joint values.

use rayon::prelude::*;

use super::local_search::{Candidate, LocalSearch, TRIES};
use crate::feasibility::View;
use crate::plan::choose::chooser::Chooser;
use crate::plan::choose::error::PlanError;
use crate::plan::survey::{Survey, spacings};
use crate::problem::{Method, Problem};
use crate::selection::packed::dot;
use crate::selection::{Constraints, RelaxationSettings, relax};

/// Most rounds; some five are common.
const ROUNDS: usize = 20;

/// Swept views that each round climbs from, beside those in hand.
const STARTS: usize = 24;

/// Spacings of the swept configurations by which views to climb from are apart along some joint.
const APART: f64 = 1.5;

/// Columns generated in a round.
const COLUMNS: usize = 12;

/// The score that no view exceeds, as a share beyond that of the views in hand, at which the columns suffice.
const TOLERANCE: f64 = 1e-3;

/// Weights from which a column is worth keeping.
const LEAST_WEIGHT: f64 = 1e-4;

/// Joint values of the views off the grid that the relaxation over all joint values weighs, for choices of `count` poses; local
/// searches found them, so nothing is proven of them.
///
/// # Errors
/// When nothing can be chosen from the swept views.
pub(super) fn columns(problem: &Problem, chooser: &Chooser, count: usize) -> Result<Vec<Vec<f64>>, PlanError> {
    let (survey, objective) = (chooser.survey(), chooser.objective());
    let search = LocalSearch::new(problem, survey, objective);
    let swept = chooser.instance(count)?;
    let settings = RelaxationSettings { tolerance: 0.1 * TOLERANCE, ..RelaxationSettings::default() };
    let start = chooser.choose(Method::Greedy, count, 0)?.selected;
    let mut columns: Vec<Candidate> = start.iter().filter_map(|&i| search.candidate(&survey.views[i])).collect();
    for _ in 0..ROUNDS {
        let matrices: Vec<Vec<f64>> = columns.iter().map(|column| column.information.clone()).collect();
        // Weights that add up to one, on k times the information: poses may repeat.
        let objective = objective.on(&matrices).known_share(1.0 / count as f64);
        let Ok(instance) = objective.instance(1, Constraints::default()) else { break };
        let all: Vec<usize> = (0..columns.len()).collect();
        let Ok(relaxation) = relax(&instance, &all, &settings) else { break };
        let weight =
            |place: usize| relaxation.weights.iter().find(|(i, _)| *i == place).map_or(0.0, |&(_, weight)| weight);
        let mut place = 0..;
        columns.retain(|_| place.next().is_some_and(|place| weight(place) > LEAST_WEIGHT));
        let dual = instance.dual(&relaxation.certificate.y);
        let score = |information: &[f64]| dot(information, &dual);
        let level = columns.iter().map(|column| score(&column.information)).fold(0.0, f64::max);
        let mut starts = far_apart(problem, survey, &swept.scores(&relaxation.certificate.y), |i| swept.is_open(i));
        starts.extend(columns.iter().map(|column| &column.view));
        let climbs = starts.par_iter().flat_map_iter(|start| TRIES.map(|stretch| (start, stretch)));
        let climbed = climbs.filter_map(|(start, stretch)| search.climb(start, &[], stretch, &score));
        let mut climbed: Vec<(f64, Candidate)> = climbed.map(|found| (score(&found.information), found)).collect();
        climbed.retain(|(score, _)| *score > level * (1.0 + TOLERANCE));
        climbed.sort_by(|a, b| b.0.total_cmp(&a.0));
        climbed.dedup_by(|a, b| a.1.view.q == b.1.view.q);
        if climbed.is_empty() {
            break;
        }
        columns.extend(climbed.into_iter().take(COLUMNS).map(|(_, found)| found));
    }
    let is_swept = |view: &View| survey.index_of(view.id).is_some_and(|i| survey.views[i].q == view.q);
    Ok(columns.into_iter().map(|column| column.view).filter(|view| !is_swept(view)).map(|view| view.q).collect())
}

/// The views of the greatest `scores`, no two of them near each other.
fn far_apart<'s>(
    problem: &Problem,
    survey: &'s Survey,
    scores: &[f64],
    is_open: impl Fn(usize) -> bool,
) -> Vec<&'s View> {
    let spacings = spacings(problem);
    let near = |a: &View, b: &View| {
        let apart = a.q.iter().zip(&b.q).zip(&spacings).map(|((a, b), spacing)| (a - b).abs() / spacing);
        apart.fold(0.0, f64::max) < APART
    };
    let mut order: Vec<usize> = (0..scores.len()).filter(|&i| is_open(i)).collect();
    order.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
    let mut starts: Vec<&View> = Vec::with_capacity(STARTS);
    for i in order {
        let view = &survey.views[i];
        if !starts.iter().any(|start| near(start, view)) {
            starts.push(view);
        }
        if starts.len() == STARTS {
            break;
        }
    }
    starts
}
