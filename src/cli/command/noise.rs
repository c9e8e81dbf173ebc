//! `calipose noise`.

use std::path::PathBuf;

use clap::Args;

use crate::calibration::{FittedNoise, Scatter};
use crate::cli::known::{KnownArguments, read_detections, window};
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, short, table};
use crate::information::{Blur, Noise, NoiseModel};
use crate::plan::document::NoiseDocument;

#[derive(Debug, Args)]
pub(crate) struct NoiseArguments {
    /// Files of detected corners, each of repeated pictures in which neither the camera nor the board moved
    #[arg(required = true)]
    observations: Vec<PathBuf>,
    #[command(flatten)]
    known: KnownArguments,
    /// Half the side of the detector's window in px [default: the problem file's, else 5]
    #[arg(long = "window-px", value_name = "PX", value_parser = window)]
    window: Option<f64>,
}

pub(crate) fn run(arguments: &NoiseArguments, screen: &mut Screen) -> Result<(), Failure> {
    let (problem, known) = arguments.known.read()?;
    let (stated, blur) = match problem.map(|problem| problem.noise.model) {
        Some(NoiseModel::Edges { window, blur }) => (window, blur),
        Some(NoiseModel::Constant) | None => (NoiseModel::USUAL_WINDOW, Blur::NONE),
    };
    let scenes = arguments.observations.iter().map(|path| Ok(read_detections(path, &known)?.observations));
    let scenes: Vec<_> = scenes.collect::<Result<_, Failure>>()?;
    let pictures = scenes.iter().map(|scene| scene.views().len()).sum();
    let scatter = Scatter::new(&scenes, arguments.window.unwrap_or(stated), blur)?;
    let document = NoiseDocument::new(&scatter, scenes.len(), pictures);
    screen.document(&document)?;
    screen.text(&text(&scatter, &document))
}

fn text(scatter: &Scatter, document: &NoiseDocument) -> String {
    let row = |name: &str, FittedNoise { noise, misfit, .. }: &FittedNoise| {
        let window = match noise.model {
            NoiseModel::Constant => "-".into(),
            NoiseModel::Edges { window, .. } => short(window),
        };
        vec![name.into(), short(noise.sigma), window, format!("{:.0} %", 100.0 * misfit)]
    };
    let rows = [row("constant", &scatter.constant), row("edges", &scatter.edges)];
    let moved = if document.moved {
        format!(
            "\nThe corners of a picture move together by {} px, more than the {} px that chance explains: camera or board moved, or the \
             light flickers. The noise is overstated.\n",
            short(scatter.common_shift),
            short(scatter.expected_shift),
        )
    } else {
        String::new()
    };
    let Noise { sigma, model } = scatter.better().noise;
    let model = match model {
        NoiseModel::Constant => "model = \"constant\"".into(),
        NoiseModel::Edges { window, .. } => format!("model = \"edges\"\nwindow_px = {}", short(window)),
    };
    format!(
        "{} corners of {} scenes in {} pictures.\n\n{}\n\nMisfit: how far the corners' own scatter is from the model's, beyond chance.\n\
         {moved}\nFor the problem file:\n\n[noise]\nsigma_px = {}\n{model}\n",
        scatter.corners,
        document.scenes,
        document.pictures,
        table(&["model", "sigma [px]", "window [px]", "misfit"], &rows),
        short(sigma),
    )
}
