//! Which selections are allowed.

use std::sync::Arc;

use rayon::prelude::*;

use crate::selection::error::SelectionError;
use crate::selection::highest::highest;

/// What a selection must satisfy besides its size. The default allows everything.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Constraints {
    /// Candidates that every selection holds.
    pub required: Vec<usize>,
    /// Candidates that no selection holds.
    pub forbidden: Vec<usize>,
    /// Groups of candidates of which a selection holds only so many; they may overlap.
    pub caps: Vec<Cap>,
    /// Distances that the selected keep from each other.
    pub separations: Vec<Separation>,
}

/// At most `most` of `members`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cap {
    /// The candidates that count.
    pub members: Vec<usize>,
    /// How many of them a selection may hold.
    pub most: usize,
}

impl Cap {
    /// How many of `selected` count.
    pub(crate) fn count(&self, selected: &[usize]) -> usize {
        selected.iter().filter(|i| self.members.binary_search(i).is_ok()).count()
    }
}

/// Selected candidates are at least `least` apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Separation {
    /// One point per candidate, all of one dimension, one after the other; distances are Euclidean.
    pub points: Arc<Vec<f64>>,
    /// Coordinates of a point.
    pub dimension: usize,
    /// The least distance.
    pub least: f64,
}

impl Separation {
    /// Of points that are all of one dimension.
    pub fn of<P: AsRef<[f64]>>(points: &[P], least: f64) -> Self {
        let dimension = points.first().map_or(0, |point| point.as_ref().len());
        let points: Vec<f64> = points.iter().flat_map(AsRef::as_ref).copied().collect();
        Self { points: points.into(), dimension, least }
    }

    fn point(&self, i: usize) -> &[f64] {
        &self.points[i * self.dimension..(i + 1) * self.dimension]
    }

    fn conflict(&self, i: usize, j: usize) -> bool {
        let (a, b) = (self.point(i), self.point(j));
        // Most are far apart in the first coordinate already.
        a.first().zip(b.first()).is_none_or(|(a, b)| (a - b).abs() < self.least) && self.distance(i, j) < self.least
    }

    fn distance(&self, i: usize, j: usize) -> f64 {
        self.point(i).iter().zip(self.point(j)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    /// Cells of a grid so fine that any two points of one cell conflict: groups of which a selection holds at most one.
    /// They say less than the separation, but linearly, so that the relaxation can hold them.
    fn cells(&self, candidates: usize) -> Vec<Cap> {
        // A little finer than exact, so that rounding never joins two points that do not conflict.
        let side = self.least / (self.dimension as f64).sqrt() * (1.0 - 1e-9);
        let places = |i: usize| self.point(i).iter().map(|x| (x / side).floor() as i64);
        // Most points have a cell to themselves, which a hash of its place tells.
        let hash = |i: usize| places(i).fold(0, |hash: u64, x| (hash.rotate_left(5) ^ x as u64).wrapping_mul(HASH));
        let mut hashed: Vec<(u64, usize)> = (0..candidates).into_par_iter().map(|i| (hash(i), i)).collect();
        hashed.par_sort_unstable();
        let alike: Vec<&[(u64, usize)]> = hashed.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1).collect();
        let of_alike = |alike: &[(u64, usize)]| -> Vec<(Vec<i64>, Vec<usize>)> {
            let mut cells: Vec<(Vec<i64>, Vec<usize>)> = vec![];
            for &(_, i) in alike {
                match cells.iter_mut().find(|(cell, _)| places(i).eq(cell.iter().copied())) {
                    Some((_, members)) => members.push(i),
                    None => cells.push((places(i).collect(), vec![i])),
                }
            }
            cells
        };
        let mut cells: Vec<_> = alike.into_par_iter().flat_map_iter(of_alike).collect();
        cells.retain(|(_, members)| members.len() > 1);
        cells.par_sort_unstable();
        cells.into_iter().map(|(_, members)| Cap { members, most: 1 }).collect()
    }

    /// The separation of some candidates alone.
    fn of_part(&self, members: &[usize]) -> Self {
        let points: Vec<f64> = members.iter().flat_map(|&i| self.point(i)).copied().collect();
        Self { points: points.into(), dimension: self.dimension, least: self.least }
    }
}

/// Multiplier of a hash: an odd number whose bits are spread, from the golden ratio.
const HASH: u64 = 0x9e37_79b9_7f4a_7c15;

/// Lists of numbers, one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
struct Lists {
    numbers: Vec<u32>,
    /// Where each list ends; empty if all are.
    ends: Vec<u32>,
}

impl Lists {
    fn get(&self, i: usize) -> &[u32] {
        let Some(&end) = self.ends.get(i) else { return &[] };
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.numbers[start as usize..end as usize]
    }

    /// Of each candidate the numbers of the caps that it counts in.
    fn of_caps(caps: &[Cap], candidates: usize) -> Self {
        if caps.is_empty() {
            return Self::default();
        }
        let mut ends = vec![0; candidates];
        for &i in caps.iter().flat_map(|cap| &cap.members) {
            ends[i] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        // From where each list starts to where it ends.
        let mut numbers = vec![0; sum as usize];
        for (c, cap) in (0..).zip(caps) {
            for &i in &cap.members {
                numbers[ends[i] as usize] = c;
                ends[i] += 1;
            }
        }
        Self { numbers, ends }
    }
}

/// Checked constraints, in the form in which algorithms ask for them.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Rules {
    /// Candidates that are always in, ascending.
    pub(crate) required: Vec<usize>,
    /// Whether a candidate may be chosen; not if it is required or forbidden. Empty if all may.
    open: Vec<bool>,
    /// The caps given, then the cells of the separations.
    pub(crate) caps: Vec<Cap>,
    /// Number of caps given.
    given: usize,
    /// Numbers of the caps that each candidate counts in.
    caps_of: Lists,
    separations: Vec<Separation>,
}

impl Rules {
    /// Checks constraints on selections of so many candidates.
    pub(crate) fn new(constraints: Constraints, candidates: usize) -> Result<Self, SelectionError> {
        let Constraints { mut required, forbidden, mut caps, separations } = constraints;
        let named = required.iter().chain(&forbidden).chain(caps.iter().flat_map(|cap| &cap.members));
        if let Some(&candidate) = named.into_iter().find(|&&i| i >= candidates) {
            return Err(SelectionError::NoSuchCandidate { candidate, candidates });
        }
        for separation in &separations {
            let Separation { points, dimension, least } = separation;
            let are_of_all = points.len() == candidates * dimension && points.iter().all(|x| x.is_finite());
            if !(are_of_all && least.is_finite() && *least >= 0.0) {
                return Err(SelectionError::Separation {
                    coordinates: points.len(),
                    dimension: *dimension,
                    candidates,
                });
            }
        }
        required.sort_unstable();
        required.dedup();
        if let Some(&candidate) = required.iter().find(|i| forbidden.contains(i)) {
            return Err(SelectionError::RequiredAndForbidden { candidate });
        }
        for cap in &mut caps {
            cap.members.sort_unstable();
            cap.members.dedup();
        }
        if let Some((group, cap, among)) = caps.iter().enumerate().find_map(|(group, cap)| {
            let among = cap.count(&required);
            (among > cap.most).then_some((group, cap, among))
        }) {
            return Err(SelectionError::RequiredAboveCap { group, required: among, most: cap.most });
        }
        for (a, &i) in required.iter().enumerate() {
            for &j in &required[a + 1..] {
                if let Some(separation) = separations.iter().find(|separation| separation.conflict(i, j)) {
                    let (distance, least) = (separation.distance(i, j), separation.least);
                    return Err(SelectionError::RequiredTooClose { first: i, second: j, distance, least });
                }
            }
        }
        let separations: Vec<_> = separations.into_iter().filter(|separation| separation.least > 0.0).collect();
        let given = caps.len();
        caps.extend(separations.iter().flat_map(|separation| separation.cells(candidates)));
        let mut open = vec![];
        if !(required.is_empty() && forbidden.is_empty()) {
            open = vec![true; candidates];
            for &i in required.iter().chain(&forbidden) {
                open[i] = false;
            }
        }
        let caps_of = Lists::of_caps(&caps, candidates);
        Ok(Self { required, open, caps, given, caps_of, separations })
    }

    /// Checks that `count` of so many candidates may be selected, caps and separations aside.
    pub(crate) fn check_count(&self, count: usize, candidates: usize) -> Result<(), SelectionError> {
        let required = self.required.len();
        let available = required + (0..candidates).filter(|&i| self.is_open(i)).count();
        if count == 0 || count < required || count > available {
            return Err(SelectionError::Allowed { count, required, available });
        }
        Ok(())
    }

    /// The same rules for `members`, ascending, the required ones among them, numbered by their places.
    pub(crate) fn of_part(&self, members: &[usize]) -> Self {
        let open = &self.open;
        let mut caps: Vec<Cap> = self.caps.iter().map(|cap| Cap { members: vec![], most: cap.most }).collect();
        for (place, &member) in members.iter().enumerate() {
            for c in self.caps_of(member) {
                caps[c].members.push(place);
            }
        }
        Self {
            required: self.required.iter().filter_map(|i| members.binary_search(i).ok()).collect(),
            open: if open.is_empty() { vec![] } else { members.iter().map(|&i| open[i]).collect() },
            caps_of: Lists::of_caps(&caps, members.len()),
            caps,
            given: self.given,
            separations: self.separations.iter().map(|separation| separation.of_part(members)).collect(),
        }
    }

    /// Whether a candidate may be chosen, for all that the others are.
    pub(crate) fn is_open(&self, i: usize) -> bool {
        self.open.is_empty() || self.open[i]
    }

    /// Whether every candidate is open.
    pub(crate) fn allows_all(&self) -> bool {
        self.open.is_empty()
    }

    /// Whether any set of open candidates is allowed.
    pub(crate) fn is_free(&self) -> bool {
        self.caps.is_empty() && self.separations.is_empty()
    }

    /// Numbers of the caps that candidate `i` counts in.
    pub(crate) fn caps_of(&self, i: usize) -> impl Iterator<Item = usize> {
        self.caps_of.get(i).iter().map(|&c| c as usize)
    }

    /// The caps given.
    pub(crate) fn groups(&self) -> &[Cap] {
        &self.caps[..self.given]
    }

    /// Whether two candidates are too close to each other.
    pub(crate) fn conflict(&self, i: usize, j: usize) -> bool {
        self.separations.iter().any(|separation| separation.conflict(i, j))
    }

    /// Whether open candidate `i` may join `selected`, once `leaving` has left.
    pub(crate) fn allows(&self, selected: &[usize], leaving: Option<usize>, i: usize) -> bool {
        let others = || selected.iter().filter(|&&j| Some(j) != leaving);
        let counts = |j: usize, c: usize| self.caps_of.get(j).iter().any(|&of_j| of_j as usize == c);
        let fits = |c: usize| others().filter(|&&j| counts(j, c)).count() < self.caps[c].most;
        self.caps_of(i).all(fits) && others().all(|&j| !self.conflict(i, j))
    }

    /// Scores less the prices of the caps that each candidate counts in.
    pub(crate) fn reduced(&self, scores: &[f64], prices: &[(usize, f64)]) -> Vec<f64> {
        let mut reduced = scores.to_vec();
        self.reduce(&mut reduced, prices);
        reduced
    }

    /// As [`Rules::reduced`], in place.
    pub(crate) fn reduce(&self, scores: &mut [f64], prices: &[(usize, f64)]) {
        for &(c, price) in prices {
            for &i in &self.caps[c].members {
                scores[i] -= price;
            }
        }
    }

    /// The `count` candidates of greatest score that hold the required ones, caps aside, and the least score among those
    /// chosen freely (∞ if there are none).
    pub(crate) fn greatest(&self, scores: &[f64], count: usize) -> (Vec<usize>, f64) {
        let free = count - self.required.len();
        let mut open = highest(scores, (0..scores.len()).filter(|&i| self.is_open(i)), free);
        let least = open.iter().map(|&i| scores[i]).fold(f64::INFINITY, f64::min);
        open.extend(&self.required);
        open.sort_unstable();
        (open, least)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// In the order of their places, as those who check a certificate number them.
        #[test]
        fn cells_are_the_shared_ones_of_a_grid(
            points in prop::collection::vec(prop::array::uniform2(-1.0..1.0f64), 0..200),
            least in 0.05..0.6f64,
        ) {
            let separation = Separation::of(&points, least);
            let side = least / 2f64.sqrt() * (1.0 - 1e-9);
            let mut cells = BTreeMap::<[i64; 2], Vec<usize>>::new();
            for (i, point) in points.iter().enumerate() {
                cells.entry(point.map(|x| (x / side).floor() as i64)).or_default().push(i);
            }
            let shared = cells.into_values().filter(|members| members.len() > 1);
            let expected: Vec<Cap> = shared.map(|members| Cap { members, most: 1 }).collect();
            let found = separation.cells(points.len());
            for cell in &found {
                prop_assert!(cell.members.windows(2).all(|pair| separation.conflict(pair[0], pair[1])));
            }
            prop_assert_eq!(&found, &expected);
            let caps_of = Lists::of_caps(&found, points.len());
            for i in 0..points.len() {
                let counts = (0..).zip(&found).filter(|(_, cap)| cap.members.contains(&i)).map(|(c, _)| c);
                prop_assert_eq!(caps_of.get(i).to_vec(), counts.collect::<Vec<u32>>());
            }
        }
    }
}
