//! Occlusion: which corners a body hides.

use nalgebra::{Point3, Vector3};

use super::solid::{Core, Placed, Solid};
use crate::robot::Tree;
use crate::spatial::Pose;

/// A body that rises no farther than this above the board's plane, in m, hides nothing: the board itself, and what it lies
/// on.
pub(crate) const FLUSH: f64 = 1e-3;

/// What stands between the camera and the board.
#[derive(Debug, Clone, PartialEq)]
pub struct Occlusion {
    solids: Vec<Solid>,
    /// For each link whether its bodies may hold the camera's centre.
    may_hold: Vec<bool>,
}

impl Occlusion {
    /// The test against the bodies of `tree`, whose link `camera_link` carries the camera.
    pub fn new(tree: &Tree, camera_link: usize) -> Self {
        // What stands still cannot hold a camera that moves: the camera would have driven into it.
        let carrier = tree.mover(camera_link);
        let may_hold = (0..tree.links.len()).map(|link| tree.mover(link) != 0 || carrier == 0);
        Self { solids: Solid::all(tree), may_hold: may_hold.collect() }
    }

    /// Whether there is nothing that could hide a corner.
    pub fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// Which of `corners` (in T) are hidden: the segment from the camera to the corner meets a body. The links are at `X_BL`,
    /// the camera at `X_BC`, on the printed side of the board at `X_BT`.
    ///
    /// Bodies that move and hold the camera's centre, its housing, hide nothing, nor do bodies that rise less than a millimetre
    /// above the board's plane.
    pub fn hidden(&self, X_BL: &[Pose], X_BC: &Pose, X_BT: &Pose, corners: &[Point3<f64>]) -> Vec<bool> {
        let mut hidden = vec![false; corners.len()];
        let corners_B: Vec<Point3<f64>> = corners.iter().map(|corner| X_BT * corner).collect();
        let Some(sight) = Sight::new(Point3::from(X_BC.translation.vector), &corners_B) else { return hidden };
        let normal_B = X_BT.rotation * Vector3::z();
        let board = normal_B.dot(&X_BT.translation.vector);
        for solid in Placed::all(&self.solids, X_BL) {
            let may_hide = sight.passes(&solid)
                && solid.extent(&normal_B) > board + FLUSH
                && !(self.may_hold[solid.solid.link] && solid.holds(&sight.camera));
            if may_hide {
                hide(&solid, &sight.camera, X_BT, corners, &corners_B, &mut hidden);
            }
        }
        hidden
    }
}

/// No more corners than this are looked at one by one without a look at all of them.
const FEW: usize = 2;

/// Those of the corners, in T and in the base frame, that the solid hides from the camera: of all, of halves of them and so on until
/// the solid lies beside the hull of the camera and their box.
fn hide(
    solid: &Placed,
    camera: &Point3<f64>,
    X_BT: &Pose,
    corners: &[Point3<f64>],
    corners_B: &[Point3<f64>],
    hidden: &mut [bool],
) {
    if corners.len() <= FEW {
        for (hidden, corner) in hidden.iter_mut().zip(corners_B).filter(|(hidden, _)| !**hidden) {
            *hidden = solid.meets(&Core::Segment([*camera, *corner]));
        }
    } else if solid.meets(&Core::Hull(std::iter::once(*camera).chain(around(X_BT, corners)).collect())) {
        let middle = corners.len() / 2;
        let [(left, right), (left_B, right_B)] = [corners, corners_B].map(|corners| corners.split_at(middle));
        let (left_hidden, right_hidden) = hidden.split_at_mut(middle);
        hide(solid, camera, X_BT, left, left_B, left_hidden);
        hide(solid, camera, X_BT, right, right_B, right_hidden);
    }
}

/// Corners in the base frame of the box in T around points in T; of a rectangle where they are all in one plane of the board's.
fn around(X_BT: &Pose, points: &[Point3<f64>]) -> impl Iterator<Item = Point3<f64>> {
    let first = points.first().copied().unwrap_or_default();
    let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let of = move |corner: usize, axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
    let corners = 0..if low.z == high.z { 4 } else { 8 };
    corners.map(move |corner| X_BT * Point3::new(of(corner, 0), of(corner, 1), of(corner, 2)))
}

/// A cone that holds all that lies between the camera and the corners.
struct Sight {
    camera: Point3<f64>,
    /// Direction of the cone's axis, and its length, m.
    axis: Vector3<f64>,
    length: f64,
    /// Of the angle between the cone's axis and its side.
    cos: f64,
    sin: f64,
}

impl Sight {
    /// None if the corners surround the camera, or there are none.
    fn new(camera: Point3<f64>, corners: &[Point3<f64>]) -> Option<Self> {
        let sum = corners.iter().fold(Vector3::zeros(), |sum, corner| sum + (corner - camera));
        let axis = sum.try_normalize(0.0)?;
        let (mut cos, mut length) = (1.0f64, 0.0f64);
        for corner in corners {
            let ray = corner - camera;
            length = length.max(ray.norm());
            cos = cos.min(ray.dot(&axis) / ray.norm());
        }
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        Some(Self { camera, axis, length, cos, sin })
    }

    /// Whether the sphere around `solid` reaches into the cone. Cheap, and never "no" where the solid does.
    fn passes(&self, solid: &Placed) -> bool {
        let to_middle = solid.middle() - self.camera;
        let (along, reach) = (to_middle.dot(&self.axis), solid.solid.reach + ROUNDING);
        let aside = (to_middle - self.axis * along).norm();
        // Beyond 90° the plane along the side does not bound the cone.
        let beside = self.cos > 0.0 && aside * self.cos - along * self.sin > reach;
        !beside && along <= self.length + reach
    }
}

/// Spheres that miss the cone by less than this, in m, are not ruled out.
const ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::robot::{Body, Link, Motion, Shape};
    use crate::target::Board;

    fn tree(bodies: Vec<Body>) -> Tree {
        let link = Link {
            name: "base".into(),
            parent: None,
            X_PJ: Pose::identity(),
            motion: Motion::Fixed,
            bodies,
            mass: None,
        };
        Tree { links: vec![link], disabled: vec![] }
    }

    fn hidden(bodies: Vec<Body>, X_BC: &Pose, X_BT: &Pose, corners: &[Point3<f64>]) -> Vec<bool> {
        Occlusion::new(&tree(bodies), 0).hidden(&[Pose::identity()], X_BC, X_BT, corners)
    }

    fn corners() -> Vec<Point3<f64>> {
        Board::checkerboard(8, 6, 0.03).corners().collect()
    }

    /// The camera 0.5 m above the board's centre.
    fn above() -> Pose {
        Pose::translation(0.0, 0.0, 0.5)
    }

    #[test]
    fn a_post_hides_what_is_behind_it() {
        let half_extents = Vector3::new(0.002, 1.0, 0.05);
        let wall = |x: f64| vec![Body { X_LG: Pose::translation(x, 0.0, 0.2), shape: Shape::Box { half_extents } }];
        // A wall across the middle column pair, halfway up: it hides |x| < 0.002 · 0.5 / 0.35 and no corner.
        let seen = hidden(wall(0.0), &above(), &Pose::identity(), &corners());
        assert!(seen.iter().all(|&hidden| !hidden));
        // Columns are at ±15, 45, 75, 105 mm; the wall's shadow at x = 9 mm reaches from 11 to 22 mm.
        let hidden = hidden(wall(0.009), &above(), &Pose::identity(), &corners());
        for (i, corner) in corners().iter().enumerate() {
            assert_eq!(hidden[i], (corner.x - 0.015).abs() < 1e-9, "{corner}");
        }
    }

    #[test]
    fn the_board_its_carrier_and_the_housing_hide_nothing() {
        let slab = |top: f64| Body {
            X_LG: Pose::translation(0.0, 0.0, top - 0.1),
            shape: Shape::Box { half_extents: Vector3::new(0.5, 0.5, 0.1) },
        };
        let housing = Body { X_LG: above(), shape: Shape::Sphere { radius: 0.05 } };
        let at = |bodies| hidden(bodies, &above(), &Pose::identity(), &corners()).iter().filter(|&&h| h).count();
        assert_eq!(at(vec![slab(0.0), slab(0.0009), housing]), 0);
        assert_eq!(at(vec![slab(0.0011)]), 48);
    }

    /// Whether the segment from `a` to `b` meets the sphere: the quadratic's nearest point.
    fn meets_sphere(a: &Point3<f64>, b: &Point3<f64>, middle: &Point3<f64>) -> f64 {
        let along = ((middle - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
        (a + (b - a) * along - middle).norm()
    }

    fn triple(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-size..size).prop_map(Vector3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn a_sphere_hides_the_corners_whose_rays_meet_it(
            middle in triple(0.4), radius in 0.005..0.2f64, r in triple(3.0), p in triple(0.3),
        ) {
            let X_BT = Pose::new(p, r);
            let camera = X_BT * Point3::new(0.05, -0.1, 0.4);
            let X_BC = Pose::translation(camera.x, camera.y, camera.z);
            let ball = Body { X_LG: X_BT * Pose::translation(middle.x, middle.y, middle.z + 0.2), shape: Shape::Sphere { radius } };
            let centre = Point3::from(ball.X_LG.translation.vector);
            let flat = middle.z + 0.2 + radius <= FLUSH;
            let housing = (camera - centre).norm() <= radius;
            let hidden = hidden(vec![ball], &X_BC, &X_BT, &corners());
            for (corner, hidden) in corners().iter().zip(hidden) {
                let distance = meets_sphere(&camera, &(X_BT * corner), &centre);
                prop_assume!((distance - radius).abs() > 1e-7);
                prop_assert_eq!(hidden, distance < radius && !flat && !housing);
            }
        }

        /// Leaving out bodies early loses no hidden corner.
        #[test]
        fn culling_changes_nothing(
            middle in triple(0.3), size in prop::array::uniform3(0.003..0.15f64), r in triple(3.0), camera in triple(0.3),
        ) {
            let camera = Point3::new(camera.x, camera.y, camera.z + 0.5);
            let X_BC = Pose::translation(camera.x, camera.y, camera.z);
            let body = Body {
                X_LG: Pose::new(middle + Vector3::z() * 0.25, r),
                shape: Shape::Cylinder { radius: size[0], length: size[1] },
            };
            let solids = Solid::all(&tree(vec![body.clone()]));
            let solid = Placed::all(&solids, &[Pose::identity()])[0];
            let exempt = solid.holds(&camera) || solid.extent(&Vector3::z()) <= FLUSH;
            let hidden = hidden(vec![body], &X_BC, &Pose::identity(), &corners());
            for (corner, hidden) in corners().iter().zip(hidden) {
                prop_assert_eq!(hidden, !exempt && solid.meets(&Core::Segment([camera, *corner])));
            }
        }
    }
}
