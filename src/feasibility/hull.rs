//! Convex hulls of many points, made ready for measuring: fewer points and a margin around them.
//!
//! The hull of some of the points lies inside that of all of them. Widened by the greatest distance of a point from it, it holds
//! them all, and reaches beyond their hull by no more than that. Corners are picked greedily, the farthest from the hull of those
//! picked before first; the farthest point from a convex set is always a corner of the whole.

use std::collections::BinaryHeap;

use nalgebra::{Point3, Unit, Vector3};
use parry3d_f64::query::gjk::{CSOPoint, GJKResult, VoronoiSimplex, closest_points};
use parry3d_f64::shape::SupportMap;
use rayon::prelude::*;

use super::solid::{Core, MILLIMETRES, farthest};
use crate::robot::{Shape, Tree};
use crate::spatial::Pose;

/// Hulls of no more points stay as they are.
const FEW: usize = 32;
/// Most points of a hull that is made simpler.
const MOST: usize = 512;
/// The margin aimed at, in m; for small hulls a share of half their bounding box's diagonal.
const MARGIN: f64 = 0.5e-3;
const SHARE_OF_SIZE: f64 = 0.01;

/// How the hulls of a robot were made simpler.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Simplified {
    /// How many hulls were.
    pub hulls: usize,
    /// Points that they had together.
    pub before: usize,
    /// Points that they have together.
    pub after: usize,
    /// The greatest of their margins: none reaches farther, in m, beyond the hull that it stands for.
    pub margin: f64,
}

/// Puts simpler hulls in place of those of many points; none loses any of its points. Meshes that occur several times are worked
/// on once.
pub fn simplify_hulls(tree: &mut Tree) -> Simplified {
    let mut shapes: Vec<&mut Shape> =
        tree.links.iter_mut().flat_map(|link| &mut link.bodies).map(|body| &mut body.shape).collect();
    let mut simplified = Simplified::default();
    // What each hull became that was met so far, by its place.
    let mut known: Vec<(Vec<Point3<f64>>, usize)> = Vec::new();
    for i in 0..shapes.len() {
        let Shape::Convex { points, .. } = &*shapes[i] else { continue };
        if points.len() <= FEW {
            continue;
        }
        let before = points.len();
        let same = known.iter().find(|(other, _)| other == points).map(|&(_, place)| place);
        let simple = if let Some(place) = same {
            shapes[place].clone()
        } else {
            known.push((points.clone(), i));
            let (points, margin) = outer_hull(points);
            Shape::Convex { points, margin }
        };
        if let Shape::Convex { points, margin } = &simple {
            simplified.hulls += 1;
            simplified.before += before;
            simplified.after += points.len();
            simplified.margin = simplified.margin.max(*margin);
        }
        *shapes[i] = simple;
    }
    simplified
}

/// A point that was not picked: its distance in mm from the hull of those that were when there were `among` of them.
#[derive(Debug, PartialEq)]
struct Left {
    distance: f64,
    point: usize,
    among: usize,
}

impl Eq for Left {}

impl Ord for Left {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.distance.total_cmp(&other.distance).then(other.point.cmp(&self.point))
    }
}

impl PartialOrd for Left {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Some of `points`, and the margin in m around their hull that holds all points.
fn outer_hull(points: &[Point3<f64>]) -> (Vec<Point3<f64>>, f64) {
    let mut picked = extremes(points);
    let first = picked[0];
    let (low, high) = picked.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let requested = MARGIN.min(SHARE_OF_SIZE * (high - low).norm() / 2.0) * MILLIMETRES;
    let among = picked.len();
    let left = |(point, p)| Left { distance: distance(&picked, p), point, among };
    let left: Vec<Left> = points.par_iter().enumerate().map(left).collect();
    let mut left = BinaryHeap::from(left);
    let margin = loop {
        // More picked points bring the others only nearer: what was found of them among fewer is still a bound.
        let Some(farthest) = left.pop() else { break 0.0 };
        if farthest.distance <= requested {
            break farthest.distance;
        }
        if farthest.among < picked.len() {
            let distance = distance(&picked, &points[farthest.point]);
            left.push(Left { distance, among: picked.len(), ..farthest });
        } else if picked.len() < MOST {
            picked.push(points[farthest.point]);
        } else {
            break farthest.distance;
        }
    };
    (picked, margin / MILLIMETRES + ROUNDING)
}

/// Added to margins for what distances lose to rounding, m.
const ROUNDING: f64 = 1e-6;

/// The farthest points along the axes and the diagonals between them, each once.
fn extremes(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let signs = [-1.0, 0.0, 1.0];
    let directions = signs.iter().flat_map(|&x| signs.iter().flat_map(move |&y| signs.map(|z| Vector3::new(x, y, z))));
    let mut picked: Vec<Point3<f64>> = Vec::new();
    for direction in directions.filter(|direction| direction.norm_squared() > 0.0) {
        let point = farthest(points, &direction);
        if !picked.contains(&point) {
            picked.push(point);
        }
    }
    picked
}

/// Points in metres as the corners of their hull in millimetres, as [`Core::separation`] measures too.
struct Corners<'p>(&'p [Point3<f64>]);

impl SupportMap for Corners<'_> {
    fn local_support_point(&self, dir: &Vector3<f64>) -> Point3<f64> {
        farthest(self.0, dir) * MILLIMETRES
    }
}

/// Distance in mm of a point from the hull of `corners`, or more: that to a point of it.
fn distance(corners: &[Point3<f64>], point: &Point3<f64>) -> f64 {
    let hull = Corners(corners);
    let X_12 = Pose::from_parts((point.coords * MILLIMETRES).into(), nalgebra::UnitQuaternion::identity());
    let start = Unit::try_new(corners[0] - point, 1e-12).unwrap_or(Vector3::x_axis());
    let mut simplex = VoronoiSimplex::new();
    simplex.reset(CSOPoint::from_shapes(&X_12, &hull, &Core::Point, &start));
    match closest_points(&X_12, &hull, &Core::Point, f64::MAX, true, &mut simplex) {
        GJKResult::Intersection => 0.0,
        GJKResult::ClosestPoints(p_1, p_2, _) => (p_2 - p_1).norm(),
        GJKResult::Proximity(_) | GJKResult::NoIntersection(_) => {
            corners.iter().map(|corner| (corner - point).norm() * MILLIMETRES).fold(f64::INFINITY, f64::min)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use proptest::prelude::*;

    use super::*;
    use crate::robot::Body;

    /// How far `points` reach along the unit direction `dir`.
    fn reach(points: &[Point3<f64>], dir: &Vector3<f64>) -> f64 {
        points.iter().map(|point| point.coords.dot(dir)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn directions(count: usize) -> impl Iterator<Item = Vector3<f64>> {
        (0..count).map(move |i| {
            let (z, turn) = (1.0 - (2 * i + 1) as f64 / count as f64, i as f64 * PI * (3.0 - 5f64.sqrt()));
            let aside = (1.0 - z * z).sqrt();
            Vector3::new(aside * turn.cos(), aside * turn.sin(), z)
        })
    }

    /// Asserts that the hull holds all points and reaches beyond them by no more than its margin.
    fn assert_holds(points: &[Point3<f64>], simple: &[Point3<f64>], margin: f64) {
        for dir in directions(500) {
            let excess = reach(simple, &dir) + margin - reach(points, &dir);
            assert!((0.0..=margin + 1e-12).contains(&excess), "{excess} {margin}");
        }
    }

    fn mesh(rings: usize, around: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> Vec<Point3<f64>> {
        let ring = |i: usize| (0..around).map(move |j| (i as f64 / (rings - 1) as f64, j as f64 / around as f64));
        (0..rings).flat_map(ring).map(|(u, v)| Point3::from(at(u, v))).collect()
    }

    #[test]
    fn fine_round_hulls_lose_nothing_and_gain_less_than_a_millimetre() {
        let ball = |radius: f64| {
            mesh(130, 208, move |u, v| {
                let (aside, up) = (PI * u).sin_cos();
                [radius * aside * (TAU * v).cos(), radius * aside * (TAU * v).sin(), radius * up + 0.3]
            })
        };
        let rod = mesh(100, 270, |u, v| [0.03 * (TAU * v).cos(), 0.03 * (TAU * v).sin(), 0.4 * u]);
        for (points, most, margin) in [(ball(0.1), 512, 0.9e-3), (ball(0.01), 300, 0.175e-3), (rod, 100, 0.502e-3)] {
            let (simple, found) = outer_hull(&points);
            assert!(simple.len() <= most && found <= margin, "{} {found}", simple.len());
            assert_holds(&points, &simple, found);
        }
    }

    #[test]
    fn what_lies_between_corners_costs_nothing() {
        // A plate of 150 x 150 points in one plane, aslant, and the surface of a cuboid.
        let plate = mesh(150, 150, |u, v| [u, 0.5 * v, 0.3 * u - 0.2 * v]);
        let cuboid = mesh(60, 60, |u, v| [u, v, 0.0]);
        let cuboid: Vec<_> =
            cuboid.iter().flat_map(|p| [*p, Point3::new(p.x, p.y, 0.3), Point3::new(p.x, 0.0, 0.3 * p.y)]).collect();
        for points in [plate, cuboid] {
            let (simple, margin) = outer_hull(&points);
            assert!(simple.len() <= 100 && margin < 2e-6, "{} {margin}", simple.len());
            assert_holds(&points, &simple, margin);
        }
    }

    proptest! {
        #[test]
        fn clouds_stay_inside(corners in prop::collection::vec(prop::array::uniform3(-0.3..0.3f64), 33..200)) {
            let points: Vec<Point3<f64>> = corners.into_iter().map(Point3::from).collect();
            let (simple, margin) = outer_hull(&points);
            assert_holds(&points, &simple, margin);
        }
    }

    #[test]
    fn meshes_that_occur_twice_and_small_ones() {
        let rod = mesh(20, 30, |u, v| [0.03 * (TAU * v).cos(), 0.03 * (TAU * v).sin(), 0.4 * u]);
        let few = rod[..FEW].to_vec();
        let body = |points: &[Point3<f64>]| Body {
            X_LG: Pose::identity(),
            shape: Shape::Convex { points: points.to_vec(), margin: 0.0 },
        };
        let mut tree = Tree::default();
        for (name, points) in [("a", &rod), ("few", &few), ("b", &rod)] {
            tree.attach(name, 0, Pose::identity(), body(points));
        }
        let simplified = simplify_hulls(&mut tree);
        assert_eq!((simplified.hulls, simplified.before), (2, 1200));
        assert_eq!(tree.links[0].bodies, tree.links[2].bodies);
        assert_ne!(tree.links[0].bodies[0], body(&rod));
        assert_eq!(tree.links[1].bodies[0], body(&few));
    }
}
