//! Boxes of joint values.

use crate::robot::Limits;

/// Most joints.
pub(super) const MOST_JOINTS: usize = 8;

/// A range for each joint, rad or m; those beyond the arm's are empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    joints: usize,
    low: [f64; MOST_JOINTS],
    high: [f64; MOST_JOINTS],
}

/// What a box comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Found {
    /// No view has its joint values there.
    Empty,
    /// No view there scores more than the bound, which is infinite where the box is too large for one.
    Bound {
        bound: f64,
        /// The joint whose range matters most.
        widest: usize,
        /// At least the score at the centre, if that is a view.
        at_centre: f64,
        /// Whether it is so small that its halves' bounds would hardly be less.
        is_finest: bool,
    },
}

impl Cell {
    /// Of at most [`MOST_JOINTS`] ranges.
    pub(super) fn new(ranges: &[Limits]) -> Self {
        let mut cell = Self { joints: ranges.len(), low: [0.0; MOST_JOINTS], high: [0.0; MOST_JOINTS] };
        for (i, range) in ranges.iter().enumerate() {
            (cell.low[i], cell.high[i]) = (range.min, range.max);
        }
        cell
    }

    pub(super) fn centre(&self) -> Vec<f64> {
        (0..self.joints).map(|i| f64::midpoint(self.low[i], self.high[i])).collect()
    }

    /// How far the ranges' ends are from the centre, rounded up.
    pub(super) fn half_widths(&self) -> Vec<f64> {
        let centre = self.centre();
        let half = |i: usize| (self.high[i] - centre[i]).max(centre[i] - self.low[i]);
        (0..self.joints).map(|i| half(i).next_up()).collect()
    }

    /// Divided in the middle of a joint's range.
    pub(super) fn halves(&self, joint: usize) -> [Self; 2] {
        let middle = f64::midpoint(self.low[joint], self.high[joint]);
        let [mut lower, mut upper] = [*self; 2];
        (lower.high[joint], upper.low[joint]) = (middle, middle);
        [lower, upper]
    }
}
