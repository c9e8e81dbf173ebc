//! Time that no tour takes less than.

use rayon::prelude::*;

use super::times::Times;
use crate::selection::{Certificate, Gradient, Instance, Part, RelaxationSettings, nonsingular_start, relax_until};

/// Most views of which all pairs are looked at.
const MOST_PAIRED: usize = 6000;

/// Gap at which a relaxation tells whether a part of the views suffices.
const TOLERANCE: f64 = 1e-3;

/// Views that are looked at first where there are more.
pub(super) const FIRST: usize = 3000;

/// A bound that could be higher by so small a share is not sharpened.
const PRECISION: f64 = 0.01;

/// Allowance in log Φ for the rounding of values.
const ROUNDING: f64 = 1e-9;

/// Sets of `instance.count()` of the views with log Φ of `floor` at least.
pub(super) struct Good<'a> {
    pub(super) instance: &'a Instance<'a>,
    pub(super) certificate: &'a Certificate,
    pub(super) floor: f64,
    /// Joint values of all views.
    pub(super) joints: &'a [&'a [f64]],
    pub(super) times: &'a Times<'a>,
    /// So many of the views are looked at first where there are more: [`FIRST`].
    pub(super) first: usize,
}

/// Least time of the move between two of `members` that may be chosen together, s; 0 where they are too many to tell.
pub(super) fn nearest(instance: &Instance, joints: &[&[f64]], times: &Times, members: &[usize]) -> f64 {
    if members.len() > MOST_PAIRED {
        return 0.0;
    }
    let of = |(place, &i): (usize, &usize)| {
        let mut least = f64::INFINITY;
        for &j in &members[place + 1..] {
            let time = times.between(joints[i], joints[j]);
            if time < least && !instance.rules().conflict(i, j) {
                least = time;
            }
        }
        least
    };
    let least = members.par_iter().enumerate().map(of).reduce(|| f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

impl Good<'_> {
    /// Time that the moves of no such set take less than, s.
    ///
    /// Of each joint, the views on one side of some value do not suffice, by the relaxation, so that every such set has a pose on the
    /// other side: its tour spans the joint from below the least of these values to above the greatest, by at least as many moves as
    /// lead from pose to pose, each of them no shorter than the nearest two views are apart.
    pub(super) fn least_moving(&self) -> f64 {
        let open: Vec<usize> =
            self.certificate.open_above(self.instance, self.floor - ROUNDING).into_iter().map(|(i, _)| i).collect();
        if open.is_empty() {
            return 0.0;
        }
        let nearest = nearest(self.instance, self.joints, self.times, &open);
        let k = self.instance.count();
        let across = |joint: usize, span: [f64; 2]| self.times.least_across(joint, span, k, nearest);
        let mut spans: Vec<Span> = (0..self.joints[0].len()).map(|joint| Span::new(self, &open, joint)).collect();
        let promises = |span: &Span| across(span.joint, span.widest());
        spans.sort_by(|a, b| promises(b).total_cmp(&promises(a)));
        let scores = Scores::new(self.instance, self.certificate);
        let mut least = 0.0_f64;
        for mut span in spans {
            while !span.is_known() && promises(&span) > (1.0 + PRECISION) * least.max(across(span.joint, span.proven()))
            {
                span.narrow(self, &open, &scores);
            }
            least = least.max(across(span.joint, span.proven()));
        }
        least
    }

    /// Whether no such set is among `members`.
    pub(super) fn falls_short(&self, members: &[usize], scores: &Scores) -> bool {
        let holds_required = self.instance.required().iter().all(|i| members.binary_search(i).is_ok());
        if !holds_required || members.len() < self.instance.count() {
            return true;
        }
        let floor = self.floor - ROUNDING;
        if scores.log_bound(self.instance, members) < floor {
            return true;
        }
        // Where the best of many suffice, the others need not be looked at.
        let mut some = members.to_vec();
        if members.len() > self.first {
            some.select_nth_unstable_by(self.first, |&a, &b| scores.reduced[b].total_cmp(&scores.reduced[a]));
            some.truncate(self.first);
        }
        let Some(found) = self.relaxed(&some, None, floor) else { return false };
        if found.log_value >= floor || members.len() <= self.first {
            return found.log_bound < floor;
        }
        self.relaxed(members, Some(found.weighted), floor).is_some_and(|found| found.log_bound < floor)
    }

    /// The relaxation on members, from equal weights on a start or on greedy's picks, until it is known on which side of the floor its
    /// optimum is; none where the start is singular.
    fn relaxed(&self, members: &[usize], start: Option<Vec<usize>>, floor: f64) -> Option<Relaxed> {
        let part = Part::new(self.instance, members.iter().copied());
        let instance = part.instance();
        let start = match start {
            Some(start) => part.places(&start),
            None => nonsingular_start(&instance).ok()?,
        };
        let settings = RelaxationSettings { tolerance: TOLERANCE, ..RelaxationSettings::default() };
        let found = relax_until(&instance, &start, &settings, floor).ok()?;
        let weighted: Vec<usize> = found.weights.iter().map(|&(place, _)| place).collect();
        Some(Relaxed {
            log_value: found.log_value,
            log_bound: found.certificate.log_bound,
            weighted: part.members(&weighted),
        })
    }
}

/// What a relaxation came to.
struct Relaxed {
    log_value: f64,
    log_bound: f64,
    /// The views of positive weight.
    weighted: Vec<usize>,
}

/// Values of a joint: every such set has a pose at the lower one or below, and one at the upper one or above.
struct Span {
    joint: usize,
    /// All values of the open views, ascending, each once.
    values: Vec<f64>,
    /// Places of the least lower value and the greatest upper one that can be proven: from the first to the second, the second of
    /// `lower` and the first of `upper` being proven.
    lower: [usize; 2],
    upper: [usize; 2],
}

impl Span {
    fn new(good: &Good, open: &[usize], joint: usize) -> Self {
        let mut values: Vec<f64> = open.iter().map(|&i| good.joints[i][joint]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        let last = values.len() - 1;
        Self { joint, values, lower: [0, last], upper: [0, last] }
    }

    fn is_known(&self) -> bool {
        self.lower[0] == self.lower[1] && self.upper[0] == self.upper[1]
    }

    /// The values that are proven.
    fn proven(&self) -> [f64; 2] {
        [self.values[self.lower[1]], self.values[self.upper[0]]]
    }

    /// The values that might yet be.
    fn widest(&self) -> [f64; 2] {
        [self.values[self.lower[0]], self.values[self.upper[1]]]
    }

    /// Halves the one of its ends of which less is known.
    fn narrow(&mut self, good: &Good, open: &[usize], scores: &Scores) {
        let unknown = |[from, to]: [usize; 2]| self.values[to] - self.values[from];
        let value = |i: usize| good.joints[i][self.joint];
        let middle = |[from, to]: [usize; 2]| usize::midpoint(from, to);
        if unknown(self.lower) >= unknown(self.upper) && self.lower[0] < self.lower[1] {
            let place = middle(self.lower);
            let above: Vec<usize> = open.iter().copied().filter(|&i| value(i) > self.values[place]).collect();
            if good.falls_short(&above, scores) {
                self.lower[1] = place;
            } else {
                self.lower[0] = place + 1;
            }
        } else {
            let place = middle(self.upper);
            let until: Vec<usize> = open.iter().copied().filter(|&i| value(i) <= self.values[place]).collect();
            if good.falls_short(&until, scores) {
                self.upper[0] = place + 1;
            } else {
                self.upper[1] = place;
            }
        }
    }
}

/// What a certificate says of parts of the views.
pub(super) struct Scores {
    /// Of each view, less the prices of its caps.
    reduced: Vec<f64>,
    /// The sum of the greatest of all views, and all that the bound is made of.
    greatest: f64,
    total: f64,
    log_bound: f64,
}

impl Scores {
    pub(super) fn new(instance: &Instance, certificate: &Certificate) -> Self {
        let mut reduced = instance.scores(&certificate.y);
        instance.rules().reduce(&mut reduced, &certificate.prices);
        let gradient = Gradient { y: certificate.y.clone(), mixture: certificate.mixture.clone() };
        let total = (certificate.log_bound + instance.log_polar(&gradient)).exp();
        let all: Vec<usize> = (0..instance.len()).collect();
        let greatest = greatest(instance, &reduced, &all);
        Self { reduced, greatest, total, log_bound: certificate.log_bound }
    }

    /// What log Φ of no set among `members`, which hold the required ones, surpasses.
    fn log_bound(&self, instance: &Instance, members: &[usize]) -> f64 {
        // Not a number where the certificate bounds nothing.
        if self.total.is_nan() {
            return f64::INFINITY;
        }
        let less = self.greatest - greatest(instance, &self.reduced, members);
        self.log_bound + (1.0 - less / self.total).max(0.0).ln()
    }
}

/// The sum of the greatest scores of as many members as are chosen freely.
fn greatest(instance: &Instance, scores: &[f64], members: &[usize]) -> f64 {
    let free = instance.count() - instance.required().len();
    let mut open: Vec<f64> = members.iter().filter(|&&i| instance.is_open(i)).map(|&i| scores[i]).collect();
    if free < open.len() {
        open.select_nth_unstable_by(free, |a, b| b.total_cmp(a));
        open.truncate(free);
    }
    open.sort_unstable_by(f64::total_cmp);
    open.iter().sum()
}
