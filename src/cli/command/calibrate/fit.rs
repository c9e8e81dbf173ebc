//! The fit itself, and whether another lens fits better.

use super::parameters::Model;
use super::{Failure, LossName};
use crate::calibration::{
    Calibration, CalibrationError, CalibrationSettings, Loss, Observations, RefinementSettings, calibrate,
};
use crate::camera::{Camera, Lens};

/// Scale, px, of a robust loss before the noise is known.
const FIRST_SCALE: f64 = 1.0;

/// Iterations after which another lens is given up.
const OTHER_ITERATIONS: usize = 60;

/// The first lens tried is taken before one that leaves less noise than so.
const ALIKE: f64 = 1.05;

/// A lens and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OtherLens {
    pub(super) lens: Lens,
    pub(super) rms: f64,
    pub(super) sigma: f64,
}

/// A robust loss takes its scale from the noise, and the noise from a first calibration.
pub(super) fn fit(observations: &Observations, model: &Model, loss: LossName) -> Result<Calibration, CalibrationError> {
    let with = |loss: Loss| {
        let refinement = RefinementSettings { loss, ..RefinementSettings::default() };
        let settings = CalibrationSettings { refinement, ties: model.ties, ..CalibrationSettings::default() };
        calibrate(observations, &model.nominal, &model.estimated, &settings)
    };
    // The usual choices: about 95 % efficient under Gaussian noise.
    let (robust, tuning): (fn(f64) -> Loss, f64) = match loss {
        LossName::Squared => return with(Loss::Squared),
        LossName::Huber => (|scale| Loss::Huber { scale }, 1.345),
        LossName::Cauchy => (|scale| Loss::Cauchy { scale }, 2.385),
    };
    let noise = with(robust(FIRST_SCALE))?.sigma;
    with(robust((tuning * noise).max(1e-6)))
}

/// The lens with distortion, other than `lens`, that fits best; of those that fit alike the one with fewer coefficients.
pub(super) fn other_lens(observations: &Observations, lens: Lens) -> Option<OtherLens> {
    let others: &[Lens] = match lens {
        Lens::Pinhole | Lens::Rational => &[Lens::BrownConrady, Lens::KannalaBrandt],
        Lens::BrownConrady => &[Lens::KannalaBrandt, Lens::Rational],
        Lens::KannalaBrandt => &[Lens::BrownConrady],
    };
    let refinement = RefinementSettings { max_iterations: OTHER_ITERATIONS, ..RefinementSettings::default() };
    let settings = CalibrationSettings { refinement, ..CalibrationSettings::default() };
    let fitted = others.iter().filter_map(|&lens| {
        let nominal = unknown_camera(lens, observations).ok()?;
        let all: Vec<usize> = (0..nominal.intrinsics().len()).collect();
        let found = calibrate(observations, &nominal, &all, &settings).ok().filter(|f| f.convergence.converged)?;
        Some(OtherLens { lens, rms: found.rms, sigma: found.sigma })
    });
    let fitted: Vec<OtherLens> = fitted.collect();
    let least = fitted.iter().map(|other| other.sigma).fold(f64::INFINITY, f64::min);
    fitted.into_iter().find(|other| other.sigma <= ALIKE * least)
}

/// A camera of which nothing but image size and lens is known.
pub(super) fn unknown_camera(lens: Lens, observations: &Observations) -> Result<Camera, Failure> {
    let mut θ = vec![0.0; lens.parameter_names().len()];
    θ[..2].fill(1.0);
    Camera::new(lens, observations.width(), observations.height(), &θ)
        .map_err(|error| Failure::Usage(error.to_string()))
}
