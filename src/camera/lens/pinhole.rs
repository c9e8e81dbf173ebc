//! The pinhole: no distortion.

use std::ops::Range;

use nalgebra::{Matrix2x3, SMatrix, Vector2, Vector3};

use super::model::{Distorted, Model};

pub(super) struct Pinhole;

impl Model for Pinhole {
    fn name(&self) -> &'static str {
        "none"
    }

    fn parameter_names(&self) -> &'static [&'static str] {
        &["fx", "fy", "cx", "cy"]
    }

    fn known_as(&self) -> &'static [&'static str] {
        &["pinhole", "perspective", "LENSMODEL_PINHOLE"]
    }

    #[cfg(test)]
    fn typical(&self) -> &'static [f64] {
        &[]
    }

    fn is_fisheye(&self) -> bool {
        false
    }

    fn radial_polynomial(&self) -> Option<[usize; 2]> {
        None
    }

    fn denominator(&self) -> Range<usize> {
        0..0
    }

    fn reach(&self, _: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn fold(&self, _: f64) -> Option<f64> {
        None
    }

    fn distort(&self, p: &Vector3<f64>, _: &[f64], _: f64) -> Option<Vector2<f64>> {
        (p.z > 0.0).then(|| p.xy() / p.z)
    }

    fn distort_with_derivatives(&self, p: &Vector3<f64>, _: &[f64], _: f64) -> Option<Distorted> {
        let point = (p.z > 0.0).then(|| p.xy() / p.z)?;
        let by_point = Matrix2x3::new(1.0, 0.0, -point.x, 0.0, 1.0, -point.y) / p.z;
        Some(Distorted { point, by_point, by_coefficients: SMatrix::zeros() })
    }

    fn direction(&self, m: &Vector2<f64>, _: &[f64], _: f64) -> Option<Vector3<f64>> {
        Some(m.push(1.0))
    }
}
