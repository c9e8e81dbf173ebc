//! Forward kinematics of a serial chain.

use super::joint::Joint;
use super::tree::Motion;
use crate::spatial::Pose;

/// Stages in series from the base frame B to the flange frame F.
///
/// `X_BF(q) = X_B1·J1(q) · X_12·J2(q) · … · X_nF`: every stage is a fixed transform followed by the motion of one joint.
/// Denavit–Hartenberg tables and URDF trees both reduce to this form. Mostly each joint drives one stage, in order; one that
/// others mimic drives theirs too.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// The joints, whose values are q.
    pub joints: Vec<Joint>,
    /// What they drive, base first.
    pub stages: Vec<Stage>,
    /// Fixed transform from the last stage's moved frame to the flange.
    pub X_nF: Pose,
}

/// One moving part of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Fixed pose of the stage's frame in the moved frame of the stage before it.
    pub X_PJ: Pose,
    /// How it moves.
    pub motion: Motion,
}

impl Stage {
    /// Pose of the moved frame in the moved frame of the stage before it, at joint values `q` (rad or m).
    pub fn pose(&self, q: &[f64]) -> Pose {
        self.X_PJ * self.motion.pose(q)
    }
}

impl Chain {
    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Joint values in the middle of the joints' ranges.
    pub fn mid_range(&self) -> Vec<f64> {
        self.joints.iter().map(|joint| f64::midpoint(joint.limits.min, joint.limits.max)).collect()
    }

    /// Pose `X_BF` of the flange at joint values `q` (rad or m, one per joint).
    pub fn flange_pose(&self, q: &[f64]) -> Pose {
        debug_assert_eq!(q.len(), self.dof());
        product(&self.stages, q) * self.X_nF
    }
}

/// The product of the stages' poses at joint values `q`.
pub(crate) fn product(stages: &[Stage], q: &[f64]) -> Pose {
    stages.iter().fold(Pose::identity(), |X, stage| X * stage.pose(q))
}
