//! OpenCV's `FileStorage` in YAML, XML and JSON, with the keys of its calibration samples.

use super::coefficients;
use super::matrix::{Matrix, camera_matrix};
use super::{StatedCamera, checked, chosen, image_side};
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::number::list;
use crate::formats::tree::Node;

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

/// The camera's matrix and coefficients by the keys that OpenCV's samples and their users give them; the pairs of a stereo file, left
/// first, are cameras of their own.
const CAMERAS: [[&str; 2]; 10] = [
    ["camera_matrix", COEFFICIENTS],
    ["Camera_Matrix", "Distortion_Coefficients"],
    ["cameraMatrix", "distCoeffs"],
    ["K", "D"],
    ["M1", "D1"],
    ["M2", "D2"],
    ["K1", "D1"],
    ["K2", "D2"],
    ["cameraMatrix1", "distCoeffs1"],
    ["cameraMatrix2", "distCoeffs2"],
];

/// The number of coefficients tells the model, as it does to OpenCV's functions.
///
/// Of a stereo file the camera is that whose matrix has the stated name, or the left one.
pub(super) fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    let cameras = CAMERAS.into_iter().filter(|[matrix, _]| root.get(matrix).is_some()).collect::<Vec<_>>();
    let Some(&first) = cameras.first() else { return Err(ReadFault::NoCamera.at(root.line)) };
    let [matrix, listed] = match &stated.name {
        None => first,
        Some(_) => {
            chosen(&cameras.iter().map(|&keys| (keys[0].to_owned(), keys)).collect::<Vec<_>>(), stated, root.line)?.1
        }
    };
    let size = stated.image_size(image_size(root)?, root.line)?;
    let matrix = Matrix::read(root, &[matrix])?;
    let listed = Matrix::read(root, &[listed])?;
    let fisheye = match root.get(FISHEYE) {
        Some(node) => node.number(&FISHEYE)?.value != 0.0,
        None => false,
    };
    let lens = match listed.entries.len() {
        _ if fisheye => Lens::KannalaBrandt,
        0 => Lens::Pinhole,
        4 | 5 => Lens::BrownConrady,
        8 | 12 | 14 => Lens::Rational,
        found => {
            let expected = "0, 4, 5, 8, 12 or 14".to_owned();
            return Err(ReadFault::Length { key: listed.key, found, expected }.at(listed.line));
        }
    };
    let model = if fisheye { "OpenCV's fisheye" } else { "OpenCV's rational model" };
    let mut θ = matrix.pinhole()?.to_vec();
    θ.extend(coefficients::of_lens(lens, model, &listed)?);
    checked(lens, size, &θ)
}

/// Width and height, where the file states them.
fn image_size(root: &Node) -> Result<Option<[u32; 2]>, ReadError> {
    let side = |keys: [&'static str; 2]| root.first_of(&keys).map(|(key, node)| image_side(node, key)).transpose();
    let [width, height] = [["image_width", "image_Width"], ["image_height", "image_Height"]].map(side);
    match (width?, height?) {
        (Some(width), Some(height)) => Ok(Some([width, height])),
        (None, None) => Ok(None),
        (Some(_), None) => Err(ReadFault::Missing { key: "image_height".to_owned() }.at(root.line)),
        (None, Some(_)) => Err(ReadFault::Missing { key: "image_width".to_owned() }.at(root.line)),
    }
}
