//! What a model is made of.

use crate::camera::Camera;
use crate::export::error::ExportError;
use crate::export::program::Program;
use crate::feasibility::LinkPair;
use crate::robot::Robot;
use crate::target::Target;

/// A tour with the robot that makes it, its camera and its board.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup<'a> {
    /// The tour; its joints are those of the robot's chain.
    pub program: &'a Program<'a>,
    /// The robot.
    pub robot: &'a Robot,
    /// Its camera.
    pub camera: &'a Camera,
    /// The board, where it lies on the robot.
    pub target: &'a Target,
    /// Pairs of the robot's links that may touch: they are not tested for collision.
    pub untested: &'a [LinkPair],
}

impl Setup<'_> {
    /// That the tour makes sense and is the robot's.
    pub(in crate::export) fn check(&self) -> Result<(), ExportError> {
        self.program.check()?;
        let names = self.program.joints.iter().map(|joint| &joint.name);
        let own = self.robot.chain.joints.iter().map(|joint| &joint.name);
        if names.eq(own) { Ok(()) } else { Err(ExportError::OtherRobot) }
    }
}
