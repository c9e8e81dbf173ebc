//! Exchange (Fedorov 1972): swaps one selected candidate for another while that gains.

use rayon::prelude::*;

use super::error::SelectionError;
use super::greedy::{EVALUATED_PER_TASK, highest, start};
use super::instance::{Instance, Part};

/// Least gain in log Φ that counts as one.
const LEAST_GAIN: f64 = 1e-12;

/// Softnesses that a function with kinks is improved at, one after the other. At the kinks almost no single swap gains, and
/// exchange would stop at once; the smooth stand-ins lead it towards selections that are good by the function itself.
const SOFTNESSES: [f64; 5] = [0.5, 0.2, 0.08, 0.03, 0.01];

/// Candidates that a swap at a softness may bring in: the way there matters less than the end, which looks at all.
const SOFT_WIDTH: usize = 150;

/// Average views for each of the k that are assumed known, ever fewer, while swaps lead out of the singular selections.
const RIDGES: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// Allowance for rounding when a bound is held against a value in log Φ.
const ROUNDING: f64 = 1e-9;

/// Swaps of one candidate that are evaluated together: first few, for they raise what the others must promise, then ever more.
const FIRST_EVALUATED: usize = 16;
const MOST_EVALUATED: usize = 4096;

/// Greedy's picks, improved by [`exchange`].
///
/// # Errors
/// When no allowed set was found, or what was found leaves a combination of the parameters undetermined.
pub fn improved_greedy(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let improved = improved(instance, start(instance)?);
    if instance.is_singular(&improved) {
        return Err(instance.unobservable(&improved));
    }
    Ok(improved)
}

/// As [`improved_greedy`], of those candidates alone that score most by `y`, `most` at most, and of the required ones.
///
/// # Errors
/// As [`improved_greedy`].
pub(crate) fn improved_greedy_of_highest(
    instance: &Instance,
    y: &[f64],
    most: usize,
) -> Result<Vec<usize>, SelectionError> {
    if instance.len() <= most {
        return improved_greedy(instance);
    }
    let part = Part::new(instance, highest(&instance.scores(y), |i| instance.is_open(i), most));
    match improved_greedy(&part.instance()) {
        Ok(found) => Ok(part.members(&found)),
        // Where so few do not do, all may.
        Err(_) => improved_greedy(instance),
    }
}

/// Improves a selection by the best swap of one selected for one other candidate until no swap gains; returns it in
/// ascending order. Required candidates stay, and only what the constraints allow comes in.
///
/// A swap of i for j gains at most `log(1 + s_j − s_i)` with the scores at the current gradient, so only pairs whose bound
/// exceeds the best gain found are evaluated, and the end is a true local optimum. A singular selection is led to a regular
/// one first, by swaps that gain beside a little information assumed known; the result is singular if they lead to none.
///
/// # Errors
/// When `selected` are not candidates, each once.
pub fn exchange(instance: &Instance, selected: Vec<usize>) -> Result<Vec<usize>, SelectionError> {
    instance.check(&selected)?;
    Ok(improved(instance, selected))
}

/// As [`exchange`], of a selection known to be one.
pub(super) fn improved(instance: &Instance, selected: Vec<usize>) -> Vec<usize> {
    improved_through(instance, selected, &SOFTNESSES)
}

/// As [`improved`], of a selection that is good already: by the least softness alone, which does not lead far away from it.
pub(super) fn improved_nearby(instance: &Instance, selected: Vec<usize>) -> Vec<usize> {
    improved_through(instance, selected, &SOFTNESSES[SOFTNESSES.len() - 1..])
}

fn improved_through(instance: &Instance, selected: Vec<usize>, softnesses: &[f64]) -> Vec<usize> {
    let value = |selected: &Vec<usize>| instance.log_value_at(&instance.total(selected));
    let mut current = regular(instance, selected);
    let mut best = ascend(instance, current.clone(), usize::MAX);
    if !instance.is_smooth() {
        for &softness in softnesses {
            current = ascend(&instance.softened(softness), current, SOFT_WIDTH);
            let candidate = ascend(instance, current.clone(), usize::MAX);
            if value(&candidate) > value(&best) {
                best = candidate;
            }
        }
    }
    best
}

/// Swaps that make a singular selection regular, if they do.
fn regular(instance: &Instance, mut selected: Vec<usize>) -> Vec<usize> {
    for ridge in RIDGES {
        if !instance.is_singular(&selected) {
            break;
        }
        let known = instance.softened(SOFTNESSES[0]).with_known_mean(ridge * instance.count() as f64);
        selected = ascend(&known, selected, usize::MAX);
    }
    selected
}

/// The best swap with one of the `width` best scores, again and again until none gains.
fn ascend(instance: &Instance, mut selected: Vec<usize>, width: usize) -> Vec<usize> {
    let mut open: Vec<bool> = (0..instance.len()).map(|i| instance.is_open(i)).collect();
    for &i in &selected {
        open[i] = false;
    }
    let mut total = instance.total(&selected);
    while let Some(minorant) = instance.minorant_at(&total) {
        let of_minorant = minorant.total(&selected);
        let Some(gradient) = minorant.gradient_at(&of_minorant) else { break };
        let before = instance.log_value_at(&total);
        let scores = minorant.scores(&gradient.y);
        selected.sort_unstable_by(|&a, &b| scores[a].total_cmp(&scores[b]).then(a.cmp(&b)));
        let Some((place, j)) = best_swap(&minorant, &selected, &open, &of_minorant, &scores, width) else { break };
        open[selected[place]] = true;
        open[j] = false;
        selected[place] = j;
        // Summed anew: updates would carry rounding from swap to swap.
        total = instance.total(&selected);
        if instance.log_value_at(&total) <= before {
            break;
        }
    }
    selected.sort_unstable();
    selected
}

/// The place among the `selected`, which are in order of their scores, and the `open` candidate that gain most together, if
/// any do.
fn best_swap(
    instance: &Instance,
    selected: &[usize],
    open: &[bool],
    total: &[f64],
    scores: &[f64],
    width: usize,
) -> Option<(usize, usize)> {
    let before = instance.log_value_at(total);
    let rules = instance.rules();
    let leaving = || (0..selected.len()).filter(|&place| instance.is_open(selected[place]));
    let lowest = leaving().next().map(|place| scores[selected[place]])?;
    let mut incoming = highest(scores, |j| open[j] && scores[j] > lowest, width.min(scores.len()));
    incoming.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
    let mut best: Option<(usize, usize)> = None;
    let mut best_gain = LEAST_GAIN;
    let mut least_lead = best_gain.exp_m1();
    for place in leaving() {
        let i = selected[place];
        let mut without = total.to_vec();
        instance.add_to(&mut without, i, -1.0);
        let mut left = incoming.as_slice();
        let mut most = FIRST_EVALUATED;
        loop {
            let leading = left.partition_point(|&j| scores[j] - scores[i] > least_lead);
            if leading == 0 {
                break;
            }
            let (next, rest) = left.split_at(leading.min(most));
            let allowed = |&j: &usize| rules.is_free() || rules.allows(selected, Some(i), j);
            let next: Vec<usize> = next.iter().copied().filter(allowed).collect();
            let level = before + best_gain - ROUNDING;
            let values = |part: &[usize]| instance.log_values_with(&without, part, level);
            let values = next.par_chunks(EVALUATED_PER_TASK).map(values);
            for (&j, value) in next.iter().zip(values.collect::<Vec<_>>().concat()) {
                let gain = value - before;
                if gain > best_gain {
                    (best, best_gain, least_lead) = (Some((place, j)), gain, gain.exp_m1());
                }
            }
            (left, most) = (rest, (2 * most).min(MOST_EVALUATED));
        }
    }
    best
}
