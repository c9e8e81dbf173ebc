//! Lists of poses: where a robot is to go, or has been, to take pictures.
//!
//! A format stands in a file of its own and is registered among `IMPORTS`; a table is told by its header.

mod easy_handeye2;
mod format;
mod joint_names;
mod joint_trajectory;
mod listed;
mod moveit_calibration;
mod plan;
mod robot_calibration;
mod table;

pub use format::PoseListFormat;
pub use listed::{ListedPose, PoseList, StatedPlace};

use super::error::{ReadError, ReadFault};
use super::tree;
use crate::robot::Joint;
use format::Import;

/// The formats in YAML and JSON; the first that recognises a file reads it.
const IMPORTS: [Import; 5] = [
    plan::IMPORT,
    robot_calibration::IMPORT,
    moveit_calibration::IMPORT,
    joint_trajectory::IMPORT,
    easy_handeye2::IMPORT,
];

/// The poses of `text`, a file of that `format`, for a robot with these `joints`. Joint values are matched by name, in whatever order the
/// file has them.
///
/// ```
/// use calipose::formats::{PoseListFormat, StatedPlace, read_poses};
/// use calipose::robot::{Joint, JointKind, Limits};
///
/// let joint = |name: &str| Joint::free(name.into(), JointKind::Revolute, Limits::FULL_TURN, None);
/// let joints = [joint("shoulder"), joint("elbow")];
/// let text = "- joints: [elbow, shoulder]\n  positions: [0.5, -1.0]\n";
/// assert_eq!(PoseListFormat::of(text)?, PoseListFormat::RobotCalibration);
/// let list = read_poses(text, PoseListFormat::RobotCalibration, &joints)?;
/// assert_eq!(list.poses[0].place, StatedPlace::Joints(vec![-1.0, 0.5]));
/// # Ok::<(), calipose::formats::ReadError>(())
/// ```
///
/// # Errors
/// The first fault, with its line; and for detections, which [`read_detections`](super::read_detections) reads.
pub fn read_poses(text: &str, format: PoseListFormat, joints: &[Joint]) -> Result<PoseList, ReadError> {
    let text = text.trim_start_matches('\u{feff}');
    let last_line = text.lines().count().max(1);
    let list = if format == PoseListFormat::Csv {
        table::read(text, joints)?
    } else {
        let import = IMPORTS.into_iter().find(|import| import.format == format);
        let import = import.ok_or_else(|| ReadFault::NoPoseList { read: PoseListFormat::described() }.at(1))?;
        (import.read)(&tree::parse(text)?, joints)?
    };
    if list.poses.is_empty() { Err(ReadFault::NoPoses.at(last_line)) } else { Ok(list) }
}

impl PoseListFormat {
    /// The format of a file, by its content.
    ///
    /// # Errors
    /// When the text is of none of them, with the line where it is no YAML.
    pub fn of(text: &str) -> Result<Self, ReadError> {
        let text = text.trim_start_matches('\u{feff}');
        let is_vnl = |line: &str| {
            line.strip_prefix('#').is_some_and(|header| header.split_whitespace().next() == Some("filename"))
        };
        if text.lines().any(is_vnl) {
            return Ok(Self::Detections);
        }
        if table::is_table(text) {
            return Ok(Self::Csv);
        }
        let root = tree::parse(text)?;
        if let Some(Ok("calipose.observations")) = root.get("format").map(|format| format.text(&"format")) {
            return Ok(Self::Detections);
        }
        let import = IMPORTS.into_iter().find(|import| (import.recognises)(&root));
        let unknown = || ReadFault::NoPoseList { read: Self::described() }.at(root.line);
        import.map(|import| import.format).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_content() {
        for (text, format) in [
            ("# by hand\n- {joints: [a], positions: [1]}\n", PoseListFormat::RobotCalibration),
            ("joint_names: [a]\njoint_values: [[1]]\n", PoseListFormat::MoveitCalibration),
            ("joint_names: [a]\npoints: [{positions: [1]}]\n", PoseListFormat::JointTrajectory),
            ("trajectory: {joint_names: [a], points: []}\n", PoseListFormat::JointTrajectory),
            ("samples:\n- robot: {}\n", PoseListFormat::EasyHandeye2),
            (",a_rad,b_deg\n0,1,2\n", PoseListFormat::Csv),
            ("\u{feff}a_rad,b_deg\n1,2\n", PoseListFormat::Csv),
            ("a_rad\n1\n", PoseListFormat::Csv),
            ("{\"format\": \"calipose.polished\"}", PoseListFormat::Plan),
            ("{\"format\": \"calipose.observations\"}", PoseListFormat::Detections),
            ("## mrgingham\n# filename x y level\na.png - - -\n", PoseListFormat::Detections),
        ] {
            assert_eq!(PoseListFormat::of(text), Ok(format), "{text}");
        }
        let refused = |text: &str| PoseListFormat::of(text).unwrap_err().to_string();
        assert!(
            refused("a: 1\n").starts_with("line 1: this is no list of poses that is known; read are poses of robot")
        );
        assert_eq!(refused(""), "line 1: the file is empty");
        assert!(refused("a: [1\n").starts_with("line 1: "));
    }
}
