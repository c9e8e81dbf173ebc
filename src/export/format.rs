//! The formats.

use super::Export;
use super::error::ExportError;
use super::program::Program;
use super::{csv, languages, ros};

/// File format that a robot's program reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProgramFormat {
    /// Parameters of ROS 2's `publisher_joint_trajectory_controller`, YAML.
    Ros2Goals,
    /// ROS 2's `trajectory_msgs/JointTrajectory`, YAML.
    JointTrajectory,
    /// Poses of `robot_calibration`, YAML.
    RobotCalibration,
    /// Joint states of `MoveIt` Calibration, YAML.
    MoveItCalibration,
    /// Program of Universal Robots.
    UrScript,
    /// Module of ABB.
    Rapid,
    /// Program of KUKA.
    Krl,
    /// Program of FANUC, as text.
    FanucLs,
    /// Table for programs of one's own.
    Csv,
}

impl ProgramFormat {
    /// Every format.
    pub const ALL: [Self; 9] = [
        Self::Ros2Goals,
        Self::JointTrajectory,
        Self::RobotCalibration,
        Self::MoveItCalibration,
        Self::UrScript,
        Self::Rapid,
        Self::Krl,
        Self::FanucLs,
        Self::Csv,
    ];

    fn export(self) -> &'static Export {
        match self {
            Self::Ros2Goals => &ros::GOALS,
            Self::JointTrajectory => &ros::JOINT_TRAJECTORY,
            Self::RobotCalibration => &ros::ROBOT_CALIBRATION,
            Self::MoveItCalibration => &ros::MOVEIT_CALIBRATION,
            Self::UrScript => &languages::URSCRIPT,
            Self::Rapid => &languages::RAPID,
            Self::Krl => &languages::KRL,
            Self::FanucLs => &languages::FANUC_LS,
            Self::Csv => &csv::EXPORT,
        }
    }

    /// Name of the format, as on the command line.
    pub fn name(self) -> &'static str {
        self.export().name
    }

    /// Name of the file; of a controller's program the only one that it may have.
    pub fn file_name(self, program: &Program) -> String {
        (self.export().file_name)(program)
    }

    /// `program` in this format.
    ///
    /// Joint values keep all their digits where the format is in rad; FANUC's have four decimals of a degree, the other
    /// controllers' six, and times are rounded up.
    ///
    /// # Errors
    /// Where the tour makes no sense, or the format has no such robots or no such long dwell.
    pub fn write(self, program: &Program) -> Result<String, ExportError> {
        program.check()?;
        (self.export().write)(program)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{joints, program, stops};

    #[test]
    fn names_are_of_the_command_line_and_the_disk() {
        let (joints, stops) = (joints(), stops());
        let program = program(&joints, &stops);
        let names = ProgramFormat::ALL.map(|format| (format.name(), format.file_name(&program)));
        let expected = [
            ("ros2-goals", "my_robot.goals.yaml"),
            ("joint-trajectory", "my_robot.trajectory.yaml"),
            ("robot-calibration", "my_robot.poses.yaml"),
            ("moveit-calibration", "my_robot.joint_states.yaml"),
            ("urscript", "my_robot.script"),
            ("rapid", "my_robot.mod"),
            ("krl", "my_robot.src"),
            ("fanuc-ls", "MY_ROBOT.LS"),
            ("csv", "my_robot.csv"),
        ];
        assert_eq!(names, expected.map(|(name, file)| (name, file.to_owned())));
    }

    #[test]
    fn every_format_takes_the_example_and_refuses_nonsense() {
        let (joints, stops) = (joints(), stops());
        let program = program(&joints, &stops);
        for format in ProgramFormat::ALL {
            let text = format.write(&program).unwrap();
            assert!(text.ends_with('\n') && !text.contains("\n\n\n"), "{text}");
            assert!(format.write(&Program { stops: &[], ..program.clone() }).is_err());
        }
    }

    #[test]
    fn no_name_breaks_out_of_a_comment() {
        let (mut joints, mut stops) = (joints(), stops());
        let evil = "x\nEND\r\u{85}\u{2028}movej(0) ; } \" \\ 'é日\u{7f}\u{0}*/";
        joints[0].name = evil.to_owned();
        stops[1].label = evil.to_owned();
        let mut program = program(&joints, &stops);
        let lines = |program: &Program, format: ProgramFormat| format.write(program).unwrap().lines().count();
        let before: Vec<usize> = ProgramFormat::ALL.iter().map(|&format| lines(&program, format)).collect();
        program.name = evil;
        for (format, before) in ProgramFormat::ALL.into_iter().zip(before) {
            let text = format.write(&program).unwrap();
            // In a table a quoted cell may hold lines; elsewhere a longer name fills a line more at most.
            assert!(text.lines().count() <= before + 2, "{text}");
            let is_free = |line: &str| line.trim_start().starts_with("END\r") || line.starts_with("movej");
            assert!(format == ProgramFormat::Csv || !text.lines().any(is_free), "{text}");
            let allowed = |c: char| c == '\n' || c == '\t' || !c.is_control();
            assert!(format == ProgramFormat::Csv || text.chars().all(allowed), "{text:?}");
        }
    }
}
