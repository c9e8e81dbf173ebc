//! Column generation over all joint values.

use std::sync::Arc;

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256Plus;
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

/// Most rounds; ten to forty are common.
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

/// Views around the columns that are climbed from where climbs from elsewhere end no higher any more, all in all and one more for each
/// column; the tries to find each, and how far from the column it is, as a share of the first steps of climbs.
const HOPS: usize = 48;
const TRIES_PER_HOP: usize = 16;
const HOP_SHARES: [f64; 2] = [1.0, 0.3];

/// Repetitions of a column are looked for at the first steps of climbs and halvings of them, so many times at each.
const NEAREST: i32 = 10;
const REPETITIONS_TRIED: usize = 24;

/// Least share of the level that the views among them score which are climbed from.
const PROMISING: f64 = 0.3;

/// Weights from which a column is worth keeping.
const LEAST_WEIGHT: f64 = 1e-4;

/// Joint values of the views off the grid that the relaxation over all joint values weighs, for choices of `count` poses, near repetitions
/// of those worth more than one pose, and those that were weighed on the way; local searches found them, so nothing is proven of them.
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
    let mut rng = Xoshiro256Plus::seed_from_u64(problem.selection.seed);
    let (mut weights, mut dual, mut left) = (vec![], vec![], vec![]);
    let mut samples = 0;
    for _ in 0..ROUNDS {
        let matrices: Vec<Vec<f64>> = columns.iter().map(|column| column.information.clone()).collect();
        // Weights that add up to one, on k times the information: poses may repeat.
        let objective = objective.on(&matrices).known_share(1.0 / count as f64);
        let Ok(instance) = objective.instance(1, &Arc::default()) else { break };
        let all: Vec<usize> = (0..columns.len()).collect();
        let Ok(relaxation) = relax(&instance, &all, &settings) else { break };
        let mut weight_of = vec![0.0; columns.len()];
        for &(place, weight) in &relaxation.weights {
            weight_of[place] = weight;
        }
        let (kept, dropped): (Vec<_>, Vec<_>) =
            columns.into_iter().zip(weight_of).partition(|(_, weight)| *weight > LEAST_WEIGHT);
        (columns, weights) = kept.into_iter().unzip();
        left.extend(dropped.into_iter().map(|(column, _)| column.view));
        dual = instance.dual(&relaxation.certificate.y);
        let score = |information: &[f64]| dot(information, &dual);
        let level = columns.iter().map(|column| score(&column.information)).fold(0.0, f64::max);
        let climbed = |starts: &[&View], tries: &[f64]| {
            let climbs = starts.par_iter().flat_map_iter(|start| tries.iter().map(move |&stretch| (start, stretch)));
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
        let mut found = climbed(&starts, &TRIES);
        if found.is_empty() {
            let hops: Vec<Candidate> = hops(&search, &columns, &weights, &mut rng);
            found = climbed(&hops.iter().map(|hop| &hop.view).collect::<Vec<_>>(), &TRIES[..1]);
        }
        while found.is_empty() && samples < SAMPLES {
            let views = sampled(problem, &search, samples, &|information| score(information) > PROMISING * level);
            let scored = views.iter().map(|found| (score(&found.information), &found.view)).collect();
            found = climbed(&far_apart(problem, scored), &TRIES);
            samples += 1;
        }
        if found.is_empty() {
            break;
        }
        columns.extend(found.into_iter().take(COLUMNS).map(|(_, found)| found));
    }
    let score = |candidate: &Candidate| dot(&candidate.information, &dual);
    let mut views: Vec<View> = columns.into_iter().map(|column| column.view).collect();
    for (place, weight) in weights.into_iter().enumerate() {
        let more = (weight * count as f64).ceil() as usize - 1;
        views.extend(near_repetitions(&search, &views[place], more, &score, &mut rng));
    }
    // Beside separations those next to the best may be chosen too.
    views.extend(left);
    let is_swept = |view: &View| survey.index_of(view.id).is_some_and(|i| survey.views[i].q == view.q);
    Ok(views.into_iter().filter(|view| !is_swept(view)).map(|view| view.q).collect())
}

/// Views around the columns, more around those of more weight: what bounds the views may stand between a place where climbs end and
/// a better one near it.
fn hops(search: &LocalSearch, columns: &[Candidate], weights: &[f64], rng: &mut impl Rng) -> Vec<Candidate> {
    let around = |(column, weight): (&Candidate, &f64)| {
        let count = (weight * HOPS as f64).ceil() as usize;
        let tries = (0..count * TRIES_PER_HOP).map(|hop| HOP_SHARES[hop % HOP_SHARES.len()]);
        let found = tries.filter_map(|share| search.around(&column.view, share, rng));
        found.take(count).collect::<Vec<_>>()
    };
    columns.iter().zip(weights).flat_map(around).collect()
}

/// So many views beside `view`, or fewer, of great scores, that the constraints allow beside it and each other: a set has each view once,
/// and the best are worth taking more often.
fn near_repetitions(
    search: &LocalSearch,
    view: &View,
    count: usize,
    score: &dyn Fn(&Candidate) -> f64,
    rng: &mut impl Rng,
) -> Vec<View> {
    if count == 0 {
        return vec![];
    }
    let shares = (0..NEAREST).flat_map(|halvings| [0.5f64.powi(halvings); REPETITIONS_TRIED]);
    let found = shares.filter_map(|share| search.around(view, share, rng));
    let mut scored: Vec<(f64, View)> = found.map(|found| (score(&found), found.view)).collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut near: Vec<View> = vec![];
    for (_, next) in scored {
        let others: Vec<&View> = std::iter::once(view).chain(&near).collect();
        if search.allows(&others, &next) {
            near.push(next);
        }
        if near.len() == count {
            break;
        }
    }
    near
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::plan::survey::survey;
    use crate::problem::Overrides;

    fn problem(separation: &str) -> Problem {
        let overrides = Overrides::new().set("sweep.step_deg=15").unwrap().set(separation).unwrap();
        Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap()
    }

    /// As near as the robot can be told where poses may repeat, and as the separation demands where they may not.
    #[test]
    fn repetitions_are_other_views_as_near_as_they_may_be() {
        for (separation, nearest) in
            [("constraints.picture_separation_px=0", 0.05), ("constraints.picture_separation_px=20", 6.0)]
        {
            let problem = problem(separation);
            let survey = survey(&problem, &|_| {}).unwrap();
            let chooser = Chooser::new(&problem, &survey).unwrap();
            let search = LocalSearch::new(&problem, &survey, chooser.objective());
            let mut rng = Xoshiro256Plus::seed_from_u64(1);
            let mut found = 0;
            for view in survey.views.iter().step_by(9) {
                let apart = |other: &View| {
                    let apart = other.q.iter().zip(&view.q).map(|(a, b)| (a - b).abs().to_degrees());
                    apart.fold(0.0, f64::max)
                };
                // As if the view were a maximum.
                let score = |candidate: &Candidate| -apart(&candidate.view);
                let near = near_repetitions(&search, view, 3, &score, &mut rng);
                found += near.len();
                let all: Vec<&View> = std::iter::once(view).chain(&near).collect();
                for (place, one) in all.iter().enumerate().skip(1) {
                    assert!(search.allows(&all[..place], one) && all[..place].iter().all(|other| other.q != one.q));
                }
                assert!(near.first().is_none_or(|first| apart(first) <= nearest), "{separation}");
            }
            assert!(found > survey.views.len() / 9, "{found}");
        }
    }

    /// Sets of many poses find each place as often as it is worth.
    #[test]
    fn columns_are_repeated_as_often_as_they_are_worth() {
        let problem = problem("constraints.picture_separation_px=0");
        let mut survey = survey(&problem, &|_| {}).unwrap();
        let (found, swept) = {
            let chooser = Chooser::new(&problem, &survey).unwrap();
            (columns(&problem, &chooser, 100).unwrap(), chooser.certificate(100).unwrap().log_bound)
        };
        assert!(found.len() >= 100, "{}", found.len());
        survey.add_off_grid(&problem, &found).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let (choice, _) = chooser.best(100, 1).unwrap();
        assert!(choice.log_value > swept + 0.3, "{} {swept}", choice.log_value);
        let chosen = choice.selected.iter().filter(|&&i| i >= survey.views.len() - survey.off_grid).count();
        assert!(chosen > 80, "{chosen} of {}", found.len());
    }
}
