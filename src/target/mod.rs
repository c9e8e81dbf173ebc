//! The planar calibration board and the zone it lies in.
//!
//! Frame **T** has its origin at the board's centre, x along its columns, y along its rows and z out of its
//! printed side.

mod aprilgrid;
mod board;
mod charuco;
mod checkerboard;
mod circles;
mod dictionary;
mod error;
mod feature;
mod layout;
mod points;
mod warp;

pub use aprilgrid::AprilGrid;
pub use board::{Board, told};
pub use charuco::Charuco;
pub use checkerboard::Checkerboard;
pub use circles::Circles;
pub use dictionary::Dictionary;
pub use error::BoardError;
pub use feature::Feature;
pub use layout::Marker;
pub use points::Points;
pub use warp::{Surface, Warp};

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};

use crate::spatial::Pose;

/// A board, its place on the robot, and the zone around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// What is printed.
    pub board: Board,
    /// Pose of the board in the robot's base frame.
    pub X_BT: Pose,
    /// The rectangle in the board's plane that the optical axis is tested against.
    pub zone: Zone,
    /// How it may bulge; flat without.
    pub warp: Option<Warp>,
    /// Thickness in metres of the plate under the printed side.
    pub thickness: f64,
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
/// image is turned no further than it takes to look there: from straight ahead, `x_C` is `x_T` and `y_C` is `−y_T`. `roll`
/// turns the camera about its optical axis.
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
    use nalgebra::Point3;

    use super::*;

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
