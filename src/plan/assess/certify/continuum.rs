//! The bound over all joint values, proven again.

use super::bound::Matrices;
use super::compare::{number, other, same};
use super::error::CertifyError;
use super::evidence::{Evidence, Rounded, Source};
use super::function::ROUNDING;
use super::{SAME, trusted};
use crate::plan::document::{CertificateTerm, ContinuumDocument};
use crate::plan::survey::Survey;

/// Boxes that are bounded at most, for each that the plan says it took, and beside them: depth first takes other ones than best first.
const BOXES: usize = 4;
const MORE_BOXES: usize = 10_000;

impl Evidence<'_> {
    /// What the continuum's certificate proves of `count` poses; log Φ of the plan is `value`.
    pub(super) fn continuum(
        &self,
        stated: &ContinuumDocument,
        survey: &Survey,
        count: usize,
        value: f64,
    ) -> Result<Rounded, CertifyError> {
        let ContinuumDocument {
            count: stated_count,
            bound: stated_bound,
            efficiency,
            score,
            tolerance,
            boxes,
            end,
            terms,
            mixture,
        } = stated;
        same("the number of poses that are bounded at all joint values", stated_count, &count)?;
        same("the tolerance of the bound at all joint values", tolerance, &self.problem.selection.continuum.tolerance)?;
        let asked = self.problem.selection.continuum.most_boxes;
        if *boxes > asked.saturating_add(MORE_BOXES) {
            return Err(other("the number of boxes of joint values", boxes, &format!("about {asked} at most")));
        }
        if !ContinuumDocument::ENDS.contains(&end.as_str()) {
            return Err(other("the end of the bound at all joint values", end, &ContinuumDocument::ENDS.join(" or ")));
        }
        let Matrices { given, log_polar: [least, greatest], .. } = self.matrices(terms, mixture)?;
        let log = (given + count as f64 * score).ln() + 2.0 * ROUNDING - least;
        let bound = Rounded { log, uncertainty: greatest - least };
        trusted("the bound at all joint values", bound.uncertainty)?;
        self.equal("the bound at all joint values", *stated_bound, log, SAME + bound.uncertainty)?;
        let found = (value - self.log_of(*stated_bound)).exp();
        number("the efficiency at all joint values", *efficiency, found, SAME + bound.uncertainty)?;
        // What takes longest comes last.
        let most = BOXES.saturating_mul(*boxes).saturating_add(MORE_BOXES);
        let on_measured = self.on_measured(terms).ok_or(CertifyError::Continuum { score: *score, boxes: 0 })?;
        let continuum = survey.continuum(self.problem, &on_measured);
        let held = continuum.map(|continuum| continuum.holds(*score, most)).ok().filter(|held| held.is_proven);
        held.map_or(Err(CertifyError::Continuum { score: *score, boxes: most }), |_| Ok(bound))
    }

    /// Y on the information of what is estimated, packed, scenario by scenario; none where a criterion is of something else.
    fn on_measured(&self, stated: &[CertificateTerm]) -> Option<Vec<Vec<f64>>> {
        let mut scenarios = vec![vec![]; self.set_ups.len()];
        for (CertificateTerm { matrix, .. }, term) in stated.iter().zip(&self.terms) {
            let unit = |i: usize| match &term.source {
                Source::Intrinsics => Some(1.0),
                Source::InUnits(units) => Some(units[i]),
                Source::Zhang | Source::Diversity(_) => None,
            };
            let sum = &mut scenarios[term.scenario];
            sum.resize(matrix.len() * (matrix.len() + 1) / 2, 0.0);
            let pairs = (0..matrix.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
            for (sum, (i, j)) in sum.iter_mut().zip(pairs) {
                *sum += matrix[i][j] * unit(i)? * unit(j)?;
            }
        }
        Some(scenarios)
    }
}
