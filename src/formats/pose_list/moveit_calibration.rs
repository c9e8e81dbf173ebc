//! Joint states of `MoveIt` Calibration: `joint_names` and rows of `joint_values`.
//!
//! Source: `handeye_control_widget.cpp` of `moveit_calibration`. It drops rows of another length; here they are faults.

use super::format::{Import, PoseListFormat};
use super::joint_names::JointOrder;
use super::listed::{PoseList, StatedPlace, numbered};
use crate::formats::error::ReadError;
use crate::formats::tree::Node;
use crate::robot::Joint;

pub(super) const IMPORT: Import =
    Import { format: PoseListFormat::MoveitCalibration, recognises: |root| root.get("joint_values").is_some(), read };

fn read(root: &Node, joints: &[Joint]) -> Result<PoseList, ReadError> {
    let order = JointOrder::read(root.require("", "joint_names")?, "joint_names", joints)?;
    let rows = root.require("", "joint_values")?.list(&"joint_values")?.iter().enumerate();
    let place = |(i, row): (usize, &Node)| {
        let values = order.values(row, &format!("joint_values[{i}]"))?;
        Ok(StatedPlace::Joints(values))
    };
    Ok(numbered(rows.map(place).collect::<Result<Vec<_>, _>>()?))
}

#[cfg(test)]
mod tests {
    use crate::formats::pose_list::listed::{joints, values};
    use crate::formats::pose_list::{PoseListFormat, read_poses};

    #[test]
    fn rows_are_poses() {
        let text = "joint_names: [slide, joint_3, waist]\njoint_values:\n  - [0.1, 0.2, 0.3]\n  - [1, 2, 3]\n";
        let read = |text: &str| read_poses(text, PoseListFormat::MoveitCalibration, &joints());
        assert_eq!(values(&read(text).unwrap()), [vec![0.3, 0.1, 0.2], vec![3.0, 1.0, 2.0]]);
        let wrong = |from: &str, to: &str| read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert_eq!(
            wrong("[1, 2, 3]", "[1, 2]"),
            "line 4: `joint_values[1]` has 2 entries; it must have 3, one for each joint"
        );
        assert_eq!(wrong("[1, 2, 3]", "7"), "line 4: `joint_values[1]` is 7; it must be a list");
        assert_eq!(wrong("joint_names", "names"), "line 1: `joint_names` is missing");
    }
}
