//! Solids and the gaps between them.
//!
//! Every solid is a convex *core* and a radius: the points within that radius of the core. A sphere is a point with a radius,
//! a capsule a segment with one, so the distance of rounded solids is that of their cores less the radii.

use nalgebra::{Point3, Unit, Vector3};
use parry3d_f64::query::gjk::{CSOPoint, GJKResult, VoronoiSimplex, closest_points};
use parry3d_f64::shape::SupportMap;

use crate::robot::{Body, Shape, Tree};
use crate::spatial::Pose;

/// A body of a robot, ready for measuring.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Solid {
    /// The link it is attached to.
    pub(super) link: usize,
    /// Pose in the link's frame of the frame G, whose origin is the middle of the solid.
    X_LG: Pose,
    core: Core,
    /// Thickness about the core, m.
    radius: f64,
    /// Radius in m of a sphere about G's origin that holds the solid.
    pub(super) reach: f64,
}

/// A convex shape in its own frame, in m.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Core {
    Point,
    Segment([Point3<f64>; 2]),
    Box(Vector3<f64>),
    /// Radius, and half the length along z.
    Cylinder(f64, f64),
    Hull(Vec<Point3<f64>>),
}

/// A solid where it stands in the base frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'s> {
    pub(super) solid: &'s Solid,
    pub(super) X_BG: Pose,
}

impl SupportMap for Core {
    /// The point of the core that lies farthest in direction `dir`.
    fn local_support_point(&self, dir: &Vector3<f64>) -> Point3<f64> {
        match self {
            Core::Point => Point3::origin(),
            Core::Segment([a, b]) => {
                if dir.dot(&(b - a)) > 0.0 {
                    *b
                } else {
                    *a
                }
            }
            Core::Box(half) => Point3::from(half.zip_map(dir, f64::copysign)),
            Core::Cylinder(radius, half) => {
                let out = dir.xy().try_normalize(0.0).unwrap_or_default() * *radius;
                Point3::new(out.x, out.y, half.copysign(dir.z))
            }
            Core::Hull(points) => farthest(points, dir),
        }
    }
}

/// The first of the points that lie farthest in direction `dir`.
pub(super) fn farthest(points: &[Point3<f64>], dir: &Vector3<f64>) -> Point3<f64> {
    let farther = |best: (f64, Point3<f64>), point: &Point3<f64>| {
        let along = point.coords.dot(dir);
        if along > best.0 { (along, *point) } else { best }
    };
    points.iter().fold((f64::NEG_INFINITY, Point3::origin()), farther).1
}

/// A core in millimetres. The search gives up when a step gains less than about 10⁻⁷ in its units' squares, which for links in
/// metres may be 10 µm.
struct Fine<'c>(&'c Core);

pub(super) const MILLIMETRES: f64 = 1e3;

impl SupportMap for Fine<'_> {
    fn local_support_point(&self, dir: &Vector3<f64>) -> Point3<f64> {
        self.0.local_support_point(dir) * MILLIMETRES
    }
}

impl Core {
    /// A lower bound of the distance in m to the core `other`, whose pose in this one's frame is `X_12`: a plane separates
    /// the two by that much. Not positive if they are not proven apart. Where the distance is below `enough`, and where they
    /// are apart at all, the bound is the distance but for rounding.
    pub(super) fn separation(&self, X_12: &Pose, other: &Core, enough: f64) -> f64 {
        let (one, two) = (&Fine(self), &Fine(other));
        let X_12 = &Pose::from_parts((X_12.translation.vector * MILLIMETRES).into(), X_12.rotation);
        let start = Unit::try_new(-X_12.translation.vector, 1e-9).unwrap_or(Vector3::x_axis());
        let mut simplex = VoronoiSimplex::new();
        simplex.reset(CSOPoint::from_shapes(X_12, one, two, &start));
        // The search may end early or stall. What counts is the gap that its axis leaves, whatever it says itself.
        let (axis, between) = match closest_points(X_12, one, two, enough * MILLIMETRES, true, &mut simplex) {
            GJKResult::Intersection => return 0.0,
            GJKResult::ClosestPoints(p_1, p_2, axis) => (axis, Unit::try_new(p_2 - p_1, 0.0)),
            GJKResult::Proximity(axis) | GJKResult::NoIntersection(axis) => (axis, None),
        };
        let gap = |axis: Unit<Vector3<f64>>| -axis.dot(&CSOPoint::from_shapes(X_12, one, two, &axis).point.coords);
        gap(axis).max(between.map_or(f64::NEG_INFINITY, gap)) / MILLIMETRES
    }
}

impl Solid {
    /// How far the solid's points are from the origin of its link's frame at most, m.
    pub(super) fn arm(&self) -> f64 {
        self.X_LG.translation.vector.norm() + self.reach
    }

    /// The solids of all links; empty convex hulls are none.
    pub(super) fn all(tree: &Tree) -> Vec<Solid> {
        let of_link = |(link, bodies): (usize, &Vec<Body>)| -> Vec<Solid> {
            bodies.iter().filter_map(|body| Solid::new(link, body)).collect()
        };
        tree.links.iter().map(|link| &link.bodies).enumerate().flat_map(of_link).collect()
    }

    fn new(link: usize, body: &Body) -> Option<Self> {
        let (core, radius, size) = match &body.shape {
            Shape::Box { half_extents } => (Core::Box(*half_extents), 0.0, half_extents.norm()),
            Shape::Cylinder { radius, length } => {
                (Core::Cylinder(*radius, length / 2.0), 0.0, radius.hypot(length / 2.0))
            }
            Shape::Sphere { radius } => (Core::Point, *radius, 0.0),
            Shape::Capsule { radius, length } => {
                let end = Point3::new(0.0, 0.0, length / 2.0);
                (Core::Segment([-end, end]), *radius, length / 2.0)
            }
            Shape::Convex { points, margin } => {
                let first = points.first()?;
                let (low, high) = points.iter().fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
                let middle = nalgebra::center(&low, &high);
                let centred: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(p - middle)).collect();
                let size = centred.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
                let X_LG = body.X_LG * nalgebra::Translation3::from(middle);
                let (core, radius) = (Core::Hull(centred), *margin);
                return Some(Self { link, X_LG, core, radius, reach: size + radius });
            }
        };
        Some(Self { link, X_LG: body.X_LG, core, radius, reach: size + radius })
    }
}

impl<'s> Placed<'s> {
    /// The solids with their links at `X_BL`.
    pub(super) fn all(solids: &'s [Solid], X_BL: &[Pose]) -> Vec<Self> {
        solids.iter().map(|solid| Self { solid, X_BG: X_BL[solid.link] * solid.X_LG }).collect()
    }

    /// Middle of the solid in the base frame.
    pub(super) fn middle(&self) -> Point3<f64> {
        Point3::from(self.X_BG.translation.vector)
    }

    /// Whether the solids are within `clearance` (m) of each other, or not proven farther apart.
    pub(super) fn is_within(&self, clearance: f64, other: &Self) -> bool {
        let apart = self.solid.reach + other.solid.reach + clearance;
        if (self.X_BG.translation.vector - other.X_BG.translation.vector).norm_squared() > apart * apart {
            return false;
        }
        let enough = self.solid.radius + other.solid.radius + clearance;
        let X_12 = self.X_BG.inv_mul(&other.X_BG);
        self.solid.core.separation(&X_12, &other.solid.core, enough) <= enough
    }

    /// Distance in m between the solids; not positive where they touch, and then not their depth.
    pub(super) fn gap(&self, other: &Self) -> f64 {
        let X_12 = self.X_BG.inv_mul(&other.X_BG);
        let separation = self.solid.core.separation(&X_12, &other.solid.core, f64::INFINITY);
        separation - self.solid.radius - other.solid.radius
    }

    /// Distance in m between the solids, or no less than `enough` where it is more than that.
    pub(super) fn gap_up_to(&self, enough: f64, other: &Self) -> f64 {
        if self.is_within(enough, other) { self.gap(other) } else { enough }
    }

    /// Whether the solid meets `core`, given in the base frame.
    pub(super) fn meets(&self, core: &Core) -> bool {
        let X_GB = self.X_BG.inverse();
        self.solid.core.separation(&X_GB, core, self.solid.radius) <= self.solid.radius
    }

    /// Whether the solid holds the point.
    pub(super) fn holds(&self, point_B: &Point3<f64>) -> bool {
        if (point_B - self.middle()).norm_squared() > self.solid.reach * self.solid.reach {
            return false;
        }
        let X_GP = self.X_BG.inverse() * nalgebra::Translation3::from(point_B.coords);
        self.solid.core.separation(&X_GP, &Core::Point, self.solid.radius) <= self.solid.radius
    }

    /// How far the solid reaches in the unit direction `dir_B`: the greatest coordinate of its points along it, m.
    pub(super) fn extent(&self, dir_B: &Vector3<f64>) -> f64 {
        let dir_G = self.X_BG.rotation.inverse() * dir_B;
        let point_B = self.X_BG * self.solid.core.local_support_point(&dir_G);
        point_B.coords.dot(dir_B) + self.solid.radius
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn solid(shape: Shape) -> Solid {
        Solid::new(0, &Body { X_LG: Pose::identity(), shape }).unwrap()
    }

    fn placed(solid: &Solid, X_BG: Pose) -> Placed<'_> {
        Placed { solid, X_BG }
    }

    fn pose() -> impl Strategy<Value = Pose> {
        let number = -1.0..1.0f64;
        (prop::array::uniform3(number.clone()), prop::array::uniform3(number))
            .prop_map(|(p, r)| Pose::new(Vector3::from(p) * 0.3, Vector3::from(r) * 3.0))
    }

    fn shape() -> impl Strategy<Value = Shape> {
        let size = 0.01..0.2f64;
        let sizes = prop::array::uniform3(size);
        let corner = prop::array::uniform3(-0.2..0.2f64);
        prop_oneof![
            sizes.clone().prop_map(|s| Shape::Box { half_extents: Vector3::from(s) }),
            sizes.clone().prop_map(|[radius, length, _]| Shape::Cylinder { radius, length }),
            sizes.clone().prop_map(|[radius, ..]| Shape::Sphere { radius }),
            sizes.prop_map(|[radius, length, _]| Shape::Capsule { radius, length }),
            (prop::collection::vec(corner, 4..20), 0.0..0.01f64).prop_map(|(points, margin)| {
                Shape::Convex { points: points.into_iter().map(Point3::from).collect(), margin }
            }),
        ]
    }

    /// Shapes whose distance to a point has a closed form.
    fn rounded_shape() -> impl Strategy<Value = Shape> {
        shape().prop_filter("hulls have none", |shape| !matches!(shape, Shape::Convex { .. }))
    }

    /// Distance of a point outside from the shape; not positive inside.
    fn distance_to_point(shape: &Shape, p: &Point3<f64>) -> f64 {
        let outside = |over: [f64; 3]| {
            let inside = over.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(0.0);
            inside + Vector3::from(over.map(|o| o.max(0.0))).norm()
        };
        let aside = p.x.hypot(p.y);
        match shape {
            Shape::Box { half_extents } => outside([0, 1, 2].map(|i| p[i].abs() - half_extents[i])),
            Shape::Cylinder { radius, length } => {
                outside([aside - radius, p.z.abs() - length / 2.0, f64::NEG_INFINITY])
            }
            Shape::Sphere { radius } => p.coords.norm() - radius,
            Shape::Capsule { radius, length } => aside.hypot((p.z.abs() - length / 2.0).max(0.0)) - radius,
            Shape::Convex { .. } => f64::NAN,
        }
    }

    /// Boxes are apart exactly if one of fifteen axes separates them (Gottschalk, Lin & Manocha 1996): the greatest gap
    /// along these, which the distance is no smaller than.
    fn gap_along_fifteen_axes(a: &Vector3<f64>, X_12: &Pose, b: &Vector3<f64>) -> f64 {
        let R = X_12.rotation.to_rotation_matrix();
        let (own, other) = ([0, 1, 2].map(|i| Vector3::ith(i, 1.0)), [0, 1, 2].map(|i| R * Vector3::ith(i, 1.0)));
        let crosses = own.iter().flat_map(|u| other.iter().map(move |v| u.cross(v)));
        let axes = own.iter().chain(&other).copied().chain(crosses).filter_map(|axis| axis.try_normalize(1e-9));
        let gap = |axis: Vector3<f64>| {
            let half = |size: &Vector3<f64>, sides: &[Vector3<f64>; 3]| -> f64 {
                (0..3).map(|i| size[i] * axis.dot(&sides[i]).abs()).sum()
            };
            axis.dot(&X_12.translation.vector).abs() - half(a, &own) - half(b, &other)
        };
        axes.map(gap).fold(f64::NEG_INFINITY, f64::max)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn boxes_meet_exactly_if_no_axis_separates_them(
            a in prop::array::uniform3(0.01..0.2f64), b in prop::array::uniform3(0.01..0.2f64), X_12 in pose(),
        ) {
            let (a, b) = (Vector3::from(a), Vector3::from(b));
            let apart = gap_along_fifteen_axes(&a, &X_12, &b);
            let (one, two) = (solid(Shape::Box { half_extents: a }), solid(Shape::Box { half_extents: b }));
            let (one, two) = (placed(&one, Pose::identity()), placed(&two, X_12));
            // The fifteen axes tell the sign; between faces, not the distance.
            prop_assert!(one.gap(&two) > apart - 1e-6, "{} {apart}", one.gap(&two));
            prop_assert_eq!(one.is_within(0.0, &two), apart <= 0.0);
        }

        /// Beside a box of many metres, as beside a plane: the distance is that of the lowest point.
        #[test]
        fn a_large_box_is_a_floor(shape in shape(), X_BG in pose(), size in 1.0..50.0f64, height in 0.0..0.6f64) {
            let half_extents = Vector3::new(size, size, size / 2.0);
            let floor = solid(Shape::Box { half_extents });
            let body = solid(shape);
            let body = placed(&body, Pose::translation(0.1, -0.2, height) * X_BG);
            let floor = placed(&floor, Pose::translation(0.0, 0.0, -size / 2.0));
            let lowest = -body.extent(&-Vector3::z());
            prop_assume!(lowest.abs() > 1e-6);
            prop_assert_eq!(floor.is_within(0.0, &body), lowest < 0.0);
            if lowest > 0.0 {
                prop_assert!((floor.gap(&body) - lowest).abs() < 1e-6, "{} {lowest}", floor.gap(&body));
                prop_assert!(body.is_within(lowest + 1e-6, &floor) && !body.is_within(lowest - 1e-6, &floor));
            }
        }

        /// In closed form: how far a point is from each shape.
        #[test]
        fn balls_are_as_far_as_their_middles_less_their_radius(
            shape in rounded_shape(), X_BG in pose(), p in prop::array::uniform3(-0.5..0.5f64), ball in 0.01..0.1f64,
        ) {
            let X_BP = Pose::translation(p[0], p[1], p[2]);
            let distance = distance_to_point(&shape, &(X_BG.inverse() * Point3::from(p))) - ball;
            let (one, two) = (solid(shape), solid(Shape::Sphere { radius: ball }));
            let (one, two) = (placed(&one, X_BG), placed(&two, X_BP));
            if distance > 0.0 {
                prop_assert!((one.gap(&two) - distance).abs() < 1e-6, "{} {distance}", one.gap(&two));
            }
            prop_assume!(distance.abs() > 1e-6);
            prop_assert_eq!(one.is_within(0.0, &two), distance < 0.0);
            prop_assert_eq!(one.is_within(0.05, &two), distance < 0.05);
            prop_assert_eq!(one.holds(&Point3::from(p)), distance + ball <= 0.0);
        }

        /// No two points of the solids are nearer than the gap, which is the same both ways and what verdicts go by.
        #[test]
        fn gaps_bound_the_distance_of_any_two_points(
            a in shape(), b in shape(), X_B1 in pose(), X_B2 in pose(), dirs in prop::collection::vec(pose(), 20),
        ) {
            let (one, two) = (solid(a), solid(b));
            let (one, two) = (placed(&one, X_B1), placed(&two, X_B2));
            let gap = one.gap(&two);
            prop_assert!((gap - two.gap(&one)).abs() < 1e-6 || gap.max(two.gap(&one)) < 1e-6);
            let point = |solid: &Placed, dir: &Vector3<f64>| {
                let dir_G = solid.X_BG.rotation.inverse() * dir;
                solid.X_BG * solid.solid.core.local_support_point(&dir_G) + dir * solid.solid.radius
            };
            let dirs: Vec<Vector3<f64>> = dirs.iter().map(|X| X.rotation * Vector3::x()).collect();
            for u in &dirs {
                for v in &dirs {
                    prop_assert!((point(&one, u) - point(&two, v)).norm() > gap - 1e-12);
                }
            }
            if gap > 1e-6 {
                prop_assert!(!one.is_within(gap - 1e-6, &two) && one.is_within(gap + 1e-5, &two));
            } else {
                prop_assert!(one.is_within(1e-5, &two));
            }
        }
    }

    #[test]
    fn distances_by_hand() {
        let ball = solid(Shape::Sphere { radius: 0.1 });
        let capsule = solid(Shape::Capsule { radius: 0.05, length: 0.4 });
        let cube = solid(Shape::Box { half_extents: Vector3::repeat(0.1) });
        let rod = solid(Shape::Cylinder { radius: 0.1, length: 0.2 });
        let at = |x: f64, y: f64, z: f64| Pose::translation(x, y, z);
        let gap = |a: &Solid, X_BA: Pose, b: &Solid, X_BB: Pose| placed(a, X_BA).gap(&placed(b, X_BB));
        assert!((gap(&ball, at(0.0, 0.0, 0.0), &ball, at(0.3, 0.0, 0.4)) - 0.3).abs() < 1e-12);
        assert!((gap(&ball, at(0.3, 0.0, 0.1), &capsule, at(0.0, 0.0, 0.0)) - 0.15).abs() < 1e-12);
        assert!((gap(&cube, at(0.0, 0.0, 0.0), &ball, at(0.4, 0.5, 0.1)) - 0.4).abs() < 1e-9);
        assert!((gap(&rod, at(0.0, 0.0, 0.0), &rod, at(0.3, 0.4, 0.0)) - 0.3).abs() < 1e-6);
        assert!(gap(&rod, at(0.0, 0.0, 0.0), &rod, at(0.3, 0.4, 0.25)) > 0.3);
        let inside = placed(&cube, at(0.0, 0.0, 0.0));
        assert!(inside.holds(&Point3::new(0.099, -0.099, 0.099)) && !inside.holds(&Point3::new(0.101, 0.0, 0.0)));
        assert!((placed(&capsule, at(0.0, 0.0, 1.0)).extent(&Vector3::z()) - 1.25).abs() < 1e-15);
    }
}
