//! Which selections are allowed.

use crate::selection::error::SelectionError;

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
    /// One point per candidate, all of one dimension; distances are Euclidean.
    pub points: Vec<Vec<f64>>,
    /// The least distance.
    pub least: f64,
}

impl Separation {
    fn conflict(&self, i: usize, j: usize) -> bool {
        self.distance(i, j) < self.least
    }

    fn distance(&self, i: usize, j: usize) -> f64 {
        self.points[i].iter().zip(&self.points[j]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    /// Cells of a grid so fine that any two points of one cell conflict: groups of which a selection holds at most one.
    /// They say less than the separation, but linearly, so that the relaxation can hold them.
    fn cells(&self) -> Vec<Cap> {
        let dimension = self.points.first().map_or(0, Vec::len).max(1);
        // A little finer than exact, so that rounding never joins two points that do not conflict.
        let side = self.least / (dimension as f64).sqrt() * (1.0 - 1e-9);
        let mut keyed: Vec<(Vec<i64>, usize)> = self
            .points
            .iter()
            .enumerate()
            .map(|(i, point)| (point.iter().map(|x| (x / side).floor() as i64).collect(), i))
            .collect();
        keyed.sort_unstable();
        keyed
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|cell| cell.len() > 1)
            .map(|cell| Cap { members: cell.iter().map(|&(_, i)| i).collect(), most: 1 })
            .collect()
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
    /// Numbers of the caps that each candidate counts in; empty if there are none.
    caps_of: Vec<Vec<usize>>,
    separations: Vec<Separation>,
}

impl Rules {
    /// Checks constraints on selections of `count` of `candidates`.
    pub(crate) fn new(constraints: Constraints, candidates: usize, count: usize) -> Result<Self, SelectionError> {
        let Constraints { mut required, forbidden, mut caps, separations } = constraints;
        let named = required.iter().chain(&forbidden).chain(caps.iter().flat_map(|cap| &cap.members));
        if let Some(&candidate) = named.into_iter().find(|&&i| i >= candidates) {
            return Err(SelectionError::NoSuchCandidate { candidate, candidates });
        }
        for separation in &separations {
            let dimension = separation.points.first().map_or(0, Vec::len);
            let sound = |point: &Vec<f64>| point.len() == dimension && point.iter().all(|x| x.is_finite());
            if separation.points.len() != candidates
                || !separation.points.iter().all(sound)
                || !(separation.least.is_finite() && separation.least >= 0.0)
            {
                return Err(SelectionError::Separation { points: separation.points.len(), candidates });
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
        caps.extend(separations.iter().flat_map(Separation::cells));
        let mut open = vec![];
        if !(required.is_empty() && forbidden.is_empty()) {
            open = vec![true; candidates];
            for &i in required.iter().chain(&forbidden) {
                open[i] = false;
            }
        }
        let mut caps_of = vec![];
        if !caps.is_empty() {
            caps_of = vec![vec![]; candidates];
            for (c, cap) in caps.iter().enumerate() {
                for &i in &cap.members {
                    caps_of[i].push(c);
                }
            }
        }
        let rules = Self { required, open, caps, given, caps_of, separations };
        let available = rules.required.len() + (0..candidates).filter(|&i| rules.is_open(i)).count();
        if count > available || count < rules.required.len() {
            return Err(SelectionError::Allowed { count, required: rules.required.len(), available });
        }
        Ok(rules)
    }

    /// The same rules for `members`, ascending, the required ones among them, numbered by their places.
    pub(crate) fn of_part(&self, members: &[usize]) -> Self {
        let place = |i: &usize| members.binary_search(i).ok();
        let places = |candidates: &[usize]| candidates.iter().filter_map(place).collect();
        let of_members = |separation: &Separation| Separation {
            points: members.iter().map(|&i| separation.points[i].clone()).collect(),
            least: separation.least,
        };
        let (open, caps_of) = (&self.open, &self.caps_of);
        Self {
            required: places(&self.required),
            open: if open.is_empty() { vec![] } else { members.iter().map(|&i| open[i]).collect() },
            caps: self.caps.iter().map(|cap| Cap { members: places(&cap.members), most: cap.most }).collect(),
            given: self.given,
            caps_of: if caps_of.is_empty() { vec![] } else { members.iter().map(|&i| caps_of[i].clone()).collect() },
            separations: self.separations.iter().map(of_members).collect(),
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
    pub(crate) fn caps_of(&self, i: usize) -> &[usize] {
        if self.caps_of.is_empty() { &[] } else { &self.caps_of[i] }
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
        let fits = |&c: &usize| others().filter(|&&j| self.caps_of(j).contains(&c)).count() < self.caps[c].most;
        self.caps_of(i).iter().all(fits) && others().all(|&j| !self.conflict(i, j))
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
        let mut open: Vec<usize> = (0..scores.len()).filter(|&i| self.is_open(i)).collect();
        if free < open.len() {
            open.select_nth_unstable_by(free, |&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
            open.truncate(free);
        }
        let least = open.iter().map(|&i| scores[i]).fold(f64::INFINITY, f64::min);
        open.extend(&self.required);
        open.sort_unstable();
        (open, least)
    }
}
