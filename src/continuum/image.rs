//! Images of points, as Taylor models: the lens models of [`camera`](crate::camera) with the derivatives that they have there.

use std::f64::consts::PI;

use super::taylor::{Expansion, Taylor};
use super::{LANES, Lanes};
use crate::camera::{Camera, Lens, MAX_INTRINSICS};
use crate::lanes::Number;

/// A pixel and its derivatives.
pub(super) struct Image<const N: usize, const Q: usize, const C: usize> {
    pub(super) pixel: [Taylor<N, Q, C>; 2],
    /// By the point in C, px per m.
    pub(super) by_point: [[Taylor<N, Q, C>; 3]; 2],
    /// By θ; none where it is zero. Boxed, for most are none and all of them are moved about.
    pub(super) by_intrinsics: [[Option<Box<Taylor<N, Q, C>>>; MAX_INTRINSICS]; 2],
    /// Whether the point is certainly behind the lens, where nothing has an image.
    pub(super) is_behind: [bool; LANES],
    /// Whether the models hold: where the point may be in the camera's plane they do not.
    pub(super) exists: [bool; LANES],
}

/// A normalised image point with its derivatives.
struct Distorted<const N: usize, const Q: usize, const C: usize> {
    point: [Taylor<N, Q, C>; 2],
    by_point: [[Taylor<N, Q, C>; 3]; 2],
    by_coefficients: Vec<[Taylor<N, Q, C>; 2]>,
    is_behind: [bool; LANES],
    exists: [bool; LANES],
}

/// The image of the point p in C. Points that the camera has no image of for another reason than their depth, such as those
/// beyond the lens's fold, have that of the formula.
pub(super) fn image<const N: usize, const Q: usize, const C: usize>(
    camera: &Camera,
    p: &[Taylor<N, Q, C>; 3],
) -> Image<N, Q, C> {
    let θ = camera.intrinsics();
    let mut k = [0.0; MAX_INTRINSICS - 4];
    k[..θ.len() - 4].copy_from_slice(&θ[4..]);
    let distorted = match camera.lens() {
        Lens::Pinhole => polynomial(p, &k, 0),
        Lens::BrownConrady => polynomial(p, &k, 5),
        Lens::Rational => polynomial(p, &k, 8),
        Lens::KannalaBrandt => fisheye(p, &k, camera.fold().unwrap_or(PI)),
    };
    let [fx, fy, cx, cy] = [θ[0], θ[1], θ[2], θ[3]];
    let focal = [fx, fy];
    let mut by_intrinsics: [[Option<Box<Taylor<N, Q, C>>>; MAX_INTRINSICS]; 2] = Default::default();
    for row in 0..2 {
        by_intrinsics[row][row] = Some(Box::new(distorted.point[row]));
        by_intrinsics[row][2 + row] = Some(Box::new(Taylor::constant(1.0)));
        for (j, column) in distorted.by_coefficients.iter().enumerate() {
            by_intrinsics[row][4 + j] = Some(Box::new(column[row].scaled(focal[row])));
        }
    }
    let [mx, my] = &distorted.point;
    Image {
        pixel: [mx.scaled(fx).plus(cx), my.scaled(fy).plus(cy)],
        by_point: std::array::from_fn(|row| distorted.by_point[row].map(|entry| entry.scaled(focal[row]))),
        by_intrinsics,
        is_behind: distorted.is_behind,
        exists: distorted.exists,
    }
}

/// The pinhole, Brown's and the rational model; see `camera::lens::polynomial`, whose names these are.
fn polynomial<const N: usize, const Q: usize, const C: usize>(
    p: &[Taylor<N, Q, C>; 3],
    k: &[f64; 8],
    coefficients: usize,
) -> Distorted<N, Q, C> {
    let (iz, mut exists) = p[2].recip();
    let front = p[2].c.0;
    let is_behind = p[2].greatest().0.map(|most| most <= 0.0);
    for (exists, z) in exists.iter_mut().zip(front) {
        *exists &= z > 0.0;
    }
    let (x, y) = (&p[0] * &iz, &p[1] * &iz);
    if coefficients == 0 {
        let zero = Taylor::constant(0.0);
        let by_point = [[iz, zero, -&(&x * &iz)], [zero, iz, -&(&y * &iz)]];
        return Distorted { point: [x, y], by_point, by_coefficients: Vec::new(), is_behind, exists };
    }
    let (xx, yy, xy) = (x.squared(), y.squared(), &x * &y);
    let r2 = &xx + &yy;
    let r4 = r2.squared();
    let r6 = &r2 * &r4;
    let series = |a: f64, b: f64, c: f64| Taylor::sum([(a, &r2), (b, &r4), (c, &r6)]);
    let slope_of = |a: f64, b: f64, c: f64| Taylor::sum([(2.0 * b, &r2), (3.0 * c, &r4)]).plus(a);
    let mut factor = series(k[0], k[1], k[4]).plus(1.0);
    let mut slope = slope_of(k[0], k[1], k[4]);
    let mut inverse = None;
    if coefficients > 5 {
        let (one_over, is_positive) = series(k[5], k[6], k[7]).plus(1.0).recip();
        for (exists, is_positive) in exists.iter_mut().zip(is_positive) {
            *exists &= is_positive;
        }
        factor = &factor * &one_over;
        slope = &(&slope - &(&factor * &slope_of(k[5], k[6], k[7]))) * &one_over;
        inverse = Some(one_over);
    }
    let (p1, p2) = (k[2], k[3]);
    let tangential = [
        Taylor::sum([(2.0 * p1, &xy), (p2, &r2), (2.0 * p2, &xx)]),
        Taylor::sum([(p1, &r2), (2.0 * p1, &yy), (2.0 * p2, &xy)]),
    ];
    let point = [&(&x * &factor) + &tangential[0], &(&y * &factor) + &tangential[1]];
    let (xx_slope, xy_slope, yy_slope) = (&xx * &slope, &xy * &slope, &yy * &slope);
    let one = 1.0;
    let D = [
        Taylor::sum([(one, &factor), (2.0, &xx_slope), (2.0 * p1, &y), (6.0 * p2, &x)]),
        Taylor::sum([(2.0, &xy_slope), (2.0 * p1, &x), (2.0 * p2, &y)]),
        Taylor::sum([(one, &factor), (2.0, &yy_slope), (6.0 * p1, &y), (2.0 * p2, &x)]),
    ];
    let by_point = [[&D[0], &D[1]], [&D[1], &D[2]]].map(|[by_x, by_y]| {
        let (by_x, by_y) = (by_x * &iz, by_y * &iz);
        [by_x, by_y, -&(&(&by_x * &x) + &(&by_y * &y))]
    });
    // By the numerator's coefficients m rⁿ / denominator, by the denominator's −m rⁿ c / denominator.
    let over = |of: &Taylor<N, Q, C>| inverse.as_ref().map_or(*of, |inverse| of * inverse);
    let by_numerator = [over(&x), over(&y)];
    let power = |of: &[Taylor<N, Q, C>; 2], power: &Taylor<N, Q, C>| [&of[0] * power, &of[1] * power];
    let mut by_coefficients = vec![
        power(&by_numerator, &r2),
        power(&by_numerator, &r4),
        [xy.scaled(2.0), Taylor::sum([(one, &r2), (2.0, &yy)])],
        [Taylor::sum([(one, &r2), (2.0, &xx)]), xy.scaled(2.0)],
        power(&by_numerator, &r6),
    ];
    if coefficients > 5 {
        let by_denominator = power(&by_numerator, &-&factor);
        by_coefficients.extend([&r2, &r4, &r6].map(|of| power(&by_denominator, of)));
    }
    Distorted { point, by_point, by_coefficients, is_behind, exists }
}

/// The fisheye. With the unit vector `a = p/|p|` and `w = a_z = cos θ`,
///
/// ```text
///     m = a_xy H(w)        H = θ_d / sin θ = h(w) (1 + k1 u + k2 u² + …)        h = θ / sin θ, u = θ²
/// ```
///
/// h and u are analytic on the axis too, `u' = −2h`.
fn fisheye<const N: usize, const Q: usize, const C: usize>(
    p: &[Taylor<N, Q, C>; 3],
    k: &[f64; 8],
    reach: f64,
) -> Distorted<N, Q, C> {
    let square = &(&p[0].squared() + &p[1].squared()) + &p[2].squared();
    let (n, mut exists) = square.recip_sqrt();
    let a = [&p[0] * &n, &p[1] * &n, &p[2] * &n];
    let w = &a[2];
    let least_seen = (reach + 1e-9).min(PI).cos();
    let most = w.greatest().0;
    let is_behind = std::array::from_fn(|lane| exists[lane] && most[lane] < least_seen);
    // From −0.9 on; nearer to the direction straight back nothing is bounded.
    let least = w.least().map(|least| least.min(1.0));
    for (exists, least) in exists.iter_mut().zip(least.0) {
        *exists &= least > -0.9;
    }
    let centre = Sines::at(w.c.map(|w| w.clamp(-0.9, 1.0)));
    let most = Sines::at(least.map(|w| w.max(-0.9)));
    let [h, h1] = [0, 1].map(|order| {
        w.through(&Expansion {
            value: centre.0[order],
            first: centre.0[order + 1],
            half_second: centre.0[order + 2] * 0.5,
            sixth_third: centre.0[order + 3] * (1.0 / 6.0),
            // The derivatives are of alternating sign and decrease in w.
            fourth: most.0[order + 4].abs() * (1.0 / 24.0 * (1.0 + 1e-9)),
        })
    });
    let u = {
        let θ = w.c.map(|w| w.clamp(-1.0, 1.0).acos());
        w.through(&Expansion {
            value: θ * θ,
            first: centre.0[0] * -2.0,
            half_second: -centre.0[1],
            sixth_third: centre.0[2] * (-1.0 / 3.0),
            fourth: most.0[3].abs() * (1.0 / 12.0 * (1.0 + 1e-9)),
        })
    };
    let u2 = u.squared();
    let (u3, u4) = (&u2 * &u, u2.squared());
    let series = Taylor::sum([(k[0], &u), (k[1], &u2), (k[2], &u3), (k[3], &u4)]).plus(1.0);
    let series_slope = Taylor::sum([(2.0 * k[1], &u), (3.0 * k[2], &u2), (4.0 * k[3], &u3)]).plus(k[0]);
    let H = &h * &series;
    // H' = h' P + h P'(u) u'.
    let slope = &(&h1 * &series) - &(&h.squared() * &series_slope).scaled(2.0);
    let point = [&a[0] * &H, &a[1] * &H];
    // ∂a/∂p = n (1 − a aᵀ).
    let (nH, n_slope) = (&n * &H, &n * &slope);
    let w_slope = &n_slope * w;
    let by_point = std::array::from_fn(|row| {
        let radial = &nH + &w_slope;
        let aside = &a[row] * &radial;
        let mut entries: [Taylor<N, Q, C>; 3] = std::array::from_fn(|column| -&(&aside * &a[column]));
        entries[row] = &entries[row] + &nH;
        entries[2] = &entries[2] + &(&a[row] * &n_slope);
        entries
    });
    let across = [&a[0] * &h, &a[1] * &h];
    let by_coefficients = [&u, &u2, &u3, &u4].map(|power| [&across[0] * power, &across[1] * power]).to_vec();
    Distorted { point, by_point, by_coefficients, is_behind, exists }
}

/// `h(w) = acos(w) / √(1 − w²)` and its first five derivatives: `∫₀^∞ dt / (t² + 2wt + 1)`, so that they alternate in sign and
/// decrease in size.
struct Sines([Lanes; 6]);

impl Sines {
    fn at(w: Lanes) -> Self {
        let columns = w.0.map(Self::one);
        Self(std::array::from_fn(|order| Lanes::of(std::array::from_fn(|lane| columns[lane][order]))))
    }

    fn one(w: f64) -> [f64; 6] {
        if w > 0.5 { Self::by_series(w) } else { Self::by_recurrence(w) }
    }

    /// `₂F₁(1, 1; 3/2; s) = Σ n! / (3/2)_n sⁿ` of `s = (1 − w)/2`.
    fn by_series(w: f64) -> [f64; 6] {
        let s = 0.5 * (1.0 - w);
        let mut sums = [0.0; 6];
        let mut coefficient = 1.0;
        let mut powers = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for n in 0..60 {
            if n > 0 {
                let n = f64::from(n);
                coefficient *= n / (n + 0.5);
                // d^k/ds^k of sⁿ from those of sⁿ⁻¹.
                for k in (1..6).rev() {
                    powers[k] = powers[k] * s + k as f64 * powers[k - 1];
                }
                powers[0] *= s;
            }
            for (sum, power) in sums.iter_mut().zip(powers) {
                *sum += coefficient * power;
            }
        }
        std::array::from_fn(|k| sums[k] * [1.0, -0.5, 0.25, -0.125, 0.0625, -0.03125][k])
    }

    /// `(1 − w²) h⁽ᵏ⁺¹⁾ = (2k + 1) w h⁽ᵏ⁾ + k² h⁽ᵏ⁻¹⁾`, and `(1 − w²) h' = w h − 1`.
    fn by_recurrence(w: f64) -> [f64; 6] {
        let square = 1.0 - w * w;
        let mut h = [0.0; 6];
        h[0] = w.acos() / square.sqrt();
        h[1] = (w * h[0] - 1.0) / square;
        for k in 1..5 {
            let n = k as f64;
            h[k + 1] = ((2.0 * n + 1.0) * w * h[k] + n * n * h[k - 1]) / square;
        }
        h
    }
}
