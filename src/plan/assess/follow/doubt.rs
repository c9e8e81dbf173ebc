//! What is wrong with a picture, against what was planned and what the others show.

use std::fmt;

use crate::calibration::{Calibration, CalibrationError, LossKind, ObservationError, Observations, View, calibrate_by};
use crate::figures::short;
use crate::plan::document::{PlannedPose, TakenPicture};
use crate::problem::Problem;

use super::knowledge::settings;
use super::picture::fault;

/// Of the corners that a plan counts on, the least share that is to be found.
const FEWEST: f64 = 0.5;

/// A view whose residuals are this many times those of the others is worse than noise explains: of unlike views they differ by two.
const LARGER: f64 = 3.0;

/// Share of a view's corners that may not fit.
const OUTLIERS: f64 = 0.05;

/// Other views among which one stands out.
const FEWEST_OTHERS: usize = 3;

/// Corners of an arm at rest lie as near as this in two pictures, px; those of another pose that lie nearer were planned there.
const STILL: f64 = 2.0;

/// What is wrong with a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// No corner was detected.
    NotFound,
    /// No calibration takes it.
    Unusable(ObservationError),
    /// Few of the corners that were planned for were found.
    FewCorners {
        /// Those found.
        found: usize,
        /// Those planned for.
        planned: usize,
    },
    /// The board is where it was in another picture, though the arm should have moved.
    Still {
        /// Name of the other picture.
        other: String,
    },
    /// The corners, in their order, are no image of the board as those of the others are.
    OtherBoard(CalibrationError),
    /// Its residuals are much longer than those of the other pictures.
    Residuals {
        /// Their root mean square, px.
        rms: f64,
        /// The median of the others', px.
        others: f64,
    },
    /// Many of its corners do not fit.
    Outliers {
        /// Those that do not.
        count: usize,
        /// All of them.
        of: usize,
    },
}

impl Doubt {
    /// Whether the picture cannot count at all.
    pub fn is_fatal(&self) -> bool {
        matches!(self, Self::NotFound | Self::Unusable(_) | Self::OtherBoard(_))
    }

    /// What is wrong with a picture of `pose`, before it is held against the `others` of other poses, each with its own.
    pub(super) fn at_sight<'p>(
        problem: &Problem,
        picture: &TakenPicture,
        pose: &PlannedPose,
        others: impl IntoIterator<Item = (&'p PlannedPose, &'p TakenPicture)>,
    ) -> Vec<Self> {
        let found = picture.corners.len();
        if found == 0 {
            return vec![Self::NotFound];
        }
        if let Some(fault) = fault(problem, picture) {
            return vec![Self::Unusable(fault)];
        }
        let planned = pose.corners_seen.as_ref().map_or(problem.target.board.corner_count(), Vec::len);
        let few = ((found as f64) < FEWEST * planned as f64).then_some(Self::FewCorners { found, planned });
        let still = others.into_iter().find(|(other, taken)| {
            let is_near = |distance: Option<f64>, most: f64| distance.is_some_and(|distance| distance < most);
            is_near(apart(picture, taken), STILL) && !is_near(planned_apart(problem, pose, other), 3.0 * STILL)
        });
        few.into_iter().chain(still.map(|(_, other)| Self::Still { other: other.name.clone() })).collect()
    }

    /// What is wrong with the last of the views, held against the others by a calibration that withstands it, and by one that does not;
    /// nothing where they do not give one for another reason.
    pub(super) fn among(problem: &Problem, observations: &Observations) -> Vec<Self> {
        let last = observations.views().len() - 1;
        let settings = settings(problem);
        let by = |loss| calibrate_by(loss, observations, &problem.camera, &problem.estimated, &settings);
        match (by(LossKind::Cauchy), by(LossKind::Squared)) {
            (Err(error), _) | (_, Err(error)) if blames(&error, last) => vec![Self::OtherBoard(error)],
            (Ok(calibration), _) => misfits(&calibration, last, observations.views()[last].len()),
            (Err(_), _) => Vec::new(),
        }
    }
}

/// How the view of that place, of so many corners, stands out in a calibration.
fn misfits(calibration: &Calibration, place: usize, of: usize) -> Vec<Doubt> {
    let mut others = calibration.view_rms.clone();
    let rms = others.remove(place);
    if others.len() < FEWEST_OTHERS {
        return Vec::new();
    }
    others.sort_by(f64::total_cmp);
    let median = others[others.len() / 2];
    let count = calibration.outliers.iter().filter(|outlier| outlier.view == place).count();
    let large = (rms > LARGER * median).then_some(Doubt::Residuals { rms, others: median });
    let outliers = (count as f64 > OUTLIERS * of as f64).then_some(Doubt::Outliers { count, of });
    large.into_iter().chain(outliers).collect()
}

/// Whether the calibration failed for that view.
fn blames(error: &CalibrationError, place: usize) -> bool {
    match error {
        CalibrationError::SwappedOrder { views, .. } | CalibrationError::Disordered { views, .. } => {
            views.contains(&place)
        }
        CalibrationError::NoStart { view } | CalibrationError::FoldedLens { view, .. } => *view == place,
        _ => false,
    }
}

/// How far apart the corners of two pictures are that both have, px in the root mean square; none where they have hardly any.
fn apart(a: &TakenPicture, b: &TakenPicture) -> Option<f64> {
    let (a, b): (View, View) = (a.view(), b.view());
    let pairs = a.iter().filter_map(|corner| Some((corner, b.iter().find(|other| other.index == corner.index)?)));
    root_mean_square(pairs.map(|(corner, other)| (corner.pixel - other.pixel).norm_squared()))
}

/// The same for the pictures that two poses are planned to give, by the nominal camera.
fn planned_apart(problem: &Problem, a: &PlannedPose, b: &PlannedPose) -> Option<f64> {
    let Problem { robot, camera, target, .. } = problem;
    let [X_CT_a, X_CT_b] = [a, b].map(|pose| robot.camera_pose(&pose.joints_rad).inverse() * target.X_BT);
    let pairs = target.board.corners().filter_map(|corner| {
        let (a, b) = (camera.project(&(X_CT_a * corner))?, camera.project(&(X_CT_b * corner))?);
        Some((a - b).norm_squared())
    });
    root_mean_square(pairs)
}

fn root_mean_square(squares: impl Iterator<Item = f64>) -> Option<f64> {
    let squares: Vec<f64> = squares.collect();
    (squares.len() >= crate::calibration::FEWEST_CORNERS)
        .then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NotFound => f.write_str("the board was not found in it"),
            Self::Unusable(error) => write!(f, "no calibration takes it: {error}"),
            Self::FewCorners { found, planned } => {
                write!(f, "{found} corners were found of {planned} that were planned for")
            }
            Self::Still { other } => {
                write!(f, "the board is where it is in {other}: did the arm move before the picture was taken?")
            }
            Self::OtherBoard(error) => error.fmt(f),
            Self::Residuals { rms, others } => write!(
                f,
                "its residuals are {} px in the root mean square, those of the other pictures {} px",
                short(*rms),
                short(*others)
            ),
            Self::Outliers { count, of } => write!(f, "{count} of its {of} corners do not fit"),
        }
    }
}
