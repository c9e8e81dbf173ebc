//! OpenCV's `FileStorage` in YAML, XML and JSON, with the keys of its calibration samples.

use super::format::{Export, Import, WriteError};
use super::intrinsics::{self, Matrix, camera_matrix};
use super::stated::StatedCamera;
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::image_size::side;
use crate::formats::number::list;
use crate::formats::tree::Node;

pub(super) const YAML: Export = Export { name: "opencv", file_name: "camera.opencv.yaml", write: write_yaml };

pub(super) const JSON: Export = Export { name: "opencv-json", file_name: "camera.opencv.json", write: write_json };

pub(super) const IMPORT: Import = Import {
    files: "OpenCV FileStorage (YAML, XML, JSON)",
    recognises: |root| CAMERAS.iter().any(|[matrix, _]| root.get(matrix).is_some()),
    read,
};

/// The lens models by their number of coefficients, which tells them to OpenCV's functions. Only the fisheye is not among them.
const LENSES: [(usize, Lens); 6] = [
    (0, Lens::Pinhole),
    (4, Lens::BrownConrady),
    (5, Lens::BrownConrady),
    (8, Lens::Rational),
    (12, Lens::Rational),
    (14, Lens::Rational),
];

const COEFFICIENTS: &str = "distortion_coefficients";
/// Only fisheyes have this key, 1: their four coefficients would pass for others.
const FISHEYE: &str = "fisheye_model";

fn write_yaml(camera: &Camera) -> Result<String, WriteError> {
    let matrix = |key: &str, [rows, columns]: [usize; 2], data: &[f64]| {
        let data = list(data);
        format!("{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: {data}\n")
    };
    let θ = camera.intrinsics();
    let fisheye = if is_fisheye(&YAML, camera)? { format!("{FISHEYE}: 1\n") } else { String::new() };
    Ok([
        format!("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n", camera.width(), camera.height()),
        fisheye,
        matrix("camera_matrix", [3, 3], &camera_matrix(θ)),
        matrix(COEFFICIENTS, shape(&θ[4..]), &θ[4..]),
    ]
    .concat())
}

fn write_json(camera: &Camera) -> Result<String, WriteError> {
    let matrix = |key: &str, [rows, columns]: [usize; 2], data: &[f64]| {
        let data = list(data);
        format!(
            "    \"{key}\": {{\n        \"type_id\": \"opencv-matrix\",\n        \"rows\": {rows},\n        \"cols\": {columns},\n        \
             \"dt\": \"d\",\n        \"data\": {data}\n    }}"
        )
    };
    let θ = camera.intrinsics();
    let fisheye = if is_fisheye(&JSON, camera)? { format!("    \"{FISHEYE}\": 1,\n") } else { String::new() };
    Ok(format!(
        "{{\n    \"image_width\": {},\n    \"image_height\": {},\n{fisheye}{},\n{}\n}}\n",
        camera.width(),
        camera.height(),
        matrix("camera_matrix", [3, 3], &camera_matrix(θ)),
        matrix(COEFFICIENTS, shape(&θ[4..]), &θ[4..]),
    ))
}

/// Whether `camera` is one of OpenCV's fisheyes, and not one of its other cameras.
fn is_fisheye(format: &Export, camera: &Camera) -> Result<bool, WriteError> {
    match camera.lens() {
        Lens::KannalaBrandt => Ok(true),
        lens if LENSES.iter().any(|(_, other)| *other == lens) => Ok(false),
        lens => Err(WriteError::Lens { format: format.name, lens: lens.name() }),
    }
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

/// Of a stereo file the camera is that whose matrix has the stated name, or the left one.
fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    let cameras = CAMERAS.into_iter().filter(|[matrix, _]| root.get(matrix).is_some()).collect::<Vec<_>>();
    let [matrix, listed] = match (&stated.name, &cameras[..]) {
        (None, [first, ..]) => *first,
        _ => stated.choose(&cameras.iter().map(|&keys| (keys[0].to_owned(), keys)).collect::<Vec<_>>(), root.line)?.1,
    };
    let size = stated.image_size(image_size(root)?, root.line)?;
    let matrix = Matrix::read(root, &[matrix])?;
    let listed = Matrix::read(root, &[listed])?;
    let fisheye = match root.get(FISHEYE) {
        Some(node) => node.number(&FISHEYE)?.value != 0.0,
        None => false,
    };
    let found = listed.entries.len();
    let lens = if fisheye {
        Lens::KannalaBrandt
    } else if let Some((_, lens)) = LENSES.iter().find(|(count, _)| *count == found) {
        *lens
    } else {
        let expected = "0, 4, 5, 8, 12 or 14".to_owned();
        return Err(ReadFault::Length { key: listed.key, found, expected }.at(listed.line));
    };
    let model = if fisheye { "OpenCV's fisheye" } else { "OpenCV's rational model" };
    let mut θ = matrix.pinhole()?.to_vec();
    θ.extend(intrinsics::coefficients_of(lens, model, &listed)?);
    intrinsics::camera(lens, size, &θ)
}

/// Width and height, where the file states them.
fn image_size(root: &Node) -> Result<Option<[u32; 2]>, ReadError> {
    let either = |keys: [&'static str; 2]| root.first_of(&keys).map(|(key, node)| side(node, key)).transpose();
    let [width, height] = [["image_width", "image_Width"], ["image_height", "image_Height"]].map(either);
    match (width?, height?) {
        (Some(width), Some(height)) => Ok(Some([width, height])),
        (None, None) => Ok(None),
        (Some(_), None) => Err(ReadFault::Missing { key: "image_height".to_owned() }.at(root.line)),
        (None, Some(_)) => Err(ReadFault::Missing { key: "image_width".to_owned() }.at(root.line)),
    }
}
