//! Poses of `robot_calibration`.
//!
//! Source: `poses_from_yaml.cpp` of `robot_calibration`, by Michael Ferguson. It drops poses with more or fewer positions than
//! joints; without features a pose is captured by all finders.

use super::{beginning, yaml};
use crate::export::Export;
use crate::export::program::Program;
use crate::export::text::{file_name, one_line};

pub(in crate::export) const ROBOT_CALIBRATION: Export = Export {
    name: "robot-calibration",
    file_name: |program| file_name(program.name, "poses.yaml"),
    write: |program| Ok(write(program)),
};

fn write(program: &Program) -> String {
    let joints = yaml::texts(program.joints.iter().map(|joint| joint.name.as_str()));
    let note = "The speed is robot_calibration's own. A home is not among the poses, since a picture is taken at each.";
    let notes: Vec<String> = std::iter::once(note.to_owned()).chain(program.note_of_turns()).collect();
    let mut text = beginning(program, &notes);
    for stop in program.visits() {
        let label = one_line(&stop.label);
        text += &format!("# {label}\n- joints: {joints}\n  positions: {}\n  features: []\n", yaml::numbers(&stop.q));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{joints, program, stops};

    #[test]
    fn turns_that_are_left_out_are_told() {
        let (joints, mut stops) = (joints(), stops());
        stops[0].picture = false;
        let text = write(&program(&joints, &stops));
        assert!(text.contains("NOT in this file: 1 turns") && !text.contains("pose 7\n"), "{text}");
        assert_eq!(text.matches("positions:").count(), 1);
    }

    #[test]
    fn a_pose_a_stop() {
        let (joints, stops) = (joints(), stops());
        let text = write(&program(&joints[..2], &stops[1..]));
        let expected = "# pose 3
- joints: [\"joint_1\", \"joint_2\"]
  positions: [0.4, 0.25, 1.0, 0.1, -0.2, 1.8]
  features: []
";
        assert!(text.ends_with(expected), "{text}");
    }
}
