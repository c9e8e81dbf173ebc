//! Poses of `robot_calibration`: a list of `joints`, `positions` and `features`.
//!
//! Source: `poses_from_yaml.cpp` of `robot_calibration`, by Michael Ferguson. It drops poses with more or fewer positions than joints;
//! here they are faults.

use super::format::{Import, PoseListFormat};
use super::joint_names::JointOrder;
use super::listed::{PoseList, StatedPlace, numbered};
use crate::formats::error::ReadError;
use crate::formats::tree::{Content, Node};
use crate::robot::Joint;

pub(super) const IMPORT: Import = Import {
    format: PoseListFormat::RobotCalibration,
    recognises: |root| match &root.content {
        Content::List(list) => list.first().is_some_and(|pose| pose.get("positions").is_some()),
        _ => false,
    },
    read,
};

fn read(root: &Node, joints: &[Joint]) -> Result<PoseList, ReadError> {
    let poses = root.list(&"the list of poses")?.iter().enumerate();
    let places: Result<Vec<_>, _> = poses.map(|(i, pose)| place(pose, i, joints)).collect();
    Ok(numbered(places?))
}

fn place(pose: &Node, i: usize, joints: &[Joint]) -> Result<StatedPlace, ReadError> {
    let within = format!("[{i}].");
    let order = JointOrder::read(pose.require(&within, "joints")?, &format!("{within}joints"), joints)?;
    let values = order.values(pose.require(&within, "positions")?, &format!("{within}positions"))?;
    Ok(StatedPlace::Joints(values))
}

#[cfg(test)]
mod tests {
    use crate::formats::pose_list::listed::{joints, values};
    use crate::formats::pose_list::{PoseListFormat, read_poses};

    const TEXT: &str = "# by hand\n- joints: &all [joint_3, waist, slide]\n  positions: [0.1, 0.2, 0.3]\n  features: []\n- \
                        joints: *all\n  positions:\n  - 1\n  - -2e-1\n  - 0\n";

    #[test]
    fn poses_are_matched_by_name() {
        let list = read_poses(TEXT, PoseListFormat::RobotCalibration, &joints()).unwrap();
        assert_eq!(values(&list), [vec![0.2, 0.3, 0.1], vec![-0.2, 0.0, 1.0]]);
        assert_eq!(list.poses[1].name, "2");
    }

    #[test]
    fn what_does_not_fit_is_told_with_its_line() {
        let wrong = |from: &str, to: &str| {
            assert!(TEXT.contains(from));
            let text = TEXT.replacen(from, to, 1);
            read_poses(&text, PoseListFormat::RobotCalibration, &joints()).unwrap_err().to_string()
        };
        assert_eq!(
            wrong("joint_3", "wrist"),
            "line 2: there is no joint \"wrist\"; the robot's joints are waist, slide, joint_3"
        );
        assert_eq!(wrong("waist, slide", "waist"), "line 2: joint slide of the robot has no value");
        assert_eq!(wrong("slide]", "waist]"), "line 2: `waist` occurs a second time");
        assert_eq!(
            wrong("0.2, 0.3", "0.2"),
            "line 3: `[0].positions` has 2 entries; it must have 3, one for each joint"
        );
        assert_eq!(wrong("0.2", ".nan"), "line 3: `[0].positions[1]` is .nan; it must be a finite number");
        assert_eq!(wrong("- -2e-1", "- up"), "line 8: `[1].positions[1]` is up; it must be a finite number");
        assert_eq!(wrong("  positions: [0.1, 0.2, 0.3]\n", ""), "line 2: `[0].positions` is missing");
        let none = read_poses("[]", PoseListFormat::RobotCalibration, &joints()).unwrap_err();
        assert_eq!(none.to_string(), "line 1: there are no poses in the file");
    }
}
