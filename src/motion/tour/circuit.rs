//! Every kind of tour as a closed one.

use super::Ends;
use super::bound::Proof;
use super::costs::Costs;

/// The closed tour to be found in place of one with the ends asked for: from a start through all stops to an end, which may
/// be the start itself, and back.
///
/// | ends | start | end |
/// |---|---|---|
/// | open | a dummy, at no cost from any stop | the start |
/// | from home | home | a dummy, at no cost from home and at the cost `far` from any stop |
/// | round home | home | the start |
///
/// From home the closed tour must pass between dummy and home, and any of least cost does if `far` exceeds every cost: in a
/// tour `dummy a … home b …`, to turn round the part `a … home` spares `far` and the cost between home and b for that between
/// a and b.
pub(super) struct Circuit {
    /// Costs between the nodes: the stops but home, then the start, then the end unless it is the start.
    pub(super) costs: Costs,
    /// Number of stops but home.
    pub(super) stops: usize,
    /// Cost of the closed tour beyond that of the one asked for.
    surplus: f64,
    /// The caller's numbers of the nodes; the dummy, the last node, has none.
    numbers: Vec<usize>,
}

impl Circuit {
    pub(super) fn new(costs: &Costs, ends: Ends) -> Self {
        let home = ends.home();
        assert!(home.is_none_or(|home| home < costs.len()), "{ends:?} of {} stops", costs.len());
        let numbers: Vec<usize> = (0..costs.len()).filter(|&i| Some(i) != home).chain(home).collect();
        let stops = numbers.len() - usize::from(home.is_some());
        let (dummies, far) = match ends {
            Ends::Open => (1, 0.0),
            Ends::From(_) => (1, 2.0 * costs.greatest()),
            Ends::Round(_) => (0, 0.0),
        };
        // Of two nodes the first has a number: the dummy comes last.
        let between = |i: usize, j: usize| match numbers.get(j) {
            Some(&j) => costs.between(numbers[i], j),
            None if i < stops => far,
            None => 0.0,
        };
        Self { costs: Costs::from_fn(numbers.len() + dummies, between), stops, surplus: far, numbers }
    }

    pub(super) fn start(&self) -> usize {
        self.stops
    }

    pub(super) fn end(&self) -> usize {
        self.costs.len() - 1
    }

    /// The order that a closed tour stands for; of its two directions, where both will do, the one with the lower number early.
    pub(super) fn order(&self, mut cycle: Vec<usize>) -> Vec<usize> {
        if let Some(place) = cycle.iter().position(|&node| node == self.start()) {
            cycle.rotate_left(place);
        }
        if let [_, first, .., last] = cycle[..]
            && (first == self.end() || (last != self.end() && first > last))
        {
            cycle[1..].reverse();
        }
        cycle.iter().filter_map(|&node| self.numbers.get(node).copied()).collect()
    }

    /// The cost that no tour with the ends asked for stays below.
    pub(super) fn bound(&self, proof: &Proof) -> f64 {
        (proof.bound - self.surplus).max(0.0)
    }
}
