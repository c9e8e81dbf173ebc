//! Calibrates a camera from corners in a file: `cargo run --release --example calibrate_from_corners`.
#![allow(clippy::print_stdout, reason = "an example talks")]

use std::path::Path;

use calipose::calibration::{CalibrationSettings, calibrate};
use calipose::camera::{Camera, Lens};
use calipose::formats::{CameraFormat, Known, read_detections_file};
use calipose::target::Board;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let board = Board::checkerboard(8, 6, 0.035);
    let known = Known { board: Some(board), image: Some([1280, 720]), images: None };
    let detections = read_detections_file(Path::new("problems/examples/servosila-corners.vnl"), &known)?;
    // The lens model, the image's size, and where what is not estimated is taken from.
    let nominal = Camera::new(Lens::BrownConrady, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5, 0.0, 0.0, 0.0, 0.0, 0.0])?;
    let estimated: Vec<usize> = (0..9).collect();
    let found = calibrate(&detections.observations, &nominal, &estimated, &CalibrationSettings::default())?;
    for ((name, value), variance) in
        nominal.lens().parameter_names().iter().zip(found.camera.intrinsics()).zip(found.covariance.diagonal().iter())
    {
        println!("{name} = {value:.4} ± {:.4}", variance.sqrt());
    }
    print!("{}", CameraFormat::Ros.write(&found.camera)?);
    Ok(())
}
