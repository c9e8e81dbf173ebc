//! The distortion that [`BrownConrady`](super::Lens::BrownConrady) and [`Rational`](super::Lens::Rational) share: a radial factor
//! and a tangential shift of the point where the ray meets the plane z = 1.
//!
//! `k` are in OpenCV's order, `k1 k2 p1 p2 k3 k4 k5 k6`; zeros where a model has fewer.

use nalgebra::{Matrix2, Matrix2x3, SMatrix, Vector2, Vector3};

use super::first_zero::first_zero;
use super::model::{Distorted, MAX_COEFFICIENTS};

/// Greatest tangent of the angle to the axis at which a fold is looked for.
const FARTHEST: f64 = 1e4;

/// The greatest `r²` up to which the radial distortion grows.
pub(super) fn reach(k: &[f64]) -> f64 {
    first_zero(FARTHEST, |tan| {
        let r2 = tan * tan;
        let radial = Radial::at(r2, k);
        // d(r·c)/dr = c + 2 r² dc/d(r²); a vanishing denominator is a pole.
        if radial.denominator <= 0.0 { -1.0 } else { radial.factor + 2.0 * r2 * radial.slope }
    })
    .map_or(f64::INFINITY, |tan| tan.powi(2))
}

/// The angle whose `tan²` is `reach`.
pub(super) fn fold(reach: f64) -> Option<f64> {
    reach.is_finite().then(|| reach.sqrt().atan())
}

pub(super) fn distort(p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Vector2<f64>> {
    let m = (p.z > 0.0).then(|| p.xy() / p.z)?;
    let r2 = m.norm_squared();
    (r2 <= reach).then(|| m * Radial::at(r2, k).factor + tangential(&m, r2, k))
}

/// As [`distort`], with derivatives by `p` and by the first `COUNT` coefficients.
#[inline]
pub(super) fn distort_with_derivatives<const COUNT: usize>(
    p: &Vector3<f64>,
    k: &[f64],
    reach: f64,
) -> Option<Distorted> {
    let m = (p.z > 0.0).then(|| p.xy() / p.z)?;
    let r2 = m.norm_squared();
    if r2 > reach {
        return None;
    }
    let (x, y) = (m.x, m.y);
    let radial = Radial::at(r2, k);
    let (r4, r6) = (r2 * r2, r2 * r2 * r2);
    let by_numerator = m / radial.denominator;
    let by_denominator = -by_numerator * radial.factor;
    let columns = [
        by_numerator * r2,
        by_numerator * r4,
        Vector2::new(2.0 * x * y, r2 + 2.0 * y * y),
        Vector2::new(r2 + 2.0 * x * x, 2.0 * x * y),
        by_numerator * r6,
        by_denominator * r2,
        by_denominator * r4,
        by_denominator * r6,
    ];
    let mut by_coefficients = SMatrix::<f64, 2, MAX_COEFFICIENTS>::zeros();
    for (j, column) in columns.iter().take(COUNT).enumerate() {
        by_coefficients.set_column(j, column);
    }
    let perspective = Matrix2x3::new(1.0, 0.0, -x, 0.0, 1.0, -y) / p.z;
    Some(Distorted {
        point: m * radial.factor + tangential(&m, r2, k),
        by_point: jacobian(&m, &radial, k) * perspective,
        by_coefficients,
    })
}

/// By Newton's method.
pub(super) fn direction(m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Vector3<f64>> {
    let mut guess = *m;
    for _ in 0..50 {
        let r2 = guess.norm_squared();
        if r2 > reach {
            // Overshot the fold: come back inside and go on.
            guess *= 0.99 * (reach / r2).sqrt();
            continue;
        }
        let radial = Radial::at(r2, k);
        let residual = guess * radial.factor + tangential(&guess, r2, k) - m;
        guess -= jacobian(&guess, &radial, k).try_inverse()? * residual;
        if residual.norm() <= 1e-14 * (1.0 + m.norm()) {
            break;
        }
    }
    Some(guess.push(1.0))
}

/// `c(r²) = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)` and its slope by r².
struct Radial {
    factor: f64,
    slope: f64,
    denominator: f64,
}

impl Radial {
    #[inline]
    fn at(r2: f64, k: &[f64]) -> Self {
        let numerator = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
        let denominator = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
        let factor = numerator / denominator;
        let numerator_slope = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);
        let denominator_slope = k[5] + r2 * (2.0 * k[6] + r2 * 3.0 * k[7]);
        Self { factor, slope: (numerator_slope - factor * denominator_slope) / denominator, denominator }
    }
}

#[inline]
fn tangential(m: &Vector2<f64>, r2: f64, k: &[f64]) -> Vector2<f64> {
    let (x, y, p1, p2) = (m.x, m.y, k[2], k[3]);
    Vector2::new(2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y)
}

/// Derivative of the distorted by the undistorted point.
#[inline]
fn jacobian(m: &Vector2<f64>, radial: &Radial, k: &[f64]) -> Matrix2<f64> {
    let (x, y, p1, p2) = (m.x, m.y, k[2], k[3]);
    let cross = 2.0 * x * y * radial.slope + 2.0 * (p1 * x + p2 * y);
    Matrix2::new(
        radial.factor + 2.0 * x * x * radial.slope + 2.0 * p1 * y + 6.0 * p2 * x,
        cross,
        cross,
        radial.factor + 2.0 * y * y * radial.slope + 6.0 * p1 * y + 2.0 * p2 * x,
    )
}
