//! The convex hull of points as triangles.

use nalgebra::{Matrix3, Point3, Vector3};
use parry3d_f64::transformation::try_convex_hull;

use super::mesh::Mesh;

/// Half the thickness in m that what is flat is given: simulators take no surface without volume.
const HALF: f64 = 5e-5;

/// The hull of `points`, thickened along the principal axes along which they hardly extend; none of no points.
///
/// It is found where the points fill a cube: of thin sets as they lie the faces would be lost to rounding.
pub(super) fn hull(points: &[Point3<f64>]) -> Option<Mesh> {
    let count = points.len() as f64;
    let centre = points.iter().map(|point| point.coords).reduce(|a, b| a + b)? / count;
    let moments: Matrix3<f64> =
        points.iter().map(|point| (point.coords - centre) * (point.coords - centre).transpose()).sum();
    let mut axes = moments.symmetric_eigen().eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(0).neg_mut();
    }
    let mut along: Vec<Vector3<f64>> = points.iter().map(|point| axes.tr_mul(&(point.coords - centre))).collect();
    let mut extent = Vector3::zeros();
    for axis in 0..3 {
        extent[axis] = along.iter().map(|point| point[axis].abs()).fold(0.0, f64::max);
        if extent[axis] < HALF {
            extent[axis] = HALF;
            let sides = |point: &Vector3<f64>| {
                [HALF, -HALF].map(|side| {
                    let mut point = *point;
                    point[axis] = side;
                    point
                })
            };
            along = along.iter().flat_map(sides).collect();
        }
    }
    let cube: Vec<Point3<f64>> = along.iter().map(|point| point.component_div(&extent).into()).collect();
    let (vertices, triangles) = try_convex_hull(&cube).ok()?;
    let back = |vertex: &Point3<f64>| Point3::from(centre + axes * vertex.coords.component_mul(&extent));
    Some(Mesh {
        vertices: vertices.iter().map(back).collect(),
        places: Vec::new(),
        triangles: triangles.into_iter().map(|triangle| triangle.map(|vertex| [vertex as usize, 0])).collect(),
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    /// Volume inside, m³.
    fn volume(mesh: &Mesh) -> f64 {
        let corner = |[vertex, _]: [usize; 2]| mesh.vertices[vertex] - mesh.vertices[0];
        let tetrahedron = |&[a, b, c]: &[[usize; 2]; 3]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0;
        mesh.triangles.iter().map(tetrahedron).sum()
    }

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

    /// However it lies.
    #[test]
    fn what_is_flat_thin_or_a_point_gets_a_little_volume() {
        let turns =
            (0..20).map(f64::from).map(|turn| Rotation3::from_euler_angles(0.3 * turn, 0.17 * turn, 0.05 * turn));
        for turn in turns {
            let thick = 2.0 * HALF;
            for (sides, expected) in
                [([4, 3, 1], 0.04 * thick), ([5, 1, 1], 0.2 * thick * thick), ([1, 1, 1], thick * thick * thick)]
            {
                let points: Vec<Point3<f64>> = grid(sides, 0.2).iter().map(|point| turn * point).collect();
                let mesh = hull(&points).unwrap();
                assert!((volume(&mesh) / expected - 1.0).abs() < 1e-3, "{sides:?} {} {expected}", volume(&mesh));
            }
        }
        assert_eq!(hull(&[]), None);
    }
}
