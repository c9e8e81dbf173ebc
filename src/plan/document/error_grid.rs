//! The map error at points of the image.

use nalgebra::{DMatrix, Vector2};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::information::Unknowns;

/// The map error over the image: the expected distance by which the calibration's error moves what is seen there, px.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorGrid {
    /// Where the points' columns are, px.
    pub u_px: Vec<f64>,
    /// Where their rows are, px.
    pub v_px: Vec<f64>,
    /// The errors, row by row; `null` where the lens does not reach.
    pub error_px: Vec<Vec<Option<f64>>>,
}

/// Points along the picture's longer side.
const POINTS: u32 = 24;

impl ErrorGrid {
    /// By the covariance (p×p) of the estimated intrinsics.
    pub(crate) fn new(unknowns: &Unknowns, covariance: &DMatrix<f64>) -> Self {
        let (width, height) = (unknowns.camera.width(), unknowns.camera.height());
        let cell = f64::from(width.max(height)) / f64::from(POINTS);
        let places = |size: u32| -> Vec<f64> {
            let count = (f64::from(size) / cell).round().max(1.0);
            (0..count as u32).map(|i| (f64::from(i) + 0.5) / count * f64::from(size) - 0.5).collect()
        };
        let (u_px, v_px) = (places(width), places(height));
        let pixels: Vec<_> = v_px.iter().flat_map(|&v| u_px.iter().map(move |&u| Vector2::new(u, v))).collect();
        let errors = unknowns.map_error_at(covariance, &pixels);
        Self { error_px: errors.chunks(u_px.len()).map(<[_]>::to_vec).collect(), u_px, v_px }
    }

    /// Whether its rows are as long as they should be, and there are some.
    pub fn is_regular(&self) -> bool {
        let Self { u_px, v_px, error_px } = self;
        let regular = error_px.len() == v_px.len() && error_px.iter().all(|row| row.len() == u_px.len());
        regular && !u_px.is_empty() && !v_px.is_empty()
    }

    /// The greatest error, px.
    pub fn greatest(&self) -> f64 {
        self.error_px.iter().flatten().flatten().copied().fold(0.0, f64::max)
    }
}
