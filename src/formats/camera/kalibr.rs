//! Kalibr's camchain in YAML, and the `sensor.yaml` of `EuRoC`, which has the same keys.

use super::format::{Export, Import, WriteError};
use super::intrinsics::{self, LensNames, Matrix};
use super::stated::StatedCamera;
use super::unsupported;
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::image_size::side;
use crate::formats::number::list;
use crate::formats::tree::{Located, Node};

const NAME: &str = "kalibr";

pub(super) const EXPORT: Export = Export { name: NAME, file_name: "camchain.yaml", write };

pub(super) const IMPORT: Import = Import { files: "Kalibr camchains", recognises: is_camchain, read };

const LENSES: LensNames<5> = LensNames {
    format: NAME,
    names: [
        ("radtan", Lens::BrownConrady),
        ("radial-tangential", Lens::BrownConrady),
        ("equidistant", Lens::KannalaBrandt),
        ("equi", Lens::KannalaBrandt),
        ("none", Lens::Pinhole),
    ],
};

/// `camera` as the only one of a chain. Kalibr's radtan has no k3, and its principal points are not negative.
fn write(camera: &Camera) -> Result<String, WriteError> {
    let θ = camera.intrinsics();
    let model = LENSES.of(camera.lens())?;
    let coefficients = match camera.lens() {
        Lens::BrownConrady if θ[8] == 0.0 => &θ[4..8],
        Lens::BrownConrady => return Err(WriteError::Intrinsic { format: NAME, name: "k3", value: θ[8] }),
        _ => &θ[4..],
    };
    if let Some(i) = (2..4).find(|&i| θ[i] < 0.0) {
        let name = camera.lens().parameter_names()[i];
        return Err(WriteError::Intrinsic { format: NAME, name, value: θ[i] });
    }
    Ok(format!(
        "cam0:\n  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: {model}\n  distortion_coeffs: {}\n  \
         resolution: [{}, {}]\n  rostopic: /camera/image_raw\n",
        list(&θ[..4]),
        list(coefficients),
        camera.width(),
        camera.height(),
    ))
}

/// Whether `root` is a chain of cameras, or one camera.
fn is_camchain(root: &Node) -> bool {
    let is_camera = |node: &Node| node.get("camera_model").is_some();
    is_camera(root) || root.entries().iter().any(|(_, node)| is_camera(node))
}

fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    let cameras = root.entries().iter().filter(|(_, node)| node.get("camera_model").is_some());
    let (name, node) = if root.get("camera_model").is_some() {
        stated.choose(&[(String::new(), root)], root.line)?
    } else {
        stated.choose(&cameras.map(|(name, node)| (name.clone(), node)).collect::<Vec<_>>(), root.line)?
    };
    let within = if name.is_empty() { name } else { format!("{name}.") };
    let key = |name: &str| format!("{within}{name}");
    let model = node.require(&within, "camera_model")?;
    match model.text(&key("camera_model"))? {
        "pinhole" => {}
        other => return Err(unsupported::model(&key("camera_model"), other, "pinhole".to_owned(), model.line)),
    }
    let distortion = node.require(&within, "distortion_model")?;
    let model = distortion.text(&key("distortion_model"))?;
    let lens = LENSES.lens(&key("distortion_model"), model, distortion.line)?;
    let numbers = |name: &str| -> Result<Matrix, ReadError> {
        let node = node.require(&within, name)?;
        Ok(Matrix { key: key(name), line: node.line, entries: node.numbers(&key(name))? })
    };
    let length = |matrix: &Matrix, expected: &str| {
        let (key, found) = (matrix.key.clone(), matrix.entries.len());
        ReadFault::Length { key, found, expected: expected.to_owned() }.at(matrix.line)
    };
    let resolution = node.require(&within, "resolution")?;
    let sides = resolution.list(&key("resolution"))?;
    let [width, height] = sides else {
        let (key, found) = (key("resolution"), sides.len());
        return Err(ReadFault::Length { key, found, expected: "2".to_owned() }.at(resolution.line));
    };
    let size = stated.image_size(
        Some([side(width, &key("resolution[0]"))?, side(height, &key("resolution[1]"))?]),
        resolution.line,
    )?;
    let pinhole = numbers("intrinsics")?;
    if pinhole.entries.len() != 4 {
        return Err(length(&pinhole, "4: fx, fy, cx, cy"));
    }
    let mut θ: Vec<Located> = pinhole.entries;
    let listed = ["distortion_coeffs", "distortion_coefficients"].into_iter().find(|key| node.get(key).is_some());
    let listed = numbers(listed.unwrap_or("distortion_coeffs"))?;
    θ.extend(intrinsics::coefficients_of(lens, model, &listed)?);
    intrinsics::camera(lens, size, &θ)
}
