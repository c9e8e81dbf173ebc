//! Samples of `easy_handeye2`: pairs of the transforms base to effector and camera to marker.
//!
//! The effector must be the flange of the problem's robot. The marker's frame is the tracker's own, with its origin where the tracker
//! likes it, and is not looked at. Of a camera beside the robot the program keeps the inverse, effector to base.
//!
//! Source: `handeye_sampler.py` of `easy_handeye2`, by Marco Esposito.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};

use super::format::{Import, PoseListFormat};
use super::listed::{PoseList, StatedPlace, numbered};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::{Content, Node};
use crate::robot::Joint;
use crate::spatial::Pose;

pub(super) const IMPORT: Import = Import {
    format: PoseListFormat::EasyHandeye2,
    recognises: |root| samples(root).is_some_and(|list| list.first().is_some_and(|first| first.get("robot").is_some())),
    read,
};

/// Farthest that a robot's flange is from its base, m.
const FARTHEST: f64 = 1e3;

/// How far the norm of a quaternion may be from 1.
const NORM: f64 = 1e-3;

fn samples(root: &Node) -> Option<&[Node]> {
    match &root.get("samples")?.content {
        Content::List(list) => Some(list),
        _ => None,
    }
}

fn read(root: &Node, _: &[Joint]) -> Result<PoseList, ReadError> {
    if let Some(kind) = root.get("parameters").and_then(|parameters| parameters.get("calibration_type")) {
        let name = kind.text(&"parameters.calibration_type")?;
        if name != "eye_in_hand" {
            let what = "samples of a camera that the robot does not carry";
            let instead = "give the joint values at which they were taken, as in a table of them";
            return Err(ReadFault::OtherFormat { what, instead }.at(kind.line));
        }
    }
    let list = root.require("", "samples")?.list(&"samples")?.iter().enumerate();
    let place = |(i, sample): (usize, &Node)| {
        let robot = sample.require(&format!("samples[{i}]."), "robot")?;
        Ok(StatedPlace::Flange(transform(robot, &format!("samples[{i}].robot."))?))
    };
    Ok(numbered(list.map(place).collect::<Result<Vec<_>, ReadError>>()?))
}

fn transform(node: &Node, within: &str) -> Result<Pose, ReadError> {
    let number = |part: &str, key: &str, most: f64| {
        let name = format!("{within}{part}.{key}");
        let of_part = node.require(within, part)?;
        of_part.require(&format!("{within}{part}."), key)?.number(&name)?.between(&name, -most, most)
    };
    let along = |key| number("translation", key, FARTHEST);
    let about = |key| number("rotation", key, 1.0 + NORM);
    let translation = Translation3::new(along("x")?, along("y")?, along("z")?);
    let quaternion = Quaternion::new(about("w")?, about("x")?, about("y")?, about("z")?);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > NORM {
        let line = node.require(within, "rotation")?.line;
        let key = format!("the norm of {within}rotation");
        return Err(ReadFault::OutOfRange { key, value: norm, min: 1.0 - NORM, max: 1.0 + NORM }.at(line));
    }
    Ok(Pose::from_parts(translation, UnitQuaternion::new_normalize(quaternion)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::pose_list::read_poses;

    const TEXT: &str = "parameters: {calibration_type: eye_in_hand, name: a}\nsamples:\n- robot:\n    translation: {x: 0.1, y: \
                        0.2, z: 0.3}\n    rotation: {x: 0.0, y: 0.0, z: 0.6, w: 0.8}\n  tracking: {}\n";

    #[test]
    fn transforms_of_the_robot_are_read() {
        let read = |text: &str| read_poses(text, PoseListFormat::EasyHandeye2, &[]);
        let list = read(TEXT).unwrap();
        let StatedPlace::Flange(X_BF) = list.poses[0].place else { panic!("{list:?}") };
        assert_eq!(X_BF.translation.x, 0.1);
        assert!((X_BF.rotation.angle() - 2.0 * 0.6f64.asin()).abs() < 1e-12);
        let wrong = |from: &str, to: &str| read(&TEXT.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(wrong("eye_in_hand", "eye_on_base").starts_with("line 1: this is samples of a camera that the robot"));
        let norm = wrong("w: 0.8", "w: 0.7");
        assert!(norm.starts_with("line 5: `the norm of samples[0].robot.rotation` is 0.92195"), "{norm}");
        assert!(norm.ends_with("; it must be from 0.999 to 1.001"), "{norm}");
        assert_eq!(
            wrong("z: 0.3", "z: 3e9"),
            "line 4: `samples[0].robot.translation.z` is 3e9; it must be from -1000 to 1000"
        );
        assert_eq!(wrong(", w: 0.8", ""), "line 5: `samples[0].robot.rotation.w` is missing");
    }
}
