//! Static stability: the centre of mass over the support polygon.

use nalgebra::{Point2, Vector2, Vector3};
use thiserror::Error;

use super::travel::travel;
use crate::robot::{PointMass, Tree};
use crate::spatial::Pose;

/// What the robot stands on.
#[derive(Debug, Clone, PartialEq)]
pub struct Stability {
    /// Corners of the support polygon in the ground plane: convex, counterclockwise in the base frame's x and y, m.
    polygon: Vec<Point2<f64>>,
    /// The ground plane is z = `ground` in the base frame, m.
    ground: f64,
    /// Least distance in m of the projected centre of mass from the polygon's edges.
    pub margin: f64,
    /// Upwards, against gravity, in the base frame; the unit vector divided by its z.
    up: Vector3<f64>,
}

/// Why points span no support polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum StabilityError {
    /// Fewer than three points.
    #[error("{found} points do not span a support polygon; it needs at least 3")]
    TooFewPoints {
        /// Points given.
        found: usize,
    },
    /// All points lie on one line.
    #[error("the {points} points lie on one line and do not span a support polygon")]
    Collinear {
        /// Points given.
        points: usize,
    },
}

impl Stability {
    /// Support by the convex hull of `points` (x, y in the base frame, m) on the plane z = `ground` of the base frame, with
    /// `margin` (m). The robot stands on ground that rolls and pitches by so much (rad, the base frame turned by
    /// Ry(pitch)·Rx(roll) from level; |angles| below 90°): a positive pitch lowers the x axis.
    ///
    /// # Errors
    /// When the points span no area.
    pub fn new(
        points: &[Point2<f64>],
        ground: f64,
        margin: f64,
        roll: f64,
        pitch: f64,
    ) -> Result<Self, StabilityError> {
        if points.len() < 3 {
            return Err(StabilityError::TooFewPoints { found: points.len() });
        }
        let polygon = convex_hull(points);
        if polygon.len() < 3 {
            return Err(StabilityError::Collinear { points: points.len() });
        }
        // Rᵀ·ez of R = Ry(pitch)·Rx(roll).
        let up = Vector3::new(-pitch.sin(), pitch.cos() * roll.sin(), pitch.cos() * roll.cos());
        Ok(Self { polygon, ground, margin, up: up / up.z })
    }

    /// The support polygon: corners x, y in the base frame, counterclockwise, m.
    pub fn polygon(&self) -> &[Point2<f64>] {
        &self.polygon
    }

    /// Tip-over margin in m of a robot whose centre of mass is at `center` in the base frame: the distance of its projection
    /// along gravity onto the ground from the polygon's nearest edge, negative outside.
    pub fn margin_of(&self, center: &PointMass) -> f64 {
        let p = center.center;
        self.signed_distance(&(p.xy() - self.up.xy() * (p.z - self.ground)))
    }

    /// Tip-over margin in m with the links at `X_BL`; none if no link has a mass.
    pub fn margin_at(&self, tree: &Tree, X_BL: &[Pose]) -> Option<f64> {
        tree.center_of_mass(X_BL).map(|center| self.margin_of(&center))
    }

    /// A bound in m on how much the tip-over margin changes on the way from joint values `from` to `to`, straight in joint space; on a
    /// part of the way, by no more than that share of it.
    pub(crate) fn change(&self, tree: &Tree, from: &[f64], to: &[f64]) -> f64 {
        // An oblique projection lengthens by at most |up| / up.z.
        travel_of_center(tree, from, to) * self.up.norm()
    }

    /// Signed distance in m of a point to the polygon's nearest edge, positive inside.
    fn signed_distance(&self, p: &Point2<f64>) -> f64 {
        let edges = self.polygon.iter().zip(self.polygon.iter().cycle().skip(1));
        let (mut inside, mut nearest) = (true, f64::INFINITY);
        for (a, b) in edges {
            let (edge, to_p) = (b - a, p - a);
            inside &= edge.perp(&to_p) >= 0.0;
            let along = (edge.dot(&to_p) / edge.norm_squared()).clamp(0.0, 1.0);
            nearest = nearest.min((to_p - edge * along).norm());
        }
        if inside { nearest } else { -nearest }
    }
}

/// Corners of the convex hull, counterclockwise (Andrew's monotone chain); fewer than three if it has no area.
pub(crate) fn convex_hull(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let size = points.iter().map(|p| (p - points[0]).norm()).fold(0.0, f64::max);
    let chain = |points: &mut dyn Iterator<Item = &Point2<f64>>| {
        let mut hull: Vec<Point2<f64>> = Vec::new();
        for p in points {
            let turns_left = |hull: &[Point2<f64>]| {
                let [.., a, b] = hull else { return true };
                let (ab, ap): (Vector2<f64>, Vector2<f64>) = (b - a, p - a);
                ab.perp(&ap) > 1e-9 * size * size
            };
            while !turns_left(&hull) {
                hull.pop();
            }
            hull.push(*p);
        }
        hull.pop(); // the first of the other chain
        hull
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    hull
}

/// A bound in m on the length of the centre of mass's way from joint values `from` to `to`: those of the masses, weighted by mass.
fn travel_of_center(tree: &Tree, from: &[f64], to: &[f64]) -> f64 {
    let (mut total, mut travelled) = (0.0, 0.0);
    for (link, point) in tree.links.iter().enumerate().filter_map(|(i, link)| Some((i, link.mass?))) {
        total += point.mass;
        travelled += point.mass * travel(tree, link, None, point.center.coords.norm(), from, to);
    }
    if total > 0.0 { travelled / total } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use proptest::prelude::*;

    use super::*;
    use crate::robot::{JointKind, Link, Motion};

    fn square(margin: f64, roll: f64, pitch: f64) -> Stability {
        // A square of 0.4 m with a point inside and one on an edge, which the hull drops.
        let corners = [(0.2, 0.2), (-0.2, 0.2), (0.0, 0.1), (-0.2, -0.2), (0.2, -0.2), (0.2, 0.0)];
        Stability::new(&corners.map(|(x, y)| Point2::new(x, y)), -0.5, margin, roll, pitch).unwrap()
    }

    fn at(x: f64, y: f64, z: f64) -> PointMass {
        PointMass { mass: 2.0, center: Point3::new(x, y, z) }
    }

    #[test]
    fn margins_by_hand() {
        let level = square(0.0, 0.0, 0.0);
        assert_eq!(level.polygon().len(), 4);
        for (x, y, margin) in
            [(0.0, 0.0, 0.2), (0.19, 0.05, 0.01), (0.201, 0.0, -0.001), (0.23, 0.24, -0.05), (-0.2, 0.1, 0.0)]
        {
            assert!((level.margin_of(&at(x, y, 3.0)) - margin).abs() < 1e-12, "{x} {y}");
        }
    }

    /// On a slope of 45° a centre 0.15 m above the ground moves by 0.15 m downhill.
    #[test]
    fn slopes_carry_the_centre_downhill() {
        let slope = std::f64::consts::FRAC_PI_4;
        let down_x = square(0.0, 0.0, slope);
        assert!((down_x.margin_of(&at(0.0, 0.0, -0.35)) - 0.05).abs() < 1e-12);
        assert!((down_x.margin_of(&at(0.06, 0.0, -0.35)) + 0.01).abs() < 1e-12);
        // A positive roll lowers −y.
        let down_y = square(0.0, slope, 0.0);
        assert!((down_y.margin_of(&at(0.0, -0.04, -0.35)) - 0.01).abs() < 1e-12);
        assert!((down_y.margin_of(&at(0.0, -0.06, -0.35)) + 0.01).abs() < 1e-12);
        assert!((down_y.margin_of(&at(0.0, 0.1, -0.35)) - 0.15).abs() < 1e-12);
    }

    #[test]
    fn points_without_area_are_refused() {
        let new = |points: &[(f64, f64)]| {
            let points: Vec<_> = points.iter().map(|&(x, y)| Point2::new(x, y)).collect();
            Stability::new(&points, 0.0, 0.0, 0.0, 0.0).map(|_| ())
        };
        assert_eq!(new(&[(0.0, 0.0), (1.0, 0.0)]), Err(StabilityError::TooFewPoints { found: 2 }));
        let line = [(0.0, 0.1), (0.1, 0.2), (0.2, 0.3), (0.7, 0.8)];
        assert_eq!(new(&line), Err(StabilityError::Collinear { points: 4 }));
        assert_eq!(new(&[(0.3, 0.1); 5]), Err(StabilityError::Collinear { points: 5 }));
    }

    /// A mass of 1 kg on a telescope of 0.1 to 0.5 m that turns about z, on a base of 1 kg.
    fn crane() -> Tree {
        let driven = |joint, kind, axis| Motion::Driven { joint, kind, axis, multiplier: 1.0, offset: 0.0 };
        let link = |name: &str, parent, X_PJ, motion, mass: f64| Link {
            name: name.into(),
            parent,
            X_PJ,
            motion,
            bodies: vec![],
            mass: Some(PointMass { mass, center: Point3::origin() }),
        };
        let turn = driven(0, JointKind::Revolute, Vector3::z_axis());
        let reach = driven(1, JointKind::Prismatic, Vector3::x_axis());
        let links = vec![
            link("base", None, Pose::identity(), Motion::Fixed, 1.0),
            link("turn", Some(0), Pose::identity(), turn, 0.0),
            link("reach", Some(1), Pose::translation(0.1, 0.0, 0.0), reach, 1.0),
        ];
        Tree { links, disabled: vec![] }
    }

    #[test]
    fn the_bound_on_the_change_is_reached() {
        // The centre, at half the reach, goes 0.2 m straight out from the middle of the square, away from its nearest edge or towards it.
        let (tree, level) = (crane(), square(0.0, 0.0, 0.0));
        let (from, to) = ([0.0, 0.0], [0.0, 0.4]);
        let [near, far] = [from, to].map(|q| level.margin_at(&tree, &tree.link_poses(&q)).unwrap());
        assert!((near - 0.15).abs() < 1e-12 && (far + 0.05).abs() < 1e-12);
        assert!((level.change(&tree, &from, &to) - 0.2).abs() < 1e-12);
        assert_eq!(level.change(&Tree::default(), &[], &[]), 0.0);
    }

    proptest! {
        /// Between two places of a way the margin changes by no more than its share of the bound.
        #[test]
        fn margins_change_no_faster_than_the_bound(
            from in (-3.0..3.0f64, 0.0..0.4f64), to in (-3.0..3.0f64, 0.0..0.4f64), roll in -0.3..0.3f64,
            [a, b] in prop::array::uniform2(0.0..1.0f64),
        ) {
            let tree = crane();
            let support = square(0.0, roll, 0.1);
            let (from, to) = ([from.0, from.1], [to.0, to.1]);
            let margin = |t: f64| {
                let q = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
                support.margin_at(&tree, &tree.link_poses(&q)).unwrap()
            };
            let most = support.change(&tree, &from, &to) * (a - b).abs();
            prop_assert!((margin(a) - margin(b)).abs() <= most + 1e-12);
        }
    }
}
