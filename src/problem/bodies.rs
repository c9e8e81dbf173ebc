//! The problem file as written: bodies and masses, and what they are tested for.
//!
//! The doc comments are the descriptions of the JSON Schema and the hints of error messages.
#![expect(clippy::struct_field_names, reason = "the units are part of the keys")]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::schema::Pose;
use super::shape::Numbers;

/// A solid attached to a link, for self-collision and occlusion. Exactly one of `box_mm`, `sphere_mm`, `cylinder_mm` and
/// `capsule_mm` gives its shape.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Body {
    /// Where the solid is attached: "base", or the name of a joint for the frame after the joint's row. Left out for the
    /// camera's housing, which is on the flange.
    pub(super) link: Option<String>,
    /// Sides of a box along x, y and z, in mm.
    pub(super) box_mm: Option<Numbers<3>>,
    /// Radius of a sphere, in mm.
    pub(super) sphere_mm: Option<f64>,
    /// Radius and length of a cylinder along z, in mm.
    pub(super) cylinder_mm: Option<Numbers<2>>,
    /// Radius and length of a capsule along z, in mm: a cylinder of that length with a half sphere on either end.
    pub(super) capsule_mm: Option<Numbers<2>>,
    /// Pose of the solid's middle in the link's frame, or of the housing's in the camera frame.
    #[serde(default)]
    pub(super) pose: Pose,
}

/// A mass attached to a link. Several on one link add up.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Mass {
    /// Where the mass is attached: "base", or the name of a joint for the frame after the joint's row.
    pub(super) link: String,
    /// The mass, in kg.
    pub(super) mass_kg: f64,
    /// Its centre in the link's frame, in mm.
    #[serde(default)]
    pub(super) center_mm: Numbers<3>,
}

/// The test for self-collision, made where links have bodies.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Collision {
    /// Least distance between two links, in mm; at 0 they may come as close as they like but not touch.
    #[serde(default)]
    pub(super) clearance_mm: f64,
    /// Pairs of links that are not tested: names as in `robot.bodies`, "camera" for the housing, "board" for the board.
    #[serde(default)]
    pub(super) ignore: Vec<Vec<String>>,
}

/// The test for static stability: the robot's centre of mass, projected along gravity, must be over the support polygon.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Stability {
    /// Points x, y in the base frame where the robot stands on the ground, in mm; their convex hull is the support polygon.
    pub(super) support_mm: Vec<Numbers<2>>,
    /// Height of the ground in the base frame, in mm; it matters on slopes only.
    #[serde(default)]
    pub(super) ground_mm: f64,
    /// Least distance of the projected centre of mass from the polygon's edges, in mm.
    #[serde(default)]
    pub(super) margin_mm: f64,
    /// Slope of the ground about the base frame's x, in degrees; positive lowers -y.
    #[serde(default)]
    pub(super) roll_deg: f64,
    /// Slope of the ground about the base frame's y, in degrees; positive lowers x.
    #[serde(default)]
    pub(super) pitch_deg: f64,
}
