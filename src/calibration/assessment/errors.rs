//! How well a calibrated camera is known over the image, and how well it fits the corners.

use nalgebra::{DMatrix, Vector2};

use crate::calibration::Calibration;

/// Predicted map errors, px; none where the lens does not reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapErrors {
    /// At the image's centre.
    pub centre: Option<f64>,
    /// At the middles of its sides.
    pub edge: Option<f64>,
    /// At its corners.
    pub corner: Option<f64>,
    /// Root mean square over the image.
    pub rms: f64,
}

/// Lengths of the residuals and their mean, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualStatistics {
    /// Half of them are shorter.
    pub median: f64,
    /// So long are 95 % of them at most.
    pub percentile_95: f64,
    /// The longest.
    pub largest: f64,
    /// Mean of the residuals as vectors.
    pub mean: Vector2<f64>,
}

impl MapErrors {
    /// Those of a calibration; `W` is the p×p weight of the map error.
    pub(super) fn new(calibration: &Calibration, W: &DMatrix<f64>) -> Self {
        let Calibration { camera, covariance, .. } = calibration;
        let (right, bottom) = (f64::from(camera.width()) - 1.0, f64::from(camera.height()) - 1.0);
        let (x, y) = (right / 2.0, bottom / 2.0);
        // The root mean square over the places of one kind, those that the lens reaches.
        let at = |places: &[(f64, f64)]| {
            let pixels: Vec<_> = places.iter().map(|&(u, v)| Vector2::new(u, v)).collect();
            let errors = calibration.unknowns().map_error_at(covariance, &pixels);
            let squares: Vec<f64> = errors.into_iter().flatten().map(|error| error * error).collect();
            (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        Self {
            centre: at(&[(x, y)]),
            edge: at(&[(0.0, y), (right, y), (x, 0.0), (x, bottom)]),
            corner: at(&[(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)]),
            rms: (W * covariance).trace().sqrt(),
        }
    }
}

impl ResidualStatistics {
    pub(super) fn new(residuals: &[Vector2<f64>]) -> Self {
        let mut lengths: Vec<f64> = residuals.iter().map(Vector2::norm).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        let quantile = |share: f64| {
            let place = share * lengths.len().saturating_sub(1) as f64;
            lengths.get(place.round() as usize).copied().unwrap_or(f64::NAN)
        };
        Self {
            median: quantile(0.5),
            percentile_95: quantile(0.95),
            largest: quantile(1.0),
            mean: residuals.iter().sum::<Vector2<f64>>() / residuals.len() as f64,
        }
    }
}
