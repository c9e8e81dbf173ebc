//! mrcal's cameramodel: a Python dict.

use super::unsupported;
use super::{StatedCamera, checked, chosen, image_side};
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::number::list;
use crate::formats::tree::{Located, Node};

const SUPPORTED: &str = "LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, LENSMODEL_OPENCV5, LENSMODEL_OPENCV8";

/// `camera` as the reference of its extrinsics; none for a fisheye, of which mrcal has no model of OpenCV's.
pub(super) fn write(camera: &Camera) -> Option<String> {
    let model = match camera.lens() {
        Lens::Pinhole => "LENSMODEL_PINHOLE",
        Lens::BrownConrady => "LENSMODEL_OPENCV5",
        Lens::Rational => "LENSMODEL_OPENCV8",
        Lens::KannalaBrandt => return None,
    };
    let (intrinsics, origin) = (list(camera.intrinsics()), list(&[0.0; 6]));
    // The extrinsics by mrcal's old name and by its new one; it takes both where they agree.
    Some(format!(
        "{{\n    'lensmodel': '{model}',\n\n    # fx, fy, cx, cy, then the distortion\n    'intrinsics': {intrinsics},\n\n    \
         'extrinsics': {origin},\n    'rt_cam_ref': {origin},\n\n    'imagersize': [{}, {}]\n}}\n",
        camera.width(),
        camera.height(),
    ))
}

pub(super) fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    chosen(&[(String::new(), root)], stated, root.line)?;
    let model = root.require("", "lensmodel")?;
    let name = model.text(&"lensmodel")?;
    let (lens, given) = match name {
        "LENSMODEL_PINHOLE" => (Lens::Pinhole, 4),
        "LENSMODEL_OPENCV4" => (Lens::BrownConrady, 8),
        "LENSMODEL_OPENCV5" => (Lens::BrownConrady, 9),
        "LENSMODEL_OPENCV8" => (Lens::Rational, 12),
        _ => return Err(unsupported::model("lensmodel", name, SUPPORTED, model.line)),
    };
    let size = root.require("", "imagersize")?;
    let sides = size.list(&"imagersize")?;
    let [width, height] = sides else {
        return Err(length("imagersize", sides.len(), 2, size.line));
    };
    let sides = [image_side(width, "imagersize[0]")?, image_side(height, "imagersize[1]")?];
    let size = stated.image_size(Some(sides), size.line)?;
    let intrinsics = root.require("", "intrinsics")?;
    let mut θ = intrinsics.numbers(&"intrinsics")?;
    if θ.len() != given {
        return Err(length("intrinsics", θ.len(), given, intrinsics.line));
    }
    // OPENCV4 is without k3.
    θ.resize(lens.parameter_names().len(), Located { line: intrinsics.line, value: 0.0 });
    checked(lens, size, &θ)
}

fn length(key: &str, found: usize, expected: usize, line: usize) -> ReadError {
    ReadFault::Length { key: key.to_owned(), found, expected: expected.to_string() }.at(line)
}
