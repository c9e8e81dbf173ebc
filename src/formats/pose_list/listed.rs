//! Poses as a file lists them.

#[cfg(test)]
use crate::robot::Joint;
use crate::spatial::Pose;

/// A pose as a file lists it.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedPose {
    /// What the file calls it; its number, from 1, where it does not.
    pub name: String,
    /// Where the robot is.
    pub place: StatedPlace,
}

/// Where a file says that the robot is.
#[derive(Debug, Clone, PartialEq)]
pub enum StatedPlace {
    /// Values of all joints of the robot, rad or m, in the robot's order.
    Joints(Vec<f64>),
    /// The pose `X_BF` of the flange in the base frame.
    Flange(Pose),
}

/// The poses of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseList {
    /// The poses, as they are listed; at least one.
    pub poses: Vec<ListedPose>,
    /// Places that the robot only passes, without a picture; they are no poses.
    pub passed: usize,
}

/// Poses that are called by their numbers.
pub(super) fn numbered(places: impl IntoIterator<Item = StatedPlace>) -> PoseList {
    let named = (1..).zip(places).map(|(number, place): (usize, _)| ListedPose { name: number.to_string(), place });
    PoseList { poses: named.collect(), passed: 0 }
}

/// A robot that turns and slides, for tests of the formats.
#[cfg(test)]
pub(super) fn joints() -> Vec<Joint> {
    use crate::robot::{JointKind, Limits};
    let joint = |name: &str, kind| Joint::free(name.into(), kind, Limits { min: -3.0, max: 3.0 }, None);
    vec![
        joint("waist", JointKind::Revolute),
        joint("slide", JointKind::Prismatic),
        joint("joint_3", JointKind::Revolute),
    ]
}

/// The joint values of the poses.
#[cfg(test)]
pub(super) fn values(list: &PoseList) -> Vec<Vec<f64>> {
    let q = |pose: &ListedPose| match &pose.place {
        StatedPlace::Joints(q) => q.clone(),
        StatedPlace::Flange(_) => vec![],
    };
    list.poses.iter().map(q).collect()
}
