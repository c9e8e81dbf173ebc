//! Time that no tour takes less than.

use rayon::prelude::*;

use super::times::Times;
use crate::selection::{
    Certificate, Gradient, Instance, Part, RelaxationSettings, highest, nonsingular_start, relax_until,
};

/// Most views of which all pairs are looked at.
const MOST_PAIRED: usize = 6000;

/// Gap at which a relaxation tells whether a part of the views suffices.
const TOLERANCE: f64 = 1e-3;

/// Views that are looked at first where there are more, and most times that the best of the others join.
pub(super) const FIRST: usize = 3000;
const LOOKS: usize = 6;

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
        // Where the best of many suffice, the others need not be looked at; where these do not, their bound tells of all others.
        let highest = |scores: &Scores| highest(&scores.reduced, members.iter().copied(), self.first);
        let mut some = highest(scores);
        let mut start = None;
        for _ in 0..LOOKS {
            let Some(found) = self.relaxed(&some, start, floor) else { return false };
            if found.log_value >= floor || found.log_bound >= floor {
                return false;
            }
            if some.len() == members.len() || found.scores.log_bound(self.instance, members) < floor {
                return true;
            }
            some = highest(&found.scores);
            some.extend(&found.weighted);
            // Each once: they are all members only if they are as many.
            some.sort_unstable();
            some.dedup();
            start = Some(found.weighted);
        }
        false
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
            scores: Scores::of_part(&part, &found.certificate),
        })
    }
}

/// What a relaxation came to.
struct Relaxed {
    log_value: f64,
    log_bound: f64,
    /// The views of positive weight.
    weighted: Vec<usize>,
    scores: Scores,
}

/// Values of a joint: every such set has a pose at the lower one or below, and one at the upper one or above.
struct Span {
    joint: usize,
    /// Its values in the open views, in their order; and all of them ascending, each once.
    of_open: Vec<f64>,
    values: Vec<f64>,
    /// Places of the least lower value and the greatest upper one that can be proven: from the first to the second, the second of
    /// `lower` and the first of `upper` being proven.
    lower: [usize; 2],
    upper: [usize; 2],
}

impl Span {
    fn new(good: &Good, open: &[usize], joint: usize) -> Self {
        let of_open: Vec<f64> = open.par_iter().map(|&i| good.joints[i][joint]).collect();
        let mut values = of_open.clone();
        values.par_sort_unstable_by(f64::total_cmp);
        values.dedup();
        let last = values.len() - 1;
        Self { joint, of_open, values, lower: [0, last], upper: [0, last] }
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
        let those = |hold: &dyn Fn(f64) -> bool| -> Vec<usize> {
            let views = open.iter().zip(&self.of_open);
            views.filter(|&(_, &value)| hold(value)).map(|(&i, _)| i).collect()
        };
        let middle = |[from, to]: [usize; 2]| usize::midpoint(from, to);
        if unknown(self.lower) >= unknown(self.upper) && self.lower[0] < self.lower[1] {
            let place = middle(self.lower);
            if good.falls_short(&those(&|value| value > self.values[place]), scores) {
                self.lower[1] = place;
            } else {
                self.lower[0] = place + 1;
            }
        } else {
            let place = middle(self.upper);
            if good.falls_short(&those(&|value| value <= self.values[place]), scores) {
                self.upper[0] = place + 1;
            } else {
                self.upper[1] = place;
            }
        }
    }
}

/// What a certificate says of parts of the views.
pub(super) struct Scores {
    /// Of each view, less the prices of its groups.
    reduced: Vec<f64>,
    /// What the bound is made of beside the greatest scores.
    others: f64,
    log_polar: f64,
}

impl Scores {
    /// By a certificate of all views.
    pub(super) fn new(instance: &Instance, certificate: &Certificate) -> Self {
        let reduced = reduced(instance, certificate);
        let gradient = Gradient { y: certificate.y.clone(), mixture: certificate.mixture.clone() };
        let log_polar = instance.log_polar(&gradient);
        let all: Vec<usize> = (0..instance.len()).collect();
        let others = (certificate.log_bound + log_polar).exp() - greatest(instance, &reduced, &all);
        Self { reduced, others, log_polar }
    }

    /// By a certificate of a part of the views.
    fn of_part(part: &Part, certificate: &Certificate) -> Self {
        let whole = Certificate { prices: part.whole_prices(&certificate.prices), ..certificate.clone() };
        Self { reduced: reduced(part.whole(), &whole), ..Self::new(&part.instance(), certificate) }
    }

    /// What log Φ of no set among `members`, which hold the required ones, surpasses.
    fn log_bound(&self, instance: &Instance, members: &[usize]) -> f64 {
        let log_bound = (self.others + greatest(instance, &self.reduced, members)).max(0.0).ln() - self.log_polar;
        // Where the certificate bounds nothing.
        if self.others.is_finite() && !log_bound.is_nan() { log_bound } else { f64::INFINITY }
    }
}

/// Scores of all views by a certificate, less the prices of their groups.
fn reduced(instance: &Instance, certificate: &Certificate) -> Vec<f64> {
    instance.rules().reduced(&instance.scores(&certificate.y), &certificate.prices)
}

/// The sum of the greatest scores of as many members as are chosen freely.
fn greatest(instance: &Instance, scores: &[f64], members: &[usize]) -> f64 {
    let free = instance.count() - instance.required().len();
    let open = members.iter().copied().filter(|&i| instance.is_open(i));
    let mut greatest: Vec<f64> = highest(scores, open, free).into_iter().map(|i| scores[i]).collect();
    greatest.sort_unstable_by(f64::total_cmp);
    greatest.iter().sum()
}
