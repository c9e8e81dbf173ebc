//! How the robot goes from pose to pose.

use crate::motion::JointLimits;

/// How the robot goes from pose to pose.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionSettings {
    /// The greatest speeds, accelerations and jerks of the joints.
    pub greatest: Vec<JointLimits>,
    /// The share of them at which the robot moves, above 0 and up to 1.
    pub share: f64,
    /// Joints of which no greatest speed is stated, by index: a slow one is assumed.
    pub assumed: Vec<usize>,
    /// Where the tour begins; none for any pose.
    pub home: Option<Home>,
    /// Time for the pictures at each pose, s.
    pub dwell: f64,
}

impl MotionSettings {
    /// What the joints do at most.
    pub fn limits(&self) -> Vec<JointLimits> {
        self.greatest.iter().map(|greatest| greatest.at_share(self.share)).collect()
    }
}

/// Where a tour begins, and may end.
#[derive(Debug, Clone, PartialEq)]
pub struct Home {
    /// Its joint values, rad or m.
    pub q: Vec<f64>,
    /// Whether the tour ends there too.
    pub returns: bool,
}
