//! Reading files from disk.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{
    Description, Detections, Outline, ReadError, Stated, StatedCamera, UrdfError, UrdfNote, outline_urdf, read_camera,
    read_detections, read_srdf, read_urdf,
};
use crate::camera::Camera;
use crate::robot::Tree;

/// Larger files are of something else: 1000 images of 10 000 corners stay below.
const LARGEST: u64 = 1_000_000_000;

/// Why a file gives nothing.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FileReadError {
    /// It could not be read.
    #[error("cannot be read: {kind}")]
    Read {
        /// Why not.
        kind: io::ErrorKind,
    },
    /// It is too large to be one of these files.
    #[error("is larger than {LARGEST} bytes")]
    TooLarge,
    /// It is not UTF-8 text.
    #[error("is not UTF-8 text: line {line} has a byte that belongs to no character")]
    Encoding {
        /// Line of the first such byte, from 1.
        line: usize,
    },
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
/// # Errors
/// When the file cannot be read or has no camera.
pub fn read_camera_file(path: &Path, stated: &StatedCamera) -> Result<Camera, FileReadError> {
    Ok(read_camera(&text(path)?, stated)?)
}

/// The detections of the file at `path`; see [`read_detections`].
///
/// # Errors
/// When the file cannot be read or its detections cannot be used.
pub fn read_detections_file(path: &Path, stated: &Stated) -> Result<Detections, FileReadError> {
    Ok(read_detections(&text(path)?, stated)?)
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

/// The file at `path`.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, FileReadError> {
    read_at_most(path, LARGEST).map_err(|error| match error.kind() {
        io::ErrorKind::FileTooLarge => FileReadError::TooLarge,
        kind => FileReadError::Read { kind },
    })
}

/// The file at `path`, at most `most` bytes of it. Pipes are read as files are; what has no end is given up there.
pub(crate) fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let mut bytes = Vec::new();
    if file.metadata()?.len() <= most {
        file.take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 <= most {
            return Ok(bytes);
        }
    }
    Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it is larger than {most} bytes")))
}

fn text(path: &Path) -> Result<String, FileReadError> {
    String::from_utf8(bytes(path)?).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        FileReadError::Encoding { line: String::from_utf8_lossy(valid).matches('\n').count() + 1 }
    })
}
