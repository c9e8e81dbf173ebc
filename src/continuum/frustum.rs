//! Where a point must be for the camera to have it in the picture: a pyramid in C, a little wider than what is seen.

use std::f64::consts::FRAC_PI_2;

use crate::camera::Camera;

/// Slopes `x/z` and `y/z` between which all points seen lie, before the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frustum {
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
}

/// Steps of a lens's range that are looked at one by one.
const STEPS: usize = 4000;

/// The greatest tangent of the angle to the axis that is looked at.
const FARTHEST: f64 = 1e3;

/// Widest angle to the axis, rad, of a fisheye for which a pyramid is of use.
const WIDEST: f64 = FRAC_PI_2 - 0.1;

impl Frustum {
    /// Of the points whose pixels keep `margin` px from the border; none where no pyramid holds them all.
    pub(super) fn new(camera: &Camera, margin: f64) -> Option<Self> {
        let θ = camera.intrinsics();
        let [fx, fy, cx, cy] = [θ[0], θ[1], θ[2], θ[3]];
        let range = |size: u32, f: f64, c: f64| [(margin - c) / f, (f64::from(size) - 1.0 - margin - c) / f];
        let m = [range(camera.width(), fx, cx), range(camera.height(), fy, cy)];
        let farthest = |[low, high]: [f64; 2]| low.abs().max(high.abs());
        let radius = farthest(m[0]).hypot(farthest(m[1]));
        let mut k = [0.0; 8];
        k[..θ.len() - 4].copy_from_slice(&θ[4..]);
        let lens = if camera.lens().is_fisheye() { fisheye(&k, radius) } else { polynomial(&k, camera, radius) };
        let (widening, shift) = lens?;
        // Rounded outward.
        let slope = |m: f64| (m + shift) * widening * (1.0 + 1e-9) + 1e-9;
        let widened = |[low, high]: [f64; 2]| [-slope((-low).max(0.0)), slope(high.max(0.0))];
        Some(Self { x: widened(m[0]), y: widened(m[1]) })
    }
}

/// The greatest factor and shift from the normalised image point, no farther than `radius` out, to the slopes.
///
/// An image point is `c(r²)` times the slopes and a tangential part of at most `3 (|p1| + |p2|) r²`.
fn polynomial(k: &[f64; 8], camera: &Camera, radius: f64) -> Option<(f64, f64)> {
    let tangential = 3.0 * (k[2].abs() + k[3].abs());
    let most = camera.fold().map_or(FARTHEST, f64::tan).min(FARTHEST) * (1.0 + 1e-9);
    let (mut least_factor, mut reach) = (f64::INFINITY, 0.0f64);
    // Small steps at first, then in proportion.
    let edge = |i: usize| {
        let share = i as f64 / STEPS as f64;
        share * (most + 1.0).powf(share) * most / (most + 1.0)
    };
    for i in 0..STEPS {
        let (from, to) = (edge(i), edge(i + 1));
        let [numerator, _] = series([k[0], k[1], k[4]], from * from, to * to);
        let [denominator_low, denominator] = series([k[5], k[6], k[7]], from * from, to * to);
        let factor = if denominator_low > 0.0 {
            numerator.min(0.0) / denominator_low + numerator.max(0.0) / denominator
        } else {
            0.0
        };
        if from * factor - tangential * to * to <= radius {
            (least_factor, reach) = (least_factor.min(factor), to);
        }
    }
    // Farther out than looked at, a polynomial that has left the picture for good stays out of it.
    let unfolded = camera.fold().is_none_or(|fold| fold.tan() > FARTHEST);
    let far = FARTHEST * FARTHEST;
    let stays_out = !unfolded || leads(k, far, tangential, radius);
    (stays_out && (!unfolded || reach < most) && least_factor > 0.0)
        .then(|| (least_factor.recip(), tangential * reach * reach))
}

/// Whether `r |c(r²)| − tangential r²` is beyond `radius` wherever r² is beyond `far`: the leading power outweighs the others.
fn leads(k: &[f64; 8], far: f64, tangential: f64, radius: f64) -> bool {
    if k[5..].iter().any(|&k| k != 0.0) {
        return false;
    }
    let terms = [1.0, k[0], k[1], k[4]];
    let Some(leading) = terms.iter().rposition(|&term| term != 0.0) else { return false };
    let power = [0, 1, 2, 3][leading];
    let rest: f64 = (0..).zip(&terms[..leading]).map(|(i, term): (i32, &f64)| term.abs() * far.powi(i - power)).sum();
    // Per power of r: c(r²)/r^2n ≥ |k_n| − rest; the tangential part falls behind if n ≥ 1.
    let left = terms[leading].abs() - rest;
    let r = far.sqrt();
    let behind = if leading == 0 {
        if tangential == 0.0 { 0.0 } else { f64::INFINITY }
    } else {
        tangential * r.powi(1 - 2 * power)
    };
    left - behind > radius * r.powi(-1 - 2 * power)
}

/// Bounds of `1 + a s + b s² + c s³` over a range of s ≥ 0.
fn series([a, b, c]: [f64; 3], from: f64, to: f64) -> [f64; 2] {
    let mut bounds = [1.0, 1.0];
    for (n, k) in [(1, a), (2, b), (3, c)] {
        let ends = [k * from.powi(n), k * to.powi(n)];
        bounds[0] += ends[0].min(ends[1]);
        bounds[1] += ends[0].max(ends[1]);
    }
    bounds
}

/// The same of a fisheye: slopes are `tan θ / θ_d` times the image point.
fn fisheye(k: &[f64; 8], radius: f64) -> Option<(f64, f64)> {
    let mut widening = 0.0f64;
    let edge = |i: usize| WIDEST * i as f64 / STEPS as f64;
    for i in 0..STEPS {
        let (from, to) = (edge(i), edge(i + 1));
        let factor = {
            let [low, _] = series([k[0], k[1], k[2]], from * from, to * to);
            low + (k[3] * from.powi(8)).min(k[3] * to.powi(8))
        };
        if from * factor > radius {
            continue;
        }
        // tan θ / θ grows.
        widening = widening.max(if factor > 0.0 { to.tan() / to / factor } else { f64::INFINITY });
        if i + 1 == STEPS {
            return None;
        }
    }
    (widening.is_finite()).then_some((widening, 0.0))
}
