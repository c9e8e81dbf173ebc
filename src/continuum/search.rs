//! Branch and bound over boxes of joint values.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::cell::{Cell, Found};
use super::{Continuum, ContinuumEnd, ContinuumProgress, ContinuumSettings, Greatest, Held};
use crate::selection::BestFirst;

/// Boxes halved together: as many whatever the number of threads, so that the outcome is the same.
const BATCH: usize = 64;

pub(super) fn greatest(
    continuum: &Continuum,
    known: f64,
    settings: &ContinuumSettings,
    score: &(dyn Fn(&[f64]) -> Option<f64> + Sync),
    observe: &mut dyn FnMut(&ContinuumProgress) -> ControlFlow<()>,
) -> Greatest {
    let mut found = known;
    // Boxes with the joint whose range is halved next; of those without a bound the largest come first.
    let mut queue = BestFirst::new(f64::INFINITY, (continuum.whole(), 0));
    // The greatest bound of boxes that are not halved any more.
    let mut finest = f64::NEG_INFINITY;
    let mut boxes = 1;
    let end = loop {
        let threshold = ((1.0 + settings.tolerance) * found).max(finest);
        let bound = queue.bound().unwrap_or(found).max(found).max(finest);
        if bound <= threshold {
            break ContinuumEnd::Closed;
        }
        if observe(&ContinuumProgress { bound, found, boxes }).is_break() {
            break ContinuumEnd::Stopped;
        }
        if boxes >= settings.most_boxes {
            break ContinuumEnd::BoxLimit;
        }
        let mut halves = Vec::with_capacity(2 * BATCH);
        while halves.len() < 2 * BATCH && queue.bound().is_some_and(|bound| bound > threshold) {
            let Some((bound, (cell, widest))) = queue.pop() else { break };
            halves.extend(cell.halves(widest).map(|half| (half, bound)));
        }
        let results: Vec<_> = halves
            .into_par_iter()
            .with_min_len(4)
            .map(|(half, bound)| {
                let found = continuum.examine(&half);
                (half, bound, found)
            })
            .collect();
        boxes += results.len();
        for (cell, parent, result) in results {
            let Found::Bound { bound, widest, at_centre, is_finest } = result else { continue };
            // What holds of the whole holds of the half.
            let bound = bound.min(parent);
            if bound <= found {
                continue;
            }
            if at_centre > found
                && let Some(score) = score(&cell.centre())
            {
                found = found.max(score);
            }
            if is_finest {
                finest = finest.max(bound);
            } else {
                queue.push(bound, (cell, widest));
            }
        }
    };
    Greatest { bound: queue.bound().unwrap_or(found).max(found).max(finest), found, boxes, end }
}

/// Whether no box holds a view that scores more than `most`, depth first.
pub(super) fn holds(continuum: &Continuum, most: f64, most_boxes: usize) -> Held {
    let mut open = vec![(continuum.whole(), 0)];
    let mut boxes = 1;
    while !open.is_empty() {
        if boxes >= most_boxes {
            return Held { is_proven: false, boxes };
        }
        let first = open.len().saturating_sub(BATCH);
        let halves: Vec<Cell> = open.drain(first..).flat_map(|(cell, widest)| cell.halves(widest)).collect();
        let results: Vec<_> = halves.par_iter().with_min_len(4).map(|half| continuum.examine(half)).collect();
        boxes += results.len();
        for (cell, result) in halves.into_iter().zip(results) {
            if let Found::Bound { bound, widest, .. } = result
                && bound > most
            {
                open.push((cell, widest));
            }
        }
    }
    Held { is_proven: true, boxes }
}
