//! Branch and bound over boxes of joint values.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use rayon::prelude::*;

use super::cell::{Cell, Found};
use super::{Continuum, ContinuumEnd, ContinuumProgress, ContinuumSettings, Greatest, Held};

/// A box in the queue.
struct Node {
    bound: f64,
    /// Boxes in the order in which they were made, so that equal bounds are told apart.
    number: usize,
    cell: Cell,
    /// The joint whose range is halved next.
    widest: usize,
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// The greatest bound first; of those without one the largest, which came first.
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(other.number.cmp(&self.number))
    }
}

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
    let mut queue = BinaryHeap::new();
    queue.push(Node { bound: f64::INFINITY, number: 0, cell: continuum.whole(), widest: 0 });
    let (mut boxes, mut number) = (1, 1);
    let end = loop {
        let threshold = (1.0 + settings.tolerance) * found;
        let bound = queue.peek().map_or(found, |node: &Node| node.bound.max(found));
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
        while halves.len() < 2 * BATCH && queue.peek().is_some_and(|node| node.bound > threshold) {
            let Some(Node { cell, widest, bound, .. }) = queue.pop() else { break };
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
            let Found::Bound { bound, widest, at_centre } = result else { continue };
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
            queue.push(Node { bound, number, cell, widest });
            number += 1;
        }
    };
    Greatest { bound: queue.peek().map_or(found, |node| node.bound.max(found)), found, boxes, end }
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
