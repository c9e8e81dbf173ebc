//! ROS `CameraInfo` in YAML: the file that `camera_calibration_parsers` reads and writes, and the message as `topic echo` prints it.

use super::format::{Export, Import, WriteError};
use super::intrinsics::{self, LensNames, Matrix, camera_matrix};
use super::stated::StatedCamera;
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::image_size;
use crate::formats::number::list;
use crate::formats::tree::Node;

const NAME: &str = "ros";

pub(super) const EXPORT: Export = Export { name: NAME, file_name: "camera_info.yaml", write };

pub(super) const IMPORT: Import =
    Import { files: "ROS camera_info", recognises: |root| root.get(MODEL).is_some(), read };

const LENSES: LensNames<5> = LensNames {
    format: NAME,
    names: [
        (PLUMB_BOB, Lens::BrownConrady),
        ("rational_polynomial", Lens::Rational),
        ("equidistant", Lens::KannalaBrandt),
        ("fisheye", Lens::KannalaBrandt),
        ("none", Lens::Pinhole),
    ],
};

/// ROS has no model without distortion; this one without coefficients means that to its tools.
const PLUMB_BOB: &str = "plumb_bob";

// Each key of the file, then those of the message in ROS 2 and ROS 1.
const WIDTH: [&str; 2] = ["image_width", "width"];
const HEIGHT: [&str; 2] = ["image_height", "height"];
const CAMERA_MATRIX: [&str; 3] = ["camera_matrix", "k", "K"];
const COEFFICIENTS: [&str; 3] = ["distortion_coefficients", "d", "D"];
const MODEL: &str = "distortion_model";

fn write(camera: &Camera) -> Result<String, WriteError> {
    let (θ, width, height) = (camera.intrinsics(), camera.width(), camera.height());
    let model = if camera.lens() == Lens::Pinhole { PLUMB_BOB } else { LENSES.of(camera.lens())? };
    let matrix = |key: &str, rows: usize, data: &[f64]| {
        format!("{key}:\n  rows: {rows}\n  cols: {}\n  data: {}\n", data.len() / rows, list(data))
    };
    Ok([
        format!("image_width: {width}\nimage_height: {height}\ncamera_name: camera\n"),
        matrix("camera_matrix", 3, &camera_matrix(θ)),
        format!("{MODEL}: {model}\n"),
        matrix("distortion_coefficients", 1, &θ[4..]),
        matrix("rectification_matrix", 3, &camera_matrix(&[1.0, 1.0, 0.0, 0.0])),
        matrix("projection_matrix", 3, &[θ[0], 0.0, θ[2], 0.0, 0.0, θ[1], θ[3], 0.0, 0.0, 0.0, 1.0, 0.0]),
    ]
    .concat())
}

fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    stated.choose(&[(String::new(), root)], root.line)?;
    let side = |keys: &[&'static str; 2]| match root.first_of(keys) {
        Some((key, node)) => Ok((image_size::side(node, key)?, node.line)),
        None => Err(ReadFault::Missing { key: keys[0].to_owned() }.at(root.line)),
    };
    let ((width, line), (height, _)) = (side(&WIDTH)?, side(&HEIGHT)?);
    let size = stated.image_size(Some([width, height]), line)?;
    whole_image(root, [width, height])?;
    let mut θ = Matrix::read(root, &CAMERA_MATRIX)?.pinhole()?.to_vec();
    let node = root.require("", MODEL)?;
    let model = node.text(&MODEL)?;
    let listed = Matrix::read(root, &COEFFICIENTS)?;
    let lens = match (model, listed.entries.len()) {
        (PLUMB_BOB, 0) | ("", _) => Lens::Pinhole,
        _ => LENSES.lens(MODEL, model, node.line)?,
    };
    let model = if model.is_empty() { "an empty model" } else { model };
    θ.extend(intrinsics::coefficients_of(lens, model, &listed)?);
    intrinsics::camera(lens, size, &θ)
}

/// That the message's images are those that its calibration is of: neither binned nor cut.
fn whole_image(root: &Node, [width, height]: [u32; 2]) -> Result<(), ReadError> {
    for key in ["binning_x", "binning_y"] {
        if let Some(node) = root.get(key) {
            let binning = node.number(&key)?;
            if binning.value > 1.0 {
                return Err(ReadFault::PartOfImage { key: key.into(), value: binning.value, what: "reductions" }
                    .at(binning.line));
            }
        }
    }
    let Some(region) = root.get("roi") else { return Ok(()) };
    // Offsets and sides of 0 stand for the whole image.
    for (key, whole) in [("x_offset", 0), ("y_offset", 0), ("width", width), ("height", height)] {
        if let Some(node) = region.get(key) {
            let key = format!("roi.{key}");
            let side = node.number(&key)?;
            if side.value != 0.0 && side.value != f64::from(whole) {
                return Err(ReadFault::PartOfImage { key, value: side.value, what: "parts" }.at(side.line));
            }
        }
    }
    Ok(())
}
