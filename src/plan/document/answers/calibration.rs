//! A calibrated camera and what it is worth: `calibration.json`.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::calibration::{AccuracyReached, Assessment, Calibration, Corner, residuals};
use crate::formats::Detections;
use crate::plan::document::error_grid::ErrorGrid;
use crate::plan::document::header::{Document, Header, ProblemReference, finite};
use crate::plan::document::plan::Pose;
use crate::target::Warp;

/// Corners of a calibration whose residuals are listed at most.
const MOST_RESIDUALS: usize = 100_000;

/// A calibrated camera, the poses of its views, and how well they are known. Lengths in px unless the key says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CalibrationDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that says board, image size, lens and what to estimate; `null` where the command line does.
    pub problem: Option<ProblemReference>,
    /// The lens model.
    pub lens: String,
    /// Size of the images.
    pub image: PictureSize,
    /// All intrinsics; sigma is 0 for those that were not estimated.
    pub intrinsics: EstimatedIntrinsics,
    /// Names of those that were estimated.
    pub estimated: Vec<String>,
    /// Pairs of intrinsics that have one value.
    pub tied: Vec<[String; 2]>,
    /// Covariance of the estimated intrinsics, p×p in their order, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// Whether the calibration came to rest.
    pub converged: bool,
    /// RMS length of the residuals.
    pub rms_px: f64,
    /// Standard deviation of one pixel coordinate of a corner; under `edges` of one seen square-on.
    pub sigma_px: f64,
    /// How far the board is from flat, where that was estimated too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warp_mm: Option<BoardWarp>,
    /// By what the corners were weighed: `constant`, or `edges`, those that the detector saw; older calibrations do not say.
    #[serde(default)]
    pub noise_model: Option<String>,
    /// The residuals' lengths, and their mean.
    pub residuals_px: ResidualLengths,
    /// The views.
    pub views: Vec<CalibratedView>,
    /// Images without a detected corner.
    pub skipped: Vec<String>,
    /// Corners that do not fit, the worst first.
    pub outliers: Vec<OutlierDocument>,
    /// Predicted map error.
    pub map_error_px: MapErrorOverImage,
    /// The same over the image; older calibrations do not say.
    #[serde(default)]
    pub error_map: Option<ErrorGrid>,
    /// Accuracies requested.
    pub requested: Vec<RequestedAccuracy>,
    /// `good`, `fair`, `weak`, `missed`, `outliers`, `wrong lens` or `not converged`.
    pub judgement: String,
    /// The same in a sentence for people, and what is weak.
    pub verdict: String,
}

/// How high a board's middle lies above its rim, towards the side printed on, as seen along x and along y; with standard
/// deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoardWarp {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Of the height along x.
    pub x_sigma: f64,
    /// Of that along y.
    pub y_sigma: f64,
}

/// Size of images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PictureSize {
    /// Width, px.
    pub width_px: u32,
    /// Height, px.
    pub height_px: u32,
}

/// Intrinsics with their values and standard deviations; lists of one length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EstimatedIntrinsics {
    /// Names.
    pub names: Vec<String>,
    /// Values: px, and none for the lens's coefficients.
    pub values: Vec<f64>,
    /// Standard deviations, in the values' units.
    pub sigma: Vec<f64>,
}

/// Lengths of the residuals, and their mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResidualLengths {
    /// Half of them are shorter.
    pub median: Option<f64>,
    /// So long are 95 % of them at most.
    pub percentile_95: Option<f64>,
    /// The longest.
    pub largest: Option<f64>,
    /// Mean of the residuals [u, v].
    pub mean: [Option<f64>; 2],
}

/// A view, with the pose of the board in the camera's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CalibratedView {
    /// Name of its image.
    pub name: String,
    /// Number of corners.
    pub corners: usize,
    /// RMS length of its residuals.
    pub rms_px: f64,
    /// The board's pose.
    #[serde(flatten)]
    pub pose: Pose,
    /// Each corner and its residual; left out in calibrations of more than 100 000 corners.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub residuals: Vec<CornerResidual>,
}

/// A corner and how far its projection is from it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CornerResidual {
    /// The corner's column on the board, from 0.
    pub column: usize,
    /// Its row, from 0.
    pub row: usize,
    /// Where it was detected [u, v].
    pub corner_px: [f64; 2],
    /// Projection less detection [u, v].
    pub residual_px: [f64; 2],
}

/// A corner that does not fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OutlierDocument {
    /// Name of the view's image.
    pub view: String,
    /// The corner's column on the board, from 0.
    pub column: usize,
    /// Its row, from 0.
    pub row: usize,
    /// Projection less detection [u, v].
    pub residual_px: [f64; 2],
    /// Length of the residual over the standard deviation of one of its coordinates.
    pub standardised: Option<f64>,
}

/// Predicted map error; `null` where the lens does not reach.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapErrorOverImage {
    /// At the image's centre.
    pub centre: Option<f64>,
    /// At the middles of its sides.
    pub edge: Option<f64>,
    /// At its corners.
    pub corner: Option<f64>,
    /// RMS over the image.
    pub rms: Option<f64>,
}

/// An accuracy requested, and what is reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RequestedAccuracy {
    /// What is to be accurate: `map error [px]`, `sigma of fx`.
    pub what: String,
    /// What is requested, px or the intrinsic's unit.
    pub requested: f64,
    /// What is reached.
    pub reached: Option<f64>,
}

impl Document for CalibrationDocument {
    const FORMAT: &'static str = "calipose.calibration";
    const VERSION: u32 = 2;
}

impl EstimatedIntrinsics {
    /// Those of a calibration that were estimated.
    pub fn new(calibration: &Calibration) -> Self {
        let Calibration { camera, estimated, .. } = calibration;
        Self {
            names: estimated.iter().map(|&i| camera.lens().parameter_names()[i].into()).collect(),
            values: estimated.iter().map(|&i| camera.intrinsics()[i]).collect(),
            sigma: estimated.iter().map(|&i| calibration.sigma_of(i)).collect(),
        }
    }
}

impl RequestedAccuracy {
    /// Of an accuracy of a calibration.
    pub fn new(accuracy: &AccuracyReached) -> Self {
        let AccuracyReached { what, limit, reached } = accuracy;
        Self { what: what.clone(), requested: *limit, reached: finite(*reached) }
    }
}

impl BoardWarp {
    /// Of heights and their standard deviations, m.
    fn new([[x, x_sigma], [y, y_sigma]]: [[f64; 2]; Warp::HEIGHTS]) -> Self {
        Self { x: x * 1e3, y: y * 1e3, x_sigma: x_sigma * 1e3, y_sigma: y_sigma * 1e3 }
    }
}

impl CalibrationDocument {
    /// The `calibration` of what was detected, as it is assessed.
    pub fn new(
        problem: Option<ProblemReference>,
        detections: &Detections,
        calibration: &Calibration,
        assessment: &Assessment,
    ) -> Self {
        let Detections { observations, names, skipped } = detections;
        let Calibration { camera, estimated, covariance, .. } = calibration;
        let Assessment { map_errors, residuals: lengths, requested, judgement, lacks: _, verdict } = assessment;
        let all = camera.lens().parameter_names();
        let name = |i: usize| all[i].to_owned();
        let fits = (observations.corner_count() <= MOST_RESIDUALS)
            .then(|| residuals(observations, camera, &calibration.poses, &calibration.surface));
        let of_view = |i: usize| {
            let of = |(corner, residual): (&Corner, &Vector2<f64>)| {
                let (column, row) = observations.board().column_and_row(corner.index);
                CornerResidual { column, row, corner_px: corner.pixel.into(), residual_px: (*residual).into() }
            };
            fits.iter().flat_map(|fits| observations.views()[i].iter().zip(&fits[i])).map(of).collect()
        };
        let views = names.iter().enumerate().map(|(i, name)| CalibratedView {
            name: name.clone(),
            corners: observations.views()[i].len(),
            rms_px: calibration.view_rms[i],
            pose: Pose::new(&calibration.poses[i]),
            residuals: of_view(i),
        });
        let outliers = calibration.outliers.iter().map(|outlier| {
            let (column, row) = observations.board().column_and_row(outlier.index);
            OutlierDocument {
                view: names[outlier.view].clone(),
                column,
                row,
                residual_px: outlier.residual.into(),
                standardised: finite(outlier.standardised),
            }
        });
        let requested = requested.iter().map(RequestedAccuracy::new);
        Self {
            header: Self::header(),
            problem,
            lens: camera.lens().name().into(),
            image: PictureSize { width_px: camera.width(), height_px: camera.height() },
            intrinsics: EstimatedIntrinsics {
                names: (0..all.len()).map(name).collect(),
                values: camera.intrinsics().to_vec(),
                sigma: (0..all.len()).map(|i| calibration.sigma_of(i)).collect(),
            },
            estimated: estimated.iter().map(|&i| name(i)).collect(),
            tied: calibration.ties.followers().map(|(j, leader)| [name(leader), name(j)]).collect(),
            covariance: covariance.row_iter().map(|row| row.iter().copied().collect()).collect(),
            converged: calibration.convergence.converged,
            rms_px: calibration.rms,
            sigma_px: calibration.sigma,
            warp_mm: calibration.warp().map(BoardWarp::new),
            noise_model: Some(calibration.noise.name().name().into()),
            residuals_px: ResidualLengths {
                median: finite(lengths.median),
                percentile_95: finite(lengths.percentile_95),
                largest: finite(lengths.largest),
                mean: [finite(lengths.mean.x), finite(lengths.mean.y)],
            },
            views: views.collect(),
            skipped: skipped.clone(),
            outliers: outliers.collect(),
            map_error_px: MapErrorOverImage {
                centre: map_errors.centre,
                edge: map_errors.edge,
                corner: map_errors.corner,
                rms: finite(map_errors.rms),
            },
            error_map: Some(ErrorGrid::new(&calibration.unknowns(), covariance)),
            requested: requested.collect(),
            judgement: judgement.name().into(),
            verdict: verdict.clone(),
        }
    }
}
