//! Brown's model (Brown 1966, Conrady 1919): three radial and two tangential coefficients.

use std::ops::Range;

use nalgebra::{Vector2, Vector3};

use super::model::{Distorted, Model};
use super::polynomial;
use crate::lanes::Number;

pub(super) struct BrownConrady;

impl Model for BrownConrady {
    fn name(&self) -> &'static str {
        "brown-conrady"
    }

    fn parameter_names(&self) -> &'static [&'static str] {
        &["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"]
    }

    fn known_as(&self) -> &'static [&'static str] {
        &["plumb_bob", "radtan", "radial-tangential", "opencv", "LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5"]
    }

    #[cfg(test)]
    fn typical(&self) -> &'static [f64] {
        &[-0.2, 0.05, 1e-3, -2e-3, 0.01]
    }

    fn is_fisheye(&self) -> bool {
        false
    }

    fn radial_polynomial(&self) -> Option<[usize; 2]> {
        Some([4, 5])
    }

    fn denominator(&self) -> Range<usize> {
        0..0
    }

    fn reach(&self, k: &[f64]) -> f64 {
        polynomial::reach(k)
    }

    fn fold(&self, reach: f64) -> Option<f64> {
        polynomial::fold(reach)
    }

    fn distort(&self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Vector2<f64>> {
        polynomial::distort(p, k, reach)
    }

    #[inline(always)]
    fn distort_with_derivatives<N: Number>(&self, p: [N; 3], k: &[f64], reach: f64) -> Option<Distorted<N>> {
        polynomial::distort_with_derivatives::<N, 5>(p, k, reach)
    }

    fn direction(&self, m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Vector3<f64>> {
        polynomial::direction(m, k, reach)
    }
}
