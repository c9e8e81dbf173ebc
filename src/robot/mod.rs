//! The robot: a serial chain of joints that carries a camera.

mod chain;
pub mod dh;
mod inverse;
mod joint;
mod mechanism;
mod tree;
mod turn;

pub(crate) use chain::product;
pub use chain::{Chain, Stage};
pub use inverse::{ReachSettings, Reached, Starts, reach};
pub use joint::{Joint, JointKind, Limits, Resolution};
pub use mechanism::{Assembly, Mechanism};
pub use tree::{Body, Link, Motion, PointMass, Shape, Tree};
pub use turn::Span;

use nalgebra::{Matrix6xX, Vector3, Vector6};

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
    /// Links of the tree that are not the robot's: obstacles around it, fixed to the root.
    pub obstacles: Vec<usize>,
}

impl Robot {
    /// Pose `X_BC` of the camera in the base frame at joint values `q` (rad or m, one per joint).
    pub fn camera_pose(&self, q: &[f64]) -> Pose {
        self.chain.flange_pose(q) * self.X_FC
    }

    /// Pose `X_BC` of the camera, and its 6 × n derivative by the joint values: each column the motion (ω, v) of
    /// [`perturb`](crate::spatial::perturb) per rad or m of a joint.
    pub fn camera_jacobian(&self, q: &[f64]) -> (Pose, Matrix6xX<f64>) {
        let X_BC = self.camera_pose(q);
        let mut J = Matrix6xX::zeros(q.len());
        let mut X_BP = Pose::identity();
        for stage in &self.chain.stages {
            let X_BJ = X_BP * stage.X_PJ;
            if let Motion::Driven { joint, kind, axis, multiplier, .. } = stage.motion {
                let axis = X_BJ.rotation * axis.into_inner() * multiplier;
                let (ω, v) = match kind {
                    JointKind::Revolute => (axis, axis.cross(&(X_BC.translation.vector - X_BJ.translation.vector))),
                    JointKind::Prismatic => (Vector3::zeros(), axis),
                };
                let mut column = J.column_mut(joint);
                column += Vector6::new(ω.x, ω.y, ω.z, v.x, v.y, v.z);
            }
            X_BP = X_BJ * stage.motion.pose(q);
        }
        (X_BC, J)
    }

    /// The joints whose moving part, up to the next joint, has no body.
    pub fn joints_without_bodies(&self) -> impl Iterator<Item = &Joint> {
        let links = &self.tree.links;
        let mut moves_body = vec![false; self.chain.dof()];
        for (i, _) in links.iter().enumerate().filter(|(_, link)| !link.bodies.is_empty()) {
            if let Motion::Driven { joint, .. } = links[self.tree.mover(i)].motion {
                moves_body[joint] = true;
            }
        }
        self.chain.joints.iter().zip(moves_body).filter(|(_, moves_body)| !moves_body).map(|(joint, _)| joint)
    }

    /// Whether any part that moves has a body.
    pub fn has_bodies(&self) -> bool {
        self.joints_without_bodies().count() < self.chain.dof()
    }

    /// Moves the arm, from the link on that hangs on the one that carries the board, by `X_BB` in the base frame.
    pub(crate) fn move_arm(&mut self, X_BB: &Pose) {
        if let Some(first) = self.chain.stages.first_mut() {
            first.X_PJ = X_BB * first.X_PJ;
        }
        let links = &mut self.tree.links;
        let mut link = self.camera_link;
        while let Some(parent) = links[link].parent {
            if parent == self.board_link {
                links[link].X_PJ = X_BB * links[link].X_PJ;
                break;
            }
            link = parent;
        }
    }

    /// Moves the joints' zeros by so much (rad or m, one per joint): at joint values q the robot stands as it did at `q + zeros`.
    pub(crate) fn move_zeros(&mut self, zeros: &[f64]) {
        let stages = self.chain.stages.iter_mut().map(|stage| &mut stage.motion);
        for motion in stages.chain(self.tree.links.iter_mut().map(|link| &mut link.motion)) {
            if let Motion::Driven { joint, multiplier, offset, .. } = motion {
                *offset += *multiplier * zeros[*joint];
            }
        }
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
