//! The distortion that [`BrownConrady`](super::Lens::BrownConrady) and [`Rational`](super::Lens::Rational) share: a radial factor
//! and a tangential shift of the point where the ray meets the plane z = 1.
//!
//! `k` are in OpenCV's order, `k1 k2 p1 p2 k3 k4 k5 k6`; zeros where a model has fewer.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::first_zero::first_zero;
use super::model::{Distorted, MAX_COEFFICIENTS};
use crate::lanes::Number;

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
    (r2 <= reach).then(|| distorted(m.into(), r2, Radial::at(r2, k).factor, k).into())
}

/// As [`distort`], with derivatives by `p` and by the first `COUNT` coefficients.
#[inline(always)]
pub(super) fn distort_with_derivatives<N: Number, const COUNT: usize>(
    p: [N; 3],
    k: &[f64],
    reach: f64,
) -> Option<Distorted<N>> {
    let z = p[2];
    if !z.every(|z| z > 0.0) {
        return None;
    }
    let [x, y] = [p[0] / z, p[1] / z];
    let r2 = x * x + y * y;
    if !r2.every(|r2| r2 <= reach) {
        return None;
    }
    let radial = Radial::at(r2, k);
    let (r4, r6) = (r2 * r2, r2 * r2 * r2);
    let by_numerator = [x / radial.denominator, y / radial.denominator];
    let by_denominator = by_numerator.map(|entry| -entry * radial.factor);
    let times = |column: [N; 2], power: N| column.map(|entry| entry * power);
    let cross = x * 2.0 * y;
    let columns = [
        times(by_numerator, r2),
        times(by_numerator, r4),
        [cross, r2 + y * 2.0 * y],
        [r2 + x * 2.0 * x, cross],
        times(by_numerator, r6),
        times(by_denominator, r2),
        times(by_denominator, r4),
        times(by_denominator, r6),
    ];
    let mut by_coefficients = [[N::all(0.0); 2]; MAX_COEFFICIENTS];
    by_coefficients[..COUNT].copy_from_slice(&columns[..COUNT]);
    let (along, across) = (N::all(1.0) / z, [-x / z, -y / z]);
    let by_point = jacobian([x, y], &radial, k).map(|[a, b]| [a * along, b * along, a * across[0] + b * across[1]]);
    Some(Distorted { point: distorted([x, y], r2, radial.factor, k), by_point, by_coefficients })
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
        let residual = Vector2::from(distorted(guess.into(), r2, radial.factor, k)) - m;
        let [[xx, xy], [yx, yy]] = jacobian(guess.into(), &radial, k);
        guess -= Matrix2::new(xx, xy, yx, yy).try_inverse()? * residual;
        if residual.norm() <= 1e-14 * (1.0 + m.norm()) {
            break;
        }
    }
    Some(guess.push(1.0))
}

/// `c(r²) = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)` and its slope by r².
struct Radial<N> {
    factor: N,
    slope: N,
    denominator: N,
}

impl<N: Number> Radial<N> {
    #[inline(always)]
    fn at(r2: N, k: &[f64]) -> Self {
        let cubic = |[a, b, c, d]: [f64; 4]| N::all(a) + r2 * (N::all(b) + r2 * (N::all(c) + r2 * d));
        let square = |[a, b, c]: [f64; 3]| N::all(a) + r2 * (N::all(b) + r2 * c);
        let numerator = cubic([1.0, k[0], k[1], k[4]]);
        let denominator = cubic([1.0, k[5], k[6], k[7]]);
        let factor = numerator / denominator;
        let numerator_slope = square([k[0], 2.0 * k[1], 3.0 * k[4]]);
        let denominator_slope = square([k[5], 2.0 * k[6], 3.0 * k[7]]);
        Self { factor, slope: (numerator_slope - factor * denominator_slope) / denominator, denominator }
    }
}

/// The undistorted point `m` times the radial factor, and shifted.
#[inline(always)]
fn distorted<N: Number>([x, y]: [N; 2], r2: N, factor: N, k: &[f64]) -> [N; 2] {
    let (p1, p2) = (k[2], k[3]);
    let shift = [x * (2.0 * p1) * y + (r2 + x * 2.0 * x) * p2, (r2 + y * 2.0 * y) * p1 + x * (2.0 * p2) * y];
    [x * factor + shift[0], y * factor + shift[1]]
}

/// Derivative of the distorted by the undistorted point, two rows.
#[inline(always)]
fn jacobian<N: Number>([x, y]: [N; 2], radial: &Radial<N>, k: &[f64]) -> [[N; 2]; 2] {
    let (p1, p2) = (k[2], k[3]);
    let cross = x * 2.0 * y * radial.slope + (x * p1 + y * p2) * 2.0;
    [
        [radial.factor + x * 2.0 * x * radial.slope + y * (2.0 * p1) + x * (6.0 * p2), cross],
        [cross, radial.factor + y * 2.0 * y * radial.slope + y * (6.0 * p1) + x * (2.0 * p2)],
    ]
}
