//! Greedy selection: the best marginal gain, k times.

use rayon::prelude::*;

use super::instance::{Instance, SelectionError};

/// Information assumed before the first pick, as a share of k average views: keeps log Φ finite until the picks
/// determine every parameter, and too little to weigh once they do.
const RIDGE: f64 = 1e-4;

/// Candidates evaluated first in each step, so that the bound can spare the rest.
const PROBES: usize = 64;

/// Picks `instance.count()` candidates, each the one that raises log Φ most; ties go to the lower index.
///
/// Each step scores all candidates by the gradient Y and evaluates only those whose bound `log(1 + ⟨Y, M_i⟩)` reaches the
/// best gain found.
///
/// # Errors
/// When the picks leave a combination of the parameters undetermined.
pub fn greedy(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let p = instance.order();
    let mut total = instance.with_mean(RIDGE * instance.count() as f64);
    let mut selected = Vec::with_capacity(instance.count());
    let mut free = vec![true; instance.candidates().len()];
    while selected.len() < instance.count() {
        let Some(y) = instance.function().gradient(&total, p) else {
            return Err(instance.least_known(&total, selected.len()));
        };
        let before = instance.log_value(&total);
        let scores = instance.scores(&y);
        let value_with = |work: &mut Vec<f64>, i: usize| {
            work.clone_from(&total);
            instance.candidates().add_to(work, i, 1.0);
            instance.function().log_value(work, p)
        };
        let better = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a };
        let probes = best_scores(&scores, &free, PROBES).into_iter().map(|i| (value_with(&mut Vec::new(), i), i));
        let probed = probes.fold((f64::NEG_INFINITY, usize::MAX), better);
        let least_score = (probed.0 - before - 1e-12).exp_m1();
        let best = (0..scores.len())
            .into_par_iter()
            .with_min_len(1024)
            .filter(|&i| free[i] && scores[i] >= least_score)
            .map_init(Vec::new, |work, i| (value_with(work, i), i))
            .reduce(|| probed, better);
        let i = best.1;
        if i == usize::MAX {
            return Err(instance.least_known(&total, selected.len()));
        }
        free[i] = false;
        instance.candidates().add_to(&mut total, i, 1.0);
        selected.push(i);
    }
    if instance.log_value(&instance.total(&selected)) == f64::NEG_INFINITY {
        return Err(instance.unobservable(&selected));
    }
    Ok(selected)
}

/// The free candidates with the `most` highest scores, in no particular order.
pub(super) fn best_scores(scores: &[f64], free: &[bool], most: usize) -> Vec<usize> {
    let mut candidates: Vec<usize> = (0..scores.len()).filter(|&i| free[i]).collect();
    if candidates.len() > most {
        let by_score = |&a: &usize, &b: &usize| scores[b].total_cmp(&scores[a]).then(a.cmp(&b));
        candidates.select_nth_unstable_by(most, by_score);
        candidates.truncate(most);
    }
    candidates
}
