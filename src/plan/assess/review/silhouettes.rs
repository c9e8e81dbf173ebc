//! What the robot's bodies and those around it cover of a picture.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Point2, Point3, Vector3};

use crate::camera::Camera;
use crate::feasibility::{FLUSH, View, convex_hull};
use crate::plan::document::{Scene, SceneShape, Silhouette};

/// Corners of a circle.
const AROUND: u16 = 32;

/// Nearest depth that is drawn, m.
const NEAR: f64 = 1e-3;

/// Tangent of the widest angle off the optical axis that is drawn, of a lens that sees beyond 90°.
const WIDEST: f64 = 20.0;

/// Length of a straight edge, as a share of the picture's width, that is bent as the lens does.
const BEND: f64 = 1.0 / 24.0;

/// The surface of a convex body, in the camera's frame.
#[derive(Debug, Clone)]
struct Surface(Vec<Vec<Point3<f64>>>);

/// The bodies in the picture of `view`, the farthest first; its links are at `X_BL`. A body that rises through the board's plane is
/// drawn twice: behind the board whole, before it what hides corners. A body that holds the camera's centre, its housing, is left out.
pub(super) fn silhouettes(scene: &Scene, camera: &Camera, view: &View, X_BL: &[Isometry3<f64>]) -> Vec<Silhouette> {
    let X_CB = view.X_BC.inverse();
    let sides = sides(scene);
    // Points before the board: those with n·p > d.
    let n = view.X_CT.rotation * Vector3::z();
    let d = n.dot(&view.X_CT.translation.vector) + FLUSH;
    let mut placed: Vec<(f64, usize, Surface)> = scene
        .solids
        .iter()
        .map(|solid| {
            let X_CG = X_CB * X_BL[solid.link] * solid.pose.transform();
            let faces = faces(&solid.shape).into_iter().map(|face| face.iter().map(|p| X_CG * p).collect()).collect();
            (X_CG.translation.vector.norm(), solid.link, Surface(faces))
        })
        .filter(|(_, _, surface)| !surface.holds_origin())
        .collect();
    placed.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut found = Vec::new();
    for (_, link, surface) in &placed {
        let Some(seen) = sides.iter().try_fold(surface.clone(), |surface, (n, d)| surface.clipped(n, *d)) else {
            continue;
        };
        let before = seen.clipped(&n, d);
        let silhouette = |surface: &Surface, before_board: bool| {
            let outline_px = surface.outline(camera)?;
            Some(Silhouette { link: *link, before_board, outline_px })
        };
        if seen.clipped(&-n, -d).is_some() {
            found.extend(silhouette(&seen, false));
        }
        found.extend(before.as_ref().and_then(|surface| silhouette(surface, true)));
    }
    found
}

/// Planes around what the camera sees: it is where n·p ≥ d for all (n, d).
fn sides(scene: &Scene) -> Vec<(Vector3<f64>, f64)> {
    let outline = &scene.camera.outline;
    // A lens whose picture reaches beyond 90° has gaps in its outline.
    let whole = outline.len() == Scene::OUTLINE_POINTS;
    let reach = |axis: usize, sign: f64| {
        let most = outline.iter().map(|ray| sign * ray[axis]).fold(f64::NEG_INFINITY, f64::max);
        if whole { most.min(WIDEST) } else { WIDEST }
    };
    let mut sides = vec![(Vector3::z(), NEAR)];
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        let mut n = Vector3::new(0.0, 0.0, reach(axis, sign));
        n[axis] = -sign;
        sides.push((n, 0.0));
    }
    sides
}

impl Surface {
    /// The surface of the part with n·p ≥ d, without the faces that the cut makes, whose corners all are corners of others; `None`
    /// where nothing is left.
    fn clipped(&self, n: &Vector3<f64>, d: f64) -> Option<Self> {
        let above = |p: &Point3<f64>| n.dot(&p.coords) - d;
        let clip = |face: &Vec<Point3<f64>>| {
            let mut left = Vec::with_capacity(face.len() + 2);
            for (p, q) in face.iter().zip(face.iter().cycle().skip(1)) {
                let (a, b) = (above(p), above(q));
                if a >= 0.0 {
                    left.push(*p);
                }
                if (a >= 0.0) != (b >= 0.0) {
                    left.push(p + (q - p) * (a / (a - b)));
                }
            }
            left
        };
        let faces: Vec<_> = self.0.iter().map(clip).filter(|face| !face.is_empty()).collect();
        (!faces.is_empty()).then_some(Self(faces))
    }

    /// Whether the camera's centre is inside: on the side of every face on which the middle is.
    fn holds_origin(&self) -> bool {
        let corners = || self.0.iter().flatten();
        let middle = corners().map(|p| p.coords).sum::<Vector3<f64>>() / corners().count().max(1) as f64;
        self.0.iter().all(|face| {
            let Some(a) = face.first() else { return true };
            // Newell's: corners that coincide do no harm.
            let normal: Vector3<f64> = face.windows(2).map(|edge| (edge[0] - a).cross(&(edge[1] - a))).sum();
            let (middle, origin) = (normal.dot(&(middle - a.coords)), -normal.dot(&a.coords));
            middle * origin >= 0.0
        })
    }

    /// Its outline in the picture, px, to a tenth; `None` where that has no area or lies outside of the picture.
    fn outline(&self, camera: &Camera) -> Option<Vec<[f64; 2]>> {
        let rays: Vec<Point2<f64>> = self.0.iter().flatten().map(|p| Point2::new(p.x / p.z, p.y / p.z)).collect();
        let hull = convex_hull(&rays);
        let fx = camera.intrinsics()[0];
        let (width, height) = (f64::from(camera.width()), f64::from(camera.height()));
        let longest = BEND * width / fx.abs();
        let mut outline: Vec<[f64; 2]> = Vec::new();
        for (a, b) in hull.iter().zip(hull.iter().cycle().skip(1)) {
            let parts = ((b - a).norm() / longest).ceil().clamp(1.0, 1000.0) as u32;
            let points = (0..parts).map(|i| a.coords.lerp(&b.coords, f64::from(i) / f64::from(parts)));
            let pixels = points.filter_map(|ray| camera.project(&Point3::new(ray.x, ray.y, 1.0)));
            outline.extend(pixels.map(|pixel| [pixel.x, pixel.y].map(|x| (x * 10.0).round() / 10.0)));
        }
        outline.dedup();
        let reaches = |axis: usize, size: f64| {
            outline.iter().any(|pixel| pixel[axis] > -0.5) && outline.iter().any(|pixel| pixel[axis] < size - 0.5)
        };
        (outline.len() >= 3 && reaches(0, width) && reaches(1, height)).then_some(outline)
    }
}

/// Convex faces of a shape, in its frame; round ones in so many as suffice for the eye.
fn faces(shape: &SceneShape) -> Vec<Vec<Point3<f64>>> {
    match shape {
        SceneShape::Box { size_m } => {
            let [x, y, z] = size_m.map(|side| side / 2.0);
            prism(&[[x, y], [-x, y], [-x, -y], [x, -y]], z)
        }
        SceneShape::Cylinder { radius_m, length_m } => {
            prism(&circle().map(|(c, s)| [radius_m * c, radius_m * s]).collect::<Vec<_>>(), length_m / 2.0)
        }
        SceneShape::Sphere { radius_m } => rounded(*radius_m, 0.0),
        SceneShape::Capsule { radius_m, length_m } => rounded(*radius_m, length_m / 2.0),
        SceneShape::Mesh { vertices_m, triangles } => {
            let vertices: Vec<Point3<f64>> = vertices_m.chunks_exact(3).map(Point3::from_slice).collect();
            triangles.chunks_exact(3).map(|corners| corners.iter().map(|&i| vertices[i as usize]).collect()).collect()
        }
    }
}

fn circle() -> impl Iterator<Item = (f64, f64)> {
    (0..AROUND).map(|i| (TAU * f64::from(i) / f64::from(AROUND)).sin_cos()).map(|(s, c)| (c, s))
}

/// From z = −`half` to `half`.
fn prism(base: &[[f64; 2]], half: f64) -> Vec<Vec<Point3<f64>>> {
    let end = |z: f64| base.iter().map(move |[x, y]| Point3::new(*x, *y, z)).collect();
    let (bottom, top): (Vec<_>, Vec<_>) = (end(-half), end(half));
    let mut faces = between(&bottom, &top);
    faces.extend([bottom, top]);
    faces
}

/// A capsule along z, of a cylinder of half the length `half`.
fn rounded(radius: f64, half: f64) -> Vec<Vec<Point3<f64>>> {
    let quarter = AROUND / 4;
    let rings: Vec<Vec<Point3<f64>>> = (0..=2 * quarter + 1)
        .map(|i| {
            // The equator counts twice, once for each end.
            let (latitude, end) = if i <= quarter { (i, -half) } else { (i - 1, half) };
            let (s, c) = (PI * f64::from(latitude) / f64::from(2 * quarter) - PI / 2.0).sin_cos();
            circle().map(|(x, y)| Point3::new(radius * c * x, radius * c * y, radius * s + end)).collect()
        })
        .collect();
    rings.windows(2).flat_map(|pair| between(&pair[0], &pair[1])).collect()
}

/// Four-cornered faces between two rings.
fn between(low: &[Point3<f64>], high: &[Point3<f64>]) -> Vec<Vec<Point3<f64>>> {
    let next = |i: usize| (i + 1) % low.len();
    (0..low.len()).map(|i| vec![low[i], low[next(i)], high[next(i)], high[i]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Lens;

    fn at(shape: &SceneShape, place: [f64; 3]) -> Surface {
        let move_to = |face: Vec<Point3<f64>>| face.iter().map(|p| p + Vector3::from(place)).collect();
        Surface(faces(shape).into_iter().map(move_to).collect())
    }

    fn camera() -> Camera {
        Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5]).unwrap()
    }

    fn spans(outline: &[[f64; 2]]) -> [f64; 4] {
        let extreme =
            |axis: usize, sign: f64| sign * outline.iter().map(|p| sign * p[axis]).fold(f64::NEG_INFINITY, f64::max);
        [extreme(0, -1.0), extreme(0, 1.0), extreme(1, -1.0), extreme(1, 1.0)]
    }

    #[test]
    fn outlines_are_where_the_edge_of_a_body_is_seen() {
        // A cube of 0.2 m, its front 1 m ahead.
        let cube = at(&SceneShape::Box { size_m: [0.2; 3] }, [0.0, 0.0, 1.1]);
        assert_eq!(spans(&cube.outline(&camera()).unwrap()), [539.5, 739.5, 259.5, 459.5]);
        // A ball's outline is a circle of the half angle asin(r/d).
        for shape in [SceneShape::Sphere { radius_m: 0.1 }, SceneShape::Capsule { radius_m: 0.1, length_m: 0.0 }] {
            let radius = 1000.0 * (0.1f64 / 0.8).asin().tan();
            let [left, right, ..] = spans(&at(&shape, [0.0, 0.0, 0.8]).outline(&camera()).unwrap());
            assert!((right - left - 2.0 * radius).abs() < 0.03 * radius, "{left} {right}");
        }
        let aside = at(&SceneShape::Sphere { radius_m: 0.1 }, [2.0, 0.0, 1.0]);
        assert_eq!(aside.outline(&camera()), None);
    }

    #[test]
    fn what_is_cut_keeps_its_corners() {
        let cube = at(&SceneShape::Box { size_m: [0.2; 3] }, [0.0, 0.0, 0.1]);
        // From the camera's own plane on; the part from a depth of 0.1 m on is as large as its nearest corners.
        let far = cube.clipped(&Vector3::z(), 0.1).unwrap();
        assert_eq!(spans(&far.outline(&camera()).unwrap())[..2], [-360.5, 1639.5]);
        assert!(cube.clipped(&Vector3::z(), 0.3).is_none());
    }

    #[test]
    fn a_housing_holds_the_camera() {
        for shape in [
            SceneShape::Box { size_m: [0.1, 0.2, 0.3] },
            SceneShape::Cylinder { radius_m: 0.1, length_m: 0.2 },
            SceneShape::Sphere { radius_m: 0.1 },
            SceneShape::Capsule { radius_m: 0.1, length_m: 0.2 },
        ] {
            assert!(at(&shape, [0.03, 0.0, 0.03]).holds_origin(), "{shape:?}");
            assert!(!at(&shape, [0.11, 0.0, 0.0]).holds_origin(), "{shape:?}");
            assert!(!at(&shape, [0.0, 0.0, -0.25]).holds_origin(), "{shape:?}");
        }
    }
}
