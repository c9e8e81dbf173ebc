//! The course of a tour in time, and the margins measured along it.

use rayon::prelude::*;

use super::safety::MarginKind;
use super::timing::Profile;
use super::way::{Margins, between};

/// Time from sample to sample at most, s.
const STEP: f64 = 0.1;

/// By how much a margin may change from sample to sample by its bound, m.
const CHANGE: f64 = 0.05;

/// Samples of a course, about; fewer than the steps ask for where it is long.
const MOST_SAMPLES: usize = 4000;

/// Measurements that narrow down a least margin between its neighbours: to a ten-thousandth of the time between them.
const NARROWINGS: usize = 20;

/// Times are rounded to so many to the second before anything is measured there.
const TIMES_PER_SECOND: f64 = 1e4;

/// A margin that stays within so much along a course is steady, m.
const STEADY: f64 = 1e-3;

/// A straight way from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// When it begins, s from the beginning of the course.
    pub start: f64,
    /// Joint values where it begins, rad or m.
    pub from: Vec<f64>,
    /// Joint values where it ends, rad or m.
    pub to: Vec<f64>,
    /// How far along it the joints are at what time.
    pub profile: Profile,
}

/// The least of some margins at the times of [`Samples`].
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Number of the least margin in its kind, and the margin itself, m.
    pub least: Vec<(usize, f64)>,
}

/// Margins measured along a course. What they are in between is not known.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// When, s; ascending.
    pub times: Vec<f64>,
    /// Of each watch, what was measured at these times.
    pub curves: Vec<Curve>,
}

/// What is measured at a time.
struct Sample {
    /// When, s.
    time: f64,
    /// Of each watch, the least margin: its number and itself, m.
    least: Vec<(usize, f64)>,
}

/// Margins of a kind to watch along a course.
#[derive(Debug)]
pub struct Watch<'k> {
    kind: &'k MarginKind<'k>,
    /// Their numbers.
    margins: Vec<usize>,
}

impl Leg {
    /// When it ends, s.
    pub fn end(&self) -> f64 {
        self.start + self.profile.duration()
    }

    /// Joint values at a time (s), rad or m: where it begins before it, where it ends after it.
    pub fn at(&self, time: f64) -> Vec<f64> {
        between(&self.from, &self.to, self.profile.at(time - self.start))
    }
}

/// Joint values at a time (s) of a course of legs, rad or m; none where there are no legs. Between legs, and before and after them, the
/// arm rests.
pub fn configuration(legs: &[Leg], time: f64) -> Option<Vec<f64>> {
    let begun = legs.partition_point(|leg| leg.start <= time);
    match legs.get(begun.saturating_sub(1))? {
        first if begun == 0 => Some(first.from.clone()),
        leg => Some(leg.at(time)),
    }
}

impl<'k> Watch<'k> {
    /// All margins of a kind.
    pub fn all(kind: &'k MarginKind<'k>) -> Self {
        Self { kind, margins: (0..kind.count()).collect() }
    }

    /// Those of them that are not steady along the legs, as far as their beginnings, middles and ends show; none where all are, or none
    /// is. Links that stay as near as they are, such as neighbours that turn about each other, hide how near others come.
    pub fn changing(kind: &'k MarginKind<'k>, legs: &[Leg]) -> Option<Self> {
        let places =
            legs.par_iter().flat_map_iter(|leg| [0.0, 0.5, 1.0].map(|share| between(&leg.from, &leg.to, share)));
        let measured = places.map(|q| {
            let measure = kind.at(&q);
            (0..kind.count()).map(|margin| measure(margin, f64::INFINITY)).collect::<Vec<f64>>()
        });
        let measured: Vec<Vec<f64>> = measured.collect();
        let spread = |margin: usize| {
            let of_margin = measured.iter().map(|margins| margins[margin]).filter(|value| value.is_finite());
            let ends = of_margin.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
            ends.1 - ends.0
        };
        let margins: Vec<usize> = (0..kind.count()).filter(|&margin| spread(margin) > STEADY).collect();
        let some = !margins.is_empty() && margins.len() < kind.count();
        some.then_some(Self { kind, margins })
    }

    /// The least of them at joint values `q` (rad or m): its number and itself, m.
    fn least(&self, q: &[f64]) -> (usize, f64) {
        let measure = self.kind.at(q);
        let smaller = |least: (usize, f64), &margin: &usize| {
            let value = measure(margin, least.1);
            if value < least.1 { (margin, value) } else { least }
        };
        self.margins.iter().fold((self.margins[0], f64::INFINITY), smaller)
    }
}

impl Samples {
    /// Measures what is watched along legs: every tenth of a second, or oftener where links move far, and closer about the least on every
    /// leg. The same on any number of threads.
    pub fn new(watches: &[Watch], legs: &[Leg]) -> Self {
        let most = (MOST_SAMPLES / legs.len().max(1)).max(2);
        let of_legs: Vec<Vec<Sample>> = legs.par_iter().map(|leg| of_leg(watches, leg, most)).collect();
        let mut samples = Self { times: vec![], curves: watches.iter().map(|_| Curve { least: vec![] }).collect() };
        for Sample { time, least } in of_legs.into_iter().flatten() {
            if samples.times.last().is_none_or(|&last| time > last) {
                samples.times.push(time);
                for (curve, least) in samples.curves.iter_mut().zip(least) {
                    curve.least.push(least);
                }
            }
        }
        samples
    }
}

impl Curve {
    /// Number of the sample with the least margin.
    pub fn least(&self) -> usize {
        let margin = |&i: &usize| self.least[i].1;
        (0..self.least.len()).min_by(|a, b| margin(a).total_cmp(&margin(b))).unwrap_or(0)
    }
}

/// What is measured along a leg at ascending times, at most at some more than `most`.
fn of_leg(watches: &[Watch], leg: &Leg, most: usize) -> Vec<Sample> {
    let change = |watch: &Watch| {
        let changes = watch.kind.changes(&leg.from, &leg.to);
        watch.margins.iter().map(|&margin| changes[margin]).fold(0.0, f64::max)
    };
    let change = watches.iter().map(change).fold(0.0, f64::max);
    let steps = (leg.profile.duration() / STEP).max(change / CHANGE).ceil().clamp(1.0, most as f64);
    let rounded = |time: f64| (time * TIMES_PER_SECOND).round() / TIMES_PER_SECOND;
    let at = |step: usize| rounded(leg.start + leg.profile.duration() * (step as f64 / steps));
    let measure = |time: f64| {
        let q = leg.at(time);
        Sample { time, least: watches.iter().map(|watch| watch.least(&q)).collect() }
    };
    let mut samples: Vec<Sample> = (0..=steps as usize).map(|step| measure(at(step))).collect();
    for (i, watch) in watches.iter().enumerate() {
        let margin = |&place: &usize| samples[place].least[i].1;
        let least = (0..samples.len()).min_by(|a, b| margin(a).total_cmp(&margin(b))).unwrap_or(0);
        let ends = [least.saturating_sub(1), (least + 1).min(samples.len() - 1)].map(|place| samples[place].time);
        let time = rounded(narrowed(ends, &|time| watch.least(&leg.at(time)).1));
        let place = samples.partition_point(|sample| sample.time < time);
        if samples.get(place).is_none_or(|sample| sample.time > time) {
            samples.insert(place, measure(time));
        }
    }
    samples
}

/// Where between two ends a function is least that falls and then rises: by golden sections.
fn narrowed([mut low, mut high]: [f64; 2], of: &dyn Fn(f64) -> f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let inner = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    let [mut left, mut right] = inner(low, high);
    let (mut of_left, mut of_right) = (of(left), of(right));
    for _ in 0..NARROWINGS {
        if of_left <= of_right {
            (high, right, of_right) = (right, left, of_left);
            left = inner(low, high)[0];
            of_left = of(left);
        } else {
            (low, left, of_left) = (left, right, of_right);
            right = inner(low, high)[1];
            of_right = of(right);
        }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::JointLimits;

    /// To 1 and, after a second's rest, on to 3.
    fn legs() -> Vec<Leg> {
        let limits = [JointLimits::new(1.0, 1.0)];
        let leg = |start: f64, from: f64, to: f64| {
            let profile = Profile::between(&[from], &[to], &limits);
            Leg { start, from: vec![from], to: vec![to], profile }
        };
        vec![leg(1.0, 0.0, 1.0), leg(4.0, 1.0, 3.0)]
    }

    #[test]
    fn the_arm_rests_between_its_legs() {
        let legs = legs();
        assert_eq!((legs[0].end(), legs[1].end()), (3.0, 7.0));
        for (time, value) in
            [(0.0, 0.0), (1.0, 0.0), (2.0, 0.5), (3.0, 1.0), (3.5, 1.0), (4.0, 1.0), (5.5, 2.0), (9.0, 3.0)]
        {
            assert_eq!(configuration(&legs, time), Some(vec![value]), "{time}");
        }
        assert_eq!(configuration(&[], 1.0), None);
    }

    #[test]
    fn the_least_of_a_valley_is_found_between_its_samples() {
        for bottom in [0.0, 0.123, 0.5, 0.987, 1.0] {
            let smooth = narrowed([0.0, 1.0], &|t| (t - bottom) * (t - bottom));
            let sharp = narrowed([0.0, 1.0], &|t| (t - bottom).abs());
            assert!((smooth - bottom).abs() < 1e-4 && (sharp - bottom).abs() < 1e-4, "{bottom}: {smooth} {sharp}");
        }
    }
}
