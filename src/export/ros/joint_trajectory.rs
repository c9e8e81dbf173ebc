//! `trajectory_msgs/JointTrajectory`: two points where the robot stands, its arrival and its departure, one where it only turns, at rest at
//! all of them.
//!
//! Sources: `JointTrajectory.msg` and `JointTrajectoryPoint.msg` of `common_interfaces`. Between points with positions and
//! velocities the controllers of ros-controls draw a cubic.

use super::{beginning, yaml};
use crate::export::Export;
use crate::export::program::{Leg, Program};
use crate::export::text::file_name;

pub(in crate::export) const JOINT_TRAJECTORY: Export = Export {
    name: "joint-trajectory",
    file_name: |program| file_name(program.name, "trajectory.yaml"),
    write: |program| Ok(write(program)),
};

/// Least time to reach the first point, s: a robot that stands there stands still so long, another gets there calmly.
const LEAD_IN: f64 = 5.0;

/// Least time of a move of no length, s: the times of points must rise.
const STEP: f64 = 0.01;

fn write(program: &Program) -> String {
    let joints = yaml::texts(program.joints.iter().map(|joint| joint.name.as_str()));
    let mut text = beginning(program, &notes());
    text += &format!("header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: \"\"\njoint_names: {joints}\npoints:\n");
    for (q, time) in points(program) {
        text += &point(q, time);
    }
    text
}

fn notes() -> Vec<String> {
    [
        "Run: ros2 topic pub --once /joint_trajectory_controller/joint_trajectory trajectory_msgs/msg/JointTrajectory \
         --yaml-file FILE (before ROS 2 Kilted \"$(cat FILE)\" in place of the last two).",
        "Where the robot stands for a picture there are two points, its arrival and its departure. Moves are cubics at rest at both ends; where one would be \
         faster than the joints may be, it takes longer than planned.",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// Joint values and times in s, rising, of all points.
fn points<'a>(program: &'a Program) -> Vec<(&'a [f64], f64)> {
    let legs = program.legs();
    let times: Vec<f64> = legs.iter().map(|leg| cubic_time(program, leg)).collect();
    let mut time = times.iter().copied().fold(LEAD_IN, f64::max);
    let mut points = Vec::new();
    for (leg, takes) in legs.iter().zip(times) {
        if leg.from.is_some() {
            time += takes;
        }
        points.push((leg.to, time));
        if leg.visit.is_some() && program.dwell > 0.0 {
            time += program.dwell;
            points.push((leg.to, time));
        }
    }
    points
}

/// How long a cubic at rest at both ends takes, s: as planned, or until no joint is too fast (a cubic's peak is 3/2 of its mean)
/// or its acceleration too great (6 d/T² at the ends of a way d).
fn cubic_time(program: &Program, leg: &Leg) -> f64 {
    let from = leg.from.unwrap_or(leg.to);
    let ways = from.iter().zip(leg.to).map(|(from, to)| (to - from).abs());
    program.joints.iter().zip(ways).fold(leg.seconds.max(STEP), |time, (joint, way)| {
        let by_speed = 1.5 * way / (program.share * joint.speed);
        time.max(by_speed).max((6.0 * way / joint.acceleration).sqrt())
    })
}

fn point(q: &[f64], time: f64) -> String {
    let nanoseconds = (time * 1e9).round() as u64;
    let rest = yaml::numbers(&vec![0.0; q.len()]);
    format!(
        "  - positions: {}\n    velocities: {rest}\n    accelerations: []\n    effort: []\n    \
         time_from_start: {{sec: {}, nanosec: {}}}\n",
        yaml::numbers(q),
        nanoseconds / 1_000_000_000,
        nanoseconds % 1_000_000_000,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{below, joints, program, stops};
    use crate::export::program::Home;

    #[test]
    fn two_points_a_stop() {
        let (joints, stops) = (joints(), stops());
        let text = write(&program(&joints, &stops));
        let expected = r#"header:
  stamp: {sec: 0, nanosec: 0}
  frame_id: ""
joint_names: ["joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"]
points:
  - positions: [0.1, -0.5, 1.0, 0.0, 0.0000001, 3.0]
    velocities: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    accelerations: []
    effort: []
    time_from_start: {sec: 5, nanosec: 0}
  - positions: [0.1, -0.5, 1.0, 0.0, 0.0000001, 3.0]
    velocities: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    accelerations: []
    effort: []
    time_from_start: {sec: 6, nanosec: 500000000}
"#;
        assert!(below(&text, "#").starts_with(expected), "{text}");
        assert!(text.contains("time_from_start: {sec: 9, nanosec: 0}"));
        assert!(text.ends_with("time_from_start: {sec: 10, nanosec: 500000000}\n"));
    }

    #[test]
    fn times_rise_and_no_cubic_is_too_fast() {
        let (joints, mut stops) = (joints(), stops());
        stops[0].seconds = 1e-3;
        stops[1].q = stops[0].q.clone();
        stops[1].seconds = 0.0;
        let home = Some(Home { q: vec![0.0; 6], back: Some(2.0) });
        let fast = Program { home, dwell: 0.0, share: 1.0, ..program(&joints, &stops) };
        let times = |program: &Program| points(program).iter().map(|point| point.1).collect::<Vec<_>>();
        // 3 rad at 2 rad/s.
        assert_eq!(times(&fast), [5.0, 7.25, 7.26, 9.51]);
        let mut weak = joints.clone();
        weak[5].acceleration = 0.5;
        let calm = Program { joints: &weak, ..fast };
        assert_eq!(times(&calm)[..2], [6.0, 12.0]);
    }
}
