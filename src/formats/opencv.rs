//! OpenCV's `FileStorage` in YAML and JSON, with the keys of OpenCV's calibration sample.

use super::camera::{checked, image_size};
use super::error::{ReadError, ReadFault};
use super::matrix::{camera_matrix, entries, pinhole};
use super::number::list;
use super::tree::{Located, Node};
use crate::camera::{Camera, Lens};

const COEFFICIENTS: &str = "distortion_coefficients";
/// Only fisheyes have this key, 1: their four coefficients would pass for others.
const FISHEYE: &str = "fisheye_model";

pub(super) fn write_yaml(camera: &Camera) -> String {
    let matrix = |key: &str, [rows, columns]: [usize; 2], data: &[f64]| {
        let data = list(data);
        format!("{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: {data}\n")
    };
    let θ = camera.intrinsics();
    let fisheye = if is_fisheye(camera) { format!("{FISHEYE}: 1\n") } else { String::new() };
    [
        format!("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n", camera.width(), camera.height()),
        fisheye,
        matrix("camera_matrix", [3, 3], &camera_matrix(θ)),
        matrix(COEFFICIENTS, shape(&θ[4..]), &θ[4..]),
    ]
    .concat()
}

pub(super) fn write_json(camera: &Camera) -> String {
    let matrix = |key: &str, [rows, columns]: [usize; 2], data: &[f64]| {
        let data = list(data);
        format!(
            "    \"{key}\": {{\n        \"type_id\": \"opencv-matrix\",\n        \"rows\": {rows},\n        \"cols\": {columns},\n        \
             \"dt\": \"d\",\n        \"data\": {data}\n    }}"
        )
    };
    let θ = camera.intrinsics();
    let fisheye = if is_fisheye(camera) { format!("    \"{FISHEYE}\": 1,\n") } else { String::new() };
    format!(
        "{{\n    \"image_width\": {},\n    \"image_height\": {},\n{fisheye}{},\n{}\n}}\n",
        camera.width(),
        camera.height(),
        matrix("camera_matrix", [3, 3], &camera_matrix(θ)),
        matrix(COEFFICIENTS, shape(&θ[4..]), &θ[4..]),
    )
}

fn is_fisheye(camera: &Camera) -> bool {
    camera.lens() == Lens::KannalaBrandt
}

/// OpenCV's empty matrix has neither rows nor columns.
fn shape(row: &[f64]) -> [usize; 2] {
    [usize::from(!row.is_empty()), row.len()]
}

/// The number of coefficients tells the model, as it does to OpenCV's functions.
pub(super) fn read(root: &Node) -> Result<Camera, ReadError> {
    let size = image_size(root)?;
    let mut θ = pinhole(root)?.to_vec();
    let line = root.require("", COEFFICIENTS)?.line;
    let mut coefficients = entries(root, COEFFICIENTS)?;
    let found = coefficients.len();
    let fisheye = match root.get(FISHEYE) {
        Some(node) => node.number(&FISHEYE)?.value != 0.0,
        None => false,
    };
    // OpenCV fills up with zeros to the thin-prism and tilt models.
    if matches!(found, 12 | 14) && coefficients[8..].iter().all(|x| x.value == 0.0) {
        coefficients.truncate(8);
    }
    let lens = match (fisheye, coefficients.len()) {
        (true, 4) => Lens::KannalaBrandt,
        (false, 0) => Lens::Pinhole,
        (false, 4 | 5) => Lens::BrownConrady,
        (false, 8) => Lens::Rational,
        _ => {
            let expected = if fisheye {
                "4 for a fisheye".to_owned()
            } else {
                "0, 4, 5 or 8 (thin prism and tilt are not supported)".to_owned()
            };
            return Err(ReadFault::Length { key: format!("{COEFFICIENTS}.data"), found, expected }.at(line));
        }
    };
    θ.extend(coefficients);
    // Without k3.
    θ.resize(lens.parameter_names().len(), Located { line, value: 0.0 });
    checked(lens, size, &θ)
}
