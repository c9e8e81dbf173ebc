//! Exchange (Fedorov 1972): swaps one selected candidate for another while that gains.

use super::instance::Instance;

/// Least gain in log Φ that counts as one.
const LEAST_GAIN: f64 = 1e-12;

/// Improves a selection by the best swap of one selected for one other candidate until no swap gains; returns it in
/// ascending order.
///
/// A swap of i for j gains at most `log(1 + s_j − s_i)` with the scores at the current gradient, so only pairs whose bound
/// exceeds the best gain found are evaluated, and the end is a true local optimum. A singular selection is returned as it
/// is.
pub fn exchange(instance: &Instance, mut selected: Vec<usize>) -> Vec<usize> {
    let p = instance.order();
    let mut total = instance.total(&selected);
    let mut free = vec![true; instance.candidates().len()];
    for &i in &selected {
        free[i] = false;
    }
    let mut without = Vec::new();
    let mut work = Vec::new();
    while let Some(y) = instance.function().gradient(&total, p) {
        let before = instance.log_value(&total);
        let scores = instance.scores(&y);
        selected.sort_unstable_by(|&a, &b| scores[a].total_cmp(&scores[b]).then(a.cmp(&b)));
        let lowest = scores[selected[0]];
        let mut incoming: Vec<usize> = (0..scores.len()).filter(|&j| free[j] && scores[j] > lowest).collect();
        incoming.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
        let mut best: Option<(usize, usize)> = None;
        let mut best_gain = LEAST_GAIN;
        let mut least_lead = best_gain.exp_m1();
        for (place, &i) in selected.iter().enumerate() {
            if incoming.first().is_none_or(|&j| scores[j] - scores[i] <= least_lead) {
                break;
            }
            without.clone_from(&total);
            instance.candidates().add_to(&mut without, i, -1.0);
            for &j in &incoming {
                if scores[j] - scores[i] <= least_lead {
                    break;
                }
                work.clone_from(&without);
                instance.candidates().add_to(&mut work, j, 1.0);
                let gain = instance.function().log_value(&mut work, p) - before;
                if gain > best_gain {
                    (best, best_gain, least_lead) = (Some((place, j)), gain, gain.exp_m1());
                }
            }
        }
        let Some((place, j)) = best else { break };
        free[selected[place]] = true;
        free[j] = false;
        selected[place] = j;
        // Summed anew: updates would carry rounding from swap to swap.
        total = instance.total(&selected);
        if instance.log_value(&total) <= before {
            break;
        }
    }
    selected.sort_unstable();
    selected
}
