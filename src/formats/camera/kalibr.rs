//! Kalibr's camchain in YAML, and the `sensor.yaml` of `EuRoC`, which has the same keys.

use super::coefficients;
use super::matrix::Matrix;
use super::unsupported;
use super::{StatedCamera, WriteError, checked, chosen, image_side};
use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::number::list;
use crate::formats::tree::{Located, Node};

/// `camera` as the only one of a chain. Kalibr's radtan has no k3, and its principal points are not negative.
pub(super) fn write(camera: &Camera) -> Result<String, WriteError> {
    let θ = camera.intrinsics();
    let (model, coefficients) = match camera.lens() {
        Lens::Pinhole => ("none", &θ[4..]),
        Lens::BrownConrady if θ[8] == 0.0 => ("radtan", &θ[4..8]),
        Lens::BrownConrady => return Err(WriteError::Intrinsic { format: "kalibr", name: "k3", value: θ[8] }),
        Lens::Rational => return Err(WriteError::Lens { format: "kalibr", lens: camera.lens().name() }),
        Lens::KannalaBrandt => ("equidistant", &θ[4..]),
    };
    if let Some(i) = (2..4).find(|&i| θ[i] < 0.0) {
        let name = camera.lens().parameter_names()[i];
        return Err(WriteError::Intrinsic { format: "kalibr", name, value: θ[i] });
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
pub(super) fn is_camchain(root: &Node) -> bool {
    let is_camera = |node: &Node| node.get("camera_model").is_some();
    is_camera(root) || root.entries().iter().any(|(_, node)| is_camera(node))
}

pub(super) fn read(root: &Node, stated: &StatedCamera) -> Result<Camera, ReadError> {
    let cameras = root.entries().iter().filter(|(_, node)| node.get("camera_model").is_some());
    let (name, node) = if root.get("camera_model").is_some() {
        chosen(&[(String::new(), root)], stated, root.line)?
    } else {
        chosen(&cameras.map(|(name, node)| (name.clone(), node)).collect::<Vec<_>>(), stated, root.line)?
    };
    let within = if name.is_empty() { name } else { format!("{name}.") };
    let key = |name: &str| format!("{within}{name}");
    let model = node.require(&within, "camera_model")?;
    match model.text(&key("camera_model"))? {
        "pinhole" => {}
        other => return Err(unsupported::model(&key("camera_model"), other, "pinhole", model.line)),
    }
    let distortion = node.require(&within, "distortion_model")?;
    let lens = match distortion.text(&key("distortion_model"))? {
        "none" => Lens::Pinhole,
        "radtan" | "radial-tangential" => Lens::BrownConrady,
        "equidistant" | "equi" => Lens::KannalaBrandt,
        other => {
            let supported = "radtan, equidistant, none";
            return Err(unsupported::model(&key("distortion_model"), other, supported, distortion.line));
        }
    };
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
        Some([image_side(width, &key("resolution[0]"))?, image_side(height, &key("resolution[1]"))?]),
        resolution.line,
    )?;
    let intrinsics = numbers("intrinsics")?;
    if intrinsics.entries.len() != 4 {
        return Err(length(&intrinsics, "4: fx, fy, cx, cy"));
    }
    let listed = ["distortion_coeffs", "distortion_coefficients"].into_iter().find(|key| node.get(key).is_some());
    let listed = numbers(listed.unwrap_or("distortion_coeffs"))?;
    let mut θ: Vec<Located> = intrinsics.entries;
    θ.extend(coefficients::of_lens(lens, distortion.text(&key("distortion_model"))?, &listed)?);
    checked(lens, size, &θ)
}
