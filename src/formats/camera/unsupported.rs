//! Lens models and camera files that other tools have and calipose has not: what they are, and what to do.

use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Node;

const UNIFIED: &str = "instead of the unified omnidirectional model (Mei), calibrate the camera as a fisheye, with \
                       `calipose calibrate --lens kannala-brandt`, Kalibr's pinhole-equi or cv2.fisheye";
const DOUBLE_SPHERE: &str = "instead of the double-sphere model, calibrate the camera as a fisheye, with `calipose calibrate \
                             --lens kannala-brandt`, Kalibr's pinhole-equi or cv2.fisheye";
const EXTENDED_UNIFIED: &str = "instead of the extended unified model, calibrate the camera as a fisheye, with `calipose \
                                calibrate --lens kannala-brandt`, Kalibr's pinhole-equi or cv2.fisheye";
const FIELD_OF_VIEW: &str = "instead of the field-of-view model (Devernay, Faugeras), calibrate the camera as a fisheye, with \
                             `calipose calibrate --lens kannala-brandt`, Kalibr's pinhole-equi or cv2.fisheye";
pub(super) const THIN_PRISM: &str = "thin prisms and tilted sensors are not supported: calibrate without CALIB_THIN_PRISM_MODEL \
                                     and CALIB_TILTED_MODEL";
const OF_MRCAL: &str = "`mrcal-convert-lensmodel LENSMODEL_OPENCV8 FILE` fits one of them to it";

/// The fault of a lens model that is none of those `supported`.
pub(super) fn model(key: &str, found: &str, supported: String, line: usize) -> ReadError {
    let instead = match found.to_lowercase().replace('-', "_").as_str() {
        "omni" | "mei" | "ucm" | "unified" | "omnidirectional" => UNIFIED,
        "ds" | "double_sphere" => DOUBLE_SPHERE,
        "eucm" | "extended_unified" => EXTENDED_UNIFIED,
        "fov" | "atan" => FIELD_OF_VIEW,
        "thin_prism" | "tilted" | "lensmodel_opencv12" | "lensmodel_opencv14" => THIN_PRISM,
        other if other.starts_with("lensmodel_") => OF_MRCAL,
        _ => "",
    };
    ReadFault::LensModel { key: key.to_owned(), found: found.to_owned(), supported, instead }.at(line)
}

/// The fault of `text` if it is the .ini file of ROS's first cameras.
pub(super) fn videre(text: &str) -> Option<ReadError> {
    let mut lines = text.lines().map(str::trim).enumerate();
    let (before, _) = lines.find(|(_, line)| *line == "[image]")?;
    lines.any(|(_, line)| line == "camera matrix").then(|| {
        ReadFault::OtherFormat {
            what: "a ROS camera file in .ini format (Videre)",
            instead: "convert it to YAML with `camera_calibration_parsers convert FILE.ini FILE.yaml`, or state the camera by \
                      width_px, height_px, fx_px, fy_px, cx_px and cy_px, and its distortion as k1 k2 p1 p2 k3 of \
                      \"brown-conrady\"",
        }
        .at(before + 1)
    })
}

/// The fault of a file that is known to be of another tool.
pub(super) fn file(root: &Node) -> Option<ReadError> {
    let (what, instead) = if let Some(model) = root.get("model_type") {
        camodocal(model.text(&"model_type").unwrap_or_default())
    } else if root.get("projection_parameters").is_some() {
        camodocal("")
    } else if root.first_of(&["Camera.fx", "Camera1.fx"]).is_some() {
        (
            "an ORB-SLAM settings file",
            "state the camera by width_px, height_px, fx_px, fy_px, cx_px and cy_px, and its distortion as k1 k2 p1 p2 k3 of \
             \"brown-conrady\" (PinHole) or k1 k2 k3 k4 of \"kannala-brandt\" (KannalaBrandt8)",
        )
    } else if root.get("value0").is_some_and(|value| value.get("intrinsics").is_some()) {
        (
            "a Basalt calibration",
            "calibrate the camera with the model kb4, and state its k1 k2 k3 k4 as \"kannala-brandt\"",
        )
    } else if root.get("xi").is_some() {
        (
            "a camera of OpenCV's omnidir (the unified model of Mei)",
            "calibrate the camera as a fisheye, with `calipose calibrate --lens kannala-brandt` or cv2.fisheye",
        )
    } else {
        return None;
    };
    Some(ReadFault::OtherFormat { what, instead }.at(root.line))
}

/// What a camera file of camodocal, with which VINS comes, is, and what to do.
fn camodocal(model: &str) -> (&'static str, &'static str) {
    match model.to_lowercase().as_str() {
        "mei" => (
            "a camodocal camera file (VINS) with the unified model of Mei",
            "calibrate the camera with the model KANNALA_BRANDT, or with `calipose calibrate --lens kannala-brandt`",
        ),
        "scaramuzza" => (
            "a camodocal camera file (VINS) with Scaramuzza's model",
            "calibrate the camera with the model KANNALA_BRANDT, or with `calipose calibrate --lens kannala-brandt`",
        ),
        "kannala_brandt" => (
            "a camodocal camera file (VINS)",
            "state the camera by width_px, height_px, fx_px, fy_px, cx_px and cy_px (its mu mv u0 v0), and its k2 k3 k4 k5 as \
             k1 k2 k3 k4 of the distortion \"kannala-brandt\"",
        ),
        _ => (
            "a camodocal camera file (VINS)",
            "state the camera by width_px, height_px, fx_px, fy_px, cx_px and cy_px, and its k1 k2 p1 p2 as distortion of the \
             model \"brown-conrady\"",
        ),
    }
}
