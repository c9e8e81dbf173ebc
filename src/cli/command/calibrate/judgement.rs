//! What a calibration is worth, and what it lacks.

use nalgebra::DMatrix;

use super::LossName;
use super::fit::OtherLens;
use crate::calibration::{Calibration, Coverage, Observations};
use crate::cli::output::short;
use crate::information::weakest;

/// Over this share of outliers something is wrong with the detections or the lens model.
const MANY_OUTLIERS: f64 = 0.01;

/// A lens that leaves the noise of a coordinate below this share of what another does fits, and the other does not.
const BETTER_LENS: f64 = 0.7;

/// Map error, px, that is good where nobody wishes for another: forty poses planned for the Servosila robot reach it.
const GOOD_MAP_ERROR: f64 = 1.0;

/// Map error, px, that is fair: ten poses planned for any of the robots that ship reach it.
const FAIR_MAP_ERROR: f64 = 2.0;

/// Boards tilted by less say little of the focal length, rad.
const ENOUGH_TILT: f64 = 0.45;

/// Boards whose tilts about an axis vary by less are all tilted about the other one, rad.
const ENOUGH_SPREAD: f64 = 0.12;

/// Intrinsics with at least this share of the largest are named in a combination.
const NAMED: f64 = 0.3;

/// An accuracy wished for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wished {
    /// What is to be accurate: `map error`, `sigma of fx`.
    pub(super) what: String,
    pub(super) limit: f64,
    pub(super) reached: f64,
}

/// The verdict on a calibration, the gravest that applies.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Judgement {
    /// It did not converge.
    NotConverged,
    /// Another lens fits.
    WrongLens(OtherLens),
    /// So many corners do not fit.
    Outliers(usize),
    /// Accuracies wished for are missed.
    Missed(Vec<Wished>),
    /// The map error is larger than ten well chosen views leave it.
    Weak,
    /// More views would pay.
    Fair,
    /// Nothing speaks against it.
    Good,
}

impl Judgement {
    /// Judges `calibration`, with the map error and whatever accuracies are wished for.
    pub(super) fn new(
        calibration: &Calibration,
        corners: usize,
        other: Option<OtherLens>,
        map_error: f64,
        wished: &[Wished],
    ) -> Self {
        let missed: Vec<_> = wished.iter().filter(|w| w.reached > w.limit).cloned().collect();
        let outliers = calibration.outliers.len();
        if !calibration.convergence.converged {
            Self::NotConverged
        } else if let Some(other) = other.filter(|other| other.sigma < BETTER_LENS * calibration.sigma) {
            Self::WrongLens(other)
        } else if outliers as f64 > MANY_OUTLIERS * corners as f64 {
            Self::Outliers(outliers)
        } else if !missed.is_empty() {
            Self::Missed(missed)
        } else if wished.is_empty() && map_error > FAIR_MAP_ERROR {
            Self::Weak
        } else if wished.is_empty() && map_error > GOOD_MAP_ERROR {
            Self::Fair
        } else {
            Self::Good
        }
    }

    /// Its name in the document.
    pub(super) fn name(&self) -> &'static str {
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
    pub(super) fn is_bad(&self) -> bool {
        matches!(self, Self::NotConverged | Self::WrongLens(_) | Self::Missed(_))
    }

    /// The verdict in a sentence or two; `lacks` says what the views lack.
    pub(super) fn text(&self, calibration: &Calibration, map_error: f64, loss: LossName, lacks: &str) -> String {
        let (error, noise) = (short(map_error), short(calibration.sigma));
        match self {
            Self::NotConverged => format!(
                "Do not use this camera: the calibration did not converge in {} iterations. Estimate fewer coefficients, \
                 as in `--fix k3=0`, or take another lens model.",
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
                    LossName::Squared => "; `--loss cauchy` withstands a few",
                    LossName::Huber | LossName::Cauchy => ", and leave out what was detected wrongly",
                };
                format!(
                    "Doubtful: {count} corners do not fit. Look at the images named, or at another lens model{loss}."
                )
            }
            Self::Missed(missed) => {
                let each = |Wished { what, limit, reached }: &Wished| {
                    format!("{what} is {} where {limit} is wished for", short(*reached))
                };
                let missed = missed.iter().map(each).collect::<Vec<_>>().join(", ");
                format!("Not accurate enough: {missed}.{lacks}")
            }
            Self::Weak => format!(
                "Weak: over the image the camera is known to {error} px only, while a corner is seen to {noise} px.{lacks}"
            ),
            Self::Fair => format!(
                "Fair: over the image the camera is known to {error} px; a corner is seen to {noise} px. More views would pay.{lacks}"
            ),
            Self::Good => {
                format!("Good: over the image the camera is known to {error} px; a corner is seen to {noise} px.")
            }
        }
    }
}

/// What the views lack for a map error of `goal` px: which intrinsics are known least, where no corners are, how the boards
/// are not tilted, and how many views like these would do.
pub(super) fn lacks(
    observations: &Observations,
    calibration: &Calibration,
    W: &DMatrix<f64>,
    map_error: f64,
    goal: Option<f64>,
) -> String {
    let Calibration { camera, covariance, poses, .. } = calibration;
    let mut text = String::new();
    if let Some(weakest) = weakest(covariance, W) {
        let units = calibration.unknowns().pixel_units();
        let moved: Vec<f64> = weakest.change.iter().zip(&units).map(|(change, unit)| (change / unit).abs()).collect();
        let largest = moved.iter().copied().fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..moved.len()).filter(|&i| moved[i] >= NAMED * largest).collect();
        order.sort_by(|&a, &b| moved[b].total_cmp(&moved[a]));
        let all = calibration.unknowns().names();
        let names: Vec<&str> = order.iter().map(|&i| all[i]).collect();
        text += &match names[..] {
            [name] => format!(" {:.0} % of its square comes from {name}.", 100.0 * weakest.share),
            _ => format!(
                " {:.0} % of its square comes from one combination of {}.",
                100.0 * weakest.share,
                names.join(", ")
            ),
        };
    }
    let coverage = Coverage::new(observations, camera, poses);
    let empty: Vec<&str> = coverage.empty.iter().map(|region| region.name()).collect();
    let mut is_spread = true;
    if !empty.is_empty() {
        is_spread = false;
        text += &format!(" No corner lies in the image's {}: bring the board there.", empty.join(", "));
    }
    if coverage.largest_tilt < ENOUGH_TILT {
        is_spread = false;
        text += &format!(
            " No board is tilted by more than {:.0}°: tilt some by 30° to 50°.",
            coverage.largest_tilt.to_degrees()
        );
    } else if coverage.least_spread < ENOUGH_SPREAD {
        is_spread = false;
        text += " The boards are tilted about one axis only: tilt some about the other.";
    }
    if let Some(goal) = goal.filter(|goal| is_spread && map_error > *goal) {
        let views = (poses.len() as f64 * (map_error / goal).powi(2)).ceil();
        text += &format!(" About {views} views like these {} would bring it to {goal} px.", poses.len());
    }
    text
}

/// The map error to reach: the wish, or a good one.
pub(super) fn goal(wished: &[Wished]) -> Option<f64> {
    match wished {
        [] => Some(GOOD_MAP_ERROR),
        _ => wished.iter().find(|w| w.what.starts_with("map error")).map(|w| w.limit),
    }
}
