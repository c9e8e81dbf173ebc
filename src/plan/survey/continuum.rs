//! Scores at all joint values.

use std::cmp::Ordering;

use super::Survey;
use crate::continuum::{Continuum, PictureBall, Setting, Unsupported};
use crate::feasibility::picture;
use crate::problem::Problem;
use crate::robot::Limits;
use crate::selection::Group;
use crate::sweep::AxisRule;

/// Rounding of joint values, rad or m.
const SLACK: f64 = 1e-9;

/// The price of the views whose pictures are nearer than half the least distance to the point midway between those from two
/// configurations: any two of them are too close to each other, so that a set has one at most.
#[derive(Debug, Clone, PartialEq)]
pub struct PricedPictures {
    /// The two configurations, rad or m, in their order; the same one twice where the ball is about its picture.
    pub between: [Vec<f64>; 2],
    /// The price, at least 0.
    pub price: f64,
}

impl PricedPictures {
    pub(crate) fn new(a: &[f64], b: &[f64], price: f64) -> Self {
        let (a, b) = if by_numbers(a, b).is_gt() { (b, a) } else { (a, b) };
        Self { between: [a.to_vec(), b.to_vec()], price }
    }

    /// By the former of the configurations, then by the latter.
    pub(crate) fn by_joints(&self, other: &Self) -> Ordering {
        let [a, b] = [0, 1].map(|end| by_numbers(&self.between[end], &other.between[end]));
        a.then(b)
    }

    /// Each once, in their order.
    pub(crate) fn merged(mut all: Vec<Self>) -> Vec<Self> {
        all.sort_by(Self::by_joints);
        all.dedup_by(|next, kept| {
            let is_same = kept.between == next.between;
            kept.price += if is_same { next.price } else { 0.0 };
            is_same
        });
        all
    }

    /// The ball of pictures.
    pub(crate) fn ball(&self, problem: &Problem) -> PictureBall {
        let Problem { robot, camera, target, .. } = problem;
        let of = |q: &[f64]| picture(&(robot.camera_pose(q).inverse() * target.X_BT), camera, &target.board);
        let [a, b] = self.between.each_ref().map(|q| of(q));
        let radius = Group::RADIUS * problem.picture_separation();
        PictureBall { centre: std::array::from_fn(|i| 0.5 * (a[i] + b[i])), radius, price: self.price }
    }
}

/// By the first number that differs.
fn by_numbers(a: &[f64], b: &[f64]) -> Ordering {
    let differing = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
    differing.unwrap_or(Ordering::Equal)
}

impl Survey {
    /// The scores, by a Y on what is measured for each of the set-ups (packed), of the joint values that poses may have, less the
    /// prices of their pictures.
    ///
    /// # Errors
    /// When the arm has too many joints.
    pub(crate) fn continuum<'a>(
        &'a self,
        problem: &'a Problem,
        ys: &[Vec<f64>],
        priced: &[PricedPictures],
    ) -> Result<Continuum<'a>, Unsupported> {
        // What is a view is asked of the axis in the set-up as stated alone.
        let drawn = self.scenarios.iter().map(|scenario| (&scenario.problem, AxisRule::Any));
        let set_ups = std::iter::once((problem, problem.axis)).chain(drawn);
        let setting = |(set_up, axis): (&'a Problem, AxisRule)| {
            let Problem { robot, target, visibility, .. } = set_up;
            Setting { robot, target, measurement: set_up.measurement(), visibility, axis }
        };
        let scored = set_ups.map(setting).zip(ys.iter().map(Vec::as_slice));
        let wider = |Limits { min, max }| Limits { min: min - SLACK, max: max + SLACK };
        let continuum = Continuum::new(scored.collect(), problem.robot.pose_ranges().into_iter().map(wider).collect())?;
        Ok(continuum.less(priced.iter().map(|priced| priced.ball(problem)).collect()))
    }
}
