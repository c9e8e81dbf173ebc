//! Iterated local search (Martin, Otto and Felten 1991) by 2-opt with neighbour lists and a queue of nodes to look at (Bentley
//! 1992).

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::bound::Proof;
use super::costs::Costs;
use super::cycle::Cycle;

/// Nodes that each may newly be joined to: the nearest.
const NEIGHBOURS: usize = 10;

/// Kicks for each node of the tour.
const KICKS: usize = 400;

/// Most nodes in a part that a kick moves.
const LONGEST_PART: usize = 50;

/// By how much a tour that is looked on from may cost more than the best so far, in mean moves (Dueck 1993).
const LEEWAY: f64 = 0.1;

/// Least gain that counts as one, as a share of the greatest cost: rounding stays below.
const LEAST_GAIN: f64 = 1e-12;

/// Share of the cost that is not worth a search.
const TOLERANCE: f64 = 1e-9;

/// A closed tour of low cost, of five nodes or more. Local changes are chosen by the costs with the fees of the proof; where
/// these bring the cost down to the bound, the search ends.
pub(super) fn improved(costs: &Costs, proof: &Proof, seed: u64) -> Vec<usize> {
    let with_fees = proof.with_fees(costs);
    let mut search = Search::new(&with_fees, by_nearest_neighbour(&with_fees));
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    search.settle();
    let mut kept = search.cycle.order().to_vec();
    let mut best = kept.clone();
    let mut least_cost = costs.around(&best);
    let leeway = LEEWAY * least_cost / costs.len() as f64;
    // What the tour kept costs more than the best one.
    let mut excess = 0.0;
    for _ in 0..KICKS * costs.len() {
        if least_cost <= proof.bound * (1.0 + TOLERANCE) {
            break;
        }
        let changed = excess + search.kick(&mut rng) - search.settle();
        if changed > leeway {
            search.cycle.set_order(&kept);
            continue;
        }
        kept.copy_from_slice(search.cycle.order());
        excess = changed;
        if excess < -search.least_gain {
            best.copy_from_slice(&kept);
            least_cost = costs.around(&best);
            excess = 0.0;
        }
    }
    best
}

/// From the last node on to the nearest one left, again and again.
fn by_nearest_neighbour(costs: &Costs) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).rev().collect();
    for place in 1..order.len() {
        let row = costs.of(order[place - 1]);
        if let Some(nearest) = (place..order.len()).min_by(|&a, &b| row[order[a]].total_cmp(&row[order[b]])) {
            order.swap(place, nearest);
        }
    }
    order
}

struct Search<'a> {
    costs: &'a Costs,
    /// Each node's neighbours, the nearest first.
    neighbours: Vec<Vec<usize>>,
    cycle: Cycle,
    queue: Queue,
    least_gain: f64,
}

impl<'a> Search<'a> {
    fn new(costs: &'a Costs, order: Vec<usize>) -> Self {
        let n = costs.len();
        Self {
            costs,
            neighbours: (0..n).map(|i| nearest(costs, i)).collect(),
            cycle: Cycle::new(order),
            queue: Queue::full(n),
            least_gain: LEAST_GAIN * costs.greatest(),
        }
    }

    /// Improves the tour until no node in the queue can be joined to a nearer one at a gain; all that was gained.
    fn settle(&mut self) -> f64 {
        let mut gained = 0.0;
        while let Some(a) = self.queue.pop() {
            while let Some(gain) = self.join(a, Cycle::after).or_else(|| self.join(a, Cycle::before)) {
                gained += gain;
            }
        }
        gained
    }

    /// Joins node a to a nearer one, b, in place of the node next to a, and those next to a and b to each other. What that gains;
    /// `None` if no b gains.
    fn join(&mut self, a: usize, next: fn(&Cycle, usize) -> usize) -> Option<f64> {
        let c = next(&self.cycle, a);
        let before = self.costs.between(a, c);
        for &b in &self.neighbours[a] {
            let nearer = before - self.costs.between(a, b);
            if nearer <= self.least_gain {
                break;
            }
            let d = next(&self.cycle, b);
            let gain = nearer + self.costs.between(b, d) - self.costs.between(c, d);
            if gain > self.least_gain {
                self.cycle.cross([a, c], [b, d]);
                self.queue.extend([a, b, c, d]);
                return Some(gain);
            }
        }
        None
    }

    /// Swaps two random parts, one behind the other (a double bridge), which 2-opt neither finds nor undoes; what that costs.
    fn kick(&mut self, rng: &mut Xoshiro256PlusPlus) -> f64 {
        let order = self.cycle.order();
        let n = order.len();
        let longest = LONGEST_PART.min((n - 1) / 2);
        let lens = [rng.gen_range(1..=longest), rng.gen_range(1..=longest)];
        let first = rng.gen_range(1..=n - lens[0] - lens[1]);
        let cuts = [first, first + lens[0], first + lens[0] + lens[1]];
        // … p | q … r | s … t | u …
        let [[p, q], [r, s], [t, u]] = cuts.map(|cut| [order[cut - 1], order[cut % n]]);
        self.cycle.swap(cuts);
        self.queue.extend([p, q, r, s, t, u]);
        let cost = |edges: [[usize; 2]; 3]| edges.iter().map(|&[i, j]| self.costs.between(i, j)).sum::<f64>();
        cost([[p, s], [t, q], [r, u]]) - cost([[p, q], [r, s], [t, u]])
    }
}

/// The nodes nearest to one, the nearest first.
fn nearest(costs: &Costs, i: usize) -> Vec<usize> {
    let row = costs.of(i);
    let mut others: Vec<usize> = (0..row.len()).filter(|&j| j != i).collect();
    others.sort_by(|&a, &b| row[a].total_cmp(&row[b]));
    others.truncate(NEIGHBOURS);
    others
}

/// Nodes to look at, each once.
struct Queue {
    nodes: Vec<usize>,
    is_in: Vec<bool>,
}

impl Queue {
    /// All of n nodes.
    fn full(n: usize) -> Self {
        Self { nodes: (0..n).collect(), is_in: vec![true; n] }
    }

    fn extend<const N: usize>(&mut self, nodes: [usize; N]) {
        for node in nodes {
            if !std::mem::replace(&mut self.is_in[node], true) {
                self.nodes.push(node);
            }
        }
    }

    fn pop(&mut self) -> Option<usize> {
        let node = self.nodes.pop()?;
        self.is_in[node] = false;
        Some(node)
    }
}
