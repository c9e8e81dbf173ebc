//! The parts of a search space that are still to be looked at, the best bound first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Parts by their bounds; of equal bounds the part that came first.
pub(crate) struct BestFirst<T> {
    heap: BinaryHeap<Entry<T>>,
    pushed: usize,
}

struct Entry<T> {
    bound: f64,
    number: usize,
    part: T,
}

impl<T> BestFirst<T> {
    /// Of the whole space alone.
    pub(crate) fn new(bound: f64, whole: T) -> Self {
        let mut parts = Self { heap: BinaryHeap::new(), pushed: 0 };
        parts.push(bound, whole);
        parts
    }

    pub(crate) fn push(&mut self, bound: f64, part: T) {
        self.heap.push(Entry { bound, number: self.pushed, part });
        self.pushed += 1;
    }

    /// The part of the greatest bound, and the bound.
    pub(crate) fn pop(&mut self) -> Option<(f64, T)> {
        self.heap.pop().map(|Entry { bound, part, .. }| (bound, part))
    }

    /// The greatest bound.
    pub(crate) fn bound(&self) -> Option<f64> {
        self.heap.peek().map(|entry| entry.bound)
    }

    pub(crate) fn len(&self) -> usize {
        self.heap.len()
    }
}

impl<T> PartialEq for Entry<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T> Eq for Entry<T> {}

impl<T> PartialOrd for Entry<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Entry<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(other.number.cmp(&self.number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_bound_comes_first_and_of_equals_the_first() {
        let mut parts = BestFirst::new(f64::INFINITY, "whole");
        for (bound, part) in [(1.0, "a"), (3.0, "b"), (3.0, "c"), (2.0, "d")] {
            parts.push(bound, part);
        }
        assert_eq!((parts.len(), parts.bound()), (5, Some(f64::INFINITY)));
        let order: Vec<&str> = std::iter::from_fn(|| parts.pop()).map(|(_, part)| part).collect();
        assert_eq!(order, ["whole", "b", "c", "d", "a"]);
        assert_eq!(parts.bound(), None);
    }
}
