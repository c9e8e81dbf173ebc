//! The result of a calibration with its statistics.

use nalgebra::{DMatrix, Vector2};

use super::normal_equations::{HEIGHTS, Measurements};
use super::observability::inverse_information;
use super::observations::{Corner, Observations};
use super::refinement::{Convergence, Refined};
use super::start::Start;
use super::{CalibrationError, CalibrationSettings, Loss, Ties};
use crate::camera::Camera;
use crate::information::{NoiseModel, Unknowns};
use crate::spatial::Pose;
use crate::target::{Surface, Warp};

/// A calibrated camera, the poses of its views, and how well they are known.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The camera.
    pub camera: Camera,
    /// `X_CT` of each view.
    pub poses: Vec<Pose>,
    /// The intrinsics that were estimated, as indices into [`Camera::intrinsics`].
    pub estimated: Vec<usize>,
    /// Which of them have one value.
    pub ties: Ties,
    /// Covariance of the estimated intrinsics, p×p in the order of `estimated`: `sigma²` times the inverse of the
    /// information left after the poses; singular where some are tied. For a robust loss the weighted equations' information: exact without
    /// outliers in the limit of a wide scale.
    pub covariance: DMatrix<f64>,
    /// The board's face: that of a flat one unless it was said to bulge.
    pub surface: Surface,
    /// Covariance of the board's heights, in their deviations, and of the estimated intrinsics, in this order; without heights,
    /// `covariance`.
    pub joint_covariance: DMatrix<f64>,
    /// How the corners' scatter depends on how they are seen, by which they were weighed.
    pub noise: NoiseModel,
    /// Estimated standard deviation of one pixel coordinate of a corner of weight 1, under the edges' noise of one seen square-on,
    /// px: from the cost and its degrees of freedom for [`Loss::Squared`], else from the median residual.
    pub sigma: f64,
    /// Root mean square length of all residuals, px; OpenCV's reprojection error.
    pub rms: f64,
    /// The same for each view.
    pub view_rms: Vec<f64>,
    /// Corners that do not fit, worst first.
    pub outliers: Vec<Outlier>,
    /// How the refinement ended.
    pub convergence: Convergence,
}

impl Calibration {
    /// The intrinsics that were estimated, of the camera found.
    pub fn unknowns(&self) -> Unknowns<'_> {
        Unknowns { camera: &self.camera, estimated: &self.estimated }
    }

    /// How high the board's middle lies above its rim along x and along y, each with its standard deviation, m; `None` of a
    /// board that was said to be flat.
    pub fn warp(&self) -> Option<[[f64; 2]; Warp::HEIGHTS]> {
        let unit = self.surface.warp()?.deviation;
        let heights = self.surface.heights();
        Some(std::array::from_fn(|i| [heights[i] * unit, self.joint_covariance[(i, i)].sqrt() * unit]))
    }

    /// Standard deviation of an intrinsic, by its index into [`Camera::intrinsics`]; 0 if it was not estimated.
    pub fn sigma_of(&self, intrinsic: usize) -> f64 {
        let place = self.estimated.iter().position(|&j| j == intrinsic);
        place.map_or(0.0, |i| self.covariance[(i, i)].sqrt())
    }
}

/// A corner that does not fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// The view, from 0.
    pub view: usize,
    /// The corner's index on the board.
    pub index: usize,
    /// Projection less detection, px.
    pub residual: Vector2<f64>,
    /// Length of the residual, whitened, over the standard deviation of one of its coordinates, taken from the median residual.
    pub standardised: f64,
}

/// How well a camera fits.
pub(super) struct Fit {
    residuals: Vec<Vec<Vector2<f64>>>,
    /// Of the whitened residuals, one after another.
    squares: Vec<f64>,
    /// The deviation below by the median residual.
    robust_sigma: f64,
    /// As [`Calibration::sigma`].
    pub(super) sigma: f64,
}

impl Fit {
    pub(super) fn new(
        observations: &Observations,
        measurements: &Measurements,
        found: &Start,
        estimated: &[usize],
        settings: &CalibrationSettings,
    ) -> Self {
        let residuals = residuals(observations, &found.camera, &found.poses, &found.surface);
        let whitened = residuals.iter().flatten().zip(&measurements.all);
        let squares: Vec<f64> = whitened.map(|(&r, corner)| square(corner.whitening.whitened(r.into()))).collect();
        // A board's heights are as many unknowns as measurements of theirs.
        let unknown = (settings.ties.free(estimated).len() + 6 * found.poses.len()) as f64;
        let measured = 2.0 * squares.len() as f64;
        // Without excess measurements there are no residuals to speak of.
        let excess = (measured - unknown).max(1.0);
        let robust_sigma = median(&squares).map_or(0.0, |median| {
            // |r|²/σ² of two coordinates has the median 2 ln 2; the fit takes its share of the noise.
            (median / (2.0 * std::f64::consts::LN_2) * measured / excess).sqrt()
        });
        let total: f64 = squares.iter().sum();
        let sigma = match settings.refinement.loss {
            Loss::Squared => (total / excess).sqrt(),
            Loss::Huber { .. } | Loss::Cauchy { .. } => robust_sigma,
        };
        Self { residuals, squares, robust_sigma, sigma }
    }
}

pub(super) fn summarise(
    observations: &Observations,
    measurements: &Measurements,
    refined: Refined,
    estimated: &[usize],
    settings: &CalibrationSettings,
) -> Result<Calibration, CalibrationError> {
    let Refined { start, convergence, information } = refined;
    let camera = start.camera.with_intrinsics(start.camera.intrinsics())?;
    let start = Start { camera: camera.clone(), ..start };
    check_fold(observations, &start)?;
    let information = information.ok_or(CalibrationError::UnobservablePose)?;
    let Fit { residuals, squares, robust_sigma, sigma } =
        Fit::new(observations, measurements, &start, estimated, settings);
    let lengths: Vec<f64> = residuals.iter().flatten().map(Vector2::norm_squared).collect();
    let free = settings.ties.free(estimated);
    let heights = if start.surface.warp().is_some() { &HEIGHTS[..] } else { &[] };
    let block = |rows: &[usize], columns: &[usize]| {
        let entry = |i: usize, j: usize| information[rows[i].min(columns[j])][rows[i].max(columns[j])];
        DMatrix::from_fn(rows.len(), columns.len(), entry)
    };
    // Of the heights something was known before.
    let of_heights = block(heights, heights).try_inverse().ok_or(CalibrationError::UnobservablePose)?;
    let across = block(&free, heights) * &of_heights;
    let S = block(&free, &free) - &across * block(heights, &free);
    let inverse = inverse_information(&S, &free, &camera, &start.poses, sigma)?;
    // Those that are tied vary as one.
    let row = |i: usize| free.iter().position(|&j| j == settings.ties.leader(estimated[i])).unwrap_or_default();
    let p = estimated.len();
    let covariance = DMatrix::from_fn(p, p, |i, j| inverse[(row(i), row(j))] * (sigma * sigma));
    // The inverse of the whole by its blocks.
    let with_heights = -(&inverse * &across) * (sigma * sigma);
    let of_heights = (of_heights + across.tr_mul(&(&inverse * &across))) * (sigma * sigma);
    let s = heights.len();
    let joint_covariance = DMatrix::from_fn(s + p, s + p, |i, j| match (i.checked_sub(s), j.checked_sub(s)) {
        (Some(i), Some(j)) => covariance[(i, j)],
        (Some(i), None) => with_heights[(row(i), j)],
        (None, Some(j)) => with_heights[(row(j), i)],
        (None, None) => of_heights[(i, j)],
    });
    Ok(Calibration {
        camera,
        estimated: estimated.to_vec(),
        ties: settings.ties,
        covariance,
        surface: start.surface,
        joint_covariance,
        noise: settings.noise,
        sigma,
        rms: (lengths.iter().sum::<f64>() / lengths.len() as f64).sqrt(),
        view_rms: residuals
            .iter()
            .map(|view| (view.iter().map(Vector2::norm_squared).sum::<f64>() / view.len() as f64).sqrt())
            .collect(),
        outliers: outliers(observations, &residuals, &squares, robust_sigma, settings.outlier_threshold),
        poses: start.poses,
        convergence,
    })
}

/// Projection less detection of every corner of every view, px; not finite where there is no projection.
pub fn residuals(
    observations: &Observations,
    camera: &Camera,
    poses: &[Pose],
    surface: &Surface,
) -> Vec<Vec<Vector2<f64>>> {
    let residual = |corner: &Corner, X_CT: &Pose| {
        let p_C = X_CT * surface.point(&observations.on_board(corner));
        camera.project(&p_C).map_or(Vector2::repeat(f64::NAN), |pixel| pixel - corner.pixel)
    };
    let views = observations.views().iter().zip(poses);
    views.map(|(view, X_CT)| view.iter().map(|corner| residual(corner, X_CT)).collect()).collect()
}

pub(super) fn check_fold(observations: &Observations, found: &Start) -> Result<(), CalibrationError> {
    let Start { camera, poses, surface } = found;
    for (view, (corners, X_CT)) in observations.views().iter().zip(poses).enumerate() {
        for corner in corners {
            if camera.project(&(X_CT * surface.point(&observations.on_board(corner)))).is_none() {
                let lens = camera.lens().name();
                return Err(CalibrationError::FoldedLens { lens, view, index: corner.index });
            }
        }
    }
    Ok(())
}

fn square([x, y]: [f64; 2]) -> f64 {
    x * x + y * y
}

/// `squares` are those of the whitened residuals, one after another.
fn outliers(
    observations: &Observations,
    residuals: &[Vec<Vector2<f64>>],
    squares: &[f64],
    sigma: f64,
    threshold: f64,
) -> Vec<Outlier> {
    let mut outliers = Vec::new();
    let mut squares = squares.iter();
    for (view, (corners, residuals)) in observations.views().iter().zip(residuals).enumerate() {
        for ((corner, residual), square) in corners.iter().zip(residuals).zip(&mut squares) {
            // Where more than half the residuals are rounding, so is the deviation.
            let standardised = square.sqrt() / sigma.max(1e-9);
            if standardised > threshold {
                outliers.push(Outlier { view, index: corner.index, residual: *residual, standardised });
            }
        }
    }
    outliers.sort_by(|a, b| b.standardised.total_cmp(&a.standardised));
    outliers
}

fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
