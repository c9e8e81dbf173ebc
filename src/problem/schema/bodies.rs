//! Bodies and masses, and what they are tested for.
#![expect(clippy::struct_field_names, reason = "the units are part of the keys")]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::{Numbers, Pose};

/// A solid attached to a link, for collision and occlusion. Exactly one of `box_mm`, `sphere_mm`, `cylinder_mm` and
/// `capsule_mm` gives its shape.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Body {
    /// Where the solid is attached: "base", or the name of a joint for the frame after the joint's row. Left out for the
    /// camera's housing, which is on the flange.
    pub(crate) link: Option<String>,
    /// Sides of a box along x, y and z, in mm.
    pub(crate) box_mm: Option<Numbers<3>>,
    /// Radius of a sphere, in mm.
    pub(crate) sphere_mm: Option<f64>,
    /// Radius and length of a cylinder along z, in mm.
    pub(crate) cylinder_mm: Option<Numbers<2>>,
    /// Radius and length of a capsule along z, in mm: a cylinder of that length with a hemisphere at each end.
    pub(crate) capsule_mm: Option<Numbers<2>>,
    /// Pose of the solid's centre in the link's frame, or of the housing's in the camera frame.
    #[serde(default)]
    pub(crate) pose: Pose,
}

/// The obstacles around the robot, which do not move with it.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scene {
    /// Solids that the robot must not touch and that may hide the board: table, walls, fixtures.
    #[serde(default)]
    pub(crate) bodies: Vec<Obstacle>,
}

/// A solid of an obstacle. Exactly one of `box_mm`, `sphere_mm`, `cylinder_mm` and `capsule_mm` gives its shape.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Obstacle {
    /// Name of the obstacle that the solid belongs to; solids with the same name form one obstacle. It must not be the name of
    /// a link, "camera" or "board".
    pub(crate) name: String,
    /// Sides of a box along x, y and z, in mm.
    pub(crate) box_mm: Option<Numbers<3>>,
    /// Radius of a sphere, in mm.
    pub(crate) sphere_mm: Option<f64>,
    /// Radius and length of a cylinder along z, in mm.
    pub(crate) cylinder_mm: Option<Numbers<2>>,
    /// Radius and length of a capsule along z, in mm: a cylinder of that length with a hemisphere at each end.
    pub(crate) capsule_mm: Option<Numbers<2>>,
    /// Pose of the solid's centre in the robot's base frame.
    #[serde(default)]
    pub(crate) pose: Pose,
}

impl Obstacle {
    /// The solid as a body of no link.
    pub(crate) fn body(&self) -> Body {
        let Self { name: _, box_mm, sphere_mm, cylinder_mm, capsule_mm, ref pose } = *self;
        Body { link: None, box_mm, sphere_mm, cylinder_mm, capsule_mm, pose: pose.clone() }
    }
}

/// A mass attached to a link. Several on one link add up.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mass {
    /// Where the mass is attached: "base", or the name of a joint for the frame after the joint's row.
    pub(crate) link: String,
    /// The mass, in kg.
    pub(crate) mass_kg: f64,
    /// Its centre in the link's frame, in mm.
    #[serde(default)]
    pub(crate) center_mm: Numbers<3>,
}

/// The test for collision of links with each other and with the scene, made where links have bodies.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Collision {
    /// Minimum distance between two links, or a link and an obstacle, in mm; at 0 they must not touch.
    #[serde(default)]
    pub(crate) clearance_mm: f64,
    /// Pairs of links that are not tested: names as in `robot.bodies` and `scene.bodies`, "camera" for the housing, "board" for the
    /// board.
    #[serde(default)]
    pub(crate) ignore: Vec<Vec<String>>,
}

/// The test for static stability: the robot's centre of mass, projected along gravity, must be over the support polygon.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stability {
    /// Points x, y in the base frame where the robot stands on the ground, in mm; their convex hull is the support polygon.
    pub(crate) support_mm: Vec<Numbers<2>>,
    /// Height of the ground in the base frame, in mm; it matters on slopes only.
    #[serde(default)]
    pub(crate) ground_mm: f64,
    /// Minimum distance of the projected centre of mass from the polygon's edges, in mm.
    #[serde(default)]
    pub(crate) margin_mm: f64,
    /// Slope of the ground about the base frame's x, in degrees; positive lowers -y.
    #[serde(default)]
    pub(crate) roll_deg: f64,
    /// Slope of the ground about the base frame's y, in degrees; positive lowers x.
    #[serde(default)]
    pub(crate) pitch_deg: f64,
}
