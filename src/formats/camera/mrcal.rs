//! mrcal's cameramodel: a Python dict.

use super::format::{Export, Import, WriteError};
use super::intrinsics::{self, LensNames};
use super::stated::StatedCamera;
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::image_size::side;
use crate::formats::number::list;
use crate::formats::tree::{Located, Node};

const NAME: &str = "mrcal";

pub(super) const EXPORT: Export = Export { name: NAME, file_name: "camera.cameramodel", write };

pub(super) const IMPORT: Import =
    Import { files: "mrcal cameramodels", recognises: |root| root.get("lensmodel").is_some(), read };

/// Brown–Conrady without k3.
const WITHOUT_K3: &str = "LENSMODEL_OPENCV4";

/// Of OpenCV's fisheye mrcal has no model.
const LENSES: LensNames<4> = LensNames {
    format: NAME,
    names: [
        ("LENSMODEL_PINHOLE", Lens::Pinhole),
        ("LENSMODEL_OPENCV5", Lens::BrownConrady),
        (WITHOUT_K3, Lens::BrownConrady),
        ("LENSMODEL_OPENCV8", Lens::Rational),
    ],
};

/// `camera` as the reference of its extrinsics.
fn write(camera: &Camera) -> Result<String, WriteError> {
    let model = LENSES.of(camera.lens())?;
    let (intrinsics, origin) = (list(camera.intrinsics()), list(&[0.0; 6]));
    // The extrinsics by mrcal's old name and by its new one; it takes both where they agree.
    Ok(format!(
        "{{\n    'lensmodel': '{model}',\n\n    # fx, fy, cx, cy, then the distortion\n    'intrinsics': {intrinsics},\n\n    \
         'extrinsics': {origin},\n    'rt_cam_ref': {origin},\n\n    'imagersize': [{}, {}]\n}}\n",
        camera.width(),
        camera.height(),
    ))
}

fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    stated.choose(&[(String::new(), root)], root.line)?;
    let model = root.require("", "lensmodel")?;
    let name = model.text(&"lensmodel")?;
    let lens = LENSES.lens("lensmodel", name, model.line)?;
    let count = lens.parameter_names().len();
    let given = count - usize::from(name == WITHOUT_K3);
    let size = root.require("", "imagersize")?;
    let sides = size.list(&"imagersize")?;
    let [width, height] = sides else {
        return Err(length("imagersize", sides.len(), 2, size.line));
    };
    let sides = [side(width, "imagersize[0]")?, side(height, "imagersize[1]")?];
    let size = stated.image_size(Some(sides), size.line)?;
    let listed = root.require("", "intrinsics")?;
    let mut θ = listed.numbers(&"intrinsics")?;
    if θ.len() != given {
        return Err(length("intrinsics", θ.len(), given, listed.line));
    }
    θ.resize(count, Located { line: listed.line, value: 0.0 });
    intrinsics::camera(lens, size, &θ)
}

fn length(key: &str, found: usize, expected: usize, line: usize) -> ReadError {
    ReadFault::Length { key: key.to_owned(), found, expected: expected.to_string() }.at(line)
}
