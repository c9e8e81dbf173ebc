//! OpenCV's rational model: Brown's, with a denominator of three coefficients more.

use std::ops::Range;

use nalgebra::{Vector2, Vector3};

use super::model::{Distorted, Model};
use super::polynomial;
use crate::lanes::Number;

pub(super) struct Rational;

impl Model for Rational {
    fn name(&self) -> &'static str {
        "rational"
    }

    fn parameter_names(&self) -> &'static [&'static str] {
        &["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"]
    }

    fn known_as(&self) -> &'static [&'static str] {
        &["rational_polynomial", "LENSMODEL_OPENCV8"]
    }

    #[cfg(test)]
    fn typical(&self) -> &'static [f64] {
        &[-0.012, 0.036, -2.5e-4, 5.3e-4, 0.0197, 0.0148, -0.0562, 0.05]
    }

    fn is_fisheye(&self) -> bool {
        false
    }

    fn radial_polynomial(&self) -> Option<[usize; 2]> {
        Some([4, 5])
    }

    fn denominator(&self) -> Range<usize> {
        9..12
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
        polynomial::distort_with_derivatives::<N, 8>(p, k, reach)
    }

    fn direction(&self, m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Vector3<f64>> {
        polynomial::direction(m, k, reach)
    }
}
