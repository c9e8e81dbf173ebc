//! `[target]`: the board and its zone.
#![expect(clippy::struct_field_names, reason = "the units are part of the keys")]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::{Choice, Named, Pose};

/// A board. Its frame has the origin in the middle of what is printed, x to the right, y up and z out of the printed side.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    /// What is printed: a checkerboard when left out, or what `file` says.
    pub(crate) kind: Option<Named<TargetKind>>,
    /// A file that describes the board, relative to the problem file: Kalibr's target in YAML, `OpenCV`'s `ChArUco` board in
    /// JSON, or for `points` a CSV table with the header `x_mm,y_mm` or `x_mm,y_mm,group`.
    pub(crate) file: Option<String>,
    /// Inner corners along x; of a `charuco` board squares, of an `aprilgrid` tags, of grids of circles the circles in a row.
    #[schemars(range(min = 1, max = 1000))]
    pub(crate) columns: Option<u32>,
    /// Inner corners along y; of a `charuco` board squares, of an `aprilgrid` tags, of grids of circles the rows.
    #[schemars(range(min = 1, max = 1000))]
    pub(crate) rows: Option<u32>,
    /// Side of a square in mm; for `checkerboard` and `charuco`.
    pub(crate) square_mm: Option<f64>,
    /// Side of a marker in mm, with its black border; for `charuco`.
    pub(crate) marker_mm: Option<f64>,
    /// Name that `OpenCV` has for the markers' dictionary, as `DICT_5X5_100`; for `charuco`.
    pub(crate) dictionary: Option<String>,
    /// Whether the board is that of `OpenCV` before 4.6, as calib.io's are: with an even number of rows its upper left square
    /// is light; for `charuco`.
    pub(crate) legacy_pattern: Option<bool>,
    /// Side of a tag in mm, with its black border; for `aprilgrid`.
    pub(crate) tag_mm: Option<f64>,
    /// Space between tags as a share of their side, Kalibr's `tagSpacing`; for `aprilgrid`.
    pub(crate) tag_spacing: Option<f64>,
    /// Distance in mm between the centres of neighbours in a row; for `circles` and `asymmetric-circles`, whose rows are half
    /// of that apart.
    pub(crate) spacing_mm: Option<f64>,
    /// Diameter of a circle in mm; for `circles` and `asymmetric-circles`.
    pub(crate) diameter_mm: Option<f64>,
    /// Points `[x, y]` or `[x, y, group]` in mm; for `points`, in the place of `file`.
    #[serde(default)]
    pub(crate) points_mm: Vec<Vec<f64>>,
    /// Link of the robot's URDF that carries the board; the base when left out.
    pub(crate) link: Option<String>,
    /// Pose of the board in the frame of the link that carries it: the robot's base frame, unless `link` names another.
    pub(crate) pose: Pose,
    /// Thickness of the board, in mm: its body is a plate of the printed size under the printed side.
    #[serde(default = "thickness")]
    pub(crate) thickness_mm: f64,
    /// How far the board may bulge: standard deviation in mm of the two heights, along x and along y, by which its middle may
    /// lie above or below its rim. They are estimated with the camera, of all views together. Flat when left out.
    pub(crate) warp_mm: Option<f64>,
    /// The zone, centred on the board, that the optical axis is tested against; the printed board when left out.
    #[serde(default)]
    pub(crate) zone: Zone,
}

/// A rectangle in the board's plane, centred on the board.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Zone {
    /// Extent along x in mm; the printed board's when left out.
    pub(crate) width_mm: Option<f64>,
    /// Extent along y in mm; the printed board's when left out.
    pub(crate) height_mm: Option<f64>,
    /// Width in mm of the band inside the border that counts as edge.
    #[serde(default)]
    pub(crate) edge_margin_mm: f64,
}

fn thickness() -> f64 {
    5.0
}

impl Default for Target {
    /// No board: nothing that must be given is.
    fn default() -> Self {
        Self {
            kind: None,
            file: None,
            columns: None,
            rows: None,
            square_mm: None,
            marker_mm: None,
            dictionary: None,
            legacy_pattern: None,
            tag_mm: None,
            tag_spacing: None,
            spacing_mm: None,
            diameter_mm: None,
            points_mm: Vec::new(),
            link: None,
            pose: Pose::default(),
            thickness_mm: thickness(),
            warp_mm: None,
            zone: Zone::default(),
        }
    }
}

/// What is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TargetKind {
    Checkerboard,
    Charuco,
    AprilGrid,
    Circles,
    AsymmetricCircles,
    Points,
}

impl Choice for TargetKind {
    fn all() -> &'static [Self] {
        &[Self::Checkerboard, Self::Charuco, Self::AprilGrid, Self::Circles, Self::AsymmetricCircles, Self::Points]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Checkerboard => "checkerboard",
            Self::Charuco => "charuco",
            Self::AprilGrid => "aprilgrid",
            Self::Circles => "circles",
            Self::AsymmetricCircles => "asymmetric-circles",
            Self::Points => "points",
        }
    }
}
