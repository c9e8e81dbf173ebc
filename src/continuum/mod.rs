//! The greatest score of a view, over all joint values within the ranges: a bound that is proven, no grid.
//!
//! A certificate bounds every set of k poses by the greatest scores `s(q) = ⟨Y, M(q)⟩` of single poses, whatever Y ⪰ 0 is. Here
//! the joint values q are not those of a grid but all of them. Branch and bound halves boxes of joint values, best bound first;
//! over each, the score is enclosed by its Taylor polynomial of third order and a remainder of fourth (`taylor`), and boxes
//! from which the board is certainly not seen are left out (`sight`). Collision, occlusion and stability are not looked at:
//! without them there are more views, and the bound holds all the more. Where poses are kept apart, a set has one view at most of a
//! ball of pictures (`pictures`), and what it scores less there may be paid for once.
//!
//! ```text
//!     twist: joints → points in C      image: points → pixels, derivatives      score: all corners → g ≥ s
//! ```

mod cell;
mod frustum;
mod image;
mod pictures;
mod quadratic;
mod score;
mod search;
mod sight;
mod taylor;
#[cfg(test)]
mod tests;
mod twist;

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector, Point3};
use thiserror::Error;

pub use pictures::PictureBall;

use cell::{Cell, Found, MOST_JOINTS};
use pictures::Balls;
use quadratic::Quadratic;
use score::{Counting, Group, Outcome, groups, score};
use sight::Sight;
use twist::{Kinematics, direction, point};

use crate::feasibility::VisibilityLimits;
use crate::information::Measurement;
use crate::lanes::Lanes as Several;
use crate::robot::{Limits, Robot};
use crate::selection::packed::{packed_len, unpack};
use crate::sweep::AxisRule;
use crate::target::Target;

/// Corners of a board that are worked on at once, and one number of each.
const LANES: usize = 4;
type Lanes = Several<LANES>;

/// Where views are sought, and what they measure.
#[derive(Debug, Clone)]
pub struct Setting<'a> {
    /// The arm and the camera's mount.
    pub robot: &'a Robot,
    /// The board and its zone.
    pub target: &'a Target,
    /// What a view measures.
    pub measurement: Measurement<'a>,
    /// What a view must satisfy.
    pub visibility: &'a VisibilityLimits,
    /// The axis test.
    pub axis: AxisRule,
}

/// Scores of all joint values within ranges.
#[derive(Debug, Clone)]
pub struct Continuum<'a> {
    scored: Vec<Scored<'a>>,
    ranges: Vec<Limits>,
    balls: Vec<PictureBall>,
}

/// A setting, prepared.
#[derive(Debug, Clone)]
struct Scored<'a> {
    setting: Setting<'a>,
    /// L of `Y = L Lᵀ`.
    root: DMatrix<f64>,
    groups: Vec<Group>,
    sight: Sight,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuumSettings {
    /// Share by which the bound may exceed the greatest score known.
    pub tolerance: f64,
    /// Boxes after which it ends, with the batch at hand.
    pub most_boxes: usize,
}

impl Default for ContinuumSettings {
    fn default() -> Self {
        Self { tolerance: 0.02, most_boxes: 0 }
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContinuumEnd {
    /// The bound is within the tolerance, or that of joint values that are all but allowed.
    Closed,
    /// As many boxes as allowed were looked at.
    BoxLimit,
    /// The observer broke.
    Stopped,
}

/// A search on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuumProgress {
    /// No view scores more.
    pub bound: f64,
    /// The greatest score known.
    pub found: f64,
    /// Boxes looked at.
    pub boxes: usize,
}

/// The greatest score, enclosed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Greatest {
    /// No view scores more; infinite where boxes were too large for a bound.
    pub bound: f64,
    /// The greatest score known: that given or that of a view on the way.
    pub found: f64,
    /// Boxes looked at.
    pub boxes: usize,
    /// How it ended.
    pub end: ContinuumEnd,
}

/// Whether a bound holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Held {
    /// Whether it was proven; if not, it may still hold.
    pub is_proven: bool,
    /// Boxes looked at.
    pub boxes: usize,
}

/// What scores cannot be bounded of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Unsupported {
    /// An arm of no joints, or of more than eight.
    #[error("scores are bounded for arms of one to {MOST_JOINTS} joints; this one has {joints}")]
    Joints {
        /// How many it has.
        joints: usize,
    },
}

/// What is added to the eigenvalues of a Y of order 1, as a share of the greatest, for their rounding.
const EIGENVALUE_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How far a box may move the board's points, as a share of their distance, for its score to be worth a bound: of boxes that move
/// them farther, all but a few are halved in any case.
const WORTH: f64 = 0.12;

/// How little a box may move them for its bound to stand as it is: some hundredth of a pixel. Where limits that only just allow it leave a
/// corner of the greatest score, no view may be near enough to be found.
const FINEST: f64 = 1e-5;

impl<'a> Continuum<'a> {
    /// The sum of the scores in several settings of one arm, by a Y (packed, as the measurement's matrices) each. Views are those
    /// of the first.
    ///
    /// # Errors
    /// When the arm has too many joints.
    ///
    /// # Panics
    /// When a Y is not of its measurement's order, or the ranges are not as many as the joints.
    pub fn new(settings: Vec<(Setting<'a>, &[f64])>, ranges: Vec<Limits>) -> Result<Self, Unsupported> {
        let joints = ranges.len();
        let is_of_arm = |(setting, _): &(Setting, &[f64])| setting.robot.chain.dof() == joints;
        assert!(settings.iter().all(is_of_arm), "a range for each joint");
        if !(1..=MOST_JOINTS).contains(&joints) {
            return Err(Unsupported::Joints { joints });
        }
        let scored = settings.into_iter().map(|(setting, y)| Scored::new(setting, y)).collect();
        Ok(Self { scored, ranges, balls: Vec::new() })
    }

    /// The scores less the prices of the balls that pictures, in the first of the settings, are in.
    #[must_use]
    pub fn less(self, balls: Vec<PictureBall>) -> Self {
        Self { balls, ..self }
    }

    /// Bounds the greatest score from above, within a tolerance of `known`, the score of some view, or of a better view on the
    /// way. `score` is that of joint values that are a view, axis, collision and all; `observe` sees every batch of boxes. The outcome does not
    /// depend on the number of threads.
    pub fn greatest(
        &self,
        known: f64,
        settings: &ContinuumSettings,
        score: &(dyn Fn(&[f64]) -> Option<f64> + Sync),
        observe: &mut dyn FnMut(&ContinuumProgress) -> ControlFlow<()>,
    ) -> Greatest {
        search::greatest(self, known, settings, score, observe)
    }

    /// Whether no view scores more than `most`, as far as that is found out with so many boxes.
    pub fn holds(&self, most: f64, most_boxes: usize) -> Held {
        search::holds(self, most, most_boxes)
    }

    fn whole(&self) -> Cell {
        Cell::new(&self.ranges)
    }

    /// What the box comes to.
    fn examine(&self, cell: &Cell) -> Found {
        match self.ranges.len() {
            // Each takes the compiler a while; joints that an arm does not have do not move.
            ..=4 => self.examine_of::<4, 10, 20>(cell),
            5 | 6 => self.examine_of::<6, 21, 56>(cell),
            _ => self.examine_of::<8, 36, 120>(cell),
        }
    }

    fn examine_of<const N: usize, const Q: usize, const C: usize>(&self, cell: &Cell) -> Found {
        let (centre, half) = (cell.centre(), cell.half_widths());
        let mut sum = Quadratic { c: 0.0, l: [0.0; N], q: [0.0; Q], r: 0.0 };
        let mut moves = [0.0; N];
        let mut limits = Vec::new();
        let mut balls = Balls::NONE;
        for (i, scored) in self.scored.iter().enumerate() {
            let Setting { robot, target, .. } = scored.setting;
            let kinematics = Kinematics::new(robot, &target.X_BT, &centre, &half);
            if scored.sight.excludes::<N, Q, C>(&kinematics) {
                if i == 0 {
                    return Found::Empty;
                }
                continue;
            }
            if i == 0 {
                moves = scored.moves::<N, Q, C>(&kinematics);
            }
            if moves.iter().sum::<f64>() > WORTH {
                return unbounded(&moves);
            }
            match scored.score::<N, Q, C>(&kinematics) {
                Outcome::Empty if i == 0 => return Found::Empty,
                Outcome::Empty => {}
                Outcome::TooLarge => return unbounded(&moves),
                Outcome::Score(scores) => {
                    sum = sum.plus(1.0, &scores.score);
                    if i == 0 {
                        limits = scored.sight.limits::<N, Q, C>(&kinematics);
                        limits.extend(scores.inside);
                        balls = scored.balls::<N, Q, C>(&self.balls, &kinematics);
                    }
                }
            }
        }
        let bound = balls.greatest(&sum, &mut limits);
        if bound.is_nan() {
            return unbounded(&moves);
        }
        let is_finest = bound.is_finite() && moves.iter().sum::<f64>() < FINEST;
        Found::Bound { bound, widest: sum.widest(&moves), at_centre: sum.c + sum.r, is_finest }
    }
}

/// A box of which nothing is bounded.
fn unbounded<const N: usize>(moves: &[f64; N]) -> Found {
    let (bound, at_centre) = (f64::INFINITY, f64::NEG_INFINITY);
    Found::Bound { bound, widest: widest(moves), at_centre, is_finest: false }
}

impl<'a> Scored<'a> {
    fn new(setting: Setting<'a>, y: &[f64]) -> Self {
        let order = setting.measurement.order();
        assert_eq!(y.len(), packed_len(order), "Y is of the measurement's order");
        let Setting { target, visibility, axis, .. } = setting;
        let sight = Sight::new(setting.measurement.unknowns.camera, target, visibility, axis);
        let groups = groups(&setting.measurement.corners);
        Self { root: root(&unpack(y, order)), groups, sight, setting }
    }

    fn score<const N: usize, const Q: usize, const C: usize>(&self, kinematics: &Kinematics) -> Outcome<N, Q> {
        let VisibilityLimits { margin, min_corners, .. } = *self.setting.visibility;
        let counting = Counting { margin, all: min_corners.is_none(), least: min_corners.unwrap_or(0) };
        score::<N, Q, C>(
            &self.setting.measurement,
            &self.groups,
            counting,
            self.sight.frustum.as_ref(),
            &self.root,
            kinematics,
        )
    }

    fn balls<const N: usize, const Q: usize, const C: usize>(
        &self,
        balls: &[PictureBall],
        kinematics: &Kinematics,
    ) -> Balls<N, Q> {
        let Setting { target, measurement, .. } = &self.setting;
        Balls::new::<C>(balls, measurement.unknowns.camera, &target.board, kinematics)
    }

    /// How far each joint moves the board in the picture, roughly, as a share of its distance.
    fn moves<const N: usize, const Q: usize, const C: usize>(&self, kinematics: &Kinematics) -> [f64; N] {
        let X_CT = &kinematics.X_CT;
        let centre = point::<N, Q, C>(&kinematics.of_board, &Point3::from(X_CT.translation.vector)).slopes();
        let size = self.setting.measurement.corners.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let normal = direction::<N, Q, C>(&kinematics.of_board, &(X_CT.rotation * nalgebra::Vector3::x())).slopes();
        let distance = X_CT.translation.vector.norm();
        std::array::from_fn(|a| (centre[a] + size * normal[a]) / distance)
    }
}

/// L of `L Lᵀ ⪰ Y`: by the eigenvalues of Y with its diagonal scaled to one, those that are negative by rounding left out.
fn root(Y: &DMatrix<f64>) -> DMatrix<f64> {
    let scale = DVector::from_iterator(Y.nrows(), Y.diagonal().iter().map(|y| y.max(0.0).sqrt()));
    let inverse = scale.map(|s| if s > 0.0 { s.recip() } else { 0.0 });
    let eigen = (DMatrix::from_diagonal(&inverse) * Y * DMatrix::from_diagonal(&inverse)).symmetric_eigen();
    let rounding = EIGENVALUE_ROUNDING * Y.nrows() as f64 * eigen.eigenvalues.amax();
    let roots = eigen.eigenvalues.map(|λ| (λ.max(0.0) + rounding).sqrt());
    DMatrix::from_diagonal(&scale) * eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}

/// The greatest of them, the first of equals.
fn widest<const N: usize>(moves: &[f64; N]) -> usize {
    (0..N).fold(0, |most, a| if moves[a] > moves[most] { a } else { most })
}
