//! Which selections are allowed.

use std::borrow::Cow;
use std::sync::Arc;

use rayon::prelude::*;

use crate::selection::error::SelectionError;
use crate::selection::group::Group;
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
        distance(self.point(i), self.point(j))
    }

    /// The ball midway between two candidates.
    fn ball(&self, [a, b]: [usize; 2]) -> Ball {
        let centre = self.point(a).iter().zip(self.point(b)).map(|(a, b)| 0.5 * (a + b)).collect();
        Ball { centre, radius: Group::RADIUS * self.least }
    }

    /// The separation of some candidates alone.
    fn of_part(&self, members: &[usize]) -> Self {
        let points: Vec<f64> = members.iter().flat_map(|&i| self.point(i)).copied().collect();
        Self { points: points.into(), dimension: self.dimension, least: self.least }
    }
}

/// Points nearer than a radius to a centre.
struct Ball {
    centre: Vec<f64>,
    radius: f64,
}

impl Ball {
    fn contains(&self, point: &[f64]) -> bool {
        let first = self.centre.first().zip(point.first());
        // Most are far away in the first coordinate already.
        first.is_none_or(|(a, b)| (a - b).abs() < self.radius) && distance(&self.centre, point) < self.radius
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

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
    /// Number of candidates; 0 where anything is allowed of any number.
    candidates: usize,
    /// Candidates that are always in, ascending.
    pub(crate) required: Vec<usize>,
    /// Whether a candidate may be chosen; not if it is required or forbidden. Empty if all may.
    open: Vec<bool>,
    /// The caps given.
    pub(crate) caps: Vec<Cap>,
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
        let mut open = vec![];
        if !(required.is_empty() && forbidden.is_empty()) {
            open = vec![true; candidates];
            for &i in required.iter().chain(&forbidden) {
                open[i] = false;
            }
        }
        let caps_of = Lists::of_caps(&caps, candidates);
        Ok(Self { candidates, required, open, caps, caps_of, separations })
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
            candidates: members.len(),
            required: self.required.iter().filter_map(|i| members.binary_search(i).ok()).collect(),
            open: if open.is_empty() { vec![] } else { members.iter().map(|&i| open[i]).collect() },
            caps_of: Lists::of_caps(&caps, members.len()),
            caps,
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

    /// Whether there is such a group.
    pub(crate) fn has(&self, group: Group) -> bool {
        match group {
            Group::Cap(c) => c < self.caps.len(),
            Group::Ball { separation, between } => {
                separation < self.separations.len() && between.iter().all(|&i| i < self.candidates)
            }
        }
    }

    /// Those of some candidates that count in a group.
    pub(crate) fn counted(&self, candidates: &[usize], group: Group) -> Vec<usize> {
        match group {
            Group::Cap(c) => candidates.iter().copied().filter(|&i| self.caps_of(i).any(|cap| cap == c)).collect(),
            Group::Ball { separation, between } => {
                let separation = &self.separations[separation];
                let ball = separation.ball(between);
                candidates.iter().copied().filter(|&i| ball.contains(separation.point(i))).collect()
            }
        }
    }

    /// The candidates that count in a group, ascending.
    pub(crate) fn members(&self, group: Group) -> Cow<'_, [usize]> {
        match group {
            Group::Cap(c) => Cow::Borrowed(&self.caps[c].members),
            Group::Ball { separation, between } => {
                let separation = &self.separations[separation];
                let ball = separation.ball(between);
                let all = (0..self.candidates).into_par_iter().with_min_len(4096);
                Cow::Owned(all.filter(|&i| ball.contains(separation.point(i))).collect())
            }
        }
    }

    /// How many of a group a selection may hold.
    pub(crate) fn most(&self, group: Group) -> usize {
        match group {
            Group::Cap(c) => self.caps[c].most,
            Group::Ball { .. } => 1,
        }
    }

    /// Balls of which weights hold more than one by more than `excess`, the fullest first, and of those that hold all the same weights the
    /// first alone.
    pub(crate) fn overfull(&self, weights: &[(usize, f64)], excess: f64) -> Vec<Group> {
        let mut balls = vec![];
        for (number, separation) in self.separations.iter().enumerate() {
            let pairs =
                weights.iter().enumerate().flat_map(|(c, &(i, _))| weights[c..].iter().map(move |&(j, _)| [i, j]));
            let held = |between: [usize; 2]| {
                let ball = separation.ball(between);
                let inside = weights.iter().filter(|&&(i, _)| ball.contains(separation.point(i)));
                let (inside, weights): (Vec<usize>, Vec<f64>) = inside.copied().unzip();
                (weights.iter().sum::<f64>(), inside, between)
            };
            let held = pairs.filter(|&[i, j]| i == j || separation.conflict(i, j)).map(held);
            let mut overfull: Vec<_> = held.filter(|&(sum, ..)| sum > 1.0 + excess).collect();
            overfull.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)));
            let mut seen: Vec<Vec<usize>> = vec![];
            for (_, inside, between) in overfull {
                if !seen.iter().any(|other| inside.iter().all(|i| other.contains(i))) {
                    seen.push(inside);
                    balls.push(Group::Ball { separation: number, between });
                }
            }
        }
        balls
    }

    /// Numbers of the caps that candidate `i` counts in.
    pub(crate) fn caps_of(&self, i: usize) -> impl Iterator<Item = usize> {
        self.caps_of.get(i).iter().map(|&c| c as usize)
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

    /// Scores less the prices of the groups that each candidate counts in.
    pub(crate) fn reduced(&self, scores: &[f64], prices: &[(Group, f64)]) -> Vec<f64> {
        let mut reduced = scores.to_vec();
        for &(group, price) in prices {
            for &i in self.members(group).iter() {
                reduced[i] -= price;
            }
        }
        reduced
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
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A ball holds what is near its middle, of which any two conflict; what weights overfill are such balls.
        #[test]
        fn selections_hold_one_of_a_ball_at_most(
            points in prop::collection::vec(prop::array::uniform2(-1.0..1.0f64), 1..60),
            least in 0.05..0.6f64,
        ) {
            let n = points.len();
            let constraints = Constraints { separations: vec![Separation::of(&points, least)], ..Constraints::default() };
            let rules = Rules::new(constraints, n).unwrap();
            let middle = |a: usize, b: usize| [0, 1].map(|axis| 0.5 * (points[a][axis] + points[b][axis]));
            let distance = |i: usize, c: [f64; 2]| (points[i][0] - c[0]).hypot(points[i][1] - c[1]);
            let all: Vec<usize> = (0..n).collect();
            let weights: Vec<(usize, f64)> = all.iter().map(|&i| (i, 0.4)).collect();
            let overfull = rules.overfull(&weights, 1e-3);
            for (a, b) in (0..n).flat_map(|a| (a..n).map(move |b| (a, b))) {
                let ball = Group::Ball { separation: 0, between: [a, b] };
                let members = rules.members(ball);
                prop_assert_eq!(&rules.counted(&all, ball), &*members);
                for i in 0..n {
                    let distance = distance(i, middle(a, b));
                    prop_assert!(members.contains(&i) && distance < 0.5 * least || distance > 0.499_999 * least);
                }
                for (c, &i) in members.iter().enumerate() {
                    prop_assert!(members[..c].iter().all(|&j| rules.conflict(i, j)));
                }
                // Three weights are more than one, and are held against the same or a fuller ball.
                let counts = |other: &Group| members.iter().all(|i| rules.members(*other).contains(i));
                if members.len() > 2 && (a == b || rules.conflict(a, b)) {
                    prop_assert!(overfull.iter().any(counts));
                }
            }
            prop_assert!(overfull.iter().all(|&ball| rules.members(ball).len() > 2));
        }
    }
}
