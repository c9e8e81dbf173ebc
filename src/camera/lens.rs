//! Lens models: from a direction in C to the normalised image point, and back.

use nalgebra::{Matrix2, Matrix2x3, SMatrix, Unit, Vector2, Vector3};

/// Coefficients of the largest lens model.
const MAX_COEFFICIENTS: usize = 8;

/// How a lens bends the rays; coefficients in OpenCV's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lens {
    /// No distortion.
    Pinhole,
    /// Brown 1966, five coefficients: `k1 k2 p1 p2 k3` (OpenCV's default, ROS `plumb_bob`).
    BrownConrady,
    /// OpenCV's rational model, eight coefficients: `k1 k2 p1 p2 k3 k4 k5 k6`.
    Rational,
    /// Kannala & Brandt 2006, four coefficients `k1 k2 k3 k4` of the angle to the axis (OpenCV's `fisheye`).
    KannalaBrandt,
}

/// A normalised image point with its derivatives.
pub(super) struct Distorted {
    pub(super) point: Vector2<f64>,
    pub(super) by_point: Matrix2x3<f64>,
    pub(super) by_coefficients: SMatrix<f64, 2, MAX_COEFFICIENTS>,
}

impl Lens {
    /// Every model.
    pub const ALL: [Lens; 4] = [Lens::Pinhole, Lens::BrownConrady, Lens::Rational, Lens::KannalaBrandt];

    /// Name as written in problem files.
    pub fn name(self) -> &'static str {
        match self {
            Lens::Pinhole => "none",
            Lens::BrownConrady => "brown-conrady",
            Lens::Rational => "rational",
            Lens::KannalaBrandt => "kannala-brandt",
        }
    }

    /// Names of all intrinsic parameters of a camera with this lens, in the order of θ.
    pub fn parameter_names(self) -> &'static [&'static str] {
        match self {
            Lens::Pinhole => &["fx", "fy", "cx", "cy"],
            Lens::BrownConrady => &["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"],
            Lens::Rational => &["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"],
            Lens::KannalaBrandt => &["fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"],
        }
    }

    /// How far from the optical axis the model is one-to-one: the greatest angle for a fisheye, the greatest
    /// `tan²` of the angle otherwise. Beyond it the radial polynomial turns back and would put far points into the
    /// image.
    pub(super) fn reach(self, k: &[f64]) -> f64 {
        match self {
            Lens::Pinhole => f64::INFINITY,
            Lens::BrownConrady | Lens::Rational => {
                first_zero(1e4, |tan| {
                    let r2 = tan * tan;
                    let radial = Radial::at(r2, k);
                    // d(r·c)/dr = c + 2 r² dc/d(r²); a vanishing denominator is a pole.
                    if radial.denominator <= 0.0 { -1.0 } else { radial.factor + 2.0 * r2 * radial.slope }
                })
                .powi(2)
            }
            Lens::KannalaBrandt => first_zero(std::f64::consts::PI, |θ| {
                let t = θ * θ;
                1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + t * (7.0 * k[2] + t * 9.0 * k[3])))
            }),
        }
    }

    /// The angle to the optical axis of [`Lens::reach`]; none where the model does not fold back.
    pub(super) fn fold(self, reach: f64) -> Option<f64> {
        match self {
            Lens::Pinhole | Lens::BrownConrady | Lens::Rational => reach.is_finite().then(|| reach.sqrt().atan()),
            Lens::KannalaBrandt => (reach < std::f64::consts::PI).then_some(reach),
        }
    }

    /// Names that other tools have for the model.
    pub fn known_as(self) -> &'static [&'static str] {
        match self {
            Lens::Pinhole => &["pinhole", "perspective", "LENSMODEL_PINHOLE"],
            Lens::BrownConrady => {
                &["plumb_bob", "radtan", "radial-tangential", "opencv", "LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5"]
            }
            Lens::Rational => &["rational_polynomial", "LENSMODEL_OPENCV8"],
            Lens::KannalaBrandt => &["fisheye", "equidistant", "equi", "kb4", "opencv_fisheye"],
        }
    }

    /// The normalised image point of direction `p` (any length).
    pub(super) fn distort(self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Vector2<f64>> {
        match self {
            Lens::Pinhole => (p.z > 0.0).then(|| p.xy() / p.z),
            Lens::BrownConrady | Lens::Rational => {
                let m = (p.z > 0.0).then(|| p.xy() / p.z)?;
                let r2 = m.norm_squared();
                (r2 <= reach).then(|| m * Radial::at(r2, k).factor + tangential(&m, r2, k))
            }
            Lens::KannalaBrandt => {
                let ρ = p.xy().norm();
                let θ = ρ.atan2(p.z);
                (θ <= reach && (ρ > 0.0 || p.z > 0.0))
                    .then(|| if ρ == 0.0 { Vector2::zeros() } else { p.xy() * (fisheye_angle(θ, k) / ρ) })
            }
        }
    }

    /// As [`Lens::distort`], with derivatives by `p` and by the coefficients.
    #[inline]
    pub(super) fn distort_with_derivatives(self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Distorted> {
        if self == Lens::KannalaBrandt {
            return fisheye_with_derivatives(p, k, reach);
        }
        if p.z <= 0.0 {
            return None;
        }
        let m = p.xy() / p.z;
        let (x, y) = (m.x, m.y);
        let perspective = Matrix2x3::new(1.0, 0.0, -x, 0.0, 1.0, -y) / p.z;
        let mut by_coefficients = SMatrix::zeros();
        if self == Lens::Pinhole {
            return Some(Distorted { point: m, by_point: perspective, by_coefficients });
        }
        let r2 = m.norm_squared();
        if r2 > reach {
            return None;
        }
        let radial = Radial::at(r2, k);
        let (r4, r6) = (r2 * r2, r2 * r2 * r2);
        let by_numerator = m / radial.denominator;
        let by_denominator = -by_numerator * radial.factor;
        by_coefficients.set_column(0, &(by_numerator * r2));
        by_coefficients.set_column(1, &(by_numerator * r4));
        by_coefficients.set_column(2, &Vector2::new(2.0 * x * y, r2 + 2.0 * y * y));
        by_coefficients.set_column(3, &Vector2::new(r2 + 2.0 * x * x, 2.0 * x * y));
        by_coefficients.set_column(4, &(by_numerator * r6));
        if self == Lens::Rational {
            by_coefficients.set_column(5, &(by_denominator * r2));
            by_coefficients.set_column(6, &(by_denominator * r4));
            by_coefficients.set_column(7, &(by_denominator * r6));
        }
        let by_m = planar_jacobian(&m, &radial, k);
        Some(Distorted {
            point: m * radial.factor + tangential(&m, r2, k),
            by_point: by_m * perspective,
            by_coefficients,
        })
    }

    /// The direction whose normalised image point is `m`, by Newton's method.
    pub(super) fn undistort(self, m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Unit<Vector3<f64>>> {
        let direction = match self {
            Lens::Pinhole => m.push(1.0),
            Lens::BrownConrady | Lens::Rational => {
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
                    guess -= planar_jacobian(&guess, &radial, k).try_inverse()? * residual;
                    if residual.norm() <= 1e-14 * (1.0 + m.norm()) {
                        break;
                    }
                }
                guess.push(1.0)
            }
            Lens::KannalaBrandt => {
                let target = m.norm();
                let mut θ = target.min(reach);
                for _ in 0..50 {
                    let t = θ * θ;
                    let slope = 1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + t * (7.0 * k[2] + t * 9.0 * k[3])));
                    let residual = fisheye_angle(θ, k) - target;
                    θ = (θ - residual / slope).clamp(0.0, reach);
                    if residual.abs() <= 1e-15 * (1.0 + target) {
                        break;
                    }
                }
                let sine_over_target = if target == 0.0 { 1.0 } else { θ.sin() / target };
                (m * sine_over_target).push(θ.cos())
            }
        };
        let again = self.distort(&direction, k, reach)?;
        ((again - m).norm() <= 1e-9 * (1.0 + m.norm())).then(|| Unit::new_normalize(direction))
    }
}

/// `c(r²) = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)` and its slope by r².
struct Radial {
    factor: f64,
    slope: f64,
    denominator: f64,
}

impl Radial {
    /// `k` in OpenCV's order, `k1 k2 p1 p2 k3 k4 k5 k6`; zeros where a model has fewer.
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

fn tangential(m: &Vector2<f64>, r2: f64, k: &[f64]) -> Vector2<f64> {
    let (x, y, p1, p2) = (m.x, m.y, k[2], k[3]);
    Vector2::new(2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y)
}

/// Derivative of the distorted by the undistorted point, for the polynomial models.
fn planar_jacobian(m: &Vector2<f64>, radial: &Radial, k: &[f64]) -> Matrix2<f64> {
    let (x, y, p1, p2) = (m.x, m.y, k[2], k[3]);
    let cross = 2.0 * x * y * radial.slope + 2.0 * (p1 * x + p2 * y);
    Matrix2::new(
        radial.factor + 2.0 * x * x * radial.slope + 2.0 * p1 * y + 6.0 * p2 * x,
        cross,
        cross,
        radial.factor + 2.0 * y * y * radial.slope + 6.0 * p1 * y + 2.0 * p2 * x,
    )
}

/// `θ_d = θ(1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)`.
fn fisheye_angle(θ: f64, k: &[f64]) -> f64 {
    let t = θ * θ;
    θ * (1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))))
}

fn fisheye_with_derivatives(p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Distorted> {
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
    let t = θ * θ;
    let θ_d = fisheye_angle(θ, k);
    let slope = 1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + t * (7.0 * k[2] + t * 9.0 * k[3])));
    let mut power = θ;
    for j in 0..4 {
        power *= t;
        by_coefficients.set_column(j, &(radial * power));
    }
    let d2 = p.norm_squared();
    // ∂θ/∂p = (z·radial, −ρ)/|p|²; across the radius the point turns with θ_d/ρ.
    let by_θ = Vector3::new(p.z * radial.x, p.z * radial.y, -ρ) / d2;
    let around = Vector2::new(-radial.y, radial.x);
    let by_xy = around * around.transpose() * (θ_d / ρ);
    let mut by_point = radial * by_θ.transpose() * slope;
    by_point.fixed_columns_mut::<2>(0).zip_apply(&by_xy, |a, b| *a += b);
    Some(Distorted { point: radial * θ_d, by_point, by_coefficients })
}

/// The first zero of `f` on (0, `end`], or `end`'s infinity where there is none: scanned on a geometric grid
/// fine enough for polynomials of this degree, then bisected.
fn first_zero(end: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: i32 = 4000;
    const START: f64 = 1e-3;
    let ratio = (end / START).powf(1.0 / f64::from(STEPS));
    let (mut low, mut high, mut steps) = (0.0, START, 0);
    while f(high) > 0.0 {
        if steps == STEPS {
            return if end > std::f64::consts::PI { f64::INFINITY } else { end };
        }
        low = high;
        high *= ratio;
        steps += 1;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}
