//! Scores at all joint values.

use super::Survey;
use crate::continuum::{Continuum, Setting, Unsupported};
use crate::problem::Problem;
use crate::robot::Limits;
use crate::sweep::AxisRule;

/// Rounding of joint values, rad or m.
const SLACK: f64 = 1e-9;

impl Survey {
    /// The scores, by a Y on what is measured for each of the set-ups (packed), of the joint values that poses may have.
    ///
    /// # Errors
    /// When the arm has too many joints.
    pub(crate) fn continuum<'a>(&'a self, problem: &'a Problem, ys: &[Vec<f64>]) -> Result<Continuum<'a>, Unsupported> {
        // What is a view is asked of the axis in the set-up as stated alone.
        let drawn = self.scenarios.iter().map(|scenario| (&scenario.problem, AxisRule::Any));
        let set_ups = std::iter::once((problem, problem.axis)).chain(drawn);
        let setting = |(set_up, axis): (&'a Problem, AxisRule)| {
            let Problem { robot, target, visibility, .. } = set_up;
            Setting { robot, target, measurement: set_up.measurement(), visibility, axis }
        };
        let scored = set_ups.map(setting).zip(ys.iter().map(Vec::as_slice));
        let wider = |Limits { min, max }| Limits { min: min - SLACK, max: max + SLACK };
        Continuum::new(scored.collect(), problem.robot.pose_ranges().into_iter().map(wider).collect())
    }
}
