//! Files that programs of ROS read: YAML, joint values in rad and m.

mod goals;
mod joint_trajectory;
mod moveit_calibration;
mod robot_calibration;
mod yaml;

pub(super) use goals::GOALS;
pub(super) use joint_trajectory::JOINT_TRAJECTORY;
pub(super) use moveit_calibration::MOVEIT_CALIBRATION;
pub(super) use robot_calibration::ROBOT_CALIBRATION;

use super::program::Program;
use super::text::{comments, header};

/// The comments at the beginning of a file, with what the format adds to them.
fn beginning(program: &Program, notes: &[String]) -> String {
    let unit = if program.turns_only() { "rad" } else { "rad, and m of those that slide" };
    let mut all = vec![format!(
        "Joint values in {unit}, in the order of the names, which must be those of the robot's description."
    )];
    all.extend_from_slice(notes);
    comments("# ", &header(program, &all))
}
