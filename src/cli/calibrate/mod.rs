//! `calipose calibrate`.

mod report;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use report::Report;

use super::failure::Failure;
use super::screen::Screen;
use super::verdict::Verdict;
use super::{WRITING, by_name};
use crate::calibration::{
    Calibration, CalibrationError, CalibrationSettings, Loss, Observations, RefinementSettings, calibrate,
};
use crate::camera::{Camera, Lens};
use crate::formats::{CameraFormat, Detections, Stated, read_detections_file};
use crate::plan::write_atomically;
use crate::problem::Problem;
use crate::target::Board;

#[derive(Debug, Args)]
pub(super) struct CalibrateArguments {
    /// Detected corners: mrcal's vnl, or calipose's JSON
    observations: PathBuf,
    /// Problem file that says board, image size, lens and what to estimate
    #[arg(long, conflicts_with_all = ["board", "square", "image", "lens"])]
    problem: Option<PathBuf>,
    /// Inner corners of the board along x and y
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = board_size, requires = "square")]
    board: Option<[u32; 2]>,
    /// Distance of neighbouring corners in mm
    #[arg(long = "square-mm", value_name = "MM", value_parser = length, requires = "board")]
    square: Option<f64>,
    /// Size of the images in px
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = image_size)]
    image: Option<[u32; 2]>,
    /// Lens model [default: brown-conrady]
    #[arg(long, value_parser = by_name(&Lens::ALL, Lens::name))]
    lens: Option<Lens>,
    /// How much a corner's error counts; huber and cauchy withstand outliers
    #[arg(long, default_value = "squared")]
    loss: LossName,
    /// Folder for the camera files and calibration.json
    #[arg(long, short, default_value = "calibration")]
    output: PathBuf,
    /// Format of the camera file
    #[arg(long, default_value = "all")]
    camera_format: FormatName,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LossName {
    Squared,
    Huber,
    Cauchy,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatName {
    Ros,
    #[value(name = "opencv")]
    OpenCv,
    #[value(name = "opencv-json")]
    OpenCvJson,
    Mrcal,
    Kalibr,
    All,
}

/// Scale, px, of a robust loss before the noise is known.
const FIRST_SCALE: f64 = 1.0;

pub(super) fn run(arguments: &CalibrateArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let (stated, model) = setting(arguments)?;
    let path = &arguments.observations;
    let found =
        read_detections_file(path, &stated).map_err(|error| Failure::Observations { path: path.clone(), error })?;
    let Detections { observations, names, .. } = &found;
    let (nominal, estimated) = match model {
        Some(model) => model,
        None => unknown_camera(arguments.lens.unwrap_or(Lens::BrownConrady), observations)?,
    };
    let formats = formats(arguments.camera_format, &nominal)?;
    let bar = screen.progress("calibrating", 1);
    let calibrated = fit(observations, &nominal, &estimated, arguments.loss);
    bar.finish_and_clear();
    let calibration =
        calibrated.map_err(|error| Failure::Calibration { error, path: path.clone(), names: names.clone() })?;

    let report = Report::new(&found, &calibration);
    let document = report.document();
    let mut files = vec![("calibration.json", format!("{document:#}\n"))];
    let mut left_out = String::new();
    for format in formats {
        match format.write(&calibration.camera) {
            Ok(text) => files.push((format.file_name(), text)),
            Err(error) if arguments.camera_format == FormatName::All => {
                left_out += &format!("\nNot written: {}, because {error}.", format.file_name());
            }
            Err(error) => return Err(Failure::Usage(error.to_string())),
        }
    }
    let writing = WRITING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    for (name, text) in &files {
        write_atomically(&arguments.output.join(name), text.as_bytes())?;
    }
    drop(writing);
    screen.document(&document.to_string())?;
    let written: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let (folder, written) = (arguments.output.display(), written.join(", "));
    screen.text(&format!("{}\nWritten to {folder}: {written}.{left_out}", report.text()))?;
    Ok(Verdict::Good)
}

/// The nominal camera, of which what is not estimated is kept, and the intrinsics to estimate.
type Model = (Camera, Vec<usize>);

/// What the command line or the problem file says of the detections, and the latter of the camera.
fn setting(arguments: &CalibrateArguments) -> Result<(Stated, Option<Model>), Failure> {
    if let Some(path) = &arguments.problem {
        let Problem { camera, target, estimated, .. } = Problem::read(path)?;
        let stated = Stated { board: Some(target.board), image: Some([camera.width(), camera.height()]) };
        return Ok((stated, Some((camera, estimated))));
    }
    let board = arguments.board.zip(arguments.square).map(|([columns, rows], square)| Board {
        columns: columns as usize,
        rows: rows as usize,
        square: square / 1e3,
    });
    Ok((Stated { board, image: arguments.image }, None))
}

/// A camera of which nothing but image size and lens is known: all its intrinsics are estimated, and not read.
fn unknown_camera(lens: Lens, observations: &Observations) -> Result<Model, Failure> {
    let count = lens.parameter_names().len();
    let mut θ = vec![0.0; count];
    θ[..2].fill(1.0);
    let camera = Camera::new(lens, observations.width(), observations.height(), &θ)
        .map_err(|error| Failure::Usage(error.to_string()))?;
    Ok((camera, (0..count).collect()))
}

/// The formats to write: one, which must know the lens, or all.
fn formats(name: FormatName, camera: &Camera) -> Result<Vec<CameraFormat>, Failure> {
    let one = match name {
        FormatName::Ros => CameraFormat::Ros,
        FormatName::OpenCv => CameraFormat::OpenCv,
        FormatName::OpenCvJson => CameraFormat::OpenCvJson,
        FormatName::Mrcal => CameraFormat::Mrcal,
        FormatName::Kalibr => CameraFormat::Kalibr,
        FormatName::All => return Ok(CameraFormat::ALL.to_vec()),
    };
    match one.write(camera) {
        Ok(_) => Ok(vec![one]),
        Err(error) => Err(Failure::Usage(error.to_string())),
    }
}

/// A robust loss takes its scale from the noise, and the noise from a first calibration.
fn fit(
    observations: &Observations,
    nominal: &Camera,
    estimated: &[usize],
    loss: LossName,
) -> Result<Calibration, CalibrationError> {
    let with = |loss: Loss| {
        let refinement = RefinementSettings { loss, ..RefinementSettings::default() };
        let settings = CalibrationSettings { refinement, ..CalibrationSettings::default() };
        calibrate(observations, nominal, estimated, &settings)
    };
    // The usual choices: about 95 % efficient under Gaussian noise.
    let (robust, tuning): (fn(f64) -> Loss, f64) = match loss {
        LossName::Squared => return with(Loss::Squared),
        LossName::Huber => (|scale| Loss::Huber { scale }, 1.345),
        LossName::Cauchy => (|scale| Loss::Cauchy { scale }, 2.385),
    };
    let noise = with(robust(FIRST_SCALE))?.sigma;
    with(robust((tuning * noise).max(1e-6)))
}

fn board_size(text: &str) -> Result<[u32; 2], String> {
    pair(text, 2, 1000, "8x6")
}

fn image_size(text: &str) -> Result<[u32; 2], String> {
    pair(text, 1, 100_000, "1280x720")
}

fn pair(text: &str, min: u32, max: u32, example: &str) -> Result<[u32; 2], String> {
    let number = |text: &str| text.parse().ok().filter(|x| (min..=max).contains(x));
    let parsed = text.split_once('x').and_then(|(a, b)| Some([number(a)?, number(b)?]));
    parsed.ok_or_else(|| format!("must be two whole numbers from {min} to {max}, as in {example}"))
}

fn length(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|x| (1e-3..=1e6).contains(x));
    parsed.ok_or_else(|| "must be a number from 0.001 to 1000000".into())
}
