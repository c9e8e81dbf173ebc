//! Forward kinematics of a serial chain.

use nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};

use crate::spatial::Pose;

/// Joints in series from the base frame B to the flange frame F.
///
/// `X_BF(q) = X_B1·J1(q1) · X_12·J2(q2) · … · X_nF`: every joint is a fixed transform followed by a motion about
/// or along its axis. Denavit–Hartenberg tables and URDF trees both reduce to this form.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// The joints, base first.
    pub joints: Vec<Joint>,
    /// Fixed transform from the last joint's moved frame to the flange.
    pub X_nF: Pose,
}

/// One joint of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, as the robot's driver knows it.
    pub name: String,
    /// How the joint moves.
    pub kind: JointKind,
    /// Fixed pose of the joint frame in the frame of the joint before it.
    pub X_PJ: Pose,
    /// Axis of the motion in the joint frame.
    pub axis: Unit<Vector3<f64>>,
    /// Range of joint values.
    pub limits: Limits,
    /// Largest speed in rad/s or m/s, where known.
    pub max_speed: Option<f64>,
}

/// The motion of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Rotation about the axis, in rad.
    Revolute,
    /// Translation along the axis, in m.
    Prismatic,
}

/// A closed range of joint values in rad or m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

impl Joint {
    /// Pose of the moved joint frame in the frame of the joint before it, at joint value `q` (rad or m).
    pub fn pose(&self, q: f64) -> Pose {
        match self.kind {
            JointKind::Revolute => self.X_PJ * UnitQuaternion::from_axis_angle(&self.axis, q),
            JointKind::Prismatic => self.X_PJ * Translation3::from(self.axis.into_inner() * q),
        }
    }
}

impl Chain {
    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Pose `X_BF` of the flange at joint values `q` (rad or m, one per joint).
    pub fn flange_pose(&self, q: &[f64]) -> Pose {
        debug_assert_eq!(q.len(), self.dof());
        let X_Bn = self.joints.iter().zip(q).fold(Pose::identity(), |X_BP, (joint, &q)| X_BP * joint.pose(q));
        X_Bn * self.X_nF
    }
}
