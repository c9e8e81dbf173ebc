//! A plan that was written, found again in a survey of its problem.

use thiserror::Error;

use super::choice::{Chooser, PlanError};
use super::document::Plan;
use super::objective::ACCURACY;
use super::survey::Survey;
use crate::figures::grouped;
use crate::information::Criterion;
use crate::problem::Problem;

/// Why a plan does not fit the survey.
#[derive(Debug, Error)]
pub enum RecallError {
    /// A pose is no view.
    #[error("its pose {id} is not among the {} configurations that see the board", grouped(*views))]
    NotAView {
        /// The pose's id.
        id: usize,
        /// Number of views.
        views: usize,
    },
    /// A pose's joint values are not those of its id.
    #[error("the joint values of its pose {id} are not those of the swept configuration {id}")]
    Moved {
        /// The pose's id.
        id: usize,
    },
    /// A pose is in the plan twice.
    #[error("its pose {id} is in it twice")]
    Twice {
        /// The pose's id.
        id: usize,
    },
    /// What it optimises is not known.
    #[error("it optimises \"{criterion}\", which is no criterion of the problem")]
    Criterion {
        /// What it says.
        criterion: String,
    },
    /// The problem's constraints or criteria cannot be held.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

impl Plan {
    /// The chooser that made the plan, by its criteria or by the accuracies that the problem wishes for, and its poses as
    /// indices into the survey's views, in the plan's order.
    ///
    /// # Errors
    /// When a pose is no view of the survey, or the criteria are not known.
    pub fn recall<'a>(
        &self,
        problem: &'a Problem,
        survey: &'a Survey,
    ) -> Result<(Chooser<'a>, Vec<usize>), RecallError> {
        let chooser = Chooser::new(problem, survey)?;
        let chooser = match self.criteria() {
            Some(criteria) => chooser.by(&criteria)?,
            None if self.criterion == ACCURACY && !problem.selection.accuracies.is_empty() => chooser.by_accuracies(),
            None => return Err(RecallError::Criterion { criterion: self.criterion.clone() }),
        };
        Ok((chooser, self.places(survey)?))
    }

    /// The criteria that the plan optimises and their shares; `None` for accuracies, and where a name is not known or the
    /// shares are not positive and of sum one.
    pub fn criteria(&self) -> Option<Vec<(Criterion, f64)>> {
        let named = |name: &str| Criterion::ALL.into_iter().find(|criterion| criterion.name() == name);
        let terms = self.certificate.terms.iter();
        let criteria: Option<Vec<_>> = terms.map(|term| Some((named(&term.criterion)?, term.share))).collect();
        criteria.filter(|criteria| {
            let sum: f64 = criteria.iter().map(|(_, share)| share).sum();
            criteria.iter().all(|&(_, share)| share > 0.0) && (sum - 1.0).abs() < 1e-9
        })
    }

    /// The poses' places among the survey's views, whose joint values must be theirs.
    fn places(&self, survey: &Survey) -> Result<Vec<usize>, RecallError> {
        let views = &survey.views;
        let mut places = Vec::with_capacity(self.poses.len());
        for pose in &self.poses {
            let id = pose.id;
            let place = views.binary_search_by_key(&id, |view| view.id);
            let place = place.map_err(|_| RecallError::NotAView { id, views: views.len() })?;
            let q = &views[place].q;
            let same = pose.joints_rad.iter().zip(q).all(|(a, b)| (a - b).abs() <= 1e-12);
            if pose.joints_rad.len() != q.len() || !same {
                return Err(RecallError::Moved { id });
            }
            if places.contains(&place) {
                return Err(RecallError::Twice { id });
            }
            places.push(place);
        }
        Ok(places)
    }
}
