//! Lower bounds of closed tours (Held and Karp 1970, 1971).
//!
//! A 1-tree is a spanning tree of all nodes but one, and two edges of that one. Every closed tour is a 1-tree, so none costs
//! less than the least of them. To charge each node i a fee `π_i` for each of its edges raises the cost of every tour by
//! `2 Σ π_i`, but that of other 1-trees by more or less: the fees that bring the least one closest to a tour prove most.

use super::costs::Costs;

/// By how much a step changes the fees (root mean square), in mean edges: at first.
const FIRST_STEP: f64 = 0.1;

/// The same at last; it shrinks evenly in between.
const LAST_STEP: f64 = 1e-4;

/// Weight of the newest 1-tree in the running mean of them.
const NEWEST: f64 = 0.2;

/// What 1-trees prove of closed tours.
pub(super) struct Proof {
    /// No closed tour costs less.
    pub(super) bound: f64,
    /// The fees π that prove it, one a node.
    fees: Vec<f64>,
}

impl Proof {
    /// The best of so many steps from no fees, for three nodes or more. Each raises the fees of nodes that have more than two
    /// edges and lowers those of nodes that have fewer, in the running mean of the least 1-trees (Barahona and Anbil 2000): in
    /// any one of them, the edge that a whole group of nodes lacks is lost among those that its nodes take from each other.
    pub(super) fn of(costs: &Costs, steps: usize) -> Self {
        let n = costs.len();
        let mut fees = vec![0.0; n];
        let mut best = Self { bound: f64::NEG_INFINITY, fees: fees.clone() };
        let mut tree = OneTree::new(n);
        // Edges beyond two.
        let mut excess = vec![0.0; n];
        let mut step = FIRST_STEP;
        for _ in 0..=steps {
            let value = tree.grow(costs, &fees);
            if value > best.bound {
                best.bound = value;
                best.fees.clone_from(&fees);
            }
            for (mean, &degree) in excess.iter_mut().zip(&tree.degrees) {
                *mean += NEWEST * (f64::from(degree) - 2.0 - *mean);
            }
            let norm = (excess.iter().map(|mean| mean * mean).sum::<f64>() / n as f64).sqrt();
            if tree.is_tour() || norm == 0.0 {
                break;
            }
            let length = step * best.bound / n as f64;
            for (fee, mean) in fees.iter_mut().zip(&excess) {
                *fee += length * mean / norm;
            }
            step *= (LAST_STEP / FIRST_STEP).powf(1.0 / steps as f64);
        }
        best.bound -= best.rounding(costs);
        best
    }

    /// The costs with the fees, by which tours compare as before, but a cheap edge is more often one of a good tour.
    pub(super) fn with_fees(&self, costs: &Costs) -> Costs {
        Costs::from_fn(costs.len(), |i, j| costs.between(i, j) + (self.fees[i] + self.fees[j]))
    }

    /// More than rounding can have added to the bound or taken from a cost that it is held against: in their sums of n terms,
    /// some 3 n times half an ε of what is never beyond 2 n times the greatest cost with fees.
    fn rounding(&self, costs: &Costs) -> f64 {
        let n = costs.len() as f64;
        let greatest_fee = self.fees.iter().fold(0.0, |greatest: f64, fee| greatest.max(fee.abs()));
        3.0 * n * n * f64::EPSILON * (costs.greatest() + 2.0 * greatest_fee)
    }
}

/// The least 1-tree, around the last node.
struct OneTree {
    degrees: Vec<u32>,
    /// Nodes that are not yet in the tree.
    outside: Vec<usize>,
    /// The cheapest edge from each of these to one in the tree: its cost and that node.
    links: Vec<(f64, usize)>,
}

impl OneTree {
    fn new(n: usize) -> Self {
        Self { degrees: vec![0; n], outside: Vec::with_capacity(n), links: Vec::with_capacity(n) }
    }

    fn is_tour(&self) -> bool {
        self.degrees.iter().all(|&degree| degree == 2)
    }

    /// Finds the 1-tree that costs least with the fees; the cost less two of each fee.
    fn grow(&mut self, costs: &Costs, fees: &[f64]) -> f64 {
        self.degrees.fill(0);
        self.spanning_tree(costs, fees) + self.last_two_edges(costs, fees) - 2.0 * fees.iter().sum::<f64>()
    }

    /// Adds the least spanning tree of all nodes but the last (Prim 1957); its cost.
    fn spanning_tree(&mut self, costs: &Costs, fees: &[f64]) -> f64 {
        let last = costs.len() - 1;
        self.outside.clear();
        self.outside.extend(1..last);
        self.links.clear();
        self.links.resize(last, (f64::INFINITY, 0));
        let (mut total, mut newest) = (0.0, 0);
        while !self.outside.is_empty() {
            let row = costs.of(newest);
            let mut cheapest = (f64::INFINITY, 0);
            for (place, &node) in self.outside.iter().enumerate() {
                let link = &mut self.links[node];
                let cost = row[node] + (fees[node] + fees[newest]);
                if cost < link.0 {
                    *link = (cost, newest);
                }
                if link.0 < cheapest.0 {
                    cheapest = (link.0, place);
                }
            }
            newest = self.outside.swap_remove(cheapest.1);
            total += cheapest.0;
            self.add(newest, self.links[newest].1);
        }
        total
    }

    /// Adds the two cheapest edges of the last node; their cost.
    fn last_two_edges(&mut self, costs: &Costs, fees: &[f64]) -> f64 {
        let last = costs.len() - 1;
        let row = costs.of(last);
        let (mut first, mut second) = ((f64::INFINITY, 0), (f64::INFINITY, 0));
        for node in 0..last {
            let cost = row[node] + (fees[node] + fees[last]);
            if cost < first.0 {
                (first, second) = ((cost, node), first);
            } else if cost < second.0 {
                second = (cost, node);
            }
        }
        self.add(last, first.1);
        self.add(last, second.1);
        first.0 + second.0
    }

    fn add(&mut self, i: usize, j: usize) {
        self.degrees[i] += 1;
        self.degrees[j] += 1;
    }
}
