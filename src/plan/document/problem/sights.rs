//! Where the camera looks and which way is up in its picture, for a mount is easily a quarter turn wrong.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

use crate::problem::Problem;
use crate::spatial::Pose;

/// Where the camera looks, in two frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct CameraSights {
    /// In the frame of the link that carries the camera.
    pub on_flange: Sight,
    /// In the base frame, with every joint in the middle of its range.
    pub in_base_at_mid_range: Sight,
}

/// The optical axis, and up in the picture; unit vectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Sight {
    /// Direction of the optical axis.
    pub looks_along: [f64; 3],
    /// Direction that is up in the picture.
    pub up: [f64; 3],
}

impl CameraSights {
    /// Those of the problem's camera.
    pub fn new(problem: &Problem) -> Self {
        let robot = &problem.robot;
        let X_RF = robot.tree.link_poses(&robot.chain.mid_range())[robot.camera_link];
        Self { on_flange: Sight::new(&robot.X_FC), in_base_at_mid_range: Sight::new(&(X_RF * robot.X_FC)) }
    }
}

impl Sight {
    /// In the frame A, with the camera at `X_AC`.
    fn new(X_AC: &Pose) -> Self {
        Self { looks_along: (X_AC.rotation * Vector3::z()).into(), up: (X_AC.rotation * -Vector3::y()).into() }
    }
}
