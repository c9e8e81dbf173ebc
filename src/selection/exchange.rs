//! Exchange (Fedorov 1972): swaps one selected candidate for another while that gains.

use rayon::prelude::*;

use super::error::SelectionError;
use super::greedy::{highest, start};
use super::instance::Instance;

/// Least gain in log Φ that counts as one.
const LEAST_GAIN: f64 = 1e-12;

/// Softnesses that a function with kinks is improved at, one after the other. At the kinks almost no single swap gains, and
/// exchange would stop at once; the smooth stand-ins lead it towards selections that are good by the function itself.
const SOFTNESSES: [f64; 5] = [0.5, 0.2, 0.08, 0.03, 0.01];

/// Candidates that a swap at a softness may bring in: the way there matters less than the end, which looks at all.
const SOFT_WIDTH: usize = 150;

/// Selections improved at a time: each holds a score for every candidate.
const SIDE_BY_SIDE: usize = 8;

/// Average views for each of the k that are assumed known, ever fewer, while swaps lead out of the singular selections.
const RIDGES: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// Greedy's picks, improved by [`exchange`].
///
/// # Errors
/// When no allowed set was found, or what was found leaves a combination of the parameters undetermined.
pub fn improved_greedy(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let improved = exchange(instance, start(instance)?);
    if instance.is_singular(&improved) {
        return Err(instance.unobservable(&improved));
    }
    Ok(improved)
}

/// Improves a selection by the best swap of one selected for one other candidate until no swap gains; returns it in
/// ascending order. Required candidates stay, and only what the constraints allow comes in.
///
/// A swap of i for j gains at most `log(1 + s_j − s_i)` with the scores at the current gradient, so only pairs whose bound
/// exceeds the best gain found are evaluated, and the end is a true local optimum. A singular selection is led to a regular
/// one first, by swaps that gain beside a little information assumed known; the result is singular if they lead to none.
pub fn exchange(instance: &Instance, selected: Vec<usize>) -> Vec<usize> {
    exchange_each(instance, vec![selected]).pop().unwrap_or_default()
}

/// As [`exchange`] for several selections, side by side: their gradients score the candidates together.
pub fn exchange_each(instance: &Instance, selections: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let value = |selected: &Vec<usize>| instance.log_value(&instance.total(selected));
    let mut current: Vec<_> = selections.into_iter().map(|selected| regular(instance, selected)).collect();
    let mut best = ascend(instance, current.clone(), usize::MAX);
    if !instance.is_smooth() {
        for softness in SOFTNESSES {
            current = ascend(&instance.softened(softness), current, SOFT_WIDTH);
            let candidates = ascend(instance, current.clone(), usize::MAX);
            for (best, candidate) in best.iter_mut().zip(candidates) {
                if value(&candidate) > value(best) {
                    *best = candidate;
                }
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
        selected = ascend(&known, vec![selected], usize::MAX).pop().unwrap_or_default();
    }
    selected
}

/// For each selection the best swap with one of the `width` best scores, again and again until none gains.
fn ascend(instance: &Instance, selections: Vec<Vec<usize>>, width: usize) -> Vec<Vec<usize>> {
    let mut climbs: Vec<Climb> = selections.into_iter().map(|selected| Climb::new(instance, selected)).collect();
    for side_by_side in climbs.chunks_mut(SIDE_BY_SIDE) {
        loop {
            let (climbing, gradients): (Vec<&mut Climb>, Vec<Vec<f64>>) =
                side_by_side.iter_mut().filter_map(|climb| climb.gradient().map(|y| (climb, y))).unzip();
            if climbing.is_empty() {
                break;
            }
            let scores = instance.scores_by_each(&gradients);
            climbing.into_par_iter().zip(scores).for_each(|(climb, scores)| climb.swap(&scores, width));
        }
    }
    let sorted = |mut climb: Climb| {
        climb.selected.sort_unstable();
        climb.selected
    };
    climbs.into_iter().map(sorted).collect()
}

/// A selection on its way.
struct Climb<'a> {
    instance: &'a Instance<'a>,
    selected: Vec<usize>,
    total: Vec<f64>,
    /// Whether a candidate may come in, the constraints aside.
    open: Vec<bool>,
    is_at_top: bool,
}

impl<'a> Climb<'a> {
    fn new(instance: &'a Instance<'a>, selected: Vec<usize>) -> Self {
        let mut open: Vec<bool> = (0..instance.len()).map(|i| instance.is_open(i)).collect();
        for &i in &selected {
            open[i] = false;
        }
        Self { instance, total: instance.total(&selected), selected, open, is_at_top: false }
    }

    /// The gradient; `None` at the top, or where there is none.
    fn gradient(&self) -> Option<Vec<f64>> {
        if self.is_at_top { None } else { self.instance.gradient(&self.total).map(|gradient| gradient.y) }
    }

    /// Makes the best swap by the `scores` at the gradient, or is at the top.
    fn swap(&mut self, scores: &[f64], width: usize) {
        let before = self.instance.log_value(&self.total);
        self.selected.sort_unstable_by(|&a, &b| scores[a].total_cmp(&scores[b]).then(a.cmp(&b)));
        let Some((place, j)) = self.best_swap(scores, width, before) else {
            self.is_at_top = true;
            return;
        };
        self.open[self.selected[place]] = true;
        self.open[j] = false;
        self.selected[place] = j;
        // Summed anew: updates would carry rounding from swap to swap.
        self.total = self.instance.total(&self.selected);
        self.is_at_top = self.instance.log_value(&self.total) <= before;
    }

    /// The place among the selected, which are in order of their scores, and the candidate that gain most, if any do.
    fn best_swap(&self, scores: &[f64], width: usize, before: f64) -> Option<(usize, usize)> {
        let Self { instance, selected, total, open, .. } = self;
        let rules = instance.rules();
        let leaving = || (0..selected.len()).filter(|&place| instance.is_open(selected[place]));
        let lowest = leaving().next().map(|place| scores[selected[place]])?;
        let mut incoming = highest(scores, |j| open[j] && scores[j] > lowest, width.min(scores.len()));
        incoming.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
        let (mut without, mut work) = (Vec::new(), Vec::new());
        let mut best: Option<(usize, usize)> = None;
        let mut best_gain = LEAST_GAIN;
        let mut least_lead = best_gain.exp_m1();
        for place in leaving() {
            let i = selected[place];
            if incoming.first().is_none_or(|&j| scores[j] - scores[i] <= least_lead) {
                break;
            }
            without.clone_from(total);
            instance.add_to(&mut without, i, -1.0);
            for &j in &incoming {
                if scores[j] - scores[i] <= least_lead {
                    break;
                }
                if !rules.is_free() && !rules.allows(selected, Some(i), j) {
                    continue;
                }
                work.clone_from(&without);
                instance.add_to(&mut work, j, 1.0);
                let gain = instance.log_value_in_place(&mut work) - before;
                if gain > best_gain {
                    (best, best_gain, least_lead) = (Some((place, j)), gain, gain.exp_m1());
                }
            }
        }
        best
    }
}
