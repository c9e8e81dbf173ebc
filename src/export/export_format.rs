//! All formats behind one door.

use super::ExportFile;
use super::error::ExportError;
use super::format::ProgramFormat;
use super::model::{ModelFormat, Setup};
use super::recording;

/// File format of whatever can be exported of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExportFormat {
    /// The tour, as a robot's program reads it.
    Program(ProgramFormat),
    /// The tour as a recording of ROS 2's messages, MCAP.
    Recording,
    /// The robot with its camera and board.
    Model(ModelFormat),
}

impl ExportFormat {
    /// Every format.
    pub const ALL: [Self; ProgramFormat::ALL.len() + 1 + ModelFormat::ALL.len()] = {
        let mut all = [Self::Recording; ProgramFormat::ALL.len() + 1 + ModelFormat::ALL.len()];
        let mut i = 0;
        while i < ProgramFormat::ALL.len() {
            all[i] = Self::Program(ProgramFormat::ALL[i]);
            i += 1;
        }
        i = 0;
        while i < ModelFormat::ALL.len() {
            all[ProgramFormat::ALL.len() + 1 + i] = Self::Model(ModelFormat::ALL[i]);
            i += 1;
        }
        all
    };

    /// Name of the format, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Program(format) => format.name(),
            Self::Recording => "mcap",
            Self::Model(format) => format.name(),
        }
    }

    /// Whether the file holds the tour, with its times and speeds.
    pub fn holds_tour(self) -> bool {
        !matches!(self, Self::Model(_))
    }

    /// The files of `setup` in this format: the one that others read first, then those that it names.
    ///
    /// # Errors
    /// Where the tour makes no sense or is not the robot's, or the format has no such robots or no such long dwell.
    pub fn write(self, setup: &Setup) -> Result<Vec<ExportFile>, ExportError> {
        match self {
            Self::Program(format) => {
                let bytes = format.write(setup.program)?.into_bytes();
                Ok(vec![ExportFile { name: format.file_name(setup.program), bytes }])
            }
            Self::Recording => Ok(vec![recording::write(setup)?]),
            Self::Model(format) => format.write(setup),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn names_differ() {
        let names: HashSet<&str> = ExportFormat::ALL.iter().map(|format| format.name()).collect();
        assert_eq!(names.len(), ExportFormat::ALL.len());
        assert_eq!(ExportFormat::ALL.map(ExportFormat::name)[9..], ["mcap", "urdf", "mjcf", "sdf"]);
    }
}
