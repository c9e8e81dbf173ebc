//! Simulated calibrations of a plan.

use nalgebra::DMatrix;
use thiserror::Error;

use crate::calibration::CalibrationSettings;
use crate::information::{NoiseModel, Unweighted};
use crate::problem::Problem;
use crate::selection::packed::unpack;
use crate::spatial::Pose;
use crate::target::Corners;
use crate::verification::{
    Disturbance, MonteCarlo, MonteCarloError, Nominal, Prediction, Trials, Weighing, monte_carlo,
};

/// Why a plan could not be verified.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VerifyError {
    /// A pose does not show the whole board to the nominal camera.
    #[error("from pose {pose} the nominal camera does not see every corner of the board")]
    NotSeen {
        /// The pose, from 1.
        pose: usize,
    },
    /// The poses leave a combination of the intrinsics undetermined.
    #[error("the {poses} poses do not determine all intrinsics, so nothing is predicted for them")]
    Unobservable {
        /// Number of poses.
        poses: usize,
    },
    /// The trials were refused.
    #[error(transparent)]
    MonteCarlo(#[from] MonteCarloError),
}

/// Simulates `count` calibrations from pictures taken at `configurations` (joint values in rad or m, one list per pose),
/// disturbed as told, calibrated as `weighing` says, and holds their scatter against the prediction for the undisturbed plan. `observe` is told the number
/// of trials done.
///
/// # Errors
/// When nothing is predicted for the poses. Failed trials are counted, not errors.
pub fn verify(
    problem: &Problem,
    configurations: &[Vec<f64>],
    disturbance: &Disturbance,
    weighing: Weighing,
    count: usize,
    seed: u64,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<MonteCarlo, VerifyError> {
    let Problem { robot, camera, target, noise, .. } = problem;
    let unknowns = problem.unknowns();
    let measurement = problem.measurement();
    let (nuisance, order) = (measurement.nuisance(), measurement.order());
    let mut M = DMatrix::from_fn(order, order, |i, j| if i == j && i < nuisance { 1.0 } else { 0.0 });
    let mut unweighted = Unweighted::new(&DMatrix::zeros(unknowns.len(), unknowns.len()));
    let mut seen = Vec::with_capacity(configurations.len());
    let checks = problem.visibility.min_corners.map(|_| problem.checks());
    for (i, q) in configurations.iter().enumerate() {
        let not_seen = VerifyError::NotSeen { pose: i + 1 };
        let corners = match &checks {
            Some(checks) => checks.view(i, q).map_err(|_| not_seen.clone())?.seen,
            None => Corners::All,
        };
        let X_CT: Pose = robot.camera_pose(q).inverse() * target.X_BT;
        let information = measurement.information(&X_CT, &corners).ok_or_else(|| not_seen.clone())?;
        unweighted.add(&measurement, &X_CT, &corners).ok_or(not_seen)?;
        seen.push(corners);
        M += unpack(&information, order);
    }
    let unobservable = VerifyError::Unobservable { poses: configurations.len() };
    let (covariance, model) = match weighing {
        Weighing::Weighted => (measurement.covariance(&M), noise.model),
        Weighing::Unweighted => (unweighted.covariance(), NoiseModel::Constant),
    };
    let covariance = covariance.ok_or(unobservable)?;
    let map_weight = unknowns.map_error_weight();
    let nominal = Nominal { robot, camera, target, noise: *noise };
    let repeated = |pose| std::iter::repeat_n(pose, problem.selection.pictures);
    let planned: Vec<_> = configurations.iter().zip(&seen).flat_map(repeated).collect();
    let scene = |trial| disturbance.scene(&nominal, &planned, seed, trial);
    let warp = match weighing {
        Weighing::Weighted => target.warp,
        Weighing::Unweighted => None,
    };
    let settings = CalibrationSettings { noise: model, warp, ..CalibrationSettings::default() };
    let trials = Trials { unknowns, board: &target.board, scene: &scene, settings, count, seed };
    Ok(monte_carlo(&trials, &Prediction { covariance: &covariance, map_weight: &map_weight }, observe)?)
}
