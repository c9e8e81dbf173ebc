//! The pinhole: no distortion.

use std::ops::Range;

use nalgebra::{Vector2, Vector3};

use super::model::{Distorted, MAX_COEFFICIENTS, Model};
use crate::lanes::Number;

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

    #[inline(always)]
    fn distort_with_derivatives<N: Number>(&self, p: [N; 3], _: &[f64], _: f64) -> Option<Distorted<N>> {
        let [x, y, z] = p;
        if !z.every(|z| z > 0.0) {
            return None;
        }
        let (point, zero) = ([x / z, y / z], N::all(0.0));
        let along = N::all(1.0) / z;
        let by_point = [[along, zero, -point[0] / z], [zero, along, -point[1] / z]];
        Some(Distorted { point, by_point, by_coefficients: [[zero; 2]; MAX_COEFFICIENTS] })
    }

    fn direction(&self, m: &Vector2<f64>, _: &[f64], _: f64) -> Option<Vector3<f64>> {
        Some(m.push(1.0))
    }
}
