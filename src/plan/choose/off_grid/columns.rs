//! Column generation over all joint values.

use std::sync::Arc;

use rayon::prelude::*;

use super::local_search::{Candidate, LocalSearch, TRIES};
use crate::feasibility::View;
use crate::plan::choose::chooser::Chooser;
use crate::plan::choose::error::PlanError;
use crate::plan::survey::spacings;
use crate::problem::{Method, Problem};
use crate::selection::packed::dot;
use crate::selection::{RelaxationSettings, relax};
use crate::sweep::HaltonSample;

/// Most rounds; some ten are common.
const ROUNDS: usize = 40;

/// Swept views that each round climbs from, beside those in hand.
const STARTS: usize = 24;

/// Spacings of the swept configurations by which views to climb from are apart along some joint.
const APART: f64 = 1.5;

/// Columns generated in a round.
const COLUMNS: usize = 12;

/// The score that no view exceeds, as a share beyond that of the views in hand, at which the columns suffice.
const TOLERANCE: f64 = 1e-3;

/// Configurations all over the joint ranges that are looked at where climbs from the swept views end no higher any more, and how often
/// that is done: a maximum may lie where no swept view is near.
const SAMPLE: usize = 50_000;
const SAMPLES: usize = 8;

/// All of them.
pub(crate) const SAMPLED: usize = SAMPLES * SAMPLE;

/// Least share of the level that the views among them score which are climbed from.
const PROMISING: f64 = 0.3;

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
    let start = chooser.choose(Method::Exchange, count, 0)?.selected;
    let mut columns: Vec<Candidate> = start.iter().filter_map(|&i| search.candidate(&survey.views[i])).collect();
    let mut samples = 0;
    for _ in 0..ROUNDS {
        let matrices: Vec<Vec<f64>> = columns.iter().map(|column| column.information.clone()).collect();
        // Weights that add up to one, on k times the information: poses may repeat.
        let objective = objective.on(&matrices).known_share(1.0 / count as f64);
        let Ok(instance) = objective.instance(1, &Arc::default()) else { break };
        let all: Vec<usize> = (0..columns.len()).collect();
        let Ok(relaxation) = relax(&instance, &all, &settings) else { break };
        let mut weights = vec![0.0; columns.len()];
        for &(place, weight) in &relaxation.weights {
            weights[place] = weight;
        }
        let weighted = columns.into_iter().zip(weights).filter(|(_, weight)| *weight > LEAST_WEIGHT);
        columns = weighted.map(|(column, _)| column).collect();
        let dual = instance.dual(&relaxation.certificate.y);
        let score = |information: &[f64]| dot(information, &dual);
        let level = columns.iter().map(|column| score(&column.information)).fold(0.0, f64::max);
        let climbed = |starts: &[&View]| {
            let climbs = starts.par_iter().flat_map_iter(|start| TRIES.map(|stretch| (start, stretch)));
            let climbed = climbs.filter_map(|(start, stretch)| {
                search.climb(start, &[], stretch, &|candidate| score(&candidate.information))
            });
            let mut climbed: Vec<(f64, Candidate)> = climbed.map(|found| (score(&found.information), found)).collect();
            climbed.retain(|(score, _)| *score > level * (1.0 + TOLERANCE));
            climbed.sort_by(|a, b| b.0.total_cmp(&a.0));
            climbed.dedup_by(|a, b| a.1.view.q == b.1.view.q);
            climbed
        };
        let scores = swept.scores(&relaxation.certificate.y);
        let of_survey = (0..scores.len()).filter(|&i| swept.is_open(i)).map(|i| (scores[i], &survey.views[i]));
        let mut starts = far_apart(problem, of_survey.collect());
        starts.extend(columns.iter().map(|column| &column.view));
        let mut found = climbed(&starts);
        while found.is_empty() && samples < SAMPLES {
            let views = sampled(problem, &search, samples, &|information| score(information) > PROMISING * level);
            let scored = views.iter().map(|found| (score(&found.information), &found.view)).collect();
            found = climbed(&far_apart(problem, scored));
            samples += 1;
        }
        if found.is_empty() {
            break;
        }
        columns.extend(found.into_iter().take(COLUMNS).map(|(_, found)| found));
    }
    let is_swept = |view: &View| survey.index_of(view.id).is_some_and(|i| survey.views[i].q == view.q);
    Ok(columns.into_iter().map(|column| column.view).filter(|view| !is_swept(view)).map(|view| view.q).collect())
}

/// Views that are `promising` among sample number `number` of all configurations.
fn sampled(
    problem: &Problem,
    search: &LocalSearch,
    number: usize,
    promising: &(dyn Fn(&[f64]) -> bool + Sync),
) -> Vec<Candidate> {
    let ranges = problem.robot.pose_ranges();
    if ranges.len() > HaltonSample::MOST_JOINTS {
        return vec![];
    }
    let sample = HaltonSample::new(&ranges, SAMPLED);
    let looked = (number * SAMPLE..(number + 1) * SAMPLE).into_par_iter().with_min_len(256);
    let found = looked.filter_map(|id| search.look(0, &sample.configuration(id), &[]));
    found.filter(|found| promising(&found.information)).collect()
}

/// The views of the greatest scores, which stand before them, no two of them near each other.
fn far_apart<'v>(problem: &Problem, mut scored: Vec<(f64, &'v View)>) -> Vec<&'v View> {
    let spacings = spacings(problem);
    let near = |a: &View, b: &View| {
        let apart = a.q.iter().zip(&b.q).zip(&spacings).map(|((a, b), spacing)| (a - b).abs() / spacing);
        apart.fold(0.0, f64::max) < APART
    };
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut starts: Vec<&View> = Vec::with_capacity(STARTS);
    for (_, view) in scored {
        if !starts.iter().any(|start| near(start, view)) {
            starts.push(view);
        }
        if starts.len() == STARTS {
            break;
        }
    }
    starts
}
