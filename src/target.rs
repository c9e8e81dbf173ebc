//! The planar calibration board and the zone it lies in.
//!
//! Frame **T** has its origin at the board's centre, x along its columns, y along its rows and z out of its
//! printed side.

use std::f64::consts::PI;

use nalgebra::{Point3, UnitQuaternion, Vector2, Vector3};

use crate::spatial::Pose;

/// A checkerboard, its place on the robot, and the zone around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// The grid of inner corners.
    pub board: Board,
    /// Pose of the board in the robot's base frame.
    pub X_BT: Pose,
    /// The rectangle in the board's plane that the optical axis is tested against.
    pub zone: Zone,
}

/// The corner grid of a checkerboard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Board {
    /// Inner corners along x.
    pub columns: usize,
    /// Inner corners along y.
    pub rows: usize,
    /// Distance of neighbouring corners in metres.
    pub square: f64,
}

/// What a point of a board is: how its place in a picture is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Feature {
    /// Edges that meet.
    Corner {
        /// The two edges on the board, from the corner to the next, in m.
        edges: [Vector2<f64>; 2],
        /// Whether the edges go on across the corner, as those of a chessboard do.
        is_crossing: bool,
    },
    /// The centre of a circle.
    Circle {
        /// Its radius in m.
        radius: f64,
    },
    /// A point of which no more is known.
    Point,
}

/// Which corners of a board, of those seen for instance.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Corners {
    /// Every corner.
    #[default]
    All,
    /// These, by their index in the order of [`Board::corners`], ascending.
    Some(Vec<usize>),
}

/// The marker zone of the paper: a rectangle centred on T's origin in T's plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Extent along x in metres.
    pub width: f64,
    /// Extent along y in metres.
    pub height: f64,
    /// Width in metres of the band along the inside of the border that counts as edge.
    pub edge_margin: f64,
}

/// Where an optical axis meets the target's plane: the three cases of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisCase {
    /// In the zone, farther from its border than the edge margin.
    Inside,
    /// In the zone, on its border or within the edge margin of it.
    Edge,
    /// Outside the zone, or the axis does not meet the plane in front of the camera.
    Outside,
}

impl Board {
    /// Number of inner corners.
    pub fn corner_count(&self) -> usize {
        self.columns * self.rows
    }

    /// Printed size in metres along x and y: one square more than inner corners in each direction.
    pub fn printed_size(&self) -> (f64, f64) {
        ((self.columns + 1) as f64 * self.square, (self.rows + 1) as f64 * self.square)
    }

    /// Position in T of the corner at `column` and `row`, counted from the corner with the least x and y.
    pub fn corner(&self, column: usize, row: usize) -> Point3<f64> {
        Point3::new(
            (column as f64 - (self.columns - 1) as f64 / 2.0) * self.square,
            (row as f64 - (self.rows - 1) as f64 / 2.0) * self.square,
            0.0,
        )
    }

    /// What the corner with that index is.
    pub fn feature(&self, _index: usize) -> Feature {
        let edges = [Vector2::new(self.square, 0.0), Vector2::new(0.0, self.square)];
        Feature::Corner { edges, is_crossing: true }
    }

    /// Column and row of the corner with that index, counted row by row.
    pub fn column_and_row(&self, index: usize) -> (usize, usize) {
        (index % self.columns, index / self.columns)
    }

    /// All corners in T, row by row: `columns × rows` points with z = 0.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = Point3<f64>> + '_ {
        (0..self.corner_count()).map(|i| self.corner(i % self.columns, i / self.columns))
    }

    /// Whether corners (by index, each once) fix the homography between board and image: four of them in general position,
    /// no three on a line. That is so unless all of them but one lie on a line.
    pub fn fix_homography(&self, corners: &[usize]) -> bool {
        let at = |i: usize| [(i % self.columns).cast_signed(), (i / self.columns).cast_signed()];
        let [a, b, c, _, ..] = *corners else { return false };
        // A line through all but one passes through two of any three.
        let off_the_line = |(a, b): (usize, usize)| {
            let ([ax, ay], [bx, by]) = (at(a), at(b));
            let off = |&&p: &&usize| {
                let [x, y] = at(p);
                (bx - ax) * (y - ay) != (by - ay) * (x - ax)
            };
            corners.iter().filter(off).count()
        };
        [(a, b), (a, c), (b, c)].into_iter().all(|line| off_the_line(line) >= 2)
    }
}

impl Corners {
    /// The indices, of a board with `count` corners.
    pub fn indices(&self, count: usize) -> Vec<usize> {
        match self {
            Corners::All => (0..count).collect(),
            Corners::Some(indices) => indices.clone(),
        }
    }

    /// Whether corner `index` is among them.
    pub fn contains(&self, index: usize) -> bool {
        match self {
            Corners::All => true,
            Corners::Some(indices) => indices.binary_search(&index).is_ok(),
        }
    }
}

/// Pose `X_TC` of a camera whose optical axis goes through the board's centre, from `distance` (m) away.
///
/// It stands `tilt` (rad) off the board's normal, in the direction `azimuth` from the board's x towards its y. At roll 0 its
/// image is turned no further than it takes to look there: from straight ahead, `x_C` is `x_T` and `y_C` is `−y_T`. `roll` turns the
/// camera about its optical axis.
pub fn viewpoint(distance: f64, tilt: f64, azimuth: f64, roll: f64) -> Pose {
    let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
    let lean = about(z, azimuth) * about(y, tilt) * about(z, -azimuth);
    let position = lean * Vector3::new(0.0, 0.0, distance);
    Pose::from_parts(position.into(), lean * about(x, PI) * about(z, roll))
}

impl Zone {
    /// The case of a point of the plane, given by its coordinates in T in metres.
    pub fn case(&self, x: f64, y: f64) -> AxisCase {
        let deeper_than = |margin: f64| self.width / 2.0 - x.abs() >= margin && self.height / 2.0 - y.abs() >= margin;
        if !deeper_than(0.0) {
            AxisCase::Outside
        } else if deeper_than(self.edge_margin.next_up()) {
            AxisCase::Inside
        } else {
            AxisCase::Edge
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_centred_and_row_by_row() {
        let board = Board { columns: 3, rows: 2, square: 0.1 };
        let corners: Vec<_> = board.corners().collect();
        assert_eq!(corners.len(), 6);
        assert!((corners[0] - Point3::new(-0.1, -0.05, 0.0)).norm() < 1e-15);
        assert!((corners[1] - Point3::new(0.0, -0.05, 0.0)).norm() < 1e-15);
        assert!((corners[5] - Point3::new(0.1, 0.05, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn four_corners_in_general_position_fix_a_homography() {
        let board = Board { columns: 4, rows: 3, square: 0.1 };
        // Rows are 0–3, 4–7, 8–11.
        assert!(board.fix_homography(&[0, 1, 4, 5]));
        assert!(board.fix_homography(&[0, 1, 2, 3, 4, 5]));
        assert!(!board.fix_homography(&[0, 1, 2, 3, 4]));
        assert!(!board.fix_homography(&[9, 0, 1, 2, 3]));
        assert!(!board.fix_homography(&[0, 5, 10, 3]));
        assert!(!board.fix_homography(&[0, 1, 5]));
        // Of four corners three on a line, whichever comes first.
        assert!(!board.fix_homography(&[4, 0, 8, 5]) && !board.fix_homography(&[5, 0, 4, 8]));
        assert!(board.fix_homography(&[4, 0, 8, 5, 6]));
    }

    #[test]
    fn viewpoints_look_at_the_centre() {
        let straight = viewpoint(0.5, 0.0, 1.0, 0.0);
        assert!((straight.rotation * Vector3::x() - Vector3::x()).norm() < 1e-15);
        assert!((straight * Point3::new(0.0, 0.0, 0.5)).coords.norm() < 1e-15);
        let (tilt, azimuth) = (0.6, 2.0);
        let X_TC = viewpoint(0.8, tilt, azimuth, 0.7);
        assert!((X_TC * Point3::new(0.0, 0.0, 0.8)).coords.norm() < 1e-15);
        let expected = Vector3::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), tilt.cos()) * 0.8;
        assert!((X_TC.translation.vector - expected).norm() < 1e-15);
        // Roll turns about the optical axis alone.
        let unrolled = viewpoint(0.8, tilt, azimuth, 0.0);
        assert!((unrolled.rotation.angle_to(&X_TC.rotation) - 0.7).abs() < 1e-14);
    }

    #[test]
    fn zone_cases_just_inside_and_just_outside_each_bound() {
        let zone = Zone { width: 0.4, height: 0.2, edge_margin: 0.01 };
        assert_eq!(zone.case(0.0, 0.0), AxisCase::Inside);
        assert_eq!(zone.case(0.189, 0.0), AxisCase::Inside);
        assert_eq!(zone.case(0.191, 0.0), AxisCase::Edge);
        assert_eq!(zone.case(0.2, 0.1), AxisCase::Edge);
        assert_eq!(zone.case(0.201, 0.0), AxisCase::Outside);
        assert_eq!(zone.case(0.0, -0.1001), AxisCase::Outside);
        assert_eq!(zone.case(f64::NAN, 0.0), AxisCase::Outside);
    }
}
