//! The problem: models and settings, as a problem file states them.

use std::path::PathBuf;

use crate::camera::Camera;
use crate::feasibility::VisibilityLimits;
use crate::information::Criterion;
use crate::robot::Robot;
use crate::selection::Method;
use crate::sweep::{AxisRule, JointSpace};
use crate::target::Target;

/// A checked problem, in metres, radians and pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Name of the problem.
    pub name: String,
    /// SHA-256 of the problem file's bytes, in lower-case hexadecimal.
    pub sha256: String,
    /// The arm and the camera's mount.
    pub robot: Robot,
    /// The nominal camera.
    pub camera: Camera,
    /// The board and its zone.
    pub target: Target,
    /// The joint configurations to sweep.
    pub space: JointSpace,
    /// The axis test.
    pub axis: AxisRule,
    /// What a view must satisfy.
    pub visibility: VisibilityLimits,
    /// Standard deviation of a detected corner in px, in each direction.
    pub noise: f64,
    /// The intrinsics to estimate: indices into the camera's, ascending.
    pub estimated: Vec<usize>,
    /// What to select.
    pub selection: SelectionSettings,
    /// Folder for the plan, relative to the working directory.
    pub output: PathBuf,
}

/// What to select, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct SelectionSettings {
    /// What to optimise.
    pub criterion: Criterion,
    /// How.
    pub method: Method,
    /// Number of poses.
    pub count: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// Relative gap at which the relaxation stops.
    pub tolerance: f64,
}
