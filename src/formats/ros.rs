//! ROS `camera_info` in YAML, as `camera_calibration_parsers` reads and writes it.

use super::camera::{checked, image_size};
use super::error::{ReadError, ReadFault};
use super::matrix::{camera_matrix, entries, pinhole};
use super::number::list;
use super::tree::Node;
use crate::camera::{Camera, Lens};

const COEFFICIENTS: &str = "distortion_coefficients";

/// ROS has no model without distortion; a `plumb_bob` without coefficients means that to its tools.
pub(super) fn write(camera: &Camera) -> String {
    let (θ, width, height) = (camera.intrinsics(), camera.width(), camera.height());
    let model = match camera.lens() {
        Lens::Pinhole | Lens::BrownConrady => "plumb_bob",
        Lens::Rational => "rational_polynomial",
        Lens::KannalaBrandt => "equidistant",
    };
    let matrix = |key: &str, rows: usize, data: &[f64]| {
        format!("{key}:\n  rows: {rows}\n  cols: {}\n  data: {}\n", data.len() / rows, list(data))
    };
    [
        format!("image_width: {width}\nimage_height: {height}\ncamera_name: camera\n"),
        matrix("camera_matrix", 3, &camera_matrix(θ)),
        format!("distortion_model: {model}\n"),
        matrix(COEFFICIENTS, 1, &θ[4..]),
        matrix("rectification_matrix", 3, &camera_matrix(&[1.0, 1.0, 0.0, 0.0])),
        matrix("projection_matrix", 3, &[θ[0], 0.0, θ[2], 0.0, 0.0, θ[1], θ[3], 0.0, 0.0, 0.0, 1.0, 0.0]),
    ]
    .concat()
}

pub(super) fn read(root: &Node) -> Result<Camera, ReadError> {
    let size = image_size(root)?;
    let mut θ = pinhole(root)?.to_vec();
    let model = root.require("", "distortion_model")?;
    let coefficients = entries(root, COEFFICIENTS)?;
    let lens = match (model.text(&"distortion_model")?, coefficients.len()) {
        ("plumb_bob" | "none" | "", 0) => Lens::Pinhole,
        ("plumb_bob", _) => Lens::BrownConrady,
        ("rational_polynomial", _) => Lens::Rational,
        ("equidistant" | "fisheye", _) => Lens::KannalaBrandt,
        (other, _) => {
            let supported = "plumb_bob, rational_polynomial, equidistant, fisheye, none";
            let (key, found) = ("distortion_model".to_owned(), other.to_owned());
            return Err(ReadFault::Unsupported { key, found, supported }.at(model.line));
        }
    };
    let expected = lens.parameter_names().len() - 4;
    if coefficients.len() != expected {
        let line = root.require("", COEFFICIENTS)?.line;
        let (key, found) = (format!("{COEFFICIENTS}.data"), coefficients.len());
        return Err(ReadFault::Length { key, found, expected: expected.to_string() }.at(line));
    }
    θ.extend(coefficients);
    checked(lens, size, &θ)
}
