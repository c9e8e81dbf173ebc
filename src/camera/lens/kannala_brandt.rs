//! The fisheye of Kannala & Brandt 2006: a polynomial of the angle to the optical axis (OpenCV's `fisheye`).

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{Vector2, Vector3};

use super::first_zero::first_zero;
use super::model::{Distorted, MAX_COEFFICIENTS, Model};
use crate::lanes::Number;

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

    #[inline(always)]
    fn distort_with_derivatives<N: Number>(&self, p: [N; 3], k: &[f64], reach: f64) -> Option<Distorted<N>> {
        let [x, y, z] = p;
        let ρ = (x * x + y * y).sqrt();
        let θ = ρ.zip(z, f64::atan2);
        // Straight ahead or back, of which the first alone has an image, ρ and z say more than the angle.
        let seen = ρ.zip(z, |ρ, z| if ρ > 0.0 || z > 0.0 { 0.0 } else { f64::INFINITY });
        if !(θ + seen).every(|θ| θ <= reach) {
            return None;
        }
        // On the axis θ_d/ρ → 1/z; with any ρ that is not 0, what there is off it vanishes there.
        let on_axis = ρ.zip(z, |ρ, z| if ρ < 1e-12 * z { 1.0 / z } else { 0.0 });
        let ρ = ρ.zip(z, |ρ, z| if ρ < 1e-12 * z { 1.0 } else { ρ });
        let radial = [x / ρ, y / ρ];
        let θ_d = distorted_angle(θ, k);
        let mut power = θ;
        let mut by_coefficients = [[N::all(0.0); 2]; MAX_COEFFICIENTS];
        for column in &mut by_coefficients[..4] {
            power = power * (θ * θ);
            *column = radial.map(|entry| entry * power);
        }
        // ∂θ/∂p = (z·radial, −ρ)/|p|²; across the radius the point turns with θ_d/ρ.
        let d2 = x * x + y * y + z * z;
        let by_θ = [z * radial[0] / d2, z * radial[1] / d2, -ρ / d2];
        let slope = slope(θ, k);
        let mut by_point = radial.map(|entry| by_θ.map(|by_θ| entry * by_θ * slope));
        let (around, turn) = ([-radial[1], radial[0]], θ_d / ρ);
        for (r, row) in by_point.iter_mut().enumerate() {
            for (entry, across) in row.iter_mut().zip(around) {
                *entry = *entry + around[r] * across * turn;
            }
            row[r] = row[r] + on_axis;
        }
        let point = [radial[0] * θ_d + x * on_axis, radial[1] * θ_d + y * on_axis];
        Some(Distorted { point, by_point, by_coefficients })
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
#[inline(always)]
fn distorted_angle<N: Number>(θ: N, k: &[f64]) -> N {
    θ * even(θ * θ, [1.0, k[0], k[1], k[2], k[3]])
}

/// `dθ_d/dθ`.
#[inline(always)]
fn slope<N: Number>(θ: N, k: &[f64]) -> N {
    even(θ * θ, [1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]])
}

/// The polynomial of those coefficients.
#[inline(always)]
fn even<N: Number>(t: N, [a, b, c, d, e]: [f64; 5]) -> N {
    N::all(a) + t * (N::all(b) + t * (N::all(c) + t * (N::all(d) + t * e)))
}
