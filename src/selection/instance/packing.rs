//! How many candidates the constraints allow together. That picks made one by one come to a dead end proves nothing: this is
//! a search.
//!
//! Candidates that are too close to each other conflict; sets without conflicts are the cliques of the complementary graph,
//! and the search is that for a maximum clique (San Segundo et al., *An exact bit-parallel algorithm for the maximum clique
//! problem*, 2011): depth first, with the bound that of each group of mutually conflicting candidates a set holds at most one.
//! Groups with caps are held by counting, and bound what lies in them.

use super::Instance;
use super::constraints::Rules;

/// Most candidates searched; of more, so many evenly spaced ones.
const MOST: usize = 4096;

/// What a search found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Packing {
    /// The largest allowed set found that holds those included, ascending; no larger than the instance's count.
    pub(crate) selected: Vec<usize>,
    /// No allowed set that holds those included is larger; says nothing once as many as wanted were found.
    pub(crate) at_most: usize,
}

/// Effort of a search that nothing else depends on, in words of 64 candidates: about a second.
pub(crate) const EFFORT: usize = 1 << 30;

/// Searches for an allowed set of `instance.count()` candidates that holds `included`, and for the largest if there is none;
/// gives up after `effort`.
pub(crate) fn packing(instance: &Instance, included: &[usize], effort: usize) -> Packing {
    let rules = instance.rules();
    let open = |&i: &usize| instance.is_open(i) && !included.contains(&i) && rules.allows(included, None, i);
    let all: Vec<usize> = (0..instance.len()).filter(open).collect();
    let searched = if all.len() > MOST { (0..MOST).map(|c| all[c * all.len() / MOST]).collect() } else { all.clone() };
    let graph = Graph::new(rules, searched);
    let room: Vec<usize> = rules.caps.iter().map(|cap| cap.most - cap.count(included)).collect();
    let wanted = instance.count() - included.len();
    let open = Bits::full(graph.members.len());
    let bound = graph.cover(&open, &room).last().map_or(0, |&(_, bound)| bound);
    let best = graph.least_conflicts(open.clone(), &room, wanted);
    let mut search = DepthFirst { graph: &graph, wanted, effort, best, current: vec![] };
    search.expand(open, &room);
    let (best, is_complete) = (search.best, search.effort > 0);
    let at_most = match (all.len() > MOST, is_complete) {
        (true, _) => all.len(),
        (false, true) => best.len(),
        (false, false) => bound,
    };
    let mut selected: Vec<usize> = best.into_iter().map(|c| graph.members[c]).chain(included.iter().copied()).collect();
    selected.sort_unstable();
    Packing { selected, at_most: included.len() + at_most }
}

/// A set of small numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Bits(Vec<u64>);

impl Bits {
    fn new(len: usize, contains: impl Fn(usize) -> bool) -> Self {
        let mut bits = Self(vec![0; len.div_ceil(64)]);
        for i in (0..len).filter(|&i| contains(i)) {
            bits.0[i / 64] |= 1 << (i % 64);
        }
        bits
    }

    fn full(len: usize) -> Self {
        Self::new(len, |_| true)
    }

    fn contains(&self, i: usize) -> bool {
        self.0[i / 64] >> (i % 64) & 1 == 1
    }

    fn remove(&mut self, i: usize) {
        self.0[i / 64] &= !(1 << (i % 64));
    }

    fn first(&self) -> Option<usize> {
        let word = self.0.iter().position(|&word| word != 0)?;
        Some(64 * word + self.0[word].trailing_zeros() as usize)
    }

    fn iter(&self) -> impl Iterator<Item = usize> {
        (0..64 * self.0.len()).filter(|&i| self.contains(i))
    }

    fn keep(&mut self, other: &Self) {
        for (word, other) in self.0.iter_mut().zip(&other.0) {
            *word &= other;
        }
    }

    fn remove_all(&mut self, other: &Self) {
        for (word, other) in self.0.iter_mut().zip(&other.0) {
            *word &= !other;
        }
    }

    fn shared(&self, other: &Self) -> u32 {
        self.0.iter().zip(&other.0).map(|(a, b)| (a & b).count_ones()).sum()
    }
}

/// Which candidates are too close to each other, and the groups with caps.
struct Graph {
    /// The candidates, those of few conflicts first.
    members: Vec<usize>,
    conflicts: Vec<Bits>,
    groups: Vec<Bits>,
}

impl Graph {
    fn new(rules: &Rules, mut members: Vec<usize>) -> Self {
        let n = members.len();
        let degrees: Vec<usize> =
            members.iter().map(|&i| members.iter().filter(|&&j| rules.conflict(i, j)).count()).collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_key(|&c| degrees[c]);
        members = order.into_iter().map(|c| members[c]).collect();
        let conflicts = |a: usize| Bits::new(n, |b| a != b && rules.conflict(members[a], members[b]));
        let conflicts = (0..n).map(conflicts).collect();
        let group = |g: usize| Bits::new(n, |c| rules.caps_of(members[c]).any(|cap| cap == g));
        let groups = (0..rules.caps.len()).map(group).collect();
        Self { members, conflicts, groups }
    }

    /// Takes `c` out of `open` with all that may not stand beside it; `room` is what the groups have left.
    fn place(&self, c: usize, open: &mut Bits, room: &mut [usize]) {
        open.remove(c);
        open.remove_all(&self.conflicts[c]);
        for (group, room) in self.groups.iter().zip(room) {
            if group.contains(c) {
                *room -= 1;
                if *room == 0 {
                    open.remove_all(group);
                }
            }
        }
    }

    /// Picks one by one, each that conflicts with the fewest others.
    fn least_conflicts(&self, mut open: Bits, room: &[usize], wanted: usize) -> Vec<usize> {
        let mut room = room.to_vec();
        let mut picked = vec![];
        while picked.len() < wanted
            && let Some(c) = open.iter().min_by_key(|&c| self.conflicts[c].shared(&open))
        {
            picked.push(c);
            self.place(c, &mut open, &mut room);
        }
        picked
    }

    /// The open candidates in an order in which each has beside it how many of it and those before it a set can hold at
    /// most: group by group what it has room for, at most one of every clique of conflicts.
    fn cover(&self, open: &Bits, room: &[usize]) -> Vec<(usize, usize)> {
        let mut order = vec![];
        let mut rest = open.clone();
        let mut bound = 0;
        for (group, room) in
            self.groups.iter().zip(room.iter().copied()).map(|(g, r)| (Some(g), r)).chain([(None, usize::MAX)])
        {
            let mut part = rest.clone();
            if let Some(group) = group {
                part.keep(group);
                rest.remove_all(group);
            }
            let mut cliques = 0;
            while let Some(first) = part.first() {
                cliques += 1;
                let mut clique = part.clone();
                let mut next = Some(first);
                while let Some(c) = next {
                    order.push((c, bound + room.min(cliques)));
                    part.remove(c);
                    clique.keep(&self.conflicts[c]);
                    next = clique.first();
                }
            }
            bound += room.min(cliques);
        }
        order
    }
}

struct DepthFirst<'a> {
    graph: &'a Graph,
    wanted: usize,
    /// What is left of it.
    effort: usize,
    best: Vec<usize>,
    current: Vec<usize>,
}

impl DepthFirst<'_> {
    fn is_over(&self) -> bool {
        self.best.len() >= self.wanted || self.effort == 0
    }

    fn expand(&mut self, mut open: Bits, room: &[usize]) {
        if self.current.len() > self.best.len() {
            self.best.clone_from(&self.current);
        }
        let cover = self.graph.cover(&open, room);
        self.effort = self.effort.saturating_sub(1 + cover.len() * open.0.len());
        for (c, bound) in cover.into_iter().rev() {
            if self.is_over() || self.current.len() + bound <= self.best.len() {
                return;
            }
            let (mut beside, mut left) = (open.clone(), room.to_vec());
            self.graph.place(c, &mut beside, &mut left);
            self.current.push(c);
            self.expand(beside, &left);
            self.current.pop();
            open.remove(c);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    use super::*;
    use crate::selection::{Cap, Constraints, InformationFunction, InformationSet, Separation, Term};

    /// Of more candidates than are searched nothing is proven: those left out may stand apart.
    #[test]
    fn a_sample_bounds_nothing() {
        let n = MOST + MOST / 512;
        let points: Vec<Vec<f64>> = (0..n).map(|i| vec![if i % 513 == 512 { i as f64 } else { 0.0 }]).collect();
        let one = DMatrix::identity(1, 1);
        let candidates = InformationSet::from_matrices(1, vec![&one; n]).unwrap();
        let function = InformationFunction::Determinant;
        let term = Term { candidates: &candidates, prior: None, function: &function, share: 1.0 };
        let constraints = Constraints { separations: vec![Separation::of(&points, 1.0)], ..Default::default() };
        let found = packing(&Instance::constrained(&[term], n, constraints).unwrap(), &[], EFFORT);
        assert!(found.selected.len() <= 9 && found.at_most >= 9, "{found:?}");
    }

    proptest! {
        /// Against every subset; and stopped at once, it has a set that is allowed and a bound that holds.
        #[test]
        fn the_largest_allowed_set_is_found(
            points in prop::collection::vec(prop::collection::vec(0.0..1.0f64, 2), 1..11),
            least in 0.1..0.9f64,
            split in (0usize..11, 0usize..11, 1usize..3),
            first in any::<bool>(),
        ) {
            let n = points.len();
            let one = DMatrix::identity(1, 1);
            let candidates = InformationSet::from_matrices(1, vec![&one; n]).unwrap();
            let function = InformationFunction::Determinant;
            let (a, b, most) = split;
            let caps = vec![
                Cap { members: (0..a.min(n)).collect(), most },
                Cap { members: (b.min(n)..n).collect(), most: 2 },
            ];
            let constraints = Constraints { caps, separations: vec![Separation::of(&points, least)], ..Default::default() };
            let term = Term { candidates: &candidates, prior: None, function: &function, share: 1.0 };
            let instance = Instance::constrained(&[term], n, constraints).unwrap();
            let included: Vec<usize> = first.then_some(0).into_iter().collect();
            let allowed = |set: &[usize]| (0..set.len()).all(|c| instance.rules().allows(&set[..c], None, set[c]));
            let sets = (0u32..1 << n).map(|set| (0..n).filter(|i| set >> i & 1 == 1).collect::<Vec<_>>());
            let holding = sets.filter(|set| included.iter().all(|i| set.contains(i)));
            let largest = holding.filter(|set| allowed(set)).map(|set| set.len()).max().unwrap();

            let found = packing(&instance, &included, EFFORT);
            prop_assert!(allowed(&found.selected) && included.iter().all(|i| found.selected.contains(i)));
            prop_assert_eq!((found.selected.len(), found.at_most), (largest, largest));
            let hasty = packing(&instance, &included, 0);
            prop_assert!(allowed(&hasty.selected) && hasty.selected.len() <= largest && largest <= hasty.at_most);
            // As many as fit are found when as many are wanted.
            let wanted = packing(&instance.with_count(largest).unwrap(), &included, EFFORT);
            prop_assert_eq!(wanted.selected.len(), largest);
        }
    }
}
