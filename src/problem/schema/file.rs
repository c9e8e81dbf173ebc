//! The problem file: its sections.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::{Collision, Scene, Stability};
use super::camera::Camera;
use super::motion::Motion;
use super::robot::Robot;
use super::robust::Robust;
use super::selection::{Constraints, Selection};
use super::sweep::Sweep;
use super::target::Target;
use super::view::{Estimate, Noise, Visibility};

/// A calibration planning problem.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "calipose problem")]
pub(crate) struct File {
    /// Name of the problem; the file's name without its extension when left out.
    pub(crate) name: Option<String>,
    /// The arm.
    pub(crate) robot: Robot,
    /// The camera: its mount on the flange and its nominal calibration.
    pub(crate) camera: Camera,
    /// The checkerboard and its place on the robot.
    pub(crate) target: Target,
    /// The joint configurations to try.
    #[serde(default)]
    pub(crate) sweep: Sweep,
    /// Conditions that a view must meet.
    #[serde(default)]
    pub(crate) visibility: Visibility,
    /// The obstacles around the robot.
    #[serde(default)]
    pub(crate) scene: Scene,
    /// The test for collision.
    #[serde(default)]
    pub(crate) collision: Collision,
    /// The test for static stability; none when left out.
    pub(crate) stability: Option<Stability>,
    /// How well corners are detected.
    #[serde(default)]
    pub(crate) noise: Noise,
    /// What the calibration estimates.
    #[serde(default)]
    pub(crate) estimate: Estimate,
    /// What the plan must withstand; nothing when left out.
    pub(crate) robust: Option<Robust>,
    /// Which poses to choose, and how.
    #[serde(default)]
    pub(crate) selection: Selection,
    /// Which sets of poses are allowed.
    #[serde(default)]
    pub(crate) constraints: Constraints,
    /// How the robot goes from pose to pose.
    #[serde(default)]
    pub(crate) motion: Motion,
    /// Where the plan goes.
    #[serde(default)]
    pub(crate) output: Output,
}

/// Where the plan goes.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Output {
    /// Folder for the plan, relative to the working directory; "plans/" and the name in lower case when left out.
    pub(crate) folder: Option<String>,
}
