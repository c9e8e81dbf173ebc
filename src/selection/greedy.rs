//! Greedy selection: the best marginal gain, k times.

use rayon::prelude::*;

use super::instance::{Instance, SelectionError};

/// Information assumed before the first pick, as a share of k average views: keeps log Φ finite until the picks
/// determine every parameter, and too little to weigh once they do.
const RIDGE: f64 = 1e-4;

/// Softness of functions with kinks, whose own gain is zero wherever two views are needed to raise the least value.
const SOFTNESS: f64 = 0.5;

/// Candidates evaluated first in each step, so that the bound can spare the rest.
const PROBES: usize = 64;

/// Picks `instance.count()` candidates, first the required ones, then each the one that raises log Φ most; ties go to the
/// lower index.
///
/// Each step scores all candidates by the gradient Y and evaluates only those whose bound `log(1 + ⟨Y, M_i⟩)` reaches the
/// best gain found.
///
/// # Errors
/// When the picks leave a combination of the parameters undetermined, or the constraints allow no further pick.
pub fn greedy(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let softened = instance.softened(SOFTNESS);
    let mut total = softened.with_mean(RIDGE * instance.count() as f64);
    let mut selected = Vec::with_capacity(instance.count());
    let mut open: Vec<bool> = (0..instance.len()).map(|i| instance.is_open(i)).collect();
    for &i in instance.required() {
        instance.add_to(&mut total, i, 1.0);
        selected.push(i);
    }
    while selected.len() < instance.count() {
        let i = best_addition(&softened, &total, &selected, &open)?;
        open[i] = false;
        instance.add_to(&mut total, i, 1.0);
        selected.push(i);
    }
    if instance.log_value(&instance.total(&selected)) == f64::NEG_INFINITY {
        return Err(instance.unobservable(&selected));
    }
    Ok(selected)
}

/// The open candidate, allowed beside `selected`, that raises log Φ of `total` most.
fn best_addition(
    instance: &Instance,
    total: &[f64],
    selected: &[usize],
    open: &[bool],
) -> Result<usize, SelectionError> {
    let Some(gradient) = instance.gradient(total) else {
        return Err(instance.least_known(total, selected.len()));
    };
    let before = instance.log_value(total);
    let scores = instance.scores(&gradient.y);
    let rules = instance.rules();
    let eligible = |i: usize| open[i] && (rules.is_free() || rules.allows(selected, None, i));
    let value_with = |work: &mut Vec<f64>, i: usize| {
        work.clear();
        work.extend_from_slice(total);
        instance.add_to(work, i, 1.0);
        instance.log_value_in_place(work)
    };
    let better = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a };
    let probes = highest(&scores, eligible, PROBES).into_iter().map(|i| (value_with(&mut Vec::new(), i), i));
    let probed = probes.fold((f64::NEG_INFINITY, usize::MAX), better);
    let least_score = (probed.0 - before - 1e-12).exp_m1();
    let best = (0..scores.len())
        .into_par_iter()
        .with_min_len(1024)
        .filter(|&i| scores[i] >= least_score && eligible(i))
        .map_init(Vec::new, |work, i| (value_with(work, i), i))
        .reduce(|| probed, better);
    match best.1 {
        usize::MAX if (0..scores.len()).any(eligible) => Err(instance.least_known(total, selected.len())),
        usize::MAX => Err(SelectionError::DeadEnd { selected: selected.len(), count: instance.count() }),
        i => Ok(i),
    }
}

/// The eligible candidates with the `most` highest scores, in no particular order.
pub(super) fn highest(scores: &[f64], eligible: impl Fn(usize) -> bool, most: usize) -> Vec<usize> {
    let mut candidates: Vec<usize> = (0..scores.len()).filter(|&i| eligible(i)).collect();
    if candidates.len() > most {
        let by_score = |&a: &usize, &b: &usize| scores[b].total_cmp(&scores[a]).then(a.cmp(&b));
        candidates.select_nth_unstable_by(most, by_score);
        candidates.truncate(most);
    }
    candidates
}
