//! Simulated calibrations with the views taken and those proposed: what linearisation about a camera that is hardly known
//! cannot tell.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::calibration::{Calibration, CalibrationSettings, Observations, calibrate, pose_of_view};
use crate::camera::Camera;
use crate::feasibility::View;
use crate::target::{Corners, Surface};
use crate::verification::Scene;

/// Simulated calibrations.
const TRIALS: usize = 60;

/// What the simulated calibrations came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rehearsal {
    /// Calibrations simulated.
    pub trials: usize,
    /// Those that gave no camera.
    pub failed: usize,
    /// Half of the map errors are below this, px.
    pub median: f64,
    /// Nine tenths are, px.
    pub percentile_90: f64,
    /// Root mean square of all, px.
    pub rms: f64,
}

/// Simulates calibrations from the views of `observations` and the `proposed` ones. The true camera of each is drawn from what
/// `calibration` knows; the views taken are posed so that it sees in them what was seen, the proposed ones as planned.
///
/// `None` where less than half of them gave a camera, or the covariance is not positive definite.
pub(crate) fn rehearse(
    observations: &Observations,
    calibration: &Calibration,
    proposed: &[&View],
    W: &DMatrix<f64>,
    seed: u64,
) -> Option<Rehearsal> {
    let L = calibration.joint_covariance.clone().cholesky()?.unpack();
    let warp = calibration.surface.warp().copied();
    let error = |trial: usize| {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed.wrapping_add(trial as u64));
        let δ = &L * DVector::from_fn(L.nrows(), |_, _| rng.sample::<f64, _>(StandardNormal));
        let mut θ = calibration.camera.intrinsics().to_vec();
        let (heights, intrinsics) = δ.as_slice().split_at(δ.len() - calibration.estimated.len());
        for (&j, δ) in calibration.estimated.iter().zip(intrinsics) {
            θ[j] += δ;
        }
        let surface = calibration.surface.moved(heights);
        let truth = calibration.camera.with_intrinsics(&θ).ok()?;
        let scene = scene(observations, calibration, proposed, truth, surface)?;
        let seen = scene.observe(observations.board(), rng.r#gen()).ok()?;
        let estimated = &calibration.estimated;
        let settings = CalibrationSettings { noise: calibration.noise, warp, ..CalibrationSettings::default() };
        let found = calibrate(&seen, &calibration.camera, estimated, &settings).ok()?;
        let (found, truth) = (found.camera.intrinsics(), scene.camera.intrinsics());
        let deviation = DVector::from_iterator(estimated.len(), estimated.iter().map(|&j| found[j] - truth[j]));
        Some(deviation.dot(&(W * &deviation)).max(0.0).sqrt())
    };
    let mut errors: Vec<f64> = (0..TRIALS).into_par_iter().filter_map(error).collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |share: f64| errors.get((share * errors.len().saturating_sub(1) as f64).round() as usize).copied();
    (2 * errors.len() >= TRIALS).then_some(())?;
    Some(Rehearsal {
        trials: TRIALS,
        failed: TRIALS - errors.len(),
        median: quantile(0.5)?,
        percentile_90: quantile(0.9)?,
        rms: (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt(),
    })
}

/// What there is to see if `truth` is the camera and `surface` the board's face.
fn scene(
    observations: &Observations,
    calibration: &Calibration,
    proposed: &[&View],
    truth: Camera,
    surface: Surface,
) -> Option<Scene> {
    let taken = (0..observations.views().len()).map(|view| pose_of_view(observations, view, &truth));
    let mut poses = taken.collect::<Option<Vec<_>>>()?;
    poses.extend(proposed.iter().map(|view| view.X_CT));
    let seen = observations.views().iter().map(|view| {
        let mut indices: Vec<usize> = view.iter().map(|corner| corner.index).collect();
        indices.sort_unstable();
        Corners::Some(indices)
    });
    let seen: Vec<Corners> = seen.chain(proposed.iter().map(|view| view.seen.clone())).collect();
    let (sigma, noise) = (vec![calibration.sigma; poses.len()], calibration.noise);
    Some(Scene { camera: truth, sigma, noise, poses, seen, missing: 0.0, surface })
}
