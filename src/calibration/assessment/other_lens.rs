//! Whether another lens fits better.

use crate::calibration::{CalibrationSettings, Observations, RefinementSettings, calibrate};
use crate::camera::{Camera, CameraError, Lens};
use crate::target::Warp;

/// Iterations after which another lens is given up.
const ITERATIONS: usize = 60;

/// The first lens tried is taken before one that leaves less noise than so.
const ALIKE: f64 = 1.05;

/// A lens and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherLens {
    /// The lens.
    pub lens: Lens,
    /// RMS length of the residuals that it leaves, px.
    pub rms: f64,
    /// Standard deviation of one coordinate of a corner by it, px.
    pub sigma: f64,
}

/// The lens with distortion, other than `lens`, that fits best a board that may bulge so; of those that fit alike the one with
/// fewer coefficients.
pub fn other_lens(observations: &Observations, lens: Lens, warp: Option<Warp>) -> Option<OtherLens> {
    let others: &[Lens] = match lens {
        Lens::Pinhole | Lens::Rational => &[Lens::BrownConrady, Lens::KannalaBrandt],
        Lens::BrownConrady => &[Lens::KannalaBrandt, Lens::Rational],
        Lens::KannalaBrandt => &[Lens::BrownConrady],
    };
    let refinement = RefinementSettings { max_iterations: ITERATIONS, ..RefinementSettings::default() };
    let settings = CalibrationSettings { refinement, warp, ..CalibrationSettings::default() };
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
///
/// # Errors
/// When the observations' images are too large for a camera.
pub fn unknown_camera(lens: Lens, observations: &Observations) -> Result<Camera, CameraError> {
    let mut θ = vec![0.0; lens.parameter_names().len()];
    θ[..2].fill(1.0);
    Camera::new(lens, observations.width(), observations.height(), &θ)
}
