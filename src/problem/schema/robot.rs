//! `[robot]`: the arm as a table or a file, and what is attached to it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::{Body, Mass};
use super::value::{Named, Pose, Range, RangeOrSets};
use crate::robot::JointKind;
use crate::robot::dh::Convention;

/// The arm: a Denavit–Hartenberg table, base first, or a URDF file.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Robot {
    /// Order of a row's factors: "standard" (the default) is Rz(theta) Tz(d) Tx(a) Rx(alpha), "modified" (Craig) is Rx(alpha)
    /// Tx(a) Rz(theta) Tz(d).
    pub(crate) convention: Option<Named<Convention>>,
    /// Set of joint limits to use, for joints that have several.
    pub(crate) limits: Option<String>,
    /// Pose of the flange in the frame of the last row; the same frame when left out.
    pub(crate) flange: Option<Pose>,
    /// The rows of the table, one per joint.
    #[serde(default)]
    pub(crate) joints: Vec<Joint>,
    /// Solids attached to the links, for collision and occlusion.
    #[serde(default)]
    pub(crate) bodies: Vec<Body>,
    /// Masses attached to the links, for static stability.
    #[serde(default)]
    pub(crate) masses: Vec<Mass>,
    /// URDF file of the robot, in place of a table; expand a xacro file first. Relative to the problem file's folder.
    pub(crate) urdf: Option<String>,
    /// SRDF file whose `disable_collisions` name the pairs of links that are never tested for collision. Relative to the problem
    /// file's folder.
    pub(crate) srdf: Option<String>,
    /// Folders of the URDF's meshes beside its own: packages (`package://`), or folders of them. Relative to the problem file's
    /// folder.
    #[serde(default)]
    pub(crate) package_folders: Vec<String>,
    /// Link of the URDF that stands on the ground and whose frame is the robot's base frame; its root when left out.
    pub(crate) base_link: Option<String>,
    /// Link of the URDF that carries the camera; its frame is the flange frame. With a link such as ROS's
    /// `camera_optical_frame` the camera needs no mount.
    pub(crate) camera_link: Option<String>,
    /// Values in degrees at which revolute joints of the URDF are held, by the joints' names. A joint that moves the camera
    /// against the board is free when left out, any other is held at 0 or the limit next to it.
    #[serde(default)]
    pub(crate) joint_values_deg: BTreeMap<String, f64>,
    /// Values in mm at which prismatic joints of the URDF are held, by the joints' names.
    #[serde(default)]
    pub(crate) joint_values_mm: BTreeMap<String, f64>,
    /// Ranges [min, max] in degrees of revolute joints, by the joints' names, within those of the URDF or in place of limits that
    /// it does not state. A continuous joint has [-180, 180] when left out.
    #[serde(default)]
    pub(crate) limits_deg: BTreeMap<String, Range>,
    /// Ranges [min, max] in mm of prismatic joints, by the joints' names, likewise.
    #[serde(default)]
    pub(crate) limits_mm: BTreeMap<String, Range>,
    /// Joints whose ranges in `limits_deg` and `limits_mm` may go beyond those of the URDF.
    #[serde(default)]
    pub(crate) exceed_urdf_limits: Vec<String>,
    /// What the controller's revolute joint values are multiples of, in degrees; 0 for any values. Poses are rounded to it before
    /// anything is computed of them. When left out, 0.01 where poses may leave the grid, and 0 where they may not.
    pub(crate) joint_resolution_deg: Option<f64>,
    /// The same of prismatic joints, in mm.
    pub(crate) joint_resolution_mm: Option<f64>,
    /// Least distance of poses from the limits of revolute joints, in degrees; joints that go round have none. When left out, 0.5
    /// where poses may leave the grid, and 0 where they may not and for joints that are swept at their limits alone.
    pub(crate) limit_margin_deg: Option<f64>,
    /// The same of prismatic joints, in mm.
    pub(crate) limit_margin_mm: Option<f64>,
}

/// One row of the table.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Joint {
    /// Name of the joint, as in the robot's driver.
    pub(crate) name: String,
    /// How the joint moves: its value is added to theta (revolute) or d (prismatic).
    #[serde(default = "revolute")]
    pub(crate) kind: Named<JointKind>,
    /// Link length along x, in mm.
    #[serde(default)]
    pub(crate) a_mm: f64,
    /// Link twist about x, in degrees.
    #[serde(default)]
    pub(crate) alpha_deg: f64,
    /// Link offset along z, in mm; a prismatic joint's value is added to it.
    #[serde(default)]
    pub(crate) d_mm: f64,
    /// Joint angle about z, in degrees; a revolute joint's value is added to it.
    #[serde(default)]
    pub(crate) theta_deg: f64,
    /// Range of a revolute joint: [min, max] in degrees, or a table of such ranges by name, of which `robot.limits`
    /// selects one.
    pub(crate) limits_deg: Option<RangeOrSets>,
    /// Range of a prismatic joint: [min, max] in mm, or a table of such ranges by name.
    pub(crate) limits_mm: Option<RangeOrSets>,
    /// Maximum speed of a revolute joint, in degrees per second.
    pub(crate) max_speed_deg_s: Option<f64>,
    /// Maximum speed of a prismatic joint, in mm per second.
    pub(crate) max_speed_mm_s: Option<f64>,
}

fn revolute() -> Named<JointKind> {
    Named(JointKind::Revolute)
}
