//! A tour of stops as files that other programs read: bytes out, nothing written to disk.
//!
//! Robots' programs need the tour alone. A format of theirs stands in a file of its own and is registered in [`ProgramFormat`]: those of ROS
//! in `ros`, those of robots' controllers in `languages`, a table in `csv`. Simulators and viewers need the robot, its camera and its board
//! besides, a [`Setup`]: `model` has the formats of models, `recording` plays the tour. [`ExportFormat`] is the door to all.
//!
//! ```
//! use calipose::export::{Program, ProgramFormat, ProgramJoint, Stop};
//! use calipose::robot::JointKind;
//!
//! let [speed, acceleration, jerk] = [2.0, 4.0, f64::INFINITY];
//! let joint = |name: &str| ProgramJoint { name: name.into(), kind: JointKind::Revolute, speed, acceleration, jerk };
//! let joints = [joint("waist"), joint("shoulder")];
//! let stops = [
//!     Stop { label: "pose 7".into(), q: vec![0.1, -0.5], seconds: 0.0, picture: true },
//!     Stop { label: "pose 3".into(), q: vec![0.4, 0.25], seconds: 2.5, picture: true },
//! ];
//! let program = Program { name: "two joints", joints: &joints, stops: &stops, home: None, dwell: 1.0, share: 0.5 };
//! let text = ProgramFormat::MoveItCalibration.write(&program)?;
//! assert!(text.ends_with("joint_names: [\"waist\", \"shoulder\"]\njoint_values:\n  - [0.1, -0.5]\n  - [0.4, 0.25]\n"));
//! let refused = ProgramFormat::UrScript.write(&program).unwrap_err();
//! assert!(refused.to_string().starts_with("the format \"urscript\" takes exactly 6 revolute joints"));
//! # Ok::<(), calipose::export::ExportError>(())
//! ```

mod csv;
mod error;
mod export_format;
mod format;
mod languages;
mod model;
mod program;
mod recording;
mod ros;
mod text;

#[cfg(test)]
mod example;

pub use error::ExportError;
pub use export_format::ExportFormat;
pub use format::ProgramFormat;
pub use model::{ModelFormat, Setup};
pub use program::{Home, Program, ProgramJoint, Stop};

/// A file of an export.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportFile {
    /// Its name; files that name each other lie in one folder.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// What a format of programs has to say of itself.
struct Export {
    /// Name on the command line.
    name: &'static str,
    /// Usual name of a file. Controllers want it to be the program's.
    file_name: fn(&Program) -> String,
    /// The tour, which makes sense, in this format.
    write: fn(&Program) -> Result<String, ExportError>,
}
