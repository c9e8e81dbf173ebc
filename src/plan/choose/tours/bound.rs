//! Time that no tour takes less than.

use rayon::prelude::*;

use super::times::Times;
use crate::selection::{Certificate, Gradient, Instance, Part, RelaxationSettings, relax_from_greedy};

/// Most views of which all pairs are looked at.
const MOST_PAIRED: usize = 6000;

/// Gap at which a relaxation tells whether a part of the views suffices.
const TOLERANCE: f64 = 1e-3;

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
        let joints = self.joints.first().map_or(0, |q| q.len());
        let k = self.instance.count();
        let spans = (0..joints)
            .into_par_iter()
            .map(|joint| self.times.least_across(joint, self.span(&open, joint), k, nearest));
        spans.reduce(|| 0.0, f64::max)
    }

    /// Values of a joint: every such set has a pose at the first or below, and one at the second or above.
    fn span(&self, open: &[usize], joint: usize) -> [f64; 2] {
        let value = |i: usize| self.joints[i][joint];
        let mut values: Vec<f64> = open.iter().map(|&i| value(i)).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        let from = |place: usize| open.iter().copied().filter(|&i| value(i) >= values[place]).collect::<Vec<_>>();
        let until = |place: usize| open.iter().copied().filter(|&i| value(i) <= values[place]).collect::<Vec<_>>();
        let places: Vec<usize> = (0..values.len() - 1).collect();
        let low = places.partition_point(|&place| !self.falls_short(&from(place + 1)));
        let high = places.partition_point(|&place| self.falls_short(&until(place)));
        [values[low], values[high]]
    }

    /// Whether no such set is among `members`.
    fn falls_short(&self, members: &[usize]) -> bool {
        let holds_required = self.instance.required().iter().all(|i| members.binary_search(i).is_ok());
        if !holds_required || members.len() < self.instance.count() {
            return true;
        }
        let part = Part::new(self.instance, members.iter().copied());
        let instance = part.instance();
        let Certificate { y, mixture, .. } = self.certificate;
        let gradient = Gradient { y: y.clone(), mixture: mixture.clone() };
        if Certificate::new(&instance, gradient, vec![]).is_ok_and(|bound| bound.log_bound < self.floor - ROUNDING) {
            return true;
        }
        let settings = RelaxationSettings { tolerance: TOLERANCE, ..RelaxationSettings::default() };
        match relax_from_greedy(&instance, &settings) {
            Ok((_, relaxation)) => relaxation.certificate.log_bound < self.floor - ROUNDING,
            Err(_) => false,
        }
    }
}
