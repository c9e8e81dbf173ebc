//! Which axis of a controller each joint is.

use crate::export::error::ExportError;
use crate::export::program::Program;
use crate::robot::JointKind;

const INSTEAD: &str = "export it as \"joint-trajectory\" if it runs on ROS, or as \"csv\" for a program of your own";

/// Joints of an arm on tracks: the first ones slide and are the controller's external axes, the others turn and are its arm's.
pub(super) struct Axes {
    external: usize,
}

impl Axes {
    /// The axes of `program`'s robot, for a format that takes an arm of up to six joints on up to `tracks` tracks.
    pub(super) fn new(
        program: &Program,
        format: &'static str,
        tracks: usize,
        takes: &'static str,
    ) -> Result<Self, ExportError> {
        let slides = |kind| kind == JointKind::Prismatic;
        let external = program.joints.iter().take_while(|joint| slides(joint.kind)).count();
        let arm = &program.joints[external..];
        if external <= tracks && (1..=6).contains(&arm.len()) && !arm.iter().any(|joint| slides(joint.kind)) {
            return Ok(Self { external });
        }
        Err(refused(program, format, takes))
    }

    /// The arm's values in degrees.
    pub(super) fn degrees(&self, q: &[f64]) -> Vec<f64> {
        q[self.external..].iter().map(|value| value.to_degrees()).collect()
    }

    /// The tracks' values in mm.
    pub(super) fn millimetres(&self, q: &[f64]) -> Vec<f64> {
        q[..self.external].iter().map(|value| 1e3 * value).collect()
    }

    /// Which joint each axis must be; `arm` and `external` name an axis by its number from 1 on.
    pub(super) fn note(
        &self,
        program: &Program,
        arm: impl Fn(usize) -> String,
        external: impl Fn(usize) -> String,
    ) -> String {
        let axis = |i: usize| if i < self.external { external(i + 1) } else { arm(i + 1 - self.external) };
        let pairs = program.joints.iter().enumerate().map(|(i, joint)| format!("{} = {}", axis(i), joint.name));
        let units = if self.external > 0 { "deg, external axes in mm" } else { "deg" };
        let pairs = pairs.collect::<Vec<_>>().join(", ");
        format!(
            "Values in {units}. The robot's axes must be these joints, with the same zeros and directions: {pairs}."
        )
    }
}

/// The fault of a robot that `format` has not.
pub(super) fn refused(program: &Program, format: &'static str, takes: &'static str) -> ExportError {
    let prismatic = program.joints.iter().filter(|joint| joint.kind == JointKind::Prismatic).count();
    ExportError::Joints { format, revolute: program.joints.len() - prismatic, prismatic, takes, instead: INSTEAD }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{joints, program, stops};

    #[test]
    fn tracks_come_first() {
        let (mut joints, stops) = (joints(), stops());
        let external = |kinds: &[usize], joints: &mut Vec<crate::export::program::ProgramJoint>| {
            for (i, joint) in joints.iter_mut().enumerate() {
                joint.kind = if kinds.contains(&i) { JointKind::Prismatic } else { JointKind::Revolute };
            }
            Axes::new(&program(joints, &stops), "rapid", 1, "one of its own").map(|axes| axes.external)
        };
        assert_eq!(external(&[], &mut joints), Ok(0));
        assert_eq!(external(&[0], &mut joints), Ok(1));
        for kinds in [&[0, 1][..], &[2], &[0, 1, 2, 3, 4, 5]] {
            assert!(external(kinds, &mut joints).is_err(), "{kinds:?}");
        }
        let message = external(&[2], &mut joints).unwrap_err().to_string();
        let expected =
            "the format \"rapid\" takes one of its own; this robot has 5 revolute and 1 prismatic: export it as";
        assert!(message.starts_with(expected), "{message}");
        let axes = Axes { external: 1 };
        assert_eq!((axes.millimetres(&[0.5, 0.0]), axes.degrees(&[0.5, 0.0])), (vec![500.0], vec![0.0]));
    }
}
