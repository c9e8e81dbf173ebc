//! What a calibration is worth.

use super::other_lens::OtherLens;
use super::{AccuracyReached, Lacks};
use crate::calibration::{Calibration, LossKind};
use crate::figures::short;

/// Over this share of outliers something is wrong with the detections or the lens model.
const MANY_OUTLIERS: f64 = 0.01;

/// A lens that leaves the noise of a coordinate below this share of what another does fits, and the other does not.
const BETTER_LENS: f64 = 0.7;

/// Map error, px, that is good where nobody requests another: forty poses planned for the Servosila robot reach it.
pub(super) const GOOD_MAP_ERROR: f64 = 1.0;

/// Map error, px, that is fair: ten poses planned for any of the robots that ship reach it.
const FAIR_MAP_ERROR: f64 = 2.0;

/// The verdict on a calibration, the gravest that applies.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// It did not converge.
    NotConverged,
    /// Another lens fits.
    WrongLens(OtherLens),
    /// So many corners do not fit.
    Outliers(usize),
    /// Accuracies requested are missed.
    Missed(Vec<AccuracyReached>),
    /// The map error is larger than ten well chosen views leave it.
    Weak,
    /// More views would pay.
    Fair,
    /// Nothing speaks against it.
    Good,
}

impl Judgement {
    /// Judges `calibration` of so many corners, with the map error and whatever accuracies are requested.
    pub(super) fn new(
        calibration: &Calibration,
        corners: usize,
        other: Option<OtherLens>,
        map_error: f64,
        requested: &[AccuracyReached],
    ) -> Self {
        let missed: Vec<_> = requested.iter().filter(|w| w.reached > w.limit).cloned().collect();
        let outliers = calibration.outliers.len();
        if !calibration.convergence.converged {
            Self::NotConverged
        } else if let Some(other) = other.filter(|other| other.sigma < BETTER_LENS * calibration.sigma) {
            Self::WrongLens(other)
        } else if outliers as f64 > MANY_OUTLIERS * corners as f64 {
            Self::Outliers(outliers)
        } else if !missed.is_empty() {
            Self::Missed(missed)
        } else if requested.is_empty() && map_error > FAIR_MAP_ERROR {
            Self::Weak
        } else if requested.is_empty() && map_error > GOOD_MAP_ERROR {
            Self::Fair
        } else {
            Self::Good
        }
    }

    /// Its name in the document.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NotConverged => "not converged",
            Self::WrongLens(_) => "wrong lens",
            Self::Outliers(_) => "outliers",
            Self::Missed(_) => "missed",
            Self::Weak => "weak",
            Self::Fair => "fair",
            Self::Good => "good",
        }
    }

    /// Whether the camera should not be used as it is.
    pub fn is_bad(&self) -> bool {
        matches!(self, Self::NotConverged | Self::WrongLens(_) | Self::Missed(_))
    }

    /// The verdict in a sentence or two.
    pub(super) fn sentence(&self, calibration: &Calibration, loss: LossKind, map_error: f64, lacks: &Lacks) -> String {
        let (error, noise) = (short(map_error), short(calibration.sigma));
        match self {
            Self::NotConverged => format!(
                "Do not use this camera: the calibration did not converge in {} iterations. Estimate fewer coefficients, \
                 as in `--fix k3=0`, or choose another lens model.",
                calibration.convergence.iterations
            ),
            Self::WrongLens(OtherLens { lens, rms, .. }) => format!(
                "Do not use this camera: the lens {} does not fit. With `--lens {}` the residuals' RMS is {} px instead of {} px.",
                calibration.camera.lens().name(),
                lens.name(),
                short(*rms),
                short(calibration.rms),
            ),
            Self::Outliers(count) => {
                let loss = match loss {
                    LossKind::Squared => "; `--loss cauchy` withstands a few",
                    LossKind::Huber | LossKind::Cauchy => ", and leave out wrong detections",
                };
                format!(
                    "Doubtful: {count} corners do not fit. Look at the images named, or at another lens model{loss}."
                )
            }
            Self::Missed(missed) => {
                let each = |AccuracyReached { what, limit, reached }: &AccuracyReached| {
                    format!("{what} is {}, but {limit} is requested", short(*reached))
                };
                let missed = missed.iter().map(each).collect::<Vec<_>>().join(", ");
                format!("Not accurate enough: {missed}.{lacks}")
            }
            Self::Weak => format!(
                "Weak: over the image, the camera is known only to {error} px, while corners are detected to {noise} px.{lacks}"
            ),
            Self::Fair => format!(
                "Fair: over the image, the camera is known to {error} px, and corners are detected to {noise} px. More views would help.{lacks}"
            ),
            Self::Good => {
                format!(
                    "Good: over the image, the camera is known to {error} px, and corners are detected to {noise} px."
                )
            }
        }
    }
}
