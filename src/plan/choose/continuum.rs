//! The bound over all joint values.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::choice::Choice;
use super::chooser::Chooser;
use super::error::PlanError;
use super::off_grid::LocalSearch;
use crate::continuum::{ContinuumEnd, ContinuumProgress, Greatest};
use crate::problem::Goal;
use crate::selection::packed::dot;
use crate::selection::{Certificate, Gradient, RelaxationSettings, relax};

/// Views of the greatest scores among which the matrices of the bound are sought, beside those off the grid.
const COLUMNS: usize = 60;

/// Gap of the relaxation on them.
const GAP: f64 = 1e-6;

/// Allowance for the rounding of the polar function, the logarithms and the sum.
const ROUNDING: f64 = 1e-12;

/// What bounds every set of as many poses, at whatever joint values.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuumCertificate {
    /// Number of poses of the sets that it bounds.
    pub count: usize,
    /// Y ⪰ 0, packed, term after term, and the mixture of a worst variance.
    pub gradient: Gradient,
    /// `⟨Y, M(q)⟩` of no view exceeds it.
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
    /// Bounds all sets of poses at any joint values, repeated poses included: of as many as `choice` has, or of one less where as few
    /// as possible are asked for. `certificate` is that of the survey's views. None where no pose leaves the grid, no boxes are
    /// allowed or too few for a bound, the number of poses is not given, a criterion is not of the intrinsics, or the arm has too many joints. `observe` may end it,
    /// and the bound reached by then holds.
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
        let scores = instance.scores(&certificate.y);
        let off_grid = survey.views.len() - survey.off_grid;
        let mut places: Vec<usize> = (0..scores.len()).filter(|&i| instance.is_open(i)).collect();
        places.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
        places.truncate(COLUMNS);
        places.extend((off_grid..survey.views.len()).chain(choice.selected.iter().copied()));
        places.sort_unstable();
        places.dedup();
        // Poses may repeat: weights that add up to one, on `count` times the information.
        let search = LocalSearch::new(problem, survey, objective);
        let matrices = places.iter().filter_map(|&i| Some(search.candidate(&survey.views[i])?.information));
        let repeated = objective.on(&matrices.collect::<Vec<_>>()).known_share(1.0 / count as f64);
        let relaxed = repeated.instance(1, &Arc::default()).map_err(|error| self.explain(error))?;
        let all: Vec<usize> = (0..relaxed.len()).collect();
        let fine = RelaxationSettings { tolerance: GAP, ..RelaxationSettings::default() };
        let relaxation = relax(&relaxed, &all, &fine).map_err(|error| self.explain(error))?;
        let Certificate { y, mixture, .. } = relaxation.certificate;
        let gradient = Gradient { y, mixture };

        let Some(on_measured) = objective.on_measured(&gradient.y) else { return Ok(None) };
        let Ok(continuum) = survey.continuum(problem, &on_measured) else { return Ok(None) };
        let dual = instance.dual(&gradient.y);
        let score = |q: &[f64]| search.look(0, q, &[]).map(|found| dot(&found.information, &dual));
        let known = instance.scores(&gradient.y).into_iter().fold(0.0, f64::max);
        let Greatest { bound, boxes, end, .. } = continuum.greatest(known, &settings, &score, observe);
        let log_bound = (dot(&instance.prior(), &dual) + count as f64 * bound).ln() + ROUNDING;
        let log_bound = log_bound - instance.log_polar(&gradient) + ROUNDING;
        let found = ContinuumCertificate {
            count,
            gradient,
            score: bound,
            log_bound,
            tolerance: settings.tolerance,
            boxes,
            end,
        };
        Ok(Some(found).filter(|found| found.log_bound.is_finite()))
    }
}
