//! Camera files of any format.

mod coefficients;
mod kalibr;
mod matrix;
mod mrcal;
mod opencv;
mod opencv_xml;
mod ros;
mod unsupported;

use thiserror::Error;

use super::error::{ReadError, ReadFault};
use super::tree;
use super::tree::{Located, Node};
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
    /// Kalibr's camchain, YAML.
    Kalibr,
}

/// Why a camera cannot be written in a format.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WriteError {
    /// The format has no such lens model.
    #[error("the format \"{format}\" has no lens model \"{lens}\"")]
    Lens {
        /// Name of the format.
        format: &'static str,
        /// Name of the lens model.
        lens: &'static str,
    },
    /// The format has no place for the value of an intrinsic.
    #[error("the format \"{format}\" cannot hold {name} = {value}")]
    Intrinsic {
        /// Name of the format.
        format: &'static str,
        /// The intrinsic.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// What is known of a camera beside its file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StatedCamera {
    /// Width and height of its images, px; needed where the file does not state them, and to agree where it does.
    pub image: Option<[u32; 2]>,
    /// Its name, in a file of several cameras.
    pub name: Option<String>,
}

impl StatedCamera {
    /// The image size that is stated and `found`, on `line` of the file.
    pub(super) fn image_size(&self, found: Option<[u32; 2]>, line: usize) -> Result<[u32; 2], ReadError> {
        match (found, self.image) {
            (Some(found), Some(given)) if found != given => {
                let [found, given] = [found, given].map(|[width, height]| format!("{width} x {height}"));
                Err(ReadFault::Mismatch { what: "image size", found, given }.at(line))
            }
            (Some(size), _) | (None, Some(size)) => Ok(size),
            (None, None) => Err(ReadFault::NotStated { what: "image size" }.at(line)),
        }
    }
}

/// The camera that is `stated`, or the only one; cameras without name are alone in their file.
pub(super) fn chosen<T: Clone>(
    cameras: &[(String, T)],
    stated: &StatedCamera,
    line: usize,
) -> Result<(String, T), ReadError> {
    let names = || cameras.iter().map(|(name, _)| name.clone()).filter(|name| !name.is_empty()).collect();
    match (&stated.name, cameras) {
        (None, [only]) => Ok(only.clone()),
        (None, _) => Err(ReadFault::SeveralCameras { names: names() }.at(line)),
        (Some(name), _) => {
            let found = cameras.iter().find(|(known, _)| !known.is_empty() && known == name);
            found.cloned().ok_or_else(|| ReadFault::UnknownCamera { name: name.clone(), names: names() }.at(line))
        }
    }
}

impl CameraFormat {
    /// Every format.
    pub const ALL: [Self; 5] = [Self::Ros, Self::OpenCv, Self::OpenCvJson, Self::Mrcal, Self::Kalibr];

    /// Name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ros => "ros",
            Self::OpenCv => "opencv",
            Self::OpenCvJson => "opencv-json",
            Self::Mrcal => "mrcal",
            Self::Kalibr => "kalibr",
        }
    }

    /// Usual name of a file of this format.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Ros => "camera_info.yaml",
            Self::OpenCv => "camera.opencv.yaml",
            Self::OpenCvJson => "camera.opencv.json",
            Self::Mrcal => "camera.cameramodel",
            Self::Kalibr => "camchain.yaml",
        }
    }

    /// `camera` in this format, all digits kept.
    ///
    /// # Errors
    /// Where the format has no such lens model, as mrcal no Kannala–Brandt and Kalibr no rational one, or no place for a value, as
    /// Kalibr for k3.
    pub fn write(self, camera: &Camera) -> Result<String, WriteError> {
        match self {
            Self::Ros => Ok(ros::write(camera)),
            Self::OpenCv => Ok(opencv::write_yaml(camera)),
            Self::OpenCvJson => Ok(opencv::write_json(camera)),
            Self::Mrcal => {
                mrcal::write(camera).ok_or(WriteError::Lens { format: self.name(), lens: camera.lens().name() })
            }
            Self::Kalibr => kalibr::write(camera),
        }
    }
}

/// The camera of a file of any [`CameraFormat`], or of OpenCV's XML, told apart by their keys; `stated` is what is known beside it.
///
/// # Errors
/// Where the file has no such camera.
pub fn read_camera(text: &str, stated: &StatedCamera) -> Result<Camera, ReadError> {
    let text = text.trim_start_matches('\u{feff}');
    if text.trim_start().starts_with('<') {
        return opencv::read(&opencv_xml::parse(text)?, stated);
    }
    if let Some(error) = unsupported::videre(text) {
        return Err(error);
    }
    let root = tree::parse(text)?;
    if root.get("lensmodel").is_some() {
        mrcal::read(&root, stated)
    } else if kalibr::is_camchain(&root) {
        kalibr::read(&root, stated)
    } else if let Some(error) = unsupported::file(&root) {
        Err(error)
    } else if ros::is_camera_info(&root) {
        ros::read(&root, stated)
    } else {
        opencv::read(&root, stated)
    }
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
