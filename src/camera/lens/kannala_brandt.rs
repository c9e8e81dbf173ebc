//! The fisheye of Kannala & Brandt 2006: a polynomial of the angle to the optical axis (OpenCV's `fisheye`).

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{Matrix2x3, SMatrix, Vector2, Vector3};

use super::first_zero::first_zero;
use super::model::{Distorted, Model};

pub(super) struct KannalaBrandt;

impl Model for KannalaBrandt {
    fn name(&self) -> &'static str {
        "kannala-brandt"
    }

    fn parameter_names(&self) -> &'static [&'static str] {
        &["fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"]
    }

    fn known_as(&self) -> &'static [&'static str] {
        &["fisheye", "equidistant", "equi", "kb4", "opencv_fisheye"]
    }

    #[cfg(test)]
    fn typical(&self) -> &'static [f64] {
        &[-0.02, 0.01, -0.004, 0.001]
    }

    fn is_fisheye(&self) -> bool {
        true
    }

    fn radial_polynomial(&self) -> Option<[usize; 2]> {
        None
    }

    fn denominator(&self) -> Range<usize> {
        0..0
    }

    fn reach(&self, k: &[f64]) -> f64 {
        first_zero(PI, |θ| slope(θ, k)).unwrap_or(PI)
    }

    fn fold(&self, reach: f64) -> Option<f64> {
        (reach < PI).then_some(reach)
    }

    fn distort(&self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Vector2<f64>> {
        let ρ = p.xy().norm();
        let θ = ρ.atan2(p.z);
        (θ <= reach && (ρ > 0.0 || p.z > 0.0))
            .then(|| if ρ == 0.0 { Vector2::zeros() } else { p.xy() * (distorted_angle(θ, k) / ρ) })
    }

    fn distort_with_derivatives(&self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Distorted> {
        let ρ = p.xy().norm();
        let θ = ρ.atan2(p.z);
        if θ > reach || (ρ == 0.0 && p.z <= 0.0) {
            return None;
        }
        let mut by_coefficients = SMatrix::zeros();
        if ρ < 1e-12 * p.z {
            // On the axis θ_d/ρ → 1/z.
            let by_point = Matrix2x3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0) / p.z;
            return Some(Distorted { point: p.xy() / p.z, by_point, by_coefficients });
        }
        let radial = p.xy() / ρ;
        let θ_d = distorted_angle(θ, k);
        let mut power = θ;
        for j in 0..4 {
            power *= θ * θ;
            by_coefficients.set_column(j, &(radial * power));
        }
        let d2 = p.norm_squared();
        // ∂θ/∂p = (z·radial, −ρ)/|p|²; across the radius the point turns with θ_d/ρ.
        let by_θ = Vector3::new(p.z * radial.x, p.z * radial.y, -ρ) / d2;
        let around = Vector2::new(-radial.y, radial.x);
        let by_xy = around * around.transpose() * (θ_d / ρ);
        let mut by_point = radial * by_θ.transpose() * slope(θ, k);
        by_point.fixed_columns_mut::<2>(0).zip_apply(&by_xy, |a, b| *a += b);
        Some(Distorted { point: radial * θ_d, by_point, by_coefficients })
    }

    /// By Newton's method.
    fn direction(&self, m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Vector3<f64>> {
        let target = m.norm();
        let mut θ = target.min(reach);
        for _ in 0..50 {
            let residual = distorted_angle(θ, k) - target;
            θ = (θ - residual / slope(θ, k)).clamp(0.0, reach);
            if residual.abs() <= 1e-15 * (1.0 + target) {
                break;
            }
        }
        let sine_over_target = if target == 0.0 { 1.0 } else { θ.sin() / target };
        Some((m * sine_over_target).push(θ.cos()))
    }
}

/// `θ_d = θ(1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)`.
fn distorted_angle(θ: f64, k: &[f64]) -> f64 {
    let t = θ * θ;
    θ * (1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))))
}

/// `dθ_d/dθ`.
fn slope(θ: f64, k: &[f64]) -> f64 {
    let t = θ * θ;
    1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + t * (7.0 * k[2] + t * 9.0 * k[3])))
}
