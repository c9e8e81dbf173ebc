//! Calibration of a camera from views of a planar board.
//!
//! ```text
//! Observations → order of the corners → start (Zhang's closed form) → refinement (Levenberg–Marquardt) → Calibration
//! ```
//!
//! [`calibrate`] runs them in turn. Poses are `X_CT`, from the board's frame T to the camera's C; pixels as in
//! [`crate::camera`].

mod assessment;
mod coverage;
mod estimate;
mod factor;
mod homography;
mod loss;
mod normal_equations;
mod observability;
mod observations;
mod order;
mod refinement;
mod robust;
mod scatter;
mod start;
mod ties;
mod zhang;

pub use assessment::{
    AccuracyReached, Assessment, Judgement, Lacks, MapErrors, MoreViews, OtherLens, Request, ResidualStatistics,
    TiltLack, WeakCombination, other_lens, unknown_camera,
};
pub use coverage::{Coverage, Region};
pub use estimate::{Calibration, Outlier, residuals};
pub use homography::homography;
pub use loss::Loss;
pub use observations::{BORDER_TOLERANCE, Corner, FEWEST_CORNERS, ObservationError, Observations, View};
pub use refinement::{Convergence, RefinementSettings};
pub use robust::{LossKind, calibrate_by};
pub use scatter::{FittedNoise, Scatter, ScatterError};
pub use start::{Start, pose_of_view, start};
pub use ties::Ties;
pub use zhang::{Pinhole, pose_of_homography};

use thiserror::Error;

use crate::camera::{Camera, CameraError, MAX_INTRINSICS};
use crate::information::NoiseModel;
use crate::target::{Surface, Warp};
use estimate::Fit;
use normal_equations::Measurements;
use refinement::{Refined, Sought};

/// How often the corners are weighed anew by what was found. Weights that are off by a percent cost a ten-thousandth of the
/// accuracy, and the first ones are off by no more.
const REWEIGHTINGS: usize = 2;

/// No corners scatter less, px: what is expected of a board's heights counts in data without noise, too.
const LEAST_SIGMA: f64 = 1e-6;

/// How to calibrate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationSettings {
    /// The refinement.
    pub refinement: RefinementSettings,
    /// Which intrinsics have one value. Default: none.
    pub ties: Ties,
    /// How the corners' scatter depends on how they are seen, by which they are weighed. Default: not at all.
    pub noise: NoiseModel,
    /// How the board may bulge, whose heights are estimated then. Default: not at all.
    pub warp: Option<Warp>,
    /// A corner is an outlier where its residual is longer than this many standard deviations of one coordinate.
    /// Default: 5, which Gaussian noise exceeds once in 270 000 corners.
    pub outlier_threshold: f64,
}

impl Default for CalibrationSettings {
    fn default() -> Self {
        Self {
            refinement: RefinementSettings::default(),
            ties: Ties::default(),
            noise: NoiseModel::Constant,
            warp: None,
            outlier_threshold: 5.0,
        }
    }
}

impl CalibrationSettings {
    /// A start whose board may bulge, if it is said that it may.
    fn bent(&self, mut start: Start) -> Start {
        if let (Some(warp), None) = (self.warp, start.surface.warp()) {
            start.surface = Surface::new(warp, [0.0; Warp::HEIGHTS]);
        }
        start
    }
}

/// Why observations do not give a camera. Views count from 0.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrationError {
    /// The camera and the observations are of different images.
    #[error("the image size is {camera:?} px for the camera, but {observations:?} px for the observations")]
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
    /// Of two intrinsics that are tied together only one is to be estimated.
    #[error("the intrinsics {a} and {b} are tied together, but only one of them is estimated")]
    Tied {
        /// The first one's name.
        a: &'static str,
        /// The other's.
        b: &'static str,
    },
    /// A setting is out of its range.
    #[error("the {name} is {value}; it must be positive and finite")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Each view of a plane by a camera without distortion fixes at most two of fx, fy, cx and cy.
    #[error(
        "{found} {} of a planar board without lens distortion {} at most {} of fx fy cx cy; estimating {} of them needs at \
         least {needed} views",
        if *found == 1 { "view" } else { "views" },
        if *found == 1 { "determines" } else { "determine" },
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
    /// Views whose corners are listed as those of a board with as many rows as this has columns.
    #[error(
        "rows and columns look swapped: in {} the corners are in the order of a board of {rows} x {columns}, not of \
         {columns} x {rows}",
        share_text(views.len(), *of)
    )]
    SwappedOrder {
        /// The views.
        views: Vec<usize>,
        /// All there are.
        of: usize,
        /// Corners along the board's x.
        columns: usize,
        /// Corners along the board's y.
        rows: usize,
    },
    /// Views whose corners are no image of the board's, as those of the others are.
    #[error("in {} the corners, in the order given, are not an image of the board", share_text(views.len(), *of))]
    Disordered {
        /// The views.
        views: Vec<usize>,
        /// All there are.
        of: usize,
    },
    /// Fewer measured coordinates than unknowns.
    #[error(
        "{measured} measured coordinates cannot determine {unknown} unknowns (intrinsics and six numbers per view)"
    )]
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
        "the boards of all views are parallel to within {:.2}°, which leaves the focal length undetermined; tilt them differently",
        largest_angle.to_degrees()
    )]
    ParallelBoards {
        /// Largest angle between the normals of two views' boards, rad.
        largest_angle: f64,
    },
    /// A combination of intrinsics that the views do not fix.
    #[error("the views do not determine this combination of intrinsics: {}", combination_text(combination))]
    Unobservable {
        /// Parameters with their share in the combination, in units of each one's own information; of unit length.
        combination: Vec<(&'static str, f64)>,
    },
    /// A view does not fix its own pose.
    #[error("a view does not determine the pose of its board")]
    UnobservablePose,
    /// The lens model found folds back within the corners it was found from.
    #[error("the {lens} lens that fits best folds back before it reaches corner {index} of view {view}")]
    FoldedLens {
        /// Name of the lens model.
        lens: &'static str,
        /// The view.
        view: usize,
        /// The corner's index on the board.
        index: usize,
    },
    /// The optimum is not a camera.
    #[error("the optimum is not a camera: {0}")]
    Camera(CameraError),
}

// The message has it already: it is no further cause.
impl From<CameraError> for CalibrationError {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}

fn share_text(count: usize, of: usize) -> String {
    match (count, of) {
        (1, 1) => "the one view".to_owned(),
        _ if count == of => format!("all {of} views"),
        _ => format!("{count} of {of} views"),
    }
}

fn combination_text(combination: &[(&'static str, f64)]) -> String {
    combination.iter().map(|(name, share)| format!("{share:+.2} {name}")).collect::<Vec<_>>().join(" ")
}

/// Calibrates the intrinsics `estimated` (indices into [`Camera::intrinsics`]) and every view's pose from
/// `observations` alone: `nominal` gives the lens model, the image size and the values of the intrinsics that are not
/// estimated, and those of the estimated ones are not read.
///
/// The optimum minimises the sum of the losses of the corners' residuals, each times the corner's weight and whitened by its
/// scatter; with [`Loss::Squared`], constant noise and equal weights it is OpenCV's `calibrateCamera`'s. Where that is a
/// rational lens which folds back before the corners, it is sought again from the lens without denominator, among those that
/// do not. A calibration that ran out of iterations is returned with `converged` false.
///
/// # Errors
/// [`CalibrationError`]: inconsistent arguments, and views that do not fix the parameters, with what they leave open.
pub fn calibrate(
    observations: &Observations,
    nominal: &Camera,
    estimated: &[usize],
    settings: &CalibrationSettings,
) -> Result<Calibration, CalibrationError> {
    order::check(observations)?;
    let mut start = settings.bent(start(observations, nominal, estimated)?);
    level(&mut start.camera, &settings.ties);
    let again = is_rational(nominal, estimated).then(|| start.clone());
    match (refine(observations, start, estimated, settings), again) {
        (Err(folded @ CalibrationError::FoldedLens { .. }), Some(start)) => {
            one_to_one(observations, start, estimated, settings).ok_or(folded)
        }
        (found, _) => found,
    }
}

/// Whether a denominator of the radial distortion is among the `estimated`.
fn is_rational(camera: &Camera, estimated: &[usize]) -> bool {
    let denominator = camera.lens().denominator();
    estimated.iter().any(|j| denominator.contains(j))
}

fn level(camera: &mut Camera, ties: &Ties) {
    let mut θ = [0.0; MAX_INTRINSICS];
    θ[..camera.intrinsics().len()].copy_from_slice(camera.intrinsics());
    ties.level(&mut θ);
    *camera = camera.extrapolated(&θ);
}

/// The optimum among the lenses that are one-to-one as far as the corners lie, if it is none of their limits.
fn one_to_one(
    observations: &Observations,
    start: Start,
    estimated: &[usize],
    settings: &CalibrationSettings,
) -> Option<Calibration> {
    let denominator = start.camera.lens().denominator();
    let plain: Vec<usize> = estimated.iter().copied().filter(|j| !denominator.contains(j)).collect();
    let sought = Sought { estimated: &plain, ties: &settings.ties, one_to_one: false };
    let mut plain = refinement::refine(&Measurements::new(observations), start, sought, &settings.refinement).start;
    plain.camera = plain.camera.with_intrinsics(plain.camera.intrinsics()).ok()?;
    estimate::check_fold(observations, &plain).ok()?;
    let sought = Sought { estimated, ties: &settings.ties, one_to_one: true };
    let (refined, measurements) = weighed(observations, plain, sought, settings);
    estimate::summarise(observations, &measurements, refined, estimated, settings)
        .ok()
        .filter(|found| found.convergence.converged)
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
    if let Some((a, b)) = settings.ties.torn(estimated) {
        let name = |j: usize| start.camera.lens().parameter_names().get(j).copied().unwrap_or_default();
        return Err(CalibrationError::Tied { a: name(a), b: name(b) });
    }
    let (poses, views) = (start.poses.len(), observations.views().len());
    if poses != views {
        return Err(CalibrationError::PoseCount { poses, views });
    }
    let sought = Sought { estimated, ties: &settings.ties, one_to_one: false };
    let (refined, measurements) = weighed(observations, settings.bent(start), sought, settings);
    estimate::summarise(observations, &measurements, refined, estimated, settings)
}

/// Refines, and where the corners' scatter depends on how they are seen, again by what was found of that, as where it must be
/// weighed against what is expected of a board's heights; with the measurements as they were weighed last.
fn weighed(
    observations: &Observations,
    start: Start,
    sought: Sought<'_>,
    settings: &CalibrationSettings,
) -> (Refined, Measurements) {
    let bulges = start.surface.warp().is_some();
    let mut measurements = Measurements::new(observations);
    let mut refined = refinement::refine(&measurements, start, sought, &settings.refinement);
    let rounds = if settings.noise == NoiseModel::Constant && !bulges { 0 } else { REWEIGHTINGS };
    for _ in 0..rounds {
        let sigma = Fit::new(observations, &measurements, &refined.start, sought.estimated, settings).sigma;
        measurements = Measurements::weighed(observations, settings.noise, &refined.start);
        measurements.sigma = sigma.max(LEAST_SIGMA);
        let before = refined.convergence.iterations;
        refined = refinement::refine(&measurements, refined.start, sought, &settings.refinement);
        refined.convergence.iterations += before;
    }
    (refined, measurements)
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
    // The image of a plane by a lens that bends it is no homography, and says more than the eight numbers of one.
    let bends = (4..count).any(|j| estimated.contains(&j) || camera.intrinsics()[j] != 0.0);
    if found < needed && !bends && !camera.lens().is_fisheye() {
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
