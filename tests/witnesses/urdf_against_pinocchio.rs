//! Link poses and centres of mass of the robots that ship, against pinocchio.
//!
//! `tests/golden/urdf_kinematics.py` made the reference, and compares public robots when run by itself.

use std::path::Path;

use calipose::formats::read_urdf_file;
use nalgebra::{Matrix4, Point3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Golden {
    robots: Vec<GoldenRobot>,
}

#[derive(Deserialize)]
struct GoldenRobot {
    urdf: String,
    joints: Vec<String>,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    q: Vec<f64>,
    /// The first three rows of the homogeneous matrix.
    camera: [[f64; 4]; 3],
    /// Positions of the links whose names start with `finger_`, one of which follows the other.
    fingers: Vec<[f64; 3]>,
    center_of_mass: [f64; 3],
    mass: f64,
}

const TOLERANCE: f64 = 1e-12;

#[test]
fn kinematics_and_centres_of_mass_equal_pinocchios() {
    let text = std::fs::read_to_string("tests/golden/urdf_kinematics.json").unwrap();
    let golden: Golden = serde_json::from_str(&text).unwrap();
    assert_eq!(golden.robots.len(), 2);
    for robot in golden.robots {
        let mechanism = read_urdf_file(&Path::new("problems/urdf").join(&robot.urdf), &[]).unwrap().mechanism;
        let names: Vec<&str> = mechanism.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, robot.joints);
        assert!(robot.cases.len() >= 40);
        for case in robot.cases {
            let X_BL = mechanism.tree.link_poses(&case.q);
            let camera = X_BL[mechanism.link("camera_optical_frame").unwrap()].to_homogeneous();
            let expected = Matrix4::from_fn(|i, j| if i < 3 { case.camera[i][j] } else { f64::from(u8::from(j == 3)) });
            assert!((camera - expected).norm() < TOLERANCE, "{}: {:?}", robot.urdf, case.q);
            let fingers = mechanism.tree.links.iter().zip(&X_BL).filter(|(link, _)| link.name.starts_with("finger_"));
            let fingers: Vec<[f64; 3]> = fingers.map(|(_, X)| X.translation.vector.into()).collect();
            assert_eq!(fingers.len(), case.fingers.len());
            for (finger, expected) in fingers.iter().zip(case.fingers) {
                assert!((Point3::from(*finger) - Point3::from(expected)).norm() < TOLERANCE);
            }
            let center = mechanism.tree.center_of_mass(&X_BL).unwrap();
            assert!((center.center - Point3::from(case.center_of_mass)).norm() < TOLERANCE);
            assert!((center.mass - case.mass).abs() < TOLERANCE * case.mass);
        }
    }
}
