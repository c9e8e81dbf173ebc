//! Calibration of a camera from views of a planar board.
//!
//! ```text
//! Observations → start (Zhang's closed form) → refinement (Levenberg–Marquardt) → Calibration
//! ```
//!
//! [`calibrate`] runs them in turn. Poses are `X_CT`, from the board's frame T to the camera's C; pixels as in
//! [`crate::camera`].

mod estimate;
mod factor;
mod homography;
mod loss;
mod normal_equations;
mod observability;
mod observations;
mod refinement;
mod start;
mod zhang;

pub use estimate::{Calibration, Outlier, residuals};
pub use homography::homography;
pub use loss::Loss;
pub use observations::{BORDER_TOLERANCE, Corner, FEWEST_CORNERS, ObservationError, Observations, View};
pub use refinement::{Convergence, RefinementSettings};
pub use start::{Start, start};
pub use zhang::{Pinhole, pose_of_homography};

use thiserror::Error;

use crate::camera::{Camera, CameraError};

/// How to calibrate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationSettings {
    /// The refinement.
    pub refinement: RefinementSettings,
    /// A corner is an outlier where its residual is longer than this many standard deviations of one coordinate.
    /// Default: 5, which Gaussian noise exceeds once in 270 000 corners.
    pub outlier_threshold: f64,
}

impl Default for CalibrationSettings {
    fn default() -> Self {
        Self { refinement: RefinementSettings::default(), outlier_threshold: 5.0 }
    }
}

/// Why observations do not give a camera. Views count from 0.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrationError {
    /// The camera and the observations are of different images.
    #[error("the camera's image is {camera:?} px, the observations' {observations:?} px")]
    ImageSize {
        /// Width and height of the camera's image.
        camera: (u32, u32),
        /// Width and height of the observations'.
        observations: (u32, u32),
    },
    /// The list of parameters to estimate is empty, names one twice, or names one that the camera does not have.
    #[error("cannot estimate the intrinsics {estimated:?} of a camera that has {count}")]
    Parameters {
        /// The indices given.
        estimated: Vec<usize>,
        /// Parameters of the model.
        count: usize,
    },
    /// A setting is out of its range.
    #[error("the {name} is {value}; it must be positive and finite")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Each view of a plane fixes at most two of fx, fy, cx and cy.
    #[error(
        "{found} views of a planar board fix at most {} of fx fy cx cy; estimating {} of them takes at least {needed}",
        2 * found, pinhole_parameters
    )]
    TooFewViews {
        /// Views given.
        found: usize,
        /// Views needed.
        needed: usize,
        /// How many of fx, fy, cx and cy are to be estimated.
        pinhole_parameters: usize,
    },
    /// Fewer measured coordinates than unknowns.
    #[error("{measured} measured coordinates cannot fix {unknown} unknowns (intrinsics and six numbers a view)")]
    TooFewMeasurements {
        /// Two for each corner.
        measured: usize,
        /// Intrinsics and poses.
        unknown: usize,
    },
    /// A start with another number of poses than there are views.
    #[error("the start has {poses} poses for {views} views")]
    PoseCount {
        /// Poses given.
        poses: usize,
        /// Views observed.
        views: usize,
    },
    /// No pose of the board explains a view at all.
    #[error("view {view}: no pose of the board explains its corners")]
    NoStart {
        /// The view.
        view: usize,
    },
    /// All boards have one orientation, so that focal length and distance trade off freely.
    #[error(
        "the boards of all views are parallel within {:.2}°, which leaves the focal length open; tilt them differently",
        largest_angle.to_degrees()
    )]
    ParallelBoards {
        /// Largest angle between the normals of two views' boards, rad.
        largest_angle: f64,
    },
    /// A combination of intrinsics that the views do not fix.
    #[error("the views do not fix this combination of intrinsics: {}", combination_text(combination))]
    Unobservable {
        /// Parameters with their share in the combination, in units of each one's own information; of unit length.
        combination: Vec<(&'static str, f64)>,
    },
    /// A view does not fix its own pose.
    #[error("a view does not fix the pose of its board")]
    UnobservablePose,
    /// The lens model found folds back within the corners it was found from.
    #[error(
        "the lens model found folds back before it reaches corner {index} of view {view}; estimate fewer coefficients"
    )]
    FoldedLens {
        /// The view.
        view: usize,
        /// The corner's index on the board.
        index: usize,
    },
    /// The optimum is not a camera.
    #[error("the optimum is not a camera: {0}")]
    Camera(#[from] CameraError),
}

fn combination_text(combination: &[(&'static str, f64)]) -> String {
    combination.iter().map(|(name, share)| format!("{share:+.2} {name}")).collect::<Vec<_>>().join(" ")
}

/// Calibrates the intrinsics `estimated` (indices into [`Camera::intrinsics`]) and every view's pose from
/// `observations` alone: `nominal` gives the lens model, the image size and the values of the intrinsics that are not
/// estimated, and those of the estimated ones are not read.
///
/// The optimum minimises the sum of the corners' losses; with [`Loss::Squared`] it is OpenCV's `calibrateCamera`'s.
/// A calibration that ran out of iterations is returned with `converged` false.
///
/// # Errors
/// [`CalibrationError`]: inconsistent arguments, and views that do not fix the parameters, with what they leave open.
pub fn calibrate(
    observations: &Observations,
    nominal: &Camera,
    estimated: &[usize],
    settings: &CalibrationSettings,
) -> Result<Calibration, CalibrationError> {
    let start = start(observations, nominal, estimated)?;
    refine(observations, start, estimated, settings)
}

/// As [`calibrate`], from a given start.
///
/// # Errors
/// As [`calibrate`], and [`CalibrationError::PoseCount`].
pub fn refine(
    observations: &Observations,
    start: Start,
    estimated: &[usize],
    settings: &CalibrationSettings,
) -> Result<Calibration, CalibrationError> {
    check_settings(settings)?;
    check_problem(observations, &start.camera, estimated)?;
    let (poses, views) = (start.poses.len(), observations.views().len());
    if poses != views {
        return Err(CalibrationError::PoseCount { poses, views });
    }
    let refined = refinement::refine(observations, start, estimated, &settings.refinement);
    estimate::summarise(observations, refined, estimated, settings)
}

fn check_settings(settings: &CalibrationSettings) -> Result<(), CalibrationError> {
    let RefinementSettings { loss, tolerance, .. } = settings.refinement;
    for (name, value) in [
        ("loss's scale", loss.scale().unwrap_or(1.0)),
        ("tolerance", tolerance),
        ("outlier threshold", settings.outlier_threshold),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CalibrationError::Setting { name, value });
        }
    }
    Ok(())
}

fn check_problem(observations: &Observations, camera: &Camera, estimated: &[usize]) -> Result<(), CalibrationError> {
    let sizes = ((camera.width(), camera.height()), (observations.width(), observations.height()));
    if sizes.0 != sizes.1 {
        return Err(CalibrationError::ImageSize { camera: sizes.0, observations: sizes.1 });
    }
    let count = camera.intrinsics().len();
    let repeated = (1..estimated.len()).any(|i| estimated[..i].contains(&estimated[i]));
    if estimated.is_empty() || repeated || estimated.iter().any(|&j| j >= count) {
        return Err(CalibrationError::Parameters { estimated: estimated.to_vec(), count });
    }
    let found = observations.views().len();
    let pinhole_parameters = estimated.iter().filter(|&&j| j < 4).count();
    let needed = pinhole_parameters.div_ceil(2);
    if found < needed {
        return Err(CalibrationError::TooFewViews { found, needed, pinhole_parameters });
    }
    let (measured, unknown) = (2 * observations.corner_count(), estimated.len() + 6 * found);
    if measured < unknown {
        return Err(CalibrationError::TooFewMeasurements { measured, unknown });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
