//! Static stability: the centre of mass over the support polygon.

use nalgebra::{Point2, Vector2, Vector3};
use thiserror::Error;

use super::rates::travel;
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

/// How far below the least margin of a way the bound of [`Stability::least_margin`] may lie, m.
const RESOLUTION: f64 = 1e-3;

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

    /// The least tip-over margin in m on the way from joint values `from` to `to`, straight in joint space; none if no link
    /// has a mass. The value is a lower bound that lies at most a millimetre below the least margin: the margin changes no
    /// faster than a rate known beforehand, so between two configurations it can sink only so far (Piyavskii 1972).
    pub fn least_margin(&self, tree: &Tree, from: &[f64], to: &[f64]) -> Option<f64> {
        let margin = |t: f64| {
            let q: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + t * (b - a)).collect();
            self.margin_at(tree, &tree.link_poses(&q))
        };
        let rate = self.change(tree, from, to);
        let (first, last) = (margin(0.0)?, margin(1.0)?);
        let mut least = first.min(last);
        let mut bound = f64::INFINITY;
        let mut open = vec![(0.0, first, 1.0, last)];
        while let Some((a, at_a, b, at_b)) = open.pop() {
            let lowest = (at_a + at_b - rate * (b - a)) / 2.0;
            if lowest >= least - RESOLUTION {
                bound = f64::min(bound, lowest);
                continue;
            }
            // Where the two slopes meet; never so near an end that the interval does not shrink.
            let middle = f64::midpoint(a, b) + (at_a - at_b) / (2.0 * rate);
            let middle = middle.clamp(a + 0.1 * (b - a), b - 0.1 * (b - a));
            let at_middle = margin(middle)?;
            least = least.min(at_middle);
            open.push((a, at_a, middle, at_middle));
            open.push((middle, at_middle, b, at_b));
        }
        Some(bound.min(least))
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
    fn the_way_may_tip_where_its_ends_do_not() {
        // The centre is at half the reach. Turning by 90° from x to y at 0.5 m passes the corner at 0.25 m from the middle.
        let tree = crane();
        let level = square(0.0, 0.0, 0.0);
        let (from, to) = ([0.1, 0.3], [std::f64::consts::FRAC_PI_2 - 0.1, 0.3]);
        let ends = level.margin_at(&tree, &tree.link_poses(&from)).unwrap();
        assert!((ends - (0.2 - 0.2 * 0.1f64.cos())).abs() < 1e-12);
        let least = level.least_margin(&tree, &from, &to).unwrap();
        assert!((0.0 - RESOLUTION..=ends + 1e-12).contains(&least));
        let over = level.least_margin(&tree, &[0.0, 0.4], &[std::f64::consts::PI, 0.4]).unwrap();
        // Beyond an edge by 0.05 at 0°, 90° and 180°, and nowhere more.
        assert!((-0.05 - RESOLUTION..=-0.05).contains(&over), "{over}");
        assert_eq!(level.least_margin(&Tree::default(), &[], &[]), None);
    }

    proptest! {
        #[test]
        fn least_margins_are_bounds_and_near_the_least_of_many(
            from in (-3.0..3.0f64, 0.0..0.4f64), to in (-3.0..3.0f64, 0.0..0.4f64), roll in -0.3..0.3f64,
        ) {
            let tree = crane();
            let support = square(0.0, roll, 0.1);
            let (from, to) = ([from.0, from.1], [to.0, to.1]);
            let bound = support.least_margin(&tree, &from, &to).unwrap();
            let margin = |i: u32| {
                let t = f64::from(i) / 1000.0;
                let q = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
                support.margin_at(&tree, &tree.link_poses(&q)).unwrap()
            };
            let least = (0..=1000).map(margin).fold(f64::INFINITY, f64::min);
            prop_assert!(bound <= least, "{bound} {least}");
            // A thousandth of the way moves the centre by less than 2 mm.
            prop_assert!(bound >= least - RESOLUTION - 2e-3, "{bound} {least}");
        }
    }
}
