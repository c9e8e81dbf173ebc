//! The next poses, given what is already known.

use super::choice::{Chooser, PlanError};
use super::document::PlannedPose;
use super::refine::candidates;
use crate::calibration::Calibration;
use crate::problem::Problem;
use crate::selection::Method;

/// How many poses to propose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wish {
    /// So many.
    Count(usize),
    /// As few as bring the expected RMS map error, px, down to `map_error`, at most `most`.
    Accuracy {
        /// The map error wished for, px.
        map_error: f64,
        /// Most poses to propose.
        most: usize,
    },
}

/// Poses to take next.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// Map error by what is known, px.
    pub known: f64,
    /// Map error expected after the poses, px; no larger than `known`.
    pub expected: f64,
    /// Whether the wish is fulfilled.
    pub fulfilled: bool,
    /// The poses; none if what is known suffices.
    pub poses: Vec<PlannedPose>,
}

/// Proposes the poses of `problem` that teach most beside what `calibration` of the views taken so far knows. The candidates
/// are surveyed anew with the calibrated camera and its noise.
///
/// # Errors
/// When there are no views to choose from, or the calibration's covariance is not positive definite.
pub fn next(
    problem: &Problem,
    calibration: &Calibration,
    wish: Wish,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<Proposal, PlanError> {
    let problem = Problem { camera: calibration.camera.clone(), noise: calibration.sigma, ..problem.clone() };
    let survey = candidates(&problem, observe)?;
    let known = (&survey.map_weight * &calibration.covariance).trace().sqrt();
    let prior = calibration.covariance.clone().cholesky().ok_or(PlanError::Covariance)?.inverse();
    let chooser = Chooser::new(&problem, &survey)?.with_prior(&prior)?;
    let (counts, goal) = match wish {
        Wish::Count(count) => (count..=count, f64::INFINITY),
        Wish::Accuracy { map_error, .. } if known <= map_error => {
            return Ok(Proposal { known, expected: known, fulfilled: true, poses: vec![] });
        }
        Wish::Accuracy { map_error, most } => {
            let fewest = problem.constraints.required.len().max(1);
            (fewest..=most.min(survey.views.len()).max(fewest), map_error)
        }
    };
    let mut proposal = Proposal { known, expected: known, fulfilled: false, poses: vec![] };
    for count in counts {
        let choice = chooser.choose(Method::Exchange, count, problem.selection.seed)?;
        let shares = chooser.shares(&choice.selected)?;
        let poses = choice.selected.iter().zip(shares);
        proposal = Proposal {
            known,
            expected: choice.map_error,
            fulfilled: choice.map_error <= goal,
            poses: poses.map(|(&i, share)| PlannedPose::new(&problem, &survey.views[i], share)).collect(),
        };
        if proposal.fulfilled {
            break;
        }
    }
    Ok(proposal)
}
