//! Cameras, detections and robots of files on disk.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::board::{StatedBoard, read_board};
use super::camera::{StatedCamera, read_camera};
use super::detections::{DetectedImage, Detections, Known, read_detections, read_images};
use super::disk::{DiskError, text};
use super::error::ReadError;
use super::urdf::{Description, Outline, UrdfError, UrdfNote, outline_urdf, read_srdf, read_urdf};
use crate::camera::Camera;
use crate::robot::Tree;

/// Why a file gives nothing.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FileReadError {
    /// It gives no text.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// Its contents are wrong.
    #[error(transparent)]
    Content(#[from] ReadError),
    /// It is no description of a robot, or a wrong one.
    #[error(transparent)]
    Robot(Box<UrdfError>),
}

impl From<UrdfError> for FileReadError {
    fn from(error: UrdfError) -> Self {
        Self::Robot(Box::new(error))
    }
}

/// The camera of the file at `path`; see [`read_camera`].
///
/// ```
/// use std::path::Path;
///
/// use calipose::formats::{StatedCamera, read_camera_file};
///
/// let camera = read_camera_file(Path::new("tests/data/camera-files/kalibr-camchain.yaml"), &StatedCamera::default())?;
/// assert_eq!(camera.lens().name(), "kannala-brandt");
/// # Ok::<(), calipose::formats::FileReadError>(())
/// ```
///
/// # Errors
/// When the file cannot be read or has no camera.
pub fn read_camera_file(path: &Path, stated: &StatedCamera) -> Result<Camera, FileReadError> {
    Ok(read_camera(&text(path)?, stated)?)
}

/// The board of the file at `path`; see [`read_board`].
///
/// # Errors
/// When the file cannot be read or has no board.
pub fn read_board_file(path: &Path) -> Result<StatedBoard, FileReadError> {
    Ok(read_board(&text(path)?)?)
}

/// The detections of the file at `path`; see [`read_detections`].
///
/// ```no_run
/// use std::path::Path;
///
/// use calipose::formats::{Known, read_detections_file};
/// use calipose::target::Board;
///
/// let board = Board::checkerboard(8, 6, 0.035);
/// let known = Known { board: Some(board), image: Some([1280, 720]), images: Some("*cam0*".into()) };
/// let detections = read_detections_file(Path::new("corners.vnl"), &known)?;
/// # Ok::<(), calipose::formats::FileReadError>(())
/// ```
///
/// # Errors
/// When the file cannot be read or its detections cannot be used.
pub fn read_detections_file(path: &Path, known: &Known) -> Result<Detections, FileReadError> {
    Ok(read_detections(&text(path)?, known)?)
}

/// The text of the file at `path`, for what looks at the content first.
///
/// # Errors
/// When the file cannot be read or is no UTF-8 text.
pub fn read_text_file(path: &Path) -> Result<String, FileReadError> {
    Ok(text(path)?)
}

/// The images of the file of detections at `path`, each for itself; see [`read_images`].
///
/// # Errors
/// When the file cannot be read.
pub fn read_images_file(path: &Path, known: &Known) -> Result<Vec<DetectedImage>, FileReadError> {
    Ok(read_images(&text(path)?, known)?)
}

/// The robot of the URDF file at `path`; see [`read_urdf`].
///
/// # Errors
/// When the file cannot be read or describes no robot.
pub fn read_urdf_file(path: &Path, package_folders: &[PathBuf]) -> Result<Description, FileReadError> {
    Ok(read_urdf(&text(path)?, path.parent().unwrap_or(Path::new("")), package_folders)?)
}

/// The robot of the URDF file at `path` without its bodies; see [`outline_urdf`].
///
/// # Errors
/// When the file cannot be read or describes no robot.
pub fn outline_urdf_file(path: &Path) -> Result<Outline, FileReadError> {
    Ok(outline_urdf(&text(path)?)?)
}

/// The pairs of links of `tree` that the SRDF file at `path` names; see [`read_srdf`].
///
/// # Errors
/// When the file cannot be read or is of another robot.
pub fn read_srdf_file(path: &Path, tree: &Tree) -> Result<(Vec<[usize; 2]>, Vec<UrdfNote>), FileReadError> {
    Ok(read_srdf(&text(path)?, tree)?)
}
