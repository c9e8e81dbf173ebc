//! Camera files of any format.
//!
//! A format stands in a file of its own and is registered here: one that is written as a [`CameraFormat`], one that is read among
//! `IMPORTS`.

mod format;
mod intrinsics;
mod kalibr;
mod mrcal;
mod opencv;
mod opencv_xml;
mod ros;
mod stated;
mod unsupported;

pub use format::WriteError;
pub use stated::StatedCamera;

use super::error::{ReadError, ReadFault};
use super::tree;
use crate::camera::Camera;
use format::{Export, Import};

/// File format that a camera is written in.
///
/// ```
/// use calipose::camera::{Camera, Lens};
/// use calipose::formats::{CameraFormat, StatedCamera, read_camera};
///
/// let camera = Camera::new(Lens::Rational, 1280, 720, &[900.0, 900.0, 640.0, 360.0, -0.2, 0.05, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0])?;
/// for format in CameraFormat::ALL {
///     match format.write(&camera) {
///         Ok(text) => assert_eq!(read_camera(&text, &StatedCamera::default())?, camera),
///         Err(error) => assert_eq!(error.to_string(), "the format \"kalibr\" has no lens model \"rational\""),
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// The formats that are read; the first that recognises a file reads it. ROS follows Kalibr, whose single cameras have ROS's keys
/// too, and OpenCV follows ROS.
const IMPORTS: [Import; 4] = [mrcal::IMPORT, kalibr::IMPORT, ros::IMPORT, opencv::IMPORT];

impl CameraFormat {
    /// Every format.
    pub const ALL: [Self; 5] = [Self::Ros, Self::OpenCv, Self::OpenCvJson, Self::Mrcal, Self::Kalibr];

    fn export(self) -> &'static Export {
        match self {
            Self::Ros => &ros::EXPORT,
            Self::OpenCv => &opencv::YAML,
            Self::OpenCvJson => &opencv::JSON,
            Self::Mrcal => &mrcal::EXPORT,
            Self::Kalibr => &kalibr::EXPORT,
        }
    }

    /// Name of the format, as on the command line.
    pub fn name(self) -> &'static str {
        self.export().name
    }

    /// Usual name of a file of this format.
    pub fn file_name(self) -> &'static str {
        self.export().file_name
    }

    /// `camera` in this format, all digits kept.
    ///
    /// # Errors
    /// Where the format has no such lens model, as mrcal no Kannala–Brandt and Kalibr no rational one, or no place for a value, as
    /// Kalibr for k3.
    pub fn write(self, camera: &Camera) -> Result<String, WriteError> {
        (self.export().write)(camera)
    }
}

/// The camera of a file of any [`CameraFormat`], or of OpenCV's XML, told apart by their keys; `stated` is what is known beside it.
///
/// ```
/// use calipose::camera::Lens;
/// use calipose::formats::{StatedCamera, read_camera};
///
/// let text = "{ camera_model: pinhole, intrinsics: [461.5, 460.1, 356.4, 231.2], resolution: [752, 480],
///               distortion_model: radtan, distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002] }";
/// let camera = read_camera(text, &StatedCamera::default())?;
/// assert_eq!((camera.lens(), camera.width()), (Lens::BrownConrady, 752));
/// # Ok::<(), calipose::formats::ReadError>(())
/// ```
///
/// # Errors
/// Where the file has no such camera.
pub fn read_camera(text: &str, stated: &StatedCamera) -> Result<Camera, ReadError> {
    let text = text.trim_start_matches('\u{feff}');
    if let Some(error) = unsupported::videre(text) {
        return Err(error);
    }
    let root = if text.trim_start().starts_with('<') { opencv_xml::parse(text)? } else { tree::parse(text)? };
    if let Some(error) = unsupported::file(&root) {
        return Err(error);
    }
    match IMPORTS.iter().find(|import| (import.recognises)(&root)) {
        Some(import) => (import.read)(&root, stated),
        None => Err(ReadFault::NoCamera { read: IMPORTS.map(|import| import.files).join(", ") }.at(root.line)),
    }
}
