//! Poses of a list that give place to others.

use crate::plan::choose::{Choice, Chooser, PlanError};
use crate::selection::{Spare, spares};

/// Swaps listed at most, and done at most one after the other.
const MOST: usize = 3;

/// Gain in log Φ below which a swap is none.
const LEAST_GAIN: f64 = 1e-4;

/// A swap, by places among the survey's views.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Swap {
    /// The place of the pose that leaves among those that the swap is of.
    pub(super) leaving: usize,
    pub(super) incoming: usize,
    /// The set after it.
    pub(super) after: Choice,
}

/// The swaps of one of the views `selected` for any other that the constraints allow beside the rest which gain most, of different
/// views, the best first.
///
/// # Errors
/// When so many cannot be chosen.
pub(super) fn single(chooser: &Chooser, selected: &[usize]) -> Result<Vec<Swap>, PlanError> {
    let before = chooser.assess(selected.to_vec()).log_value;
    let instance = chooser.instance(selected.len())?;
    let found = spares(&instance, selected, 1, &|_, _| true).map_err(PlanError::Selection)?;
    let mut best: Vec<(usize, Spare)> =
        found.into_iter().enumerate().filter_map(|(leaving, spares)| Some((leaving, *spares.first()?))).collect();
    // Where nothing is determined, what determines everything gains.
    best.retain(|(_, spare)| spare.log_value > f64::NEG_INFINITY && spare.log_value >= before + LEAST_GAIN);
    best.sort_by(|a, b| b.1.log_value.total_cmp(&a.1.log_value));
    best.truncate(MOST);
    let swap = |(leaving, spare): (usize, Spare)| {
        let mut after = selected.to_vec();
        after[leaving] = spare.candidate;
        Swap { leaving, incoming: spare.candidate, after: chooser.assess(after) }
    };
    Ok(best.into_iter().map(swap).collect())
}

/// Swaps one after the other, each the best after those before it, and none of a view that came in by one.
///
/// # Errors
/// As [`single`].
pub(super) fn one_after_the_other(chooser: &Chooser, selected: &[usize]) -> Result<Vec<Swap>, PlanError> {
    let mut current = selected.to_vec();
    let mut done: Vec<Swap> = Vec::new();
    for _ in 0..MOST {
        let Some(swap) = single(chooser, &current)?.into_iter().next() else { break };
        if done.iter().any(|before| before.leaving == swap.leaving) {
            break;
        }
        current[swap.leaving] = swap.incoming;
        done.push(swap);
    }
    Ok(done)
}
