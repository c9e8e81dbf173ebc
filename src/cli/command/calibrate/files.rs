//! The files of a calibration.

use std::path::Path;

use super::Failure;
use crate::camera::Camera;
use crate::cli::interrupt::writing;
use crate::formats::CameraFormat;
use crate::plan::document::{CalibrationDocument, Document};
use crate::plan::results::write_together;
use crate::report::calibration_page;

/// Writes a calibration, its page, its camera in those formats and the files `beside` them to `folder`; says so, and which formats do not
/// have the camera. Camera files of an older calibration are removed.
///
/// # Errors
/// When a file cannot be written; where `is_all` is not set, also when a format does not have the camera.
pub(in crate::cli::command) fn write(
    folder: &Path,
    document: &CalibrationDocument,
    camera: &Camera,
    (formats, is_all): (&[CameraFormat], bool),
    beside: Vec<(&'static str, Vec<u8>)>,
) -> Result<String, Failure> {
    let page = calibration_page(document).into_bytes();
    let mut files = vec![("calibration.json", document.to_json().into_bytes()), ("calibration.html", page)];
    let mut left_out = String::new();
    for format in formats {
        match format.write(camera) {
            Ok(text) => files.push((format.file_name(), text.into_bytes())),
            Err(error) if is_all => {
                left_out += &format!("\nNot written: {}, because {error}.", format.file_name());
            }
            Err(error) => return Err(Failure::Usage(error.to_string())),
        }
    }
    files.extend(beside);
    // Camera files beside an older calibration are of that.
    let is_ours = folder.join("calibration.json").exists();
    let stale: Vec<&str> = CameraFormat::ALL.iter().filter(|_| is_ours).map(|format| format.file_name()).collect();
    writing(|| write_together(folder, &files, &stale))?;
    let written: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    Ok(format!("Written to {}: {}.{left_out}", folder.display(), written.join(", ")))
}
