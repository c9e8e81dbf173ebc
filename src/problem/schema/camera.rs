//! `[camera]`: its mount and its nominal calibration.
#![expect(clippy::struct_field_names, reason = "`file_camera` names a camera of the file")]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::Body;
use super::value::{MountName, Named, Pose, TextOrTable};
use crate::camera::Lens;

/// The nominal camera. Pixel (0, 0) is the centre of the top-left pixel.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Camera {
    /// Pose of the camera (x right, y down, z forward) in the flange frame: "optical-axis-z" or "ros-optical" when they are the
    /// same frame; "ros-body" when the flange frame is like ROS's `camera_link` (x forward, y left, z up); "opengl" when it is
    /// like Blender's or USD's camera (y up, looking along -z); "optical-axis-x" when the camera looks along the flange's x with
    /// its right along z (`z_C` = `x_F`, `y_C` = -`y_F`, `x_C` = `z_F`); or a table with `position_mm` and `rpy_deg` or
    /// `quaternion_xyzw`. `calipose check` says which way is up in the picture.
    #[serde(default)]
    pub(crate) mount: TextOrTable<Named<MountName>, Pose>,
    /// Turn of the mounted camera about its optical axis, in degrees: positive turns its right towards its down.
    #[serde(default)]
    pub(crate) roll_deg: f64,
    /// Solid around the camera; its pose is in the camera frame.
    pub(crate) housing: Option<Body>,
    /// File with the nominal calibration, in place of the keys below: ROS `camera_info` YAML or the message as `topic echo` prints it,
    /// OpenCV `FileStorage` YAML, XML or JSON, a Kalibr camchain, or mrcal's cameramodel. Relative to the problem file's folder.
    pub(crate) file: Option<String>,
    /// Camera to use if `file` has several: "cam1" of a Kalibr camchain, "M2" of OpenCV's stereo files (by default the left
    /// camera).
    pub(crate) file_camera: Option<String>,
    /// Image width in px; required without a `file` that states it.
    #[schemars(range(min = 1, max = 100_000))]
    pub(crate) width_px: Option<u32>,
    /// Image height in px; required without a `file` that states it.
    #[schemars(range(min = 1, max = 100_000))]
    pub(crate) height_px: Option<u32>,
    /// Focal length along x, in px; required without `file`.
    pub(crate) fx_px: Option<f64>,
    /// Focal length along y, in px; `fx_px` when left out.
    pub(crate) fy_px: Option<f64>,
    /// Principal point x, in px; the image centre, (width - 1) / 2, when left out.
    pub(crate) cx_px: Option<f64>,
    /// Principal point y, in px; the image centre, (height - 1) / 2, when left out.
    pub(crate) cy_px: Option<f64>,
    /// Lens distortion; none when left out.
    pub(crate) distortion: Option<Distortion>,
}

/// The lens model and its coefficients, with OpenCV's names. A coefficient that is left out is 0.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Distortion {
    /// Lens model: "brown-conrady" has k1 k2 p1 p2 k3 (ROS `plumb_bob`), "rational" k1 k2 p1 p2 k3 k4 k5 k6,
    /// "kannala-brandt" k1 k2 k3 k4 (OpenCV fisheye).
    pub(crate) model: Named<Lens>,
    /// First radial coefficient.
    pub(crate) k1: Option<f64>,
    /// Second radial coefficient.
    pub(crate) k2: Option<f64>,
    /// First tangential coefficient.
    pub(crate) p1: Option<f64>,
    /// Second tangential coefficient.
    pub(crate) p2: Option<f64>,
    /// Third radial coefficient.
    pub(crate) k3: Option<f64>,
    /// First radial coefficient of the denominator; for "kannala-brandt" the fourth of the angle.
    pub(crate) k4: Option<f64>,
    /// Second radial coefficient of the denominator.
    pub(crate) k5: Option<f64>,
    /// Third radial coefficient of the denominator.
    pub(crate) k6: Option<f64>,
}

impl Default for TextOrTable<Named<MountName>, Pose> {
    fn default() -> Self {
        Self::Text(Named(MountName::OpticalAxisZ))
    }
}

impl Distortion {
    /// The coefficient of that name.
    pub(crate) fn coefficient(&mut self, name: &str) -> Option<&mut Option<f64>> {
        macro_rules! named {
            ($($key:ident)+) => { [$((stringify!($key), &mut self.$key)),+] };
        }
        named![k1 k2 p1 p2 k3 k4 k5 k6].into_iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }
}

impl Default for Distortion {
    fn default() -> Self {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = [None; 8];
        Self { model: Named(Lens::Pinhole), k1, k2, p1, p2, k3, k4, k5, k6 }
    }
}
