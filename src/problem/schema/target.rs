//! `[target]`: the board and its zone.
#![expect(clippy::struct_field_names, reason = "the units are part of the keys")]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::Pose;

/// A checkerboard. Its frame has the origin at the board's centre, x along the columns, y along the rows and z out of
/// the printed side.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    /// Inner corners along x.
    #[schemars(range(min = 2, max = 1000))]
    pub(crate) columns: u32,
    /// Inner corners along y.
    #[schemars(range(min = 2, max = 1000))]
    pub(crate) rows: u32,
    /// Side of a square in mm.
    pub(crate) square_mm: f64,
    /// Link of the robot's URDF that carries the board; the base when left out.
    pub(crate) link: Option<String>,
    /// Pose of the board in the frame of the link that carries it: the robot's base frame, unless `link` names another.
    pub(crate) pose: Pose,
    /// Thickness of the board, in mm: its body is a plate of the printed size under the printed side.
    #[serde(default = "thickness")]
    pub(crate) thickness_mm: f64,
    /// The zone, centred on the board, that the optical axis is tested against; the printed board when left out.
    #[serde(default)]
    pub(crate) zone: Zone,
}

/// A rectangle in the board's plane, centred on the board.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Zone {
    /// Extent along x in mm; the printed board's, (columns + 1) squares, when left out.
    pub(crate) width_mm: Option<f64>,
    /// Extent along y in mm; the printed board's, (rows + 1) squares, when left out.
    pub(crate) height_mm: Option<f64>,
    /// Width in mm of the band inside the border that counts as edge.
    #[serde(default)]
    pub(crate) edge_margin_mm: f64,
}

fn thickness() -> f64 {
    5.0
}

impl Default for Target {
    /// No board: what must be given is out of range.
    fn default() -> Self {
        let (pose, zone) = (Pose::default(), Zone::default());
        Self { columns: 0, rows: 0, square_mm: 0.0, link: None, pose, thickness_mm: thickness(), zone }
    }
}
