//! The robot: a serial chain of joints that carries a camera.

mod chain;
pub mod dh;
mod mechanism;
mod tree;

pub(crate) use chain::product;
pub use chain::{Chain, Joint, JointKind, Limits, Stage};
pub use mechanism::{Assembly, Mechanism};
pub use tree::{Body, Link, Motion, PointMass, Shape, Tree};

use crate::spatial::Pose;

/// A serial chain with a camera mounted on its flange, and all links of the robot that it belongs to.
///
/// The chain runs from the link that carries the board to the link that carries the camera. Its base frame B is that of the
/// former, which is the root of the tree unless the board rides on a link that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// The joints from the base to the flange.
    pub chain: Chain,
    /// All links with their bodies and masses; joint values as the chain's.
    pub tree: Tree,
    /// Pose of the camera in the flange frame.
    pub X_FC: Pose,
    /// Link of the tree that carries the board: its frame is B.
    pub board_link: usize,
    /// Link of the tree that carries the camera: its frame is F.
    pub camera_link: usize,
}

impl Robot {
    /// Pose `X_BC` of the camera in the base frame at joint values `q` (rad or m, one per joint).
    pub fn camera_pose(&self, q: &[f64]) -> Pose {
        self.chain.flange_pose(q) * self.X_FC
    }

    /// Poses `X_BL` of all links in the base frame at joint values `q` (rad or m).
    pub fn link_poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut poses = self.tree.link_poses(q);
        if self.board_link > 0 {
            let X_BR = poses[self.board_link].inverse();
            for X_RL in &mut poses {
                *X_RL = X_BR * *X_RL;
            }
        }
        poses
    }
}
