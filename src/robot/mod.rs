//! The robot: a serial chain of joints that carries a camera.

mod chain;
pub mod dh;
mod tree;

pub use chain::{Chain, Joint, JointKind, Limits};
pub use tree::{Body, Link, Motion, PointMass, Shape, Tree};

use crate::spatial::Pose;

/// A serial chain with a camera mounted on its flange.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// The joints from the base to the flange.
    pub chain: Chain,
    /// All links with their bodies and masses; joint values as the chain's.
    pub tree: Tree,
    /// Pose of the camera in the flange frame.
    pub X_FC: Pose,
}

impl Robot {
    /// Pose `X_BC` of the camera in the base frame at joint values `q` (rad or m, one per joint).
    pub fn camera_pose(&self, q: &[f64]) -> Pose {
        self.chain.flange_pose(q) * self.X_FC
    }
}
