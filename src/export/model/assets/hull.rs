//! The convex hull of points as triangles.

use nalgebra::{Point3, Vector3};
use parry3d_f64::transformation::try_convex_hull;

use super::mesh::Mesh;

/// Half the thickness in m that what is flat is given: simulators take no surface without volume.
const HALF: f64 = 5e-5;

/// What counts as flat: less volume than this share of the cube around it.
const FLAT: f64 = 1e-6;

/// The hull of `points`, thickened where they lie in a plane; none of no points.
pub(super) fn hull(points: &[Point3<f64>]) -> Option<Mesh> {
    let first = *points.first()?;
    let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let cube = (high - low).max().powi(3);
    let has_volume = |mesh: &Mesh| volume(mesh) > FLAT * cube;
    triangulated(points).filter(has_volume).or_else(|| triangulated(&thickened(points)))
}

/// The hull where it can be found.
fn triangulated(points: &[Point3<f64>]) -> Option<Mesh> {
    let (vertices, triangles) = try_convex_hull(points).ok()?;
    let triangles = triangles.into_iter().map(|triangle| triangle.map(|vertex| [vertex as usize, 0])).collect();
    Some(Mesh { vertices, places: Vec::new(), triangles })
}

/// Six points around each: all that is within `HALF` of it along an axis.
fn thickened(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let ways = [Vector3::x(), Vector3::y(), Vector3::z()];
    points.iter().flat_map(|point| ways.iter().flat_map(move |way| [point + way * HALF, point - way * HALF])).collect()
}

/// Volume inside, m³.
fn volume(mesh: &Mesh) -> f64 {
    let Some(origin) = mesh.vertices.first() else { return 0.0 };
    let corner = |[vertex, _]: [usize; 2]| mesh.vertices[vertex] - origin;
    let tetrahedron = |&[a, b, c]: &[[usize; 2]; 3]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0;
    mesh.triangles.iter().map(tetrahedron).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(sides: [usize; 3], step: f64) -> Vec<Point3<f64>> {
        let at = |i: usize, count: usize| i as f64 / (count.max(2) - 1) as f64 * step;
        let [a, b, c] = sides;
        (0..a * b * c).map(|i| Point3::new(at(i % a, a), at(i / a % b, b), at(i / (a * b), c))).collect()
    }

    #[test]
    fn a_cube_has_its_volume_and_faces_outwards() {
        let mesh = hull(&grid([3, 3, 3], 0.2)).unwrap();
        assert!((volume(&mesh) - 0.008).abs() < 1e-12);
        assert_eq!(mesh.vertices.len(), 8);
        assert_eq!(mesh.triangles.len(), 12);
    }

    #[test]
    fn what_is_flat_thin_or_a_point_gets_a_little_volume() {
        for (sides, most) in [([4, 3, 1], 1e-5), ([5, 1, 1], 1e-8), ([1, 1, 1], 1e-12)] {
            let mesh = hull(&grid(sides, 0.2)).unwrap();
            let found = volume(&mesh);
            assert!(found > 0.0 && found < most, "{sides:?} {found}");
        }
        assert_eq!(hull(&[]), None);
    }
}
