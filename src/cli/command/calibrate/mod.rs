//! `calipose calibrate`.

mod parameters;
mod summary;

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};

use parameters::ParameterArguments;
use summary::text;

use crate::calibration::{Assessment, LossKind, Request, calibrate_by, other_lens, unknown_camera};
use crate::camera::{Camera, Lens};
use crate::cli::by_name;
use crate::cli::interrupt::writing;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::cli::output::verdict::Verdict;
use crate::formats::{CameraFormat, Detections, Known, read_detections_file};
use crate::plan::document::{CalibrationDocument, Document, ProblemReference};
use crate::plan::results::{probe, write_together};
use crate::problem::{Accuracy, Problem};
use crate::report::calibration_page;
use crate::target::Board;

#[derive(Debug, Args)]
pub(crate) struct CalibrateArguments {
    /// File of detected corners: mrcal's vnl, or calipose's JSON
    observations: PathBuf,
    /// Problem file that gives the board, image size, lens and intrinsics to estimate
    #[arg(long, conflicts_with_all = ["board", "square", "image", "lens"])]
    problem: Option<PathBuf>,
    /// Inner corners of the board along x and y
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = board_size, requires = "square")]
    board: Option<[u32; 2]>,
    /// Distance between neighbouring corners (side of a square), in mm
    #[arg(long = "square-mm", value_name = "MM", value_parser = length, requires = "board")]
    square: Option<f64>,
    /// Size of the images in px
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = image_size)]
    image: Option<[u32; 2]>,
    /// Lens model [default: brown-conrady]
    #[arg(long, value_parser = by_name(&Lens::ALL, Lens::name))]
    lens: Option<Lens>,
    #[command(flatten)]
    parameters: ParameterArguments,
    /// Use only images whose names match, with `*` for any text, as in '*cam0*'
    #[arg(long, value_name = "PATTERN")]
    images: Option<String>,
    /// Map error that the verdict requires, in px [default: the problem file's accuracy, else 1]
    #[arg(long = "map-error-px", value_name = "PX", value_parser = map_error)]
    map_error: Option<f64>,
    /// Loss function; huber and cauchy withstand outliers
    #[arg(long, default_value = "squared")]
    loss: LossName,
    /// Folder for the camera files and calibration.json
    #[arg(long, short, default_value = "calibration")]
    output: PathBuf,
    /// Format of the camera file; all writes every format that can hold the camera
    #[arg(long, default_value = ALL_FORMATS, value_parser = camera_files())]
    camera_format: CameraFiles,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LossName {
    Squared,
    Huber,
    Cauchy,
}

impl LossName {
    fn kind(self) -> LossKind {
        match self {
            Self::Squared => LossKind::Squared,
            Self::Huber => LossKind::Huber,
            Self::Cauchy => LossKind::Cauchy,
        }
    }
}

/// The camera files to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CameraFiles {
    /// One, in a format that must have the lens.
    One(CameraFormat),
    /// Those of every format that has the lens.
    All,
}

/// What [`CameraFiles::All`] is called beside the names of the formats.
const ALL_FORMATS: &str = "all";

fn camera_files() -> impl TypedValueParser<Value = CameraFiles> {
    let names = CameraFormat::ALL.map(CameraFormat::name).into_iter().chain([ALL_FORMATS]);
    PossibleValuesParser::new(names).map(|name| {
        let format = CameraFormat::ALL.into_iter().find(|format| format.name() == name);
        format.map_or(CameraFiles::All, CameraFiles::One)
    })
}

pub(crate) fn run(arguments: &CalibrateArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let setting = Setting::read(arguments)?;
    let path = &arguments.observations;
    let found = read_detections_file(path, &setting.known)
        .map_err(|error| Failure::Observations { path: path.clone(), error })?;
    let Detections { observations, names, .. } = &found;
    let (nominal, estimated, is_known) = if let Some(Problem { camera, estimated, .. }) = &setting.problem {
        (camera.clone(), estimated.clone(), true)
    } else {
        let camera = unknown_camera(arguments.lens.unwrap_or(Lens::BrownConrady), observations)
            .map_err(|error| Failure::Usage(error.to_string()))?;
        let all = (0..camera.intrinsics().len()).collect();
        (camera, all, false)
    };
    let model = arguments.parameters.model(&nominal, &estimated, is_known)?;
    let formats = formats(arguments.camera_format, &nominal)?;
    probe(&arguments.output)?;
    let bar = screen.progress("calibrating", 1);
    let loss = arguments.loss.kind();
    let calibrated = calibrate_by(loss, observations, &model.nominal, &model.estimated, model.ties);
    let other = other_lens(observations, nominal.lens());
    bar.finish_and_clear();
    let calibration = calibrated.map_err(|error| Failure::Calibration {
        error: Box::new(error),
        path: path.clone(),
        names: names.clone(),
        fits: other.map(|other| (other.lens.name(), other.rms)),
    })?;

    let assessment = Assessment::new(observations, &calibration, loss, other, &setting.requested);
    let problem = setting.problem.as_ref().map(ProblemReference::new);
    let document = CalibrationDocument::new(problem, &found, &calibration, &assessment);
    let page = calibration_page(&document).into_bytes();
    let mut files = vec![("calibration.json", document.to_json().into_bytes()), ("calibration.html", page)];
    let mut left_out = String::new();
    for format in formats {
        match format.write(&calibration.camera) {
            Ok(text) => files.push((format.file_name(), text.into_bytes())),
            Err(error) if arguments.camera_format == CameraFiles::All => {
                left_out += &format!("\nNot written: {}, because {error}.", format.file_name());
            }
            Err(error) => return Err(Failure::Usage(error.to_string())),
        }
    }
    // Camera files beside an older calibration are of that.
    let is_ours = arguments.output.join("calibration.json").exists();
    let stale: Vec<&str> = CameraFormat::ALL.iter().filter(|_| is_ours).map(|format| format.file_name()).collect();
    writing(|| write_together(&arguments.output, &files, &stale))?;
    screen.document(&document)?;
    let written: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let (folder, written) = (arguments.output.display(), written.join(", "));
    screen.text(&format!("{}\nWritten to {folder}: {written}.{left_out}", text(&found, &calibration, &assessment)))?;
    Ok(Verdict::good_if(!assessment.judgement.is_bad()))
}

/// What the command line and the problem file say.
struct Setting {
    known: Known,
    problem: Option<Problem>,
    requested: Vec<Request>,
}

impl Setting {
    fn read(arguments: &CalibrateArguments) -> Result<Self, Failure> {
        let problem = arguments.problem.as_deref().map(Problem::read).transpose()?;
        let images = arguments.images.clone();
        let known = if let Some(Problem { camera, target, .. }) = &problem {
            Known { board: Some(target.board.clone()), image: Some([camera.width(), camera.height()]), images }
        } else {
            let board = arguments
                .board
                .zip(arguments.square)
                .map(|([columns, rows], square)| Board::checkerboard(columns as usize, rows as usize, square / 1e3));
            Known { board, image: arguments.image, images }
        };
        let request = |problem: &Problem, &(accuracy, requested): &(Accuracy, f64)| match accuracy {
            Accuracy::MapError => Some(Request::MapError(requested)),
            Accuracy::Intrinsic(j) => {
                problem.estimated.get(j).map(|&intrinsic| Request::Sigma { intrinsic, sigma: requested })
            }
        };
        let mut requested: Vec<Request> = problem
            .iter()
            .flat_map(|problem| {
                problem.selection.goal.accuracies().iter().filter_map(|accuracy| request(problem, accuracy))
            })
            .collect();
        if let Some(map_error) = arguments.map_error {
            requested.retain(|request| !matches!(request, Request::MapError(_)));
            requested.push(Request::MapError(map_error));
        }
        Ok(Self { known, problem, requested })
    }
}

/// The formats to write; a single one must have the lens.
fn formats(files: CameraFiles, camera: &Camera) -> Result<Vec<CameraFormat>, Failure> {
    match files {
        CameraFiles::All => Ok(CameraFormat::ALL.to_vec()),
        CameraFiles::One(format) => match format.write(camera) {
            Ok(_) => Ok(vec![format]),
            Err(error) => Err(Failure::Usage(error.to_string())),
        },
    }
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

fn map_error(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    parsed.ok_or_else(|| "must be a positive number".into())
}
