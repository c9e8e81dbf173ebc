//! A pose.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::flexible::Numbers;

/// A position and an orientation.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Pose {
    /// Position x, y, z in mm; zero when left out.
    #[serde(default)]
    pub(crate) position_mm: Numbers<3>,
    /// Roll, pitch and yaw in degrees, as in URDF: Rz(yaw) Ry(pitch) Rx(roll). No rotation when left out.
    pub(crate) rpy_deg: Option<Numbers<3>>,
    /// Orientation as a unit quaternion x, y, z, w, instead of `rpy_deg`.
    pub(crate) quaternion_xyzw: Option<Numbers<4>>,
}
