//! The next poses, given what is already known.

use rayon::prelude::*;

mod rehearsal;
mod retaken;

pub use rehearsal::Rehearsal;

use crate::calibration::{Calibration, Observations};
use crate::feasibility::View;
use crate::information::Noise;
use crate::plan::choose::{Chooser, PlanError, refined_survey};
use crate::plan::document::{
    Document, EstimatedIntrinsics, NextDocument, Plan, PlannedPose, SimulatedMapError, finite, poses_csv,
};
use crate::problem::{Method, PoseConstraints, Problem, Uncertainty};
use rehearsal::rehearse;
use retaken::Taken;

/// How many poses to propose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// So many.
    Count(usize),
    /// As few as bring the expected RMS map error, px, down to `map_error`, at most `most`.
    Accuracy {
        /// The map error requested, px.
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
    /// Map error expected after the poses, px; no larger than `known`. Both are linearised about the camera found so far.
    pub expected: f64,
    /// What simulated calibrations with these poses came to, with cameras drawn from what is known; none without poses.
    pub rehearsal: Option<Rehearsal>,
    /// Whether the request is fulfilled.
    pub fulfilled: bool,
    /// The poses; none if what is known suffices.
    pub poses: Vec<PlannedPose>,
    /// For each of them the view taken that it would repeat.
    pub repeats: Vec<Option<usize>>,
}

impl Proposal {
    /// The poses as CSV, as those of `plan.csv`.
    ///
    /// # Errors
    /// Never in practice: the writer writes to memory.
    pub fn to_csv(&self, problem: &Problem) -> Result<Vec<u8>, csv::Error> {
        poses_csv(&problem.robot.chain.joints, &self.poses)
    }

    /// What is written of the poses proposed beside those of `plan`, with the `calibration` of the views taken so far and their
    /// `names`.
    pub fn document(&self, plan: &Plan, calibration: &Calibration, names: &[String]) -> NextDocument {
        let name = |view: usize| names.get(view).cloned();
        NextDocument {
            header: NextDocument::header(),
            problem: plan.problem.clone(),
            views: names.len(),
            pictures: plan.pictures,
            intrinsics: EstimatedIntrinsics::new(calibration),
            known_map_error_px: finite(self.known),
            expected_map_error_px: finite(self.expected),
            simulated_map_error_px: self.rehearsal.map(|simulated| SimulatedMapError {
                trials: simulated.trials,
                failed: simulated.failed,
                median: simulated.median,
                percentile_90: simulated.percentile_90,
                rms: simulated.rms,
            }),
            fulfilled: self.fulfilled,
            joints: plan.joints.clone(),
            poses: self.poses.clone(),
            repeats: self.repeats.iter().map(|view| view.and_then(name)).collect(),
        }
    }
}

/// The problem with what `calibration` found of camera and noise in the place of what is stated.
pub(super) fn after(problem: &Problem, calibration: &Calibration) -> Problem {
    let mut problem = Problem {
        camera: calibration.camera.clone(),
        noise: Noise { sigma: calibration.sigma, model: problem.noise.model.through(&calibration.camera) },
        ..problem.clone()
    };
    // Of the camera more is known now than was stated.
    if let Some(robust) = &mut problem.robust {
        let Uncertainty { focal_length, principal_point, intrinsics, .. } = &mut robust.uncertainty;
        (*focal_length, *principal_point) = (0.0, 0.0);
        intrinsics.clear();
    }
    problem.robust = problem.robust.filter(|robust| !robust.uncertainty.is_none());
    problem
}

/// Proposes the poses of `problem` that teach most beside what `calibration` of the views taken so far, `observations`, knows; only
/// such that repeat none of those views if `is_new`. The candidates are surveyed anew with the calibrated camera and its noise.
///
/// # Errors
/// When there are no views to choose from, or the calibration's covariance is not positive definite.
pub fn next(
    problem: &Problem,
    observations: &Observations,
    calibration: &Calibration,
    request: Request,
    is_new: bool,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<Proposal, PlanError> {
    let mut problem = after(problem, calibration);
    let survey = refined_survey(&problem, observe)?;
    let taken = Taken::new(observations, &calibration.camera);
    if is_new {
        let repeated = survey.views.par_iter().filter(|view| taken.like(view).is_some()).map(|view| view.id);
        let repeated: Vec<usize> = repeated.collect();
        let PoseConstraints { required, forbidden, .. } = &mut problem.constraints;
        forbidden.extend(repeated.into_iter().filter(|id| !required.contains(id)));
        forbidden.sort_unstable();
        forbidden.dedup();
    }
    let problem = problem;
    let known = (&survey.map_weight * &calibration.covariance).trace().sqrt();
    let mut prior = calibration.joint_covariance.clone().cholesky().ok_or(PlanError::Covariance)?.inverse();
    // What was expected of the board's heights is known without the calibration too.
    for height in 0..problem.measurement().nuisance() {
        prior[(height, height)] -= 1.0;
    }
    let chooser = Chooser::new(&problem, &survey)?.with_prior(&prior)?;
    let nothing =
        Proposal { known, expected: known, rehearsal: None, fulfilled: false, poses: vec![], repeats: vec![] };
    let (counts, goal) = match request {
        Request::Count(count) => (count..=count, f64::INFINITY),
        Request::Accuracy { map_error, .. } if known <= map_error => {
            return Ok(Proposal { fulfilled: true, ..nothing });
        }
        Request::Accuracy { map_error, most } => {
            let fewest = problem.constraints.required.len().max(1);
            (fewest..=most.min(survey.views.len()).max(fewest), map_error)
        }
    };
    let mut chosen = None;
    for count in counts {
        let choice = chooser.choose(Method::Exchange, count, problem.selection.seed)?;
        let is_enough = choice.map_error <= goal;
        chosen = Some(choice);
        if is_enough {
            break;
        }
    }
    let Some(choice) = chosen else { return Ok(nothing) };
    let shares = chooser.shares(&choice.selected)?;
    let views: Vec<&View> = choice.selected.iter().map(|&i| &survey.views[i]).collect();
    let pictures = |&view| std::iter::repeat_n(view, problem.selection.pictures);
    let pictured: Vec<&View> = views.iter().flat_map(pictures).collect();
    Ok(Proposal {
        expected: choice.map_error,
        rehearsal: rehearse(observations, calibration, &pictured, &survey.map_weight, problem.selection.seed),
        fulfilled: choice.map_error <= goal,
        poses: views.iter().zip(shares).map(|(view, share)| PlannedPose::new(&problem, view, share)).collect(),
        repeats: views.iter().map(|view| taken.like(view)).collect(),
        ..nothing
    })
}
