//! The accuracy at which a tour ends.

use thiserror::Error;

use crate::calibration::Request;
use crate::plan::document::Plan;
use crate::problem::{Accuracy, Problem};

/// By which share a calibration may miss what the plan promises. That is predicted for a nominal camera and a stated noise; both are
/// only estimated, and half of all plans that do as promised would miss it by a percent.
const PROMISE_MISSED: f64 = 0.1;

/// The accuracy at which a tour ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Until {
    /// What is to be reached, at least one.
    pub requests: Vec<Request>,
    /// Whether nobody asked for it: it is what the plan promises.
    pub is_promise: bool,
}

/// An accuracy of something that is not estimated.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{name}` has no accuracy here; give one of {}", .allowed.join(", "))]
pub struct UnknownAccuracy {
    /// Its name.
    pub name: String,
    /// Names that have one.
    pub allowed: Vec<&'static str>,
}

impl Until {
    /// What is `stated` by name, else what the problem requests, else what the plan promises.
    ///
    /// # Errors
    /// When something stated is neither the map error nor an intrinsic that is estimated.
    pub fn new(problem: &Problem, plan: &Plan, stated: &[(String, f64)]) -> Result<Self, UnknownAccuracy> {
        let names = problem.unknowns().names();
        let request = |(name, limit): &(String, f64)| match names.iter().position(|other| other == name) {
            Some(place) => Ok(Request::Sigma { intrinsic: problem.estimated[place], sigma: *limit }),
            None if name == Accuracy::MAP_ERROR => Ok(Request::MapError(*limit)),
            None => Err(UnknownAccuracy {
                name: name.clone(),
                allowed: std::iter::once(Accuracy::MAP_ERROR).chain(names.iter().copied()).collect(),
            }),
        };
        let mut requests = stated.iter().map(request).collect::<Result<Vec<_>, _>>()?;
        if requests.is_empty() {
            requests = problem.requests();
        }
        let is_promise = requests.is_empty();
        if is_promise {
            requests.push(Request::MapError(plan.map_error_px));
        }
        Ok(Self { requests, is_promise })
    }

    /// The map error to reach, px, where that is all there is to reach.
    pub(super) fn map_error_alone(&self) -> Option<f64> {
        match self.requests[..] {
            [Request::MapError(limit)] => Some(limit),
            _ => None,
        }
    }

    /// The share of what is to be reached that will do once all poses are taken.
    pub(super) fn share_in_the_end(&self) -> f64 {
        if self.is_promise { 1.0 + PROMISE_MISSED } else { 1.0 }
    }
}
