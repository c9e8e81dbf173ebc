//! Boxes of joint values from which the board is certainly not seen.

use nalgebra::{Point3, Vector3};

use super::frustum::Frustum;
use super::quadratic::Quadratic;
use super::taylor::Taylor;
use super::twist::{Kinematics, Moved, direction, point};
use super::{LANES, Lanes};
use crate::camera::Camera;
use crate::feasibility::VisibilityLimits;
use crate::sweep::AxisRule;
use crate::target::{Target, Zone};

/// What a view must satisfy, prepared.
#[derive(Debug, Clone)]
pub(super) struct Sight {
    limits: VisibilityLimits,
    pub(super) frustum: Option<Frustum>,
    zone: Option<Zone>,
    /// Points of the board of which a view sees all.
    required: Vec<Point3<f64>>,
}

/// Bounds the rounding of a linear form.
const ROUNDING: f64 = 1e-12;

impl Sight {
    pub(super) fn new(camera: &Camera, target: &Target, limits: &VisibilityLimits, axis: AxisRule) -> Self {
        let frustum = Frustum::new(camera, limits.margin);
        let corners: Vec<Point3<f64>> = target.board.corners().collect();
        let required = if limits.min_corners.is_none() { outermost(&corners) } else { Vec::new() };
        let zone = matches!(axis, AxisRule::Zone).then_some(target.zone);
        Self { limits: *limits, frustum, zone, required }
    }

    /// Whether no joint values of the box that the kinematics are of see the board.
    pub(super) fn excludes<const N: usize, const Q: usize, const C: usize>(&self, kinematics: &Kinematics) -> bool {
        let X_CT = &kinematics.X_CT;
        let normal: Moved<N, Q, C> = direction(&kinematics.of_board, &(X_CT.rotation * Vector3::z()));
        // The cosine of the tilt.
        if -normal.least(&Vector3::z()) < self.limits.max_tilt.cos() {
            return true;
        }
        if let Some(frustum) = &self.frustum {
            let is_outside = |p: &Point3<f64>| {
                let p: Moved<N, Q, C> = point(&kinematics.of_board, &(X_CT * p));
                frustum.sides().iter().any(|side| p.greatest(side) < 0.0)
            };
            if self.required.iter().any(is_outside) {
                return true;
            }
        }
        let camera: Moved<N, Q, C> = point(&kinematics.of_camera, &Point3::from(X_CT.inverse().translation.vector));
        // The height above the board's plane, and the distance from its centre.
        let height = camera.greatest(&Vector3::z());
        if height <= 0.0 {
            return true;
        }
        let [near, far] = camera.distances();
        if far < self.limits.min_distance || near > self.limits.max_distance {
            return true;
        }
        let cosine = self.limits.max_incidence.cos();
        if cosine > 0.0 && height < cosine * near * (1.0 - ROUNDING) {
            return true;
        }
        self.zone.as_ref().is_some_and(|zone| {
            let axis: Moved<N, Q, C> = direction(&kinematics.of_camera, &(X_CT.rotation.inverse() * Vector3::z()));
            misses(&camera, &axis, zone)
        })
    }
}

impl Frustum {
    /// Which of four points are certainly outside.
    pub(super) fn excludes<const N: usize, const Q: usize, const C: usize>(
        &self,
        p: &[Taylor<N, Q, C>; 3],
    ) -> [bool; LANES] {
        let mut is_outside = [false; LANES];
        for side in self.sides() {
            let depth = Taylor::sum((0..3).map(|row| (side[row], &p[row])));
            for (is_outside, most) in is_outside.iter_mut().zip(depth.greatest().0) {
                *is_outside |= most < 0.0;
            }
        }
        is_outside
    }

    /// Normals of its sides and of the camera's plane, inward.
    fn sides(&self) -> [Vector3<f64>; 5] {
        [
            Vector3::z(),
            Vector3::new(1.0, 0.0, -self.x[0]),
            Vector3::new(-1.0, 0.0, self.x[1]),
            Vector3::new(0.0, 1.0, -self.y[0]),
            Vector3::new(0.0, -1.0, self.y[1]),
        ]
    }
}

impl Sight {
    /// What of the limits can be written as `h(q) ≥ 0` at every view, over the box.
    pub(super) fn limits<const N: usize, const Q: usize, const C: usize>(
        &self,
        kinematics: &Kinematics,
    ) -> Vec<Quadratic<N, Q>> {
        let X_CT = &kinematics.X_CT;
        let camera: Moved<N, Q, C> = point(&kinematics.of_camera, &Point3::from(X_CT.inverse().translation.vector));
        let axis: Moved<N, Q, C> = direction(&kinematics.of_camera, &(X_CT.rotation.inverse() * Vector3::z()));
        let mut limits = Vec::new();
        let all = |of: &Moved<N, Q, C>, row: usize, factor: f64| model(of, [row; LANES], [factor; LANES]);
        // The axis falls on the board by no more than the tilt, which is the zone's condition on it too.
        let fall = all(&axis, 2, -1.0);
        limits.push(Quadratic::of(&fall.plus(-self.limits.max_tilt.cos()), 0));
        let squares = [0, 1, 2].map(|row| all(&camera, row, 1.0).squared());
        let square = &(&squares[0] + &squares[1]) + &squares[2];
        if self.limits.min_distance > 0.0 {
            limits.push(Quadratic::of(&square.plus(-self.limits.min_distance.powi(2)), 0));
        }
        if self.limits.max_distance.is_finite() {
            limits.push(Quadratic::of(&(-&square).plus(self.limits.max_distance.powi(2)), 0));
        }
        if let Some(zone) = &self.zone {
            let inside = inside(&camera, &axis, zone);
            limits.extend((0..LANES).map(|lane| Quadratic::of(&inside, lane)));
        }
        limits
    }
}

/// The outermost of a board's corners, four at most.
fn outermost(corners: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut found: Vec<Point3<f64>> = Vec::new();
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let most = corners.iter().max_by(|a, b| (x * a.x + y * a.y).total_cmp(&(x * b.x + y * b.y)));
        found.extend(most.filter(|corner| !found.contains(corner)));
    }
    found
}

/// Whether the axes from `camera` along `axis`, in T, all miss the zone.
fn misses<const N: usize, const Q: usize, const C: usize>(
    camera: &Moved<N, Q, C>,
    axis: &Moved<N, Q, C>,
    zone: &Zone,
) -> bool {
    // Downward, and the camera above: then `x fall + a_x z` is where the axis meets the plane, times fall.
    if axis.least(&Vector3::z()) >= 0.0 {
        return true;
    }
    inside(camera, axis, zone).greatest().0.iter().any(|&most| most < 0.0)
}

/// How far inside each of the zone's four sides the axis meets the plane, times its fall.
fn inside<const N: usize, const Q: usize, const C: usize>(
    camera: &Moved<N, Q, C>,
    axis: &Moved<N, Q, C>,
    zone: &Zone,
) -> Taylor<N, Q, C> {
    let sides = [1.0, -1.0, 1.0, -1.0];
    let across = [0, 0, 1, 1];
    let (fall, height) = (model(axis, [2; LANES], [-1.0; LANES]), model(camera, [2; LANES], [1.0; LANES]));
    let (place, slope) = (model(camera, across, sides), model(axis, across, sides));
    let half = Lanes::of([zone.width, zone.width, zone.height, zone.height].map(|size| 0.5 * size * (1.0 + ROUNDING)));
    &fall.scaled_by(half) - &(&(&place * &fall) + &(&slope * &height))
}

/// Coordinates of a vector, a factor times each.
fn model<const N: usize, const Q: usize, const C: usize>(
    of: &Moved<N, Q, C>,
    rows: [usize; LANES],
    factors: [f64; LANES],
) -> Taylor<N, Q, C> {
    let lanes = |v: &Vector3<f64>| Lanes::of(std::array::from_fn(|lane| factors[lane] * v[rows[lane]]));
    let r = Lanes::of(factors.map(|factor| of.r * factor.abs()));
    Taylor::new(lanes(&of.c), of.l.each_ref().map(lanes), of.q.each_ref().map(lanes), of.t.each_ref().map(lanes), r)
}

impl<const N: usize, const Q: usize, const C: usize> Moved<N, Q, C> {
    /// How far `along · v` can be from its centre.
    fn spread(&self, along: &Vector3<f64>) -> f64 {
        let terms = self.l.iter().chain(&self.q).chain(&self.t);
        let spread: f64 = terms.map(|v| along.dot(v).abs()).sum();
        spread + (self.r + ROUNDING * self.c.norm()) * along.norm() * (1.0 + ROUNDING)
    }

    fn greatest(&self, along: &Vector3<f64>) -> f64 {
        along.dot(&self.c) + self.spread(along)
    }

    fn least(&self, along: &Vector3<f64>) -> f64 {
        along.dot(&self.c) - self.spread(along)
    }

    /// Bounds of its length.
    fn distances(&self) -> [f64; 2] {
        let length = self.c.norm();
        let along = if length > 0.0 { self.c / length } else { Vector3::z() };
        let near = self.least(&along).max(0.0);
        let moved: f64 = self.l.iter().chain(&self.q).chain(&self.t).map(Vector3::norm).sum::<f64>() + self.r;
        [near, length + moved + ROUNDING * length]
    }

    /// How far each of the variables moves it.
    pub(super) fn slopes(&self) -> [f64; N] {
        self.l.map(|l| l.norm())
    }
}
