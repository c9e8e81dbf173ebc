//! Many simulated calibrations of one plan.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use thiserror::Error;

use super::chi_square::deviation_interval;
use super::simulation::{Scene, trial_seed};
use crate::calibration::{CalibrationError, CalibrationSettings, ObservationError, calibrate};
use crate::information::Unknowns;
use crate::target::Board;

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.99;

/// What is simulated.
#[derive(Clone, Copy)]
pub struct Trials<'a> {
    /// The nominal camera and the intrinsics to estimate. A calibration learns from the camera the lens model and the intrinsics
    /// that are not estimated.
    pub unknowns: Unknowns<'a>,
    /// The board.
    pub board: &'a Board,
    /// What is really there in a trial, by its number.
    pub scene: &'a (dyn Fn(usize) -> Scene + Sync),
    /// How each set is calibrated.
    pub settings: CalibrationSettings,
    /// Number of simulated sets.
    pub count: usize,
    /// Seed of the noise.
    pub seed: u64,
}

/// How the simulated sets are calibrated, where the corners scatter unequally.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weighing {
    /// By weights as the problem's noise has them.
    #[default]
    Weighted,
    /// Without, as OpenCV's `calibrateCamera` does.
    Unweighted,
}

/// What was predicted for the plan, p×p in the order of the unknowns.
#[derive(Debug, Clone, Copy)]
pub struct Prediction<'a> {
    /// Covariance of the estimated intrinsics.
    pub covariance: &'a DMatrix<f64>,
    /// `W`: `√(δᵀWδ)` is the map error, px, of a deviation δ of the estimated intrinsics.
    pub map_weight: &'a DMatrix<f64>,
}

/// Why there is nothing to run.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MonteCarloError {
    /// A matrix of the prediction is not p×p for the p estimated intrinsics.
    #[error("the {matrix} is {rows} x {columns}; {expected} intrinsics are estimated")]
    Shape {
        /// Which matrix.
        matrix: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Estimated intrinsics.
        expected: usize,
    },
    /// A predicted variance is not positive.
    #[error("the {name} is {value}; it must be positive and finite")]
    NotPositive {
        /// What it is.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An estimated intrinsic that the camera does not have.
    #[error("cannot estimate intrinsic {index} of a camera that has {count}")]
    Parameter {
        /// The index given.
        index: usize,
        /// Parameters of the model.
        count: usize,
    },
}

/// Why a trial gave no camera.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrialFailure {
    /// The simulated corners cannot be calibrated from.
    #[error(transparent)]
    Observations(#[from] ObservationError),
    /// The calibration failed.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The refinement did not converge.
    #[error("not converged after {iterations} iterations")]
    NotConverged {
        /// Steps tried.
        iterations: usize,
    },
}

/// A trial that gave no camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// The trial, from 0.
    pub trial: usize,
    /// The reason.
    pub reason: TrialFailure,
}

/// One intrinsic over all trials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterStatistics {
    /// Its name.
    pub name: &'static str,
    /// Its nominal value.
    pub nominal: f64,
    /// Mean of the estimates less the true value.
    pub bias: f64,
    /// Standard deviation of the estimates about their mean.
    pub sampled_sigma: f64,
    /// The predicted standard deviation.
    pub predicted_sigma: f64,
    /// Sampled over predicted.
    pub ratio: f64,
    /// 99 % confidence interval of the ratio.
    pub interval: (f64, f64),
}

/// The map error over all trials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapError {
    /// Root mean square of the measured map errors, px.
    pub measured: f64,
    /// `√tr(W·covariance)`, px.
    pub predicted: f64,
    /// The measured map error's standard error, px.
    pub standard_error: f64,
}

/// What the trials showed.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarlo {
    /// Each estimated intrinsic, in the order of the unknowns.
    pub parameters: Vec<ParameterStatistics>,
    /// Sampled covariance of the estimates, p×p.
    pub covariance: DMatrix<f64>,
    /// The map error.
    pub map_error: MapError,
    /// Root mean square of the trials' reprojection errors, px.
    pub rms: f64,
    /// Trials run.
    pub count: usize,
    /// Trials that gave no camera, in their order.
    pub failures: Vec<Failure>,
}

/// Simulates and calibrates `trials.count` sets of images on all cores. Each calibration sees the images and the
/// intrinsics that are not estimated, nothing else of the truth.
///
/// Statistics are NaN where fewer than two trials gave a camera.
///
/// `observer` is told the number of trials done, from any thread. The result does not depend on the number of threads.
///
/// # Errors
/// [`MonteCarloError`] when the prediction does not fit the trials. Failed trials are counted, not errors.
pub fn monte_carlo(
    trials: &Trials<'_>,
    prediction: &Prediction<'_>,
    observer: &(dyn Fn(usize) + Sync),
) -> Result<MonteCarlo, MonteCarloError> {
    check(trials, prediction)?;
    let done = AtomicUsize::new(0);
    let run = |trial: usize| {
        let outcome = run_trial(trials, trial);
        observer(done.fetch_add(1, Ordering::Relaxed) + 1);
        outcome
    };
    let outcomes: Vec<_> = (0..trials.count).into_par_iter().map(run).collect();

    let p = trials.unknowns.len();
    let mut failures = Vec::new();
    let mut deviations = Vec::with_capacity(trials.count);
    let mut mean_square = 0.0;
    for (trial, outcome) in outcomes.into_iter().enumerate() {
        match outcome {
            Ok((deviation, rms)) => {
                mean_square += rms * rms;
                deviations.push(deviation);
            }
            Err(reason) => failures.push(Failure { trial, reason }),
        }
    }
    let n = deviations.len() as f64;
    let bias = deviations.iter().fold(DVector::zeros(p), |sum, δ| sum + δ) / n;
    let scatter = deviations.iter().map(|δ| δ - &bias).fold(DMatrix::zeros(p, p), |sum, δ| sum + &δ * δ.transpose());
    let covariance = scatter / (n - 1.0);
    Ok(MonteCarlo {
        parameters: parameters(trials, prediction, &bias, &covariance, deviations.len()),
        map_error: map_error(&deviations, prediction),
        covariance,
        rms: (mean_square / n).sqrt(),
        count: trials.count,
        failures,
    })
}

/// What is kept of a trial: the estimates less the true values, and the RMS reprojection error. A calibration as a whole is
/// a hundred times as large.
fn run_trial(trials: &Trials<'_>, trial: usize) -> Result<(DVector<f64>, f64), TrialFailure> {
    let Trials { unknowns: Unknowns { camera, estimated }, board, scene, settings, seed, .. } = trials;
    let scene = scene(trial);
    let observations = scene.observe(board, trial_seed(*seed, trial))?;
    let found = calibrate(&observations, camera, estimated, settings)?;
    if !found.convergence.converged {
        return Err(TrialFailure::NotConverged { iterations: found.convergence.iterations });
    }
    let (θ, truth) = (found.camera.intrinsics(), scene.camera.intrinsics());
    let deviations = estimated.iter().map(|&i| θ[i] - truth[i]);
    Ok((DVector::from_iterator(estimated.len(), deviations), found.rms))
}

fn parameters(
    trials: &Trials<'_>,
    prediction: &Prediction<'_>,
    bias: &DVector<f64>,
    covariance: &DMatrix<f64>,
    count: usize,
) -> Vec<ParameterStatistics> {
    let (low, high) = deviation_interval(count, CONFIDENCE);
    let (names, values) = (trials.unknowns.names(), trials.unknowns.values());
    let statistics = names.into_iter().zip(values).enumerate().map(|(i, (name, nominal))| {
        let sampled_sigma = covariance[(i, i)].sqrt();
        let predicted_sigma = prediction.covariance[(i, i)].sqrt();
        let ratio = sampled_sigma / predicted_sigma;
        ParameterStatistics {
            name,
            nominal,
            bias: bias[i],
            sampled_sigma,
            predicted_sigma,
            ratio,
            interval: (ratio * low, ratio * high),
        }
    });
    statistics.collect()
}

fn map_error(deviations: &[DVector<f64>], prediction: &Prediction<'_>) -> MapError {
    let W = prediction.map_weight;
    let squares: Vec<f64> = deviations.iter().map(|δ| δ.dot(&(W * δ))).collect();
    let n = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / n;
    let variance = squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let measured = mean.sqrt();
    MapError {
        measured,
        predicted: (W * prediction.covariance).trace().sqrt(),
        // d√m = dm / 2√m.
        standard_error: (variance / n).sqrt() / (2.0 * measured),
    }
}

fn check(trials: &Trials<'_>, prediction: &Prediction<'_>) -> Result<(), MonteCarloError> {
    let expected = trials.unknowns.len();
    for (matrix, M) in [("predicted covariance", prediction.covariance), ("map weight", prediction.map_weight)] {
        let (rows, columns) = M.shape();
        if (rows, columns) != (expected, expected) {
            return Err(MonteCarloError::Shape { matrix, rows, columns, expected });
        }
    }
    let Unknowns { camera, estimated } = trials.unknowns;
    let count = camera.intrinsics().len();
    if let Some(&index) = estimated.iter().find(|&&j| j >= count) {
        return Err(MonteCarloError::Parameter { index, count });
    }
    if let Some(&value) = prediction.covariance.diagonal().iter().find(|&&v| !(v > 0.0 && v.is_finite())) {
        return Err(MonteCarloError::NotPositive { name: "predicted variance", value });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use crate::spatial::Pose;

    use super::*;
    use crate::calibration::{Start, refine};
    use crate::camera::{Camera, Lens};
    use crate::information::{Noise, NoiseModel};
    use crate::target::{Corners, Surface};

    const BOARD: Board = Board::checkerboard(8, 6, 0.035);

    fn camera() -> Camera {
        let θ = [1000.0, 1000.0, 639.5, 479.5, -0.2, 0.05, 0.0, 0.0, 0.0];
        Camera::new(Lens::BrownConrady, 1280, 960, &θ).unwrap()
    }

    /// Tilted views that fill the image's four corners and its middle.
    fn poses() -> Vec<Pose> {
        let pose = |i: usize| {
            let φ = 2.4 * i as f64;
            let tilt = Pose::rotation(0.6 * Vector3::new(φ.cos(), φ.sin(), 0.0));
            let place = Pose::translation(0.1 * (2.0 * φ).cos(), 0.06 * (3.0 * φ).sin(), 0.45 + 0.01 * i as f64);
            place * tilt * Pose::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0))
        };
        (0..12).map(pose).collect()
    }

    /// The covariance at the truth: that of a refinement of noise-free corners, brought to `sigma`.
    fn predicted(estimated: &[usize], sigma: f64) -> DMatrix<f64> {
        let noise = Noise { sigma: 1e-4, model: NoiseModel::Constant };
        let observations = crate::verification::simulate(&camera(), &BOARD, &poses(), noise, 0).unwrap();
        let start = Start { camera: camera(), poses: poses(), surface: Surface::FLAT };
        let found = refine(&observations, start, estimated, &CalibrationSettings::default()).unwrap();
        found.covariance * (sigma / found.sigma).powi(2)
    }

    #[test]
    fn sampled_deviations_are_the_predicted_ones_on_any_number_of_threads() {
        let estimated = [0, 1, 2, 3, 4, 5];
        let (camera, poses) = (camera(), poses());
        let sigma = 0.3;
        let covariance = predicted(&estimated, sigma);
        let map_weight = covariance.clone().cholesky().unwrap().inverse();
        let trials = Trials {
            unknowns: Unknowns { camera: &camera, estimated: &estimated },
            board: &BOARD,
            scene: &|_| Scene {
                camera: camera.clone(),
                poses: poses.clone(),
                seen: vec![Corners::All; poses.len()],
                sigma: vec![sigma; poses.len()],
                noise: NoiseModel::Constant,
                missing: 0.0,
                surface: Surface::FLAT,
            },
            settings: CalibrationSettings::default(),
            count: 400,
            seed: 5,
        };
        let prediction = Prediction { covariance: &covariance, map_weight: &map_weight };
        let last = AtomicUsize::new(0);
        let observer = |done: usize| {
            last.fetch_max(done, Ordering::Relaxed);
        };
        let found = monte_carlo(&trials, &prediction, &observer).unwrap();
        assert_eq!(last.into_inner(), 400);
        assert!(found.failures.is_empty(), "{:?}", found.failures);
        for parameter in &found.parameters {
            let (low, high) = parameter.interval;
            assert!(low < 1.0 && 1.0 < high, "{parameter:?}");
            // The mean of 400 samples, at four deviations.
            assert!(parameter.bias.abs() < 0.2 * parameter.sampled_sigma, "{parameter:?}");
        }
        // W is the inverse of the prediction: the squared map error has the mean p.
        assert!((found.map_error.predicted - 6f64.sqrt()).abs() < 1e-9);
        assert!((found.map_error.measured - found.map_error.predicted).abs() < 4.0 * found.map_error.standard_error);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let again = alone.install(|| monte_carlo(&trials, &prediction, &|_| {})).unwrap();
        assert_eq!(again, found);
    }

    #[test]
    fn failed_trials_are_counted_with_their_reason() {
        // A lens with known distortion would betray the focal length even so.
        let camera = Camera::new(Lens::Pinhole, 1280, 960, &[1000.0, 1000.0, 639.5, 479.5]).unwrap();
        let estimated = [0, 1, 2, 3];
        let frontal = Pose::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        let poses = [0.5, 0.6, 0.7].map(|z| Pose::translation(0.0, 0.0, z) * frontal);
        let one = DMatrix::identity(4, 4);
        let trials = Trials {
            unknowns: Unknowns { camera: &camera, estimated: &estimated },
            board: &BOARD,
            scene: &|_| Scene {
                camera: camera.clone(),
                poses: poses.to_vec(),
                seen: vec![Corners::All; poses.len()],
                sigma: vec![0.3; poses.len()],
                noise: NoiseModel::Constant,
                missing: 0.0,
                surface: Surface::FLAT,
            },
            settings: CalibrationSettings::default(),
            count: 20,
            seed: 1,
        };
        let found = monte_carlo(&trials, &Prediction { covariance: &one, map_weight: &one }, &|_| {}).unwrap();
        assert_eq!(found.failures.len(), 20);
        for failure in &found.failures {
            let parallel = matches!(failure.reason, TrialFailure::Calibration(CalibrationError::ParallelBoards { .. }));
            assert!(parallel, "{:?}", failure.reason);
        }
        let small = DMatrix::identity(3, 3);
        let error = monte_carlo(&trials, &Prediction { covariance: &small, map_weight: &one }, &|_| {}).unwrap_err();
        assert!(matches!(error, MonteCarloError::Shape { rows: 3, expected: 4, .. }));
    }
}
