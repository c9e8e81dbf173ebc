//! The joint configurations that a sweep visits.

use std::f64::consts::TAU;
use std::ops::Range;

use thiserror::Error;

use crate::robot::{Limits, Resolution, Span};

/// A finite set of joint configurations, numbered from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum JointSpace {
    /// Every combination of evenly spaced joint values.
    Grid(JointGrid),
    /// A low-discrepancy sample, for arms whose grid would explode.
    Sample(HaltonSample),
}

/// The grid `q = min + j·step, j = 0 … floor((max − min) / step)` of every joint; the last joint runs fastest. Where a joint's ends
/// are one place, only the first of them belongs to the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct JointGrid {
    joints: Vec<Axis>,
    /// Empty where any values can be told.
    resolutions: Vec<Resolution>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    min: f64,
    step: f64,
    count: usize,
}

/// The first points of Halton's sequence, leaped over its correlated start and scaled to the joint limits.
#[derive(Debug, Clone, PartialEq)]
pub struct HaltonSample {
    limits: Vec<Limits>,
    len: usize,
    /// Empty where any values can be told.
    resolutions: Vec<Resolution>,
}

/// Why steps make no grid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GridError {
    /// Not one a joint.
    #[error("{steps} steps are given for {joints} joints; a grid needs one for each")]
    Steps {
        /// Number of joints.
        joints: usize,
        /// Number of steps.
        steps: usize,
    },
    /// A step is not positive.
    #[error("the step of joint {joint}, counted from 0, is {step}; it must be positive and finite")]
    Step {
        /// The joint, from 0.
        joint: usize,
        /// Its step, rad or m.
        step: f64,
    },
}

impl JointSpace {
    /// Number of configurations.
    pub fn len(&self) -> usize {
        match self {
            JointSpace::Grid(grid) => grid.len(),
            JointSpace::Sample(sample) => sample.len,
        }
    }

    /// Number of configurations, also where it is beyond what [`JointSpace::len`] can say.
    pub fn size(&self) -> f64 {
        match self {
            JointSpace::Grid(grid) => grid.joints.iter().map(|axis| axis.count as f64).product(),
            JointSpace::Sample(sample) => sample.len as f64,
        }
    }

    /// Whether there is no configuration.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A space of about `count` configurations or fewer over the same ranges.
    #[must_use]
    pub fn coarser(&self, count: usize) -> Self {
        match self {
            JointSpace::Grid(grid) => {
                let moving = grid.joints.iter().filter(|axis| axis.count > 1).count().max(1);
                let factor = (self.size() / count as f64).powf(1.0 / moving as f64).ceil().max(1.0);
                let coarser = |axis: &Axis| Axis {
                    step: axis.step * factor,
                    count: (axis.count - 1) / factor as usize + 1,
                    ..*axis
                };
                JointSpace::Grid(JointGrid { joints: grid.joints.iter().map(coarser).collect(), ..grid.clone() })
            }
            JointSpace::Sample(sample) => {
                JointSpace::Sample(HaltonSample { len: sample.len.min(count), ..sample.clone() })
            }
        }
    }

    /// The same configurations, their joints told the values next to theirs that they can be told, one resolution a joint.
    #[must_use]
    pub fn told(mut self, resolutions: Vec<Resolution>) -> Self {
        match &mut self {
            JointSpace::Grid(JointGrid { resolutions: old, .. })
            | JointSpace::Sample(HaltonSample { resolutions: old, .. }) => *old = resolutions,
        }
        self
    }

    /// Whether any value of a joint, by its index, lies within `limits` when told in steps of a resolution.
    pub fn has_within(&self, joint: usize, limits: &Limits, resolution: Resolution) -> bool {
        match self {
            JointSpace::Grid(grid) => {
                let axis = grid.joints[joint];
                let told = |i: usize| resolution.nearest(axis.min + i as f64 * axis.step, &axis.limits());
                (0..axis.count).any(|i| limits.holds(told(i)))
            }
            JointSpace::Sample(sample) => {
                let swept = &sample.limits[joint];
                swept.min.max(limits.min) < swept.max.min(limits.max)
            }
        }
    }

    /// At most `count` configurations all over the space, by steps of the golden section: an even stride would be in step with a
    /// grid and see one value of its inner joints. The first of them are as even as all.
    pub fn evenly(&self, count: usize) -> impl Iterator<Item = usize> {
        let total = self.len();
        let step = move |i: usize| ((i as f64 * 0.618_033_988_749_895).fract() * total as f64) as usize;
        (0..count.min(total)).map(move |i| if total <= count { i } else { step(i) })
    }

    /// Joint values (rad or m) of configuration `id`, which must be below [`JointSpace::len`].
    pub fn configuration(&self, id: usize) -> Vec<f64> {
        match self {
            JointSpace::Grid(grid) => grid.configuration(id),
            JointSpace::Sample(sample) => sample.configuration(id),
        }
    }

    /// Shows the joint values of configurations `ids` in turn, as [`JointSpace::configuration`] gives them.
    pub(crate) fn visit(&self, ids: Range<usize>, mut see: impl FnMut(usize, &[f64])) {
        match self {
            JointSpace::Grid(grid) => ids.for_each(|id| see(id, &grid.configuration(id))),
            JointSpace::Sample(sample) => sample.visit(ids, see),
        }
    }
}

impl Axis {
    fn limits(&self) -> Limits {
        Limits { min: self.min, max: self.min + (self.count - 1) as f64 * self.step }
    }
}

impl JointGrid {
    /// The grid over what the joints reach, with these steps (rad or m, positive), one per joint.
    ///
    /// Both ends belong to the grid where the step divides the range, rounding errors of 10⁻⁹ steps forgiven, and they are not one
    /// place.
    ///
    /// # Errors
    /// When there are more or fewer steps than joints, or one is not positive and finite.
    pub fn new(spans: &[Span], steps: &[f64]) -> Result<Self, GridError> {
        if spans.len() != steps.len() {
            return Err(GridError::Steps { joints: spans.len(), steps: steps.len() });
        }
        match steps.iter().position(|step| !(step.is_finite() && *step > 0.0)) {
            Some(joint) => Err(GridError::Step { joint, step: steps[joint] }),
            None => Ok(Self::of(spans, steps)),
        }
    }

    /// As [`JointGrid::new`], of steps known to be right.
    pub(crate) fn of(spans: &[Span], steps: &[f64]) -> Self {
        let joints = spans.iter().zip(steps).map(|(Span { limits, is_turn }, &step)| {
            let last = ((limits.max - limits.min) / step + 1e-9).floor();
            let again = *is_turn && last * step > TAU - 1e-9;
            Axis { min: limits.min, step, count: last as usize + usize::from(!again) }
        });
        Self { joints: joints.collect(), resolutions: vec![] }
    }

    /// Number of values of each joint.
    pub fn counts(&self) -> Vec<usize> {
        self.joints.iter().map(|axis| axis.count).collect()
    }

    /// Step of each joint, rad or m.
    pub fn steps(&self) -> Vec<f64> {
        self.joints.iter().map(|axis| axis.step).collect()
    }

    /// Number of configurations: the product of the counts, saturating.
    pub fn len(&self) -> usize {
        self.joints.iter().fold(1, |product, axis| product.saturating_mul(axis.count))
    }

    /// Whether there is no configuration.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Joint values of configuration `id`: its digits in the mixed radix of the counts.
    pub fn configuration(&self, mut id: usize) -> Vec<f64> {
        let mut q = vec![0.0; self.joints.len()];
        for (q, axis) in q.iter_mut().zip(&self.joints).rev() {
            *q = axis.min + (id % axis.count) as f64 * axis.step;
            id /= axis.count;
        }
        for ((q, axis), resolution) in q.iter_mut().zip(&self.joints).zip(&self.resolutions) {
            *q = resolution.nearest(*q, &axis.limits());
        }
        q
    }
}

/// Bases of the sequence, one per joint.
const PRIMES: [usize; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

impl HaltonSample {
    /// Most joints that the sequence has bases for.
    pub const MOST_JOINTS: usize = PRIMES.len();

    /// `len` configurations within `limits`, of at most [`HaltonSample::MOST_JOINTS`] joints.
    pub fn new(limits: &[Limits], len: usize) -> Self {
        debug_assert!(limits.len() <= Self::MOST_JOINTS);
        Self { limits: limits.to_vec(), len, resolutions: vec![] }
    }

    /// Limits of each joint.
    pub fn limits(&self) -> &[Limits] {
        &self.limits
    }

    /// Joint values of point `id`.
    pub fn configuration(&self, id: usize) -> Vec<f64> {
        let mut point = vec![];
        self.visit(id..id + 1, |_, q| point.extend_from_slice(q));
        point
    }

    /// Shows the joint values of the points `ids` in turn.
    pub(crate) fn visit(&self, ids: Range<usize>, mut see: impl FnMut(usize, &[f64])) {
        // The first points of the larger bases rise together; skipping past the largest base breaks that up.
        let index = ids.start + 2 * PRIMES[PRIMES.len() - 1];
        let mut mirrored: Vec<RadicalInverse> =
            self.limits.iter().zip(PRIMES).map(|(_, base)| RadicalInverse::new(index, base)).collect();
        let mut q = vec![0.0; self.limits.len()];
        for id in ids {
            for ((q, limits), mirrored) in q.iter_mut().zip(&self.limits).zip(&mut mirrored) {
                *q = limits.min + (limits.max - limits.min) * mirrored.value();
                mirrored.advance();
            }
            for ((q, limits), resolution) in q.iter_mut().zip(&self.limits).zip(&self.resolutions) {
                *q = resolution.nearest(*q, limits);
            }
            see(id, &q);
        }
    }
}

/// The digits of a number in some base, mirrored at the point: van der Corput's sequence, number by number.
struct RadicalInverse {
    base: usize,
    /// From the lowest on.
    digits: Vec<Digit>,
}

struct Digit {
    number: usize,
    /// What a one is worth here, mirrored.
    place: f64,
    /// What the digit is.
    value: f64,
}

impl RadicalInverse {
    fn new(mut index: usize, base: usize) -> Self {
        let mut inverse = Self { base, digits: vec![] };
        while index > 0 {
            inverse.push(index % base);
            index /= base;
        }
        inverse
    }

    fn push(&mut self, digit: usize) {
        let place = self.digits.last().map_or(1.0, |last| last.place) / self.base as f64;
        self.digits.push(Digit { number: digit, place, value: place * digit as f64 });
    }

    fn value(&self) -> f64 {
        self.digits.iter().fold(0.0, |sum, digit| sum + digit.value)
    }

    /// On to the next number, as a mileometer does: no division, and seldom more than a digit or two.
    fn advance(&mut self) {
        for Digit { number, place, value } in &mut self.digits {
            *number += 1;
            if *number < self.base {
                *value = *place * *number as f64;
                return;
            }
            (*number, *value) = (0, 0.0);
        }
        self.push(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(min: f64, max: f64) -> Limits {
        Limits { min: min.to_radians(), max: max.to_radians() }
    }

    fn grid(limits: &[Limits], steps: &[f64]) -> JointGrid {
        let spans: Vec<Span> = limits.iter().map(|&limits| Span { limits, is_turn: false }).collect();
        JointGrid::new(&spans, steps).unwrap()
    }

    #[test]
    fn both_ends_belong_to_the_grid_when_the_step_divides_the_range() {
        let grid = grid(&[degrees(-0.3, 0.3), degrees(0.0, 10.0)], &[0.1f64.to_radians(), 4f64.to_radians()]);
        assert_eq!(grid.counts(), [7, 3]);
        assert!((grid.configuration(20)[0] - 0.3f64.to_radians()).abs() < 1e-15);
        assert!((grid.configuration(20)[1] - 8f64.to_radians()).abs() < 1e-15);
        assert_eq!(grid.configuration(1), [degrees(-0.3, 0.0).min, 4f64.to_radians()]);
    }

    #[test]
    fn a_grid_beyond_counting_has_a_size() {
        let grid = grid(&[degrees(0.0, 1e4); 4], &[0.01f64.to_radians(); 4]);
        assert_eq!(grid.len(), usize::MAX);
        assert!((JointSpace::Grid(grid).size() / 1_000_001f64.powi(4) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_joint_has_a_positive_step() {
        let spans = [Span { limits: Limits::FULL_TURN, is_turn: false }; 2];
        assert_eq!(JointGrid::new(&spans, &[0.1]), Err(GridError::Steps { joints: 2, steps: 1 }));
        assert_eq!(JointGrid::new(&spans, &[0.1, 0.0]), Err(GridError::Step { joint: 1, step: 0.0 }));
    }

    #[test]
    fn a_fixed_joint_has_one_value() {
        assert_eq!(grid(&[degrees(5.0, 5.0)], &[1.0]).counts(), [1]);
    }

    #[test]
    fn a_whole_turn_has_its_first_place_once() {
        let turn = Span { limits: Limits::FULL_TURN, is_turn: true };
        let counts = |degrees: f64| JointGrid::new(&[turn], &[degrees.to_radians()]).unwrap().counts()[0];
        // At 7° the last value is 3° short of the first; at 400° there is only one.
        assert_eq!([10.0, 7.0, 0.1, 360.0, 400.0].map(counts), [36, 52, 3600, 1, 1]);
        assert_eq!(grid(&[Limits::FULL_TURN], &[10f64.to_radians()]).counts(), [37]);
    }

    /// The paper's table III: Q of 20°, 10° and 8°.
    #[test]
    fn servosila_grid_sizes() {
        let limits = [degrees(-214.2, 137.3), degrees(-16.4, 114.2), degrees(-216.9, 0.0), degrees(0.0, 188.8)];
        for (step, size) in [(20.0, 13_860), (10.0, 210_672), (8.0, 502_656)] {
            assert_eq!(grid(&limits, &[f64::to_radians(step); 4]).len(), size);
        }
    }

    /// The same bits however many came before, so that every part of a sweep may start where it will.
    #[test]
    fn points_are_visited_as_they_are() {
        let sample = HaltonSample::new(&[Limits { min: -1.0, max: 2.0 }; 6], 5000);
        let mirrored = |mut index: usize, base: usize| {
            let (mut value, mut place) = (0.0, 1.0);
            while index > 0 {
                place /= base as f64;
                value += place * (index % base) as f64;
                index /= base;
            }
            value
        };
        let mut visited = 0;
        sample.visit(0..5000, |id, q| {
            assert_eq!(id, visited);
            let expected: Vec<f64> = PRIMES[..6].iter().map(|&base| -1.0 + 3.0 * mirrored(id + 106, base)).collect();
            assert_eq!(q, expected);
            assert_eq!(sample.configuration(id), expected);
            visited += 1;
        });
        assert_eq!(visited, 5000);
    }

    #[test]
    fn the_sample_fills_every_sixteenth_of_two_joints() {
        let sample = HaltonSample::new(&[Limits { min: -1.0, max: 1.0 }, Limits { min: 0.0, max: 4.0 }], 400);
        let mut cells = [0; 16];
        for id in 0..400 {
            let q = sample.configuration(id);
            assert!((-1.0..1.0).contains(&q[0]) && (0.0..4.0).contains(&q[1]));
            cells[((q[0] + 1.0) * 2.0) as usize * 4 + q[1] as usize] += 1;
        }
        assert!(cells.iter().all(|&n| (20..=30).contains(&n)), "{cells:?}");
    }
}
