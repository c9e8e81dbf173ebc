//! `trajectory_msgs/JointTrajectory`, alone or under `trajectory` as in an action's goal.
//!
//! A trajectory does not say where pictures are taken. Where it has the robot stand still, at two or more points in a row of the same
//! positions, these stops are the poses and all other points are passed; one that never stands still has a pose at every point.
//!
//! Sources: `JointTrajectory.msg` and `JointTrajectoryPoint.msg` of `common_interfaces`.

use super::format::{Import, PoseListFormat};
use super::joint_names::JointOrder;
use super::listed::{ListedPose, PoseList, StatedPlace};
use crate::formats::error::ReadError;
use crate::formats::tree::Node;
use crate::robot::Joint;

pub(super) const IMPORT: Import = Import {
    format: PoseListFormat::JointTrajectory,
    recognises: |root| root.get("trajectory").unwrap_or(root).get("points").is_some(),
    read,
};

fn read(root: &Node, joints: &[Joint]) -> Result<PoseList, ReadError> {
    let (within, message) = match root.get("trajectory") {
        Some(goal) => ("trajectory.", goal),
        None => ("", root),
    };
    let order = JointOrder::read(message.require(within, "joint_names")?, &format!("{within}joint_names"), joints)?;
    let points = message.require(within, "points")?.list(&format_args!("{within}points"))?.iter().enumerate();
    let values = |(i, point): (usize, &Node)| {
        let within = format!("{within}points[{i}].");
        order.values(point.require(&within, "positions")?, &format!("{within}positions"))
    };
    let points = points.map(values).collect::<Result<Vec<_>, ReadError>>()?;
    let stays: Vec<&[Vec<f64>]> = points.chunk_by(|a, b| a == b).collect();
    let stands = stays.iter().any(|stay| stay.len() > 1);
    let mut list = PoseList { poses: vec![], passed: 0 };
    let mut number = 1_usize;
    for stay in stays {
        if stands && stay.len() == 1 {
            list.passed += 1;
        } else {
            list.poses.push(ListedPose { name: number.to_string(), place: StatedPlace::Joints(stay[0].clone()) });
            number += 1;
        }
    }
    Ok(list)
}

#[cfg(test)]
mod tests {
    use crate::formats::pose_list::listed::{joints, values};
    use crate::formats::pose_list::{PoseListFormat, read_poses};

    #[test]
    fn stops_are_poses_and_without_any_all_points_are() {
        let read = |text: &str| read_poses(text, PoseListFormat::JointTrajectory, &joints());
        let head = "joint_names: [waist, slide, joint_3]\npoints:\n";
        let point = |x: f64| format!("  - {{positions: [{x}, 0, 0], time_from_start: {{sec: 1, nanosec: 0}}}}\n");
        let all: String = [0.0, 1.0, 2.0].map(point).concat();
        let list = read(&format!("{head}{all}")).unwrap();
        assert_eq!((list.poses.len(), list.passed), (3, 0));
        let stops: String = [0.0, 1.0, 1.0, 1.5, 2.0, 2.0, 0.0].map(point).concat();
        let list = read(&format!("{head}{stops}")).unwrap();
        assert_eq!(values(&list), [vec![1.0, 0.0, 0.0], vec![2.0, 0.0, 0.0]]);
        assert_eq!((list.poses[1].name.as_str(), list.passed), ("2", 3));
        let goal = "trajectory:\n  joint_names: [waist, slide, joint_3]\n  points:\n  - {velocities: [1]}\n";
        assert_eq!(read(goal).unwrap_err().to_string(), "line 4: `trajectory.points[0].positions` is missing");
    }
}
