//! `[visibility]`, `[noise]` and `[estimate]`: what makes a view, and what it tells.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::Named;
use crate::information::NoiseName;

/// Conditions that a view must meet, besides showing the corners.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Visibility {
    /// Minimum distance of every corner from the centres of the outermost pixels, in px; 3 more than
    /// `noise.window_px` when left out, and 5 for constant noise.
    pub(crate) margin_px: Option<f64>,
    /// Maximum angle between the board's normal and the direction to the camera, in degrees.
    pub(crate) max_incidence_deg: f64,
    /// Maximum angle between the board's normal and the optical axis, in degrees.
    pub(crate) max_tilt_deg: f64,
    /// Minimum distance from the camera to the board's centre, in mm.
    pub(crate) min_distance_mm: f64,
    /// Maximum distance from the camera to the board's centre, in mm.
    pub(crate) max_distance_mm: f64,
    /// Minimum distance between neighbouring rows and columns of corners in the image, in px: the height of the squares,
    /// however slanted; 1.5 times `noise.window_px` and half a px when left out, of boards with markers as high that these are
    /// 2 px beyond the window, and 5 for constant noise.
    pub(crate) min_corner_spacing_px: Option<f64>,
    /// Minimum number of corners in a view, for boards that can be read in part. When left out: 4 of a `charuco` board, 16 of
    /// an `aprilgrid`, and every corner of other boards.
    #[schemars(range(min = 4))]
    pub(crate) min_corners: Option<u32>,
    /// Minimum length of a marker's or tag's sides in the image, in px, for it to be read; three px for each of its modules
    /// when left out.
    pub(crate) min_marker_px: Option<f64>,
}

/// The error of a detected corner.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Noise {
    /// Standard deviation of a detected corner in each direction, in px; under "edges" that of a corner of large squares seen
    /// square-on.
    pub(crate) sigma_px: f64,
    /// How it depends on the view: "constant" not at all, "edges" by the length of the edges that the detector sees and by the angle at
    /// which they meet.
    pub(crate) model: Named<NoiseName>,
    /// Half the side of the detector's window in px, as `winSize` of OpenCV's `cornerSubPix`, for "edges"; 5 when left out.
    pub(crate) window_px: Option<f64>,
    /// Distance in mm along the optical axis that the lens is focused on, for "edges", with `aperture_mm`; everything is in
    /// focus when left out.
    pub(crate) focus_mm: Option<f64>,
    /// Diameter of the lens's aperture in mm: its focal length over the f-number.
    pub(crate) aperture_mm: Option<f64>,
    /// Exposure of a picture in ms, for "edges", during which the camera turns by `turning_deg_s` and moves by `moving_mm_s`;
    /// it is at rest when left out.
    pub(crate) exposure_ms: Option<f64>,
    /// Angular speed of the camera during the exposure in °/s; 0 when left out.
    pub(crate) turning_deg_s: Option<f64>,
    /// Speed of the camera during the exposure in mm/s; 0 when left out.
    pub(crate) moving_mm_s: Option<f64>,
}

/// The parameters that the calibration estimates.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Estimate {
    /// Names of the intrinsics to estimate: fx, fy, cx, cy and the lens model's coefficients. All when left out.
    pub(crate) intrinsics: Option<Vec<String>>,
    /// What is known of intrinsics before calibration: their standard deviations by name, as in `{ cx = 20, cy = 20 }`. Nothing when
    /// left out.
    #[serde(default)]
    pub(crate) prior_sigma: BTreeMap<String, f64>,
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            margin_px: None,
            max_incidence_deg: 80.0,
            max_tilt_deg: 70.0,
            min_distance_mm: 0.0,
            max_distance_mm: 100_000.0,
            min_corner_spacing_px: None,
            min_corners: None,
            min_marker_px: None,
        }
    }
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            sigma_px: 0.3,
            model: Named(NoiseName::default()),
            window_px: None,
            focus_mm: None,
            aperture_mm: None,
            exposure_ms: None,
            turning_deg_s: None,
            moving_mm_s: None,
        }
    }
}
