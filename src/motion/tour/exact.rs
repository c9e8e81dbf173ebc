//! Dynamic programming over sets of stops (Bellman 1962; Held and Karp 1962).

use super::circuit::Circuit;

/// The closed tour of least cost, for n stops in the time n² 2ⁿ and the memory n 2ⁿ.
pub(super) fn shortest(circuit: &Circuit) -> Vec<usize> {
    let (n, costs, start, end) = (circuit.stops, &circuit.costs, circuit.start(), circuit.end());
    let all = (1 << n) - 1;
    // For each set, n costs: the least from the start through all of the set to its member j, the last of them.
    let mut ways = vec![f64::INFINITY; n << n];
    for set in 1..=all {
        for j in members(set) {
            let before = set & !(1 << j);
            ways[set * n + j] = match before {
                0 => costs.between(start, j),
                _ => last_before(&ways[before * n..], before, costs.of(j)).1,
            };
        }
    }
    // Back from the end, each time by what was least on the way.
    let mut cycle = vec![end];
    let (mut set, mut next) = (all, end);
    while set != 0 {
        next = last_before(&ways[set * n..], set, costs.of(next)).0;
        cycle.push(next);
        set &= !(1 << next);
    }
    if start != end {
        cycle.push(start);
    }
    cycle
}

/// Which member i of a set comes last before some node, and the least cost up to that node: `ways[i] + costs[i]`, the way
/// through the set to i and the move from there.
fn last_before(ways: &[f64], set: usize, costs: &[f64]) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for i in members(set) {
        let cost = ways[i] + costs[i];
        if cost < best.1 {
            best = (i, cost);
        }
    }
    best
}

/// The members of a set, a bit each, in ascending order.
fn members(mut set: usize) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let first = set.trailing_zeros() as usize;
        (set != 0).then(|| {
            set &= set - 1;
            first
        })
    })
}
