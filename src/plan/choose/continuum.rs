//! The bound over all joint values.

use std::ops::ControlFlow;

use super::choice::Choice;
use super::chooser::Chooser;
use super::dual::Dual;
use super::error::PlanError;
use super::off_grid::{Candidate, LocalSearch};
use crate::continuum::{ContinuumEnd, ContinuumProgress, Greatest, PictureBall};
use crate::plan::survey::PricedPictures;
use crate::problem::Goal;
use crate::selection::packed::dot;
use crate::selection::{Certificate, Gradient};

/// Allowance for the rounding of the polar function, the logarithms and the sum.
const ROUNDING: f64 = 1e-12;

/// What bounds every set of as many poses, at whatever joint values.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuumCertificate {
    /// Number of poses of the sets that it bounds.
    pub count: usize,
    /// Y ⪰ 0, packed, term after term, and the mixture of a worst variance.
    pub gradient: Gradient,
    /// Balls of pictures, of which a set has one view each at most, and their prices; in an order of their own.
    pub balls: Vec<PricedPictures>,
    /// `⟨Y, M(q)⟩` less the prices of the balls that it is in of no view exceeds it.
    pub score: f64,
    /// No set of as many poses has a greater log Φ.
    pub log_bound: f64,
    /// Share by which the score was to be known.
    pub tolerance: f64,
    /// Boxes of joint values that were bounded.
    pub boxes: usize,
    /// How that ended.
    pub end: ContinuumEnd,
}

impl Chooser<'_> {
    /// Bounds all sets of poses at any joint values whose pictures are far enough apart: of as many as `choice` has, or of one less
    /// where as few as possible are asked for. `certificate` is that of the survey's views. None where no pose leaves the grid, no boxes
    /// are allowed or too few for a bound, the number of poses is not given, a criterion is not of the intrinsics, or the arm has too
    /// many joints. `observe` may end it, and the bound reached by then holds.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn continuum(
        &self,
        choice: &Choice,
        certificate: &Certificate,
        observe: &mut dyn FnMut(&ContinuumProgress) -> ControlFlow<()>,
    ) -> Result<Option<ContinuumCertificate>, PlanError> {
        let (problem, survey, objective) = (self.problem(), self.survey(), self.objective());
        let settings = problem.selection.continuum;
        let fewer = usize::from(problem.selection.goal.proves_fewest());
        let count = choice.selected.len() - fewer;
        if !problem.selection.leaves_grid()
            || settings.most_boxes == 0
            || count < problem.constraints.required.len().max(1)
            || matches!(problem.selection.goal, Goal::Within { .. })
        {
            return Ok(None);
        }
        let instance = self.instance(count)?;
        let mut dual = Dual::repeated(self, choice, certificate, count)?;
        if problem.picture_separation() > 0.0 {
            let progress = ContinuumProgress { bound: f64::INFINITY, found: dual.score, boxes: 0 };
            let separated = Dual::separated(self, certificate, count, &mut || observe(&progress).is_continue())?;
            let bound = |dual: &Dual| dual.log_bound(&instance, count, dual.score);
            if let Some(separated) = separated.filter(|separated| bound(separated) < bound(&dual)) {
                dual = separated;
            }
        }
        dual.balls = PricedPictures::merged(dual.balls);

        let Some(on_measured) = objective.on_measured(&dual.gradient.y) else { return Ok(None) };
        let Ok(continuum) = survey.continuum(problem, &on_measured, &dual.balls) else { return Ok(None) };
        let search = LocalSearch::new(problem, survey, objective);
        let packed = instance.dual(&dual.gradient.y);
        let balls: Vec<PictureBall> = dual.balls.iter().map(|ball| ball.ball(problem)).collect();
        let score = |q: &[f64]| {
            let Candidate { view, information } = search.look(0, q, &[])?;
            let picture = view.picture(&problem.camera, &problem.target.board);
            Some(dot(&information, &packed) - PictureBall::price_of(&balls, &picture))
        };
        let Greatest { bound, boxes, end, .. } = continuum.greatest(dual.score, &settings, &score, observe);
        let log_bound = dual.log_bound(&instance, count, bound) + 2.0 * ROUNDING;
        let Dual { gradient, balls, .. } = dual;
        let found = ContinuumCertificate {
            count,
            gradient,
            balls,
            score: bound,
            log_bound,
            tolerance: settings.tolerance,
            boxes,
            end,
        };
        Ok(Some(found).filter(|found| found.log_bound.is_finite()))
    }
}
