//! Exchange (Fedorov 1972): swaps one selected candidate for another while that gains.

use std::iter::zip;

use rayon::prelude::*;

use super::error::SelectionError;
use super::greedy::{EVALUATED_PER_TASK, sample, start};
use super::highest::highest;
use super::instance::{Instance, Part};

/// Least gain in log Φ that counts as one.
const LEAST_GAIN: f64 = 1e-12;

/// Softnesses that a function with kinks is improved at, one after the other. At the kinks almost no single swap gains, and
/// exchange would stop at once; the smooth stand-ins lead it towards selections that are good by the function itself.
const SOFTNESSES: [f64; 5] = [0.5, 0.2, 0.08, 0.03, 0.01];

/// Candidates that a swap at a softness may bring in: the way there matters less than the end, which looks at all.
const SOFT_WIDTH: usize = 150;

/// Candidates that swaps may bring in where a sample's picks are improved, those of all that score most; and how often they are looked for.
const SAMPLED_WIDTH: usize = 3000;
const LOOKS_AT_ALL: usize = 2;

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
    regular_of(instance, improved(instance, start(instance)?))
}

/// As [`improved_greedy`], but where candidates are many by greedy's picks among an even sample of them, and from there by swaps for those
/// of all that score most.
///
/// # Errors
/// As [`improved_greedy`].
pub(crate) fn improved_sample(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let begun = sample(instance).and_then(|part| {
        let picked = start(&part.instance()).ok()?;
        Some(part.members(&picked)).filter(|picked| !instance.is_singular(picked))
    });
    let Some(mut selected) = begun else { return improved_greedy(instance) };
    for _ in 0..LOOKS_AT_ALL {
        let scores = instance.scores(&instance.gradient(&selected)?.y);
        let highest = highest(&scores, (0..scores.len()).filter(|&i| instance.is_open(i)), SAMPLED_WIDTH);
        let part = Part::new(instance, highest.into_iter().chain(selected.iter().copied()));
        let improved = exchange(&part.instance(), part.places(&selected))?;
        selected = part.members(&improved);
    }
    regular_of(instance, selected)
}

/// `selected`, if they determine every parameter.
fn regular_of(instance: &Instance, selected: Vec<usize>) -> Result<Vec<usize>, SelectionError> {
    if instance.is_singular(&selected) { Err(instance.unobservable(&selected)) } else { Ok(selected) }
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
    let mut incoming =
        highest(scores, (0..scores.len()).filter(|&j| open[j] && scores[j] > lowest), width.min(scores.len()));
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
            let level = before + best_gain - ROUNDING;
            let values = next.par_chunks(EVALUATED_PER_TASK).map(|part| {
                let allowed = |&j: &usize| rules.is_free() || rules.allows(selected, Some(i), j);
                let part: Vec<usize> = part.iter().copied().filter(allowed).collect();
                let values = instance.log_values_with(&without, &part, level);
                zip(part, values).collect::<Vec<_>>()
            });
            for (j, value) in values.collect::<Vec<_>>().concat() {
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

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256Plus;

    use super::*;
    use crate::selection::{
        Constraints, InformationFunction, InformationSet, RelaxationSettings, Separation, Term, best,
    };

    /// `g gᵀ` of three numbers each, of so many that greedy picks from every other one.
    fn many() -> (Vec<[f64; 3]>, InformationSet) {
        let mut rng = Xoshiro256Plus::seed_from_u64(3);
        let rows: Vec<[f64; 3]> = (0..120_000).map(|_| std::array::from_fn(|_| rng.gen_range(-1.0..1.0))).collect();
        let table = rows.iter().flat_map(|&[x, y, z]| [x * x, x * y, y * y, x * z, y * z, z * z]).collect();
        (rows, InformationSet::from_packed(3, table).unwrap())
    }

    #[test]
    fn a_sample_leads_to_as_good_a_selection_as_all() {
        let (rows, candidates) = many();
        let function = InformationFunction::variance(&DMatrix::identity(3, 3));
        let term = Term { candidates: &candidates, prior: None, function: &function, share: 1.0 };
        let constraints =
            Constraints { required: vec![9999], separations: vec![Separation::of(&rows, 0.2)], ..Default::default() };
        let instance = Instance::constrained(&[term], 8, constraints).unwrap();
        let sampled = sample(&instance).unwrap();
        assert!(sampled.place(9999).is_some() && sampled.place(9998).is_some() && sampled.place(9997).is_none());
        let (of_sample, of_all) = (improved_sample(&instance).unwrap(), improved_greedy(&instance).unwrap());
        assert!(of_sample.contains(&9999) && of_sample.len() == 8);
        for (c, &i) in of_sample.iter().enumerate() {
            assert!(instance.rules().allows(&of_sample[..c], None, i));
        }
        let value = |selected: &Vec<usize>| instance.log_value(selected).unwrap();
        assert!((value(&of_sample) - value(&of_all)).abs() < 0.01, "{} {}", value(&of_sample), value(&of_all));
    }

    #[test]
    fn many_candidates_are_all_chosen_from() {
        let (_, candidates) = many();
        let instance = Instance::new(&candidates, None, &InformationFunction::Determinant, 8).unwrap();
        let found = best(&instance, &RelaxationSettings::default(), 0).unwrap();
        let efficiency = found.relaxation.certificate.efficiency(found.log_value);
        assert!(efficiency > 0.99, "{efficiency}");
        assert!(found.selected.iter().any(|i| i % 2 == 1), "{:?}", found.selected);
    }
}
