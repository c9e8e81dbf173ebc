//! Parameters of `publisher_joint_trajectory_controller`, a node of `ros2_controllers_test_nodes` that sends one goal after the
//! other.
//!
//! Source: `publisher_joint_trajectory_controller.py` of ros-controls/ros2_controllers. Whatever the goal, that node gives the
//! robot 4 s for it, and after the last goal begins again.

use super::{beginning, yaml};
use crate::export::Export;
use crate::export::program::{Leg, Program};
use crate::export::text::{Names, file_name};

pub(in crate::export) const GOALS: Export = Export {
    name: "ros2-goals",
    file_name: |program| file_name(program.name, "goals.yaml"),
    write: |program| Ok(write(program)),
};

/// How long the node gives the robot for each goal, s.
const MOVE: f64 = 4.0;

/// What no goal may be called: parameters of the node, of every node, and what YAML takes for something else than a text.
const RESERVED: &str = "check_starting_point controller_name false goal_names joints n no null off on qos_overrides \
    start_type_description_service starting_point_limits true use_sim_time wait_sec_between_publish y yes";

fn write(program: &Program) -> String {
    let goals = goals(program);
    let names = yaml::texts(goals.iter().map(|(name, _)| name.as_str()));
    let joints = yaml::texts(program.joints.iter().map(|joint| joint.name.as_str()));
    // A whole number, because the node declares the parameter with one.
    let wait = (MOVE + program.dwell).ceil();
    let mut text = beginning(program, &notes());
    // Under any name of the node: its own is not that of its program, and launch files give it others.
    text += &format!(
        "/**:\n  ros__parameters:\n    controller_name: joint_trajectory_controller\n    wait_sec_between_publish: {wait}\n    \
         goal_names: {names}\n    joints: {joints}\n    check_starting_point: false\n"
    );
    for (name, q) in &goals {
        text += &format!("    {name}:\n      positions: {}\n", yaml::numbers(q));
    }
    text
}

fn notes() -> Vec<String> {
    [
        "Run: ros2 run ros2_controllers_test_nodes publisher_joint_trajectory_controller --ros-args --params-file FILE. \
         controller_name must be the controller's.",
        "The node gives the robot 4 s for every goal. Moves that take longer have goals on their way, with the same wait: take \
         pictures at the goals of poses alone, not at home nor at those called to_… or way_…",
        "Stop the node after the last goal: it begins again with the first, and the way there may not be planned.",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// The goals with their names. A move of more than 4 s has some on its way: to a goal without velocities the controller goes at
/// constant speed, which is then no more than the mean of the planned move.
fn goals(program: &Program) -> Vec<(String, Vec<f64>)> {
    let mut names = Names::new(60, RESERVED);
    let mut goals = Vec::new();
    for leg in program.legs() {
        let parts = (leg.seconds / MOVE - 1e-9).ceil().max(1.0) as u32;
        let name = names.take(leg.label, "pose");
        for part in 1..parts {
            let via = names.take(&format!("to_{name}_{part}"), "pose");
            goals.push((via, on_the_way(&leg, f64::from(part) / f64::from(parts))));
        }
        goals.push((name, leg.to.to_vec()));
    }
    goals
}

/// The joint values where `share` of the way is done.
fn on_the_way(leg: &Leg, share: f64) -> Vec<f64> {
    let from = leg.from.unwrap_or(leg.to);
    from.iter().zip(leg.to).map(|(from, to)| from + share * (to - from)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{below, joints, program, stops};
    use crate::export::program::Home;

    #[test]
    fn a_goal_a_stop() {
        let (joints, stops) = (joints(), stops());
        let text = write(&program(&joints, &stops));
        assert!(text.starts_with("# Made by calipose "));
        let expected = r#"/**:
  ros__parameters:
    controller_name: joint_trajectory_controller
    wait_sec_between_publish: 6
    goal_names: ["pose_7", "pose_3"]
    joints: ["joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"]
    check_starting_point: false
    pose_7:
      positions: [0.1, -0.5, 1.0, 0.0, 0.0000001, 3.0]
    pose_3:
      positions: [0.4, 0.25, 1.0, 0.1, -0.2, 1.8]
"#;
        assert_eq!(below(&text, "#"), expected);
    }

    #[test]
    fn long_moves_have_goals_on_their_way() {
        let (joints, mut stops) = (joints(), stops());
        stops[1].label = "joints".into();
        let home = Some(Home { q: vec![0.0; 6], back: Some(4.0) });
        let goals = super::goals(&Program { home, ..program(&joints, &stops) });
        let names: Vec<&str> = goals.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["home", "to_pose_7_1", "to_pose_7_2", "pose_7", "joints_2", "home_2"]);
        assert_eq!(goals[1].1[2], 1.0 / 3.0);
        stops[1].label = "Yes".into();
        assert!(write(&program(&joints, &stops)).contains("    Yes_2:\n"));
    }
}
