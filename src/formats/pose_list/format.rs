//! Which formats lists of poses have, and what one has to say of itself.

use super::listed::PoseList;
use crate::formats::error::ReadError;
use crate::formats::tree::Node;
use crate::robot::Joint;

/// A format that poses are read from in YAML.
pub(super) struct Import {
    pub(super) format: PoseListFormat,
    /// Whether a file is of this format, if it is of none before.
    pub(super) recognises: fn(&Node) -> bool,
    /// The poses of such a file.
    pub(super) read: fn(&Node, &[Joint]) -> Result<PoseList, ReadError>,
}

/// What a file that tells poses is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PoseListFormat {
    /// Poses of ROS `robot_calibration`, YAML.
    RobotCalibration,
    /// Joint states of `MoveIt` Calibration, YAML.
    MoveitCalibration,
    /// `trajectory_msgs/JointTrajectory`, YAML.
    JointTrajectory,
    /// Samples of `easy_handeye2`, YAML.
    EasyHandeye2,
    /// A table with a column for each joint, CSV.
    Csv,
    /// A plan of calipose or poses that it proposed, JSON.
    Plan,
    /// Detected corners: mrcal's vnl or calipose's JSON.
    Detections,
}

impl PoseListFormat {
    /// Every format.
    pub const ALL: [Self; 7] = [
        Self::RobotCalibration,
        Self::MoveitCalibration,
        Self::JointTrajectory,
        Self::EasyHandeye2,
        Self::Csv,
        Self::Plan,
        Self::Detections,
    ];

    /// Name of the format, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::RobotCalibration => "robot-calibration",
            Self::MoveitCalibration => "moveit-calibration",
            Self::JointTrajectory => "joint-trajectory",
            Self::EasyHandeye2 => "easy-handeye2",
            Self::Csv => "csv",
            Self::Plan => "plan",
            Self::Detections => "detections",
        }
    }

    /// What its files are, in the plural.
    fn files(self) -> &'static str {
        match self {
            Self::RobotCalibration => "poses of robot_calibration",
            Self::MoveitCalibration => "joint states of MoveIt Calibration",
            Self::JointTrajectory => "JointTrajectory messages (YAML)",
            Self::EasyHandeye2 => "samples of easy_handeye2",
            Self::Csv => "tables with a column for each joint (CSV)",
            Self::Plan => "plans",
            Self::Detections => "detected corners",
        }
    }

    /// All files that are read, in words.
    pub(super) fn described() -> String {
        Self::ALL.map(Self::files).join(", ")
    }
}
