//! The accuracy that a plan's poses promise.

use nalgebra::DMatrix;

use super::bound::{inverse, uncertainty_of};
use super::compare::{number, numbers, same};
use super::error::CertifyError;
use super::{MOST_ROUNDING, SAME};
use crate::plan::choose::PlanError;
use crate::plan::choose::{captured, known};
use crate::plan::document::AccuracyDocument;
use crate::plan::document::Intrinsics;
use crate::plan::survey::Survey;
use crate::problem::{Accuracy, Problem};

/// What the poses' information predicts.
pub(crate) struct PredictedAccuracy {
    sigma: Vec<f64>,
    map_error: f64,
    names: Vec<&'static str>,
    nominal: Vec<f64>,
    /// Numbers agree to this share.
    pub(crate) tolerance: f64,
}

impl PredictedAccuracy {
    pub(crate) fn new(problem: &Problem, survey: &Survey, selected: &[usize]) -> Result<Self, CertifyError> {
        let captured = captured(problem).map_err(PlanError::from)?;
        let known: DMatrix<f64> = known(problem, &captured).map_err(PlanError::from)?;
        let M = selected.iter().fold(known, |M, &i| M + survey.information.matrix(i));
        let rounding = uncertainty_of(&M);
        if rounding.is_nan() || rounding > MOST_ROUNDING {
            return Err(CertifyError::Rounding { what: "the predicted accuracy", share: rounding });
        }
        let covariance = inverse(&M);
        Ok(Self {
            sigma: covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
            map_error: (&survey.map_weight * &covariance).trace().sqrt(),
            names: problem.unknowns().names(),
            nominal: problem.unknowns().values(),
            tolerance: SAME + rounding,
        })
    }

    pub(crate) fn is_that(&self, stated: &Intrinsics, map_error: f64) -> Result<(), CertifyError> {
        let Intrinsics { names, nominal, sigma } = stated;
        same("the list of intrinsics", &names.join(", "), &self.names.join(", "))?;
        numbers("nominal value", nominal, &self.nominal, |what, stated, found| same(what, &stated, &found))?;
        numbers("predicted sigma", sigma, &self.sigma, |what, stated, found| {
            number(what, stated, found, self.tolerance)
        })?;
        number("the map error", map_error, self.map_error, self.tolerance)
    }

    /// The accuracies that the problem wishes for, in its order, and what is reached.
    pub(crate) fn reached(&self, problem: &Problem) -> Vec<AccuracyDocument> {
        let reached = |&(accuracy, wished): &(Accuracy, f64)| match accuracy {
            Accuracy::MapError => AccuracyDocument { name: "map_error_px".into(), wished, reached: self.map_error },
            Accuracy::Intrinsic(j) => AccuracyDocument { name: self.names[j].into(), wished, reached: self.sigma[j] },
        };
        problem.selection.goal.accuracies().iter().map(reached).collect()
    }
}
