//! Why a tour cannot be exported.

use thiserror::Error;

/// Why a tour cannot be exported.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ExportError {
    /// There is nothing to export.
    #[error("there are no {what}")]
    Empty {
        /// What there is none of.
        what: &'static str,
    },
    /// Values of more or fewer joints than the robot has.
    #[error("{place} has {found} joint values, but the robot has {expected} joints")]
    Length {
        /// Label of the stop.
        place: String,
        /// Values there are.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// A number that makes no sense.
    #[error("{what} is {value}; it must be {expected}")]
    Number {
        /// What it is of.
        what: String,
        /// The number.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// A joint has no name of its own.
    #[error("a joint is called \"{name}\"; every joint needs a name that no other has")]
    JointName {
        /// The name it has.
        name: String,
    },
    /// The format has no such robots.
    #[error(
        "the format \"{format}\" takes {takes}; this robot has {revolute} revolute and {prismatic} prismatic: {instead}"
    )]
    Joints {
        /// Name of the format.
        format: &'static str,
        /// Joints that turn, of the tour's robot.
        revolute: usize,
        /// Joints that slide.
        prismatic: usize,
        /// Which robots the format has.
        takes: &'static str,
        /// What to do.
        instead: &'static str,
    },
    /// The tour is of another robot than the one beside it.
    #[error("the tour's joints are not those of the robot")]
    OtherRobot,
    /// A joint only drives links at another rate than its own.
    #[error("no link moves by the value of joint \"{joint}\" itself; models need one")]
    NoLeader {
        /// Name of the joint.
        joint: String,
    },
    /// The format keeps a name for itself.
    #[error("the format \"{format}\" cannot have the name \"{name}\": names must be {allowed}")]
    ReservedName {
        /// Name of the format.
        format: &'static str,
        /// The name.
        name: String,
        /// What names must be.
        allowed: &'static str,
    },
    /// The recording cannot be written.
    #[error("the recording cannot be written: {message}")]
    Recording {
        /// Why not.
        message: String,
    },
    /// The format cannot wait so long.
    #[error("the format \"{format}\" can wait {most} s at most, not the dwell of {dwell} s")]
    Dwell {
        /// Name of the format.
        format: &'static str,
        /// The tour's dwell, s.
        dwell: f64,
        /// The format's longest, s.
        most: f64,
    },
}
