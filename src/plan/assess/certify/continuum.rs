//! The bound over all joint values, proven again.

use super::bound::Matrices;
use super::compare::{number, other, same};
use super::error::CertifyError;
use super::evidence::{Evidence, Rounded, Source};
use super::function::ROUNDING;
use super::{SAME, trusted};
use crate::plan::document::{CertificateTerm, ContinuumDocument, PicturePrice};
use crate::plan::survey::{PricedPictures, Survey};

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
            balls,
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
        let priced = self.pictures(balls)?;
        let paid: f64 = priced.iter().map(|priced| priced.price).sum();
        let log = (given + paid + count as f64 * score).ln() + 2.0 * ROUNDING - least;
        let bound = Rounded { log, uncertainty: greatest - least };
        trusted("the bound at all joint values", bound.uncertainty)?;
        self.equal("the bound at all joint values", *stated_bound, log, SAME + bound.uncertainty)?;
        let found = (value - self.log_of(*stated_bound)).exp();
        number("the efficiency at all joint values", *efficiency, found, SAME + bound.uncertainty)?;
        // What takes longest comes last.
        let most = BOXES.saturating_mul(*boxes).saturating_add(MORE_BOXES);
        let on_measured = self.on_measured(terms).ok_or(CertifyError::Continuum { score: *score, boxes: 0 })?;
        let continuum = survey.continuum(self.problem, &on_measured, &priced);
        let held = continuum.map(|continuum| continuum.holds(*score, most)).ok().filter(|held| held.is_proven);
        held.map_or(Err(CertifyError::Continuum { score: *score, boxes: most }), |_| Ok(bound))
    }

    /// The balls of pictures; refused where they are out of their order, or a price is none.
    fn pictures(&self, balls: &[PicturePrice]) -> Result<Vec<PricedPictures>, CertifyError> {
        let what = "a ball of pictures at all joint values";
        let dof = self.problem.robot.chain.dof();
        for PicturePrice { between_rad, price } in balls {
            if !(price.is_finite() && *price > 0.0) {
                return Err(other("a price at all joint values", price, "positive"));
            }
            if between_rad.iter().any(|q| q.len() != dof || q.iter().any(|q| !q.is_finite())) {
                return Err(other(what, &format!("{between_rad:?}"), &format!("{dof} joint values, twice")));
            }
        }
        if !balls.is_empty() && self.problem.picture_separation() == 0.0 {
            return Err(other(what, &"one", "none, for pictures may be as near as they like"));
        }
        let priced: Vec<PricedPictures> = balls.iter().map(PicturePrice::priced).collect();
        let is_in_order = priced.is_sorted_by(|a, b| a.by_joints(b).is_lt());
        let is_as_stated = balls.iter().zip(&priced).all(|(ball, priced)| ball.between_rad == priced.between);
        if !is_in_order || !is_as_stated {
            return Err(other("the balls of pictures at all joint values", &"out of order", "ascending, each once"));
        }
        Ok(priced)
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
