//! Calibration by a loss whose scale nobody has to know.

use super::{Calibration, CalibrationError, CalibrationSettings, Loss, Observations, RefinementSettings, calibrate};
use crate::camera::Camera;

/// Scale, px, of a robust loss before the noise is known.
const FIRST_SCALE: f64 = 1.0;

/// Least scale, px.
const LEAST_SCALE: f64 = 1e-6;

/// A loss, whatever its scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LossKind {
    /// [`Loss::Squared`].
    Squared,
    /// [`Loss::Huber`].
    Huber,
    /// [`Loss::Cauchy`].
    Cauchy,
}

/// Calibrates by a loss of that kind, else as `settings` say. A robust loss takes its scale from the noise, and the noise from a first
/// calibration.
///
/// # Errors
/// As [`calibrate`].
pub fn calibrate_by(
    loss: LossKind,
    observations: &Observations,
    nominal: &Camera,
    estimated: &[usize],
    settings: &CalibrationSettings,
) -> Result<Calibration, CalibrationError> {
    let with = |loss: Loss| {
        let refinement = RefinementSettings { loss, ..settings.refinement };
        let settings = CalibrationSettings { refinement, ..*settings };
        calibrate(observations, nominal, estimated, &settings)
    };
    // The usual choices: about 95 % efficient under Gaussian noise.
    let (robust, tuning): (fn(f64) -> Loss, f64) = match loss {
        LossKind::Squared => return with(Loss::Squared),
        LossKind::Huber => (|scale| Loss::Huber { scale }, 1.345),
        LossKind::Cauchy => (|scale| Loss::Cauchy { scale }, 2.385),
    };
    let noise = with(robust(FIRST_SCALE))?.sigma;
    with(robust((tuning * noise).max(LEAST_SCALE)))
}
