//! `calipose calibrate`.

pub(super) mod files;
mod parameters;
mod summary;

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};

use parameters::ParameterArguments;
use summary::text;

use crate::calibration::{
    Assessment, CalibrationSettings, LossKind, Request, calibrate_by, other_lens, unknown_camera,
};
use crate::camera::{Camera, Lens};
use crate::cli::by_name;
use crate::cli::known::{KnownArguments, read_detections, window};
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::cli::output::verdict::Verdict;
use crate::formats::{CameraFormat, Detections, Known};
use crate::information::{Blur, NoiseModel, NoiseName};
use crate::plan::document::{CalibrationDocument, ProblemReference};
use crate::plan::results::probe;
use crate::problem::Problem;
use crate::target::{Board, Warp};

#[derive(Debug, Args)]
pub(crate) struct CalibrateArguments {
    /// File of detected corners: mrcal's vnl, or calipose's JSON
    observations: PathBuf,
    #[command(flatten)]
    known: KnownArguments,
    /// Lens model [default: brown-conrady]
    #[arg(long, conflicts_with = "problem", value_parser = by_name(&Lens::ALL, Lens::name))]
    lens: Option<Lens>,
    #[command(flatten)]
    parameters: ParameterArguments,
    /// Map error that the verdict requires, in px [default: the problem file's accuracy, else 1]
    #[arg(long = "map-error-px", value_name = "PX", value_parser = map_error)]
    map_error: Option<f64>,
    /// Loss function; huber and cauchy withstand outliers
    #[arg(long, default_value = "squared")]
    loss: LossName,
    /// How far corners scatter: `edges` weighs them by the edges that the detector saw [default: the problem file's, else constant]
    #[arg(long = "noise-model", value_parser = by_name(&NoiseName::ALL, NoiseName::name))]
    noise: Option<NoiseName>,
    /// Half the side of the detector's window in px, for `edges` [default: the problem file's, else 5]
    #[arg(long = "window-px", value_name = "PX", value_parser = window)]
    window: Option<f64>,
    /// How far the board may bulge, in mm, of which two heights are estimated [default: the problem file's, else flat]
    #[arg(long = "warp-mm", value_name = "MM", value_parser = warp)]
    warp: Option<f64>,
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
    let found = read_detections(path, &setting.known)?;
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
    let warp = expected_warp(arguments, setting.problem.as_ref(), observations.board());
    let settings =
        CalibrationSettings { ties: model.ties, noise: setting.noise, warp, ..CalibrationSettings::default() };
    let calibrated = calibrate_by(loss, observations, &model.nominal, &model.estimated, &settings);
    let other = other_lens(observations, nominal.lens(), warp);
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
    let is_all = arguments.camera_format == CameraFiles::All;
    let written = files::write(&arguments.output, &document, &calibration.camera, (&formats, is_all), Vec::new())?;
    screen.document(&document)?;
    screen.text(&format!("{}\n{written}", text(&found, &calibration, &assessment)))?;
    Ok(Verdict::good_if(!assessment.judgement.is_bad()))
}

/// What the command line and the problem file say.
struct Setting {
    known: Known,
    problem: Option<Problem>,
    requested: Vec<Request>,
    noise: NoiseModel,
}

impl Setting {
    fn read(arguments: &CalibrateArguments) -> Result<Self, Failure> {
        let (problem, known) = arguments.known.read()?;
        let mut requested = problem.as_ref().map(Problem::requests).unwrap_or_default();
        if let Some(map_error) = arguments.map_error {
            requested.retain(|request| !matches!(request, Request::MapError(_)));
            requested.push(Request::MapError(map_error));
        }
        let noise = noise(arguments, problem.as_ref())?;
        Ok(Self { known, problem, requested, noise })
    }
}

/// How corners are weighed.
fn noise(arguments: &CalibrateArguments, problem: Option<&Problem>) -> Result<NoiseModel, Failure> {
    let stated = problem.map(|problem| problem.noise.model).unwrap_or_default();
    let model = match arguments.noise {
        Some(NoiseName::Constant) => NoiseModel::Constant,
        Some(NoiseName::Edges) if stated == NoiseModel::Constant => {
            NoiseModel::Edges { window: NoiseModel::USUAL_WINDOW, blur: Blur::NONE }
        }
        Some(NoiseName::Edges) | None => stated,
    };
    match (arguments.window, model) {
        (None, model) => Ok(model),
        (Some(window), NoiseModel::Edges { blur, .. }) => Ok(NoiseModel::Edges { window, blur }),
        (Some(_), NoiseModel::Constant) => {
            Err(Failure::Usage("--window-px is for --noise-model edges: constant noise has no window".into()))
        }
    }
}

/// How the board may bulge.
fn expected_warp(arguments: &CalibrateArguments, problem: Option<&Problem>, board: &Board) -> Option<Warp> {
    let given = arguments.warp.map(|mm| Warp::new(mm * 1e-3, board));
    given.or_else(|| problem.and_then(|problem| problem.target.warp))
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

fn warp(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|mm: &f64| (1e-3..=20.0).contains(mm));
    parsed.ok_or_else(|| "must be a number of mm from 0.001 to 20".into())
}

fn map_error(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    parsed.ok_or_else(|| "must be a positive number".into())
}
