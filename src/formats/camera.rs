//! Camera files of any format.

use thiserror::Error;

use super::error::{ReadError, ReadFault};
use super::tree::{self, Located, Node};
use super::{mrcal, opencv, ros};
use crate::camera::{Camera, Lens};

/// Longest image side, px.
const LONGEST_SIDE: u32 = 100_000;

/// File format of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CameraFormat {
    /// ROS `camera_info`, YAML.
    Ros,
    /// OpenCV `FileStorage`, YAML.
    OpenCv,
    /// OpenCV `FileStorage`, JSON.
    OpenCvJson,
    /// mrcal's cameramodel.
    Mrcal,
}

/// Why a camera cannot be written in a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the format \"{format}\" has no lens model \"{lens}\"")]
pub struct WriteError {
    /// Name of the format.
    pub format: &'static str,
    /// Name of the lens model.
    pub lens: &'static str,
}

impl CameraFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Ros, Self::OpenCv, Self::OpenCvJson, Self::Mrcal];

    /// Name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ros => "ros",
            Self::OpenCv => "opencv",
            Self::OpenCvJson => "opencv-json",
            Self::Mrcal => "mrcal",
        }
    }

    /// Usual name of a file of this format.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Ros => "camera_info.yaml",
            Self::OpenCv => "camera.opencv.yaml",
            Self::OpenCvJson => "camera.opencv.json",
            Self::Mrcal => "camera.cameramodel",
        }
    }

    /// `camera` in this format, all digits kept.
    ///
    /// # Errors
    /// Where the format has no such lens model: mrcal has no Kannala–Brandt.
    pub fn write(self, camera: &Camera) -> Result<String, WriteError> {
        match self {
            Self::Ros => Ok(ros::write(camera)),
            Self::OpenCv => Ok(opencv::write_yaml(camera)),
            Self::OpenCvJson => Ok(opencv::write_json(camera)),
            Self::Mrcal => mrcal::write(camera).ok_or(WriteError { format: self.name(), lens: camera.lens().name() }),
        }
    }
}

/// The camera of a file of any [`CameraFormat`], told apart by their keys.
///
/// # Errors
/// Where the file has no such camera.
pub fn read_camera(text: &str) -> Result<Camera, ReadError> {
    let root = tree::parse(text)?;
    if root.get("lensmodel").is_some() {
        mrcal::read(&root)
    } else if root.get("distortion_model").is_some() {
        ros::read(&root)
    } else {
        opencv::read(&root)
    }
}

/// Width and height from the keys `image_width` and `image_height`.
pub(super) fn image_size(root: &Node) -> Result<[u32; 2], ReadError> {
    let side = |key: &str| image_side(root.require("", key)?, key);
    Ok([side("image_width")?, side("image_height")?])
}

/// The side of an image, px.
pub(super) fn image_side(node: &Node, key: &str) -> Result<u32, ReadError> {
    node.count(&key, 1, LONGEST_SIDE)
}

/// The camera of intrinsics θ, each checked for its range.
pub(super) fn checked(lens: Lens, [width, height]: [u32; 2], θ: &[Located]) -> Result<Camera, ReadError> {
    for (i, (name, value)) in lens.parameter_names().iter().zip(θ).enumerate() {
        let (min, max) = match i {
            0 | 1 => (1e-3, 1e6),
            2 => (-0.5, f64::from(width) - 0.5),
            3 => (-0.5, f64::from(height) - 0.5),
            _ => (-1e6, 1e6),
        };
        value.between(name, min, max)?;
    }
    let values: Vec<f64> = θ.iter().map(|x| x.value).collect();
    Camera::new(lens, width, height, &values)
        .map_err(|error| ReadFault::Syntax { message: error.to_string() }.at(θ.first().map_or(1, |x| x.line)))
}
