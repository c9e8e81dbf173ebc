//! `trajectory_msgs/JointTrajectory`: two points where the robot stands, its arrival and its departure, one where it only turns, at rest at
//! all of them.
//!
//! Sources: `JointTrajectory.msg` and `JointTrajectoryPoint.msg` of `common_interfaces`. Between points with positions and
//! velocities the controllers of ros-controls draw a cubic, with accelerations a quintic, whose acceleration never jumps.

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
    let mut text = beginning(program, &notes(program));
    text += &format!("header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: \"\"\njoint_names: {joints}\npoints:\n");
    for (q, time) in points(program) {
        text += &point(q, time, program.limits_jerk());
    }
    text
}

fn notes(program: &Program) -> Vec<String> {
    let curves = if program.limits_jerk() { "quintics" } else { "cubics" };
    vec![
        "Run: ros2 topic pub --once /joint_trajectory_controller/joint_trajectory trajectory_msgs/msg/JointTrajectory \
         --yaml-file FILE (before ROS 2 Kilted \"$(cat FILE)\" in place of the last two)."
            .to_owned(),
        format!(
            "Where the robot stands for a picture there are two points, its arrival and its departure. Moves are {curves} at rest at both \
             ends; where one would be faster than the joints may be, it takes longer than planned."
        ),
    ]
}

/// Joint values and times in s, rising, of all points.
fn points<'a>(program: &'a Program) -> Vec<(&'a [f64], f64)> {
    let legs = program.legs();
    let times: Vec<f64> = legs.iter().map(|leg| time_of_curve(program, leg)).collect();
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

/// How long a cubic, or a quintic, at rest at both ends takes, s: as planned, or until no joint is too fast. On a way d in the time T a
/// cubic's greatest speed is 3/2 d/T and its greatest acceleration 6 d/T²; a quintic's are 15/8 d/T and 10/√3 d/T², and its greatest
/// jerk 60 d/T³.
fn time_of_curve(program: &Program, leg: &Leg) -> f64 {
    let from = leg.from.unwrap_or(leg.to);
    let ways = from.iter().zip(leg.to).map(|(from, to)| (to - from).abs());
    let [of_speed, of_acceleration, of_jerk] =
        if program.limits_jerk() { [1.875, 10.0 / 3.0_f64.sqrt(), 60.0] } else { [1.5, 6.0, 0.0] };
    program.joints.iter().zip(ways).fold(leg.seconds.max(STEP), |time, (joint, way)| {
        let by_speed = of_speed * way / (program.share * joint.speed);
        let by_acceleration = (of_acceleration * way / joint.acceleration).sqrt();
        time.max(by_speed).max(by_acceleration).max((of_jerk * way / joint.jerk).cbrt())
    })
}

fn point(q: &[f64], time: f64, eased: bool) -> String {
    let nanoseconds = (time * 1e9).round() as u64;
    let rest = yaml::numbers(&vec![0.0; q.len()]);
    let accelerations = if eased { &rest } else { "[]" };
    format!(
        "  - positions: {}\n    velocities: {rest}\n    accelerations: {accelerations}\n    effort: []\n    \
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

    #[test]
    fn joints_with_limits_of_jerk_take_quintics() {
        let (mut joints, stops) = (joints(), stops());
        joints[3].jerk = 1.0;
        let text = write(&Program { dwell: 0.0, share: 1.0, ..program(&joints, &stops) });
        assert!(
            text.contains("    accelerations: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n") && text.contains("quintics"),
            "{text}"
        );
        // .1 rad at no more than 1 rad/s³, which takes less than the planned 2.5 s.
        assert!(text.ends_with("time_from_start: {sec: 7, nanosec: 500000000}\n"), "{text}");
        joints[3].jerk = 0.1;
        let text = write(&Program { dwell: 0.0, share: 1.0, ..program(&joints, &stops) });
        assert!(text.ends_with("time_from_start: {sec: 8, nanosec: 914867641}\n"), "{text}");
    }
}
