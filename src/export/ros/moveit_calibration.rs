//! Joint states of `MoveIt` Calibration.
//!
//! Source: `handeye_control_widget.cpp` of `moveit_calibration`. It opens names that end in `.yaml` alone, drops rows of another
//! length, and takes the names only where they are the move group's active joints in their order.

use super::{beginning, yaml};
use crate::export::Export;
use crate::export::program::Program;
use crate::export::text::file_name;

pub(in crate::export) const MOVEIT_CALIBRATION: Export = Export {
    name: "moveit-calibration",
    file_name: |program| file_name(program.name, "joint_states.yaml"),
    write: |program| Ok(write(program)),
};

fn write(program: &Program) -> String {
    let joints = yaml::texts(program.joints.iter().map(|joint| joint.name.as_str()));
    let note = "The joints must be the active ones of the move group. MoveIt plans the ways itself, at half of its speeds. A \
                home is not among the states, since a sample is taken at each.";
    let notes: Vec<String> = std::iter::once(note.to_owned()).chain(program.note_of_turns()).collect();
    let mut text = beginning(program, &notes);
    text += &format!("joint_names: {joints}\njoint_values:\n");
    for stop in program.visits() {
        text += &format!("  - {}\n", yaml::numbers(&stop.q));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{below, joints, program, stops};

    #[test]
    fn a_row_a_stop() {
        let (mut joints, stops) = (joints(), stops());
        joints[1].name = "yes: \"no\"\n".into();
        let text = write(&program(&joints, &stops));
        let expected = r#"joint_names: ["joint_1", "yes: \"no\"\x0a", "joint_3", "joint_4", "joint_5", "joint_6"]
joint_values:
  - [0.1, -0.5, 1.0, 0.0, 0.0000001, 3.0]
  - [0.4, 0.25, 1.0, 0.1, -0.2, 1.8]
"#;
        assert_eq!(below(&text, "#"), expected);
    }
}
