//! `calipose render`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::interrupt::writing;
use crate::cli::loaded_plan::LoadedPoses;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::plan::document::{Document, PictureFile, PicturesDocument, PlannedPose, ProblemReference};
use crate::plan::results::{probe, write_together};
use crate::print::{Artwork, Pattern};
use crate::problem::Problem;
use crate::render::{Bodies, Picture, PlacedBody, RenderSettings, render};

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// plan.json of the plan, as `calipose plan` wrote it, or the polished.json of `calipose polish`
    plan: PathBuf,
    /// Problem file [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Folder for the pictures [default: `pictures` beside the plan]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Standard deviation of the lens's blur in px
    #[arg(long = "blur-px", value_name = "PX", default_value_t = RenderSettings::default().blur)]
    blur: f64,
    /// Change of the light from left to right, as a share
    #[arg(long, default_value_t = RenderSettings::default().gradient)]
    gradient: f64,
    /// Standard deviation of the sensor's noise in grey values of 255
    #[arg(long, default_value_t = RenderSettings::default().noise)]
    noise: f64,
    /// Rays along each side of a pixel
    #[arg(long, default_value_t = RenderSettings::default().supersampling)]
    supersampling: u32,
    /// Seed of the noise
    #[arg(long, default_value_t = RenderSettings::default().seed)]
    seed: u64,
}

pub(crate) fn run(arguments: &RenderArguments, screen: &mut Screen) -> Result<(), Failure> {
    let settings = arguments.settings()?;
    let path = &arguments.plan;
    let LoadedPoses { planned, problem } = LoadedPoses::read(path, arguments.problem.as_deref())?;
    let poses = planned.in_order();
    let beside = path.parent().unwrap_or(Path::new("")).join("pictures");
    let folder = arguments.output.clone().unwrap_or(beside);
    probe(&folder)?;
    let pattern = Pattern::new(&Artwork::new(&problem.target.board)?);
    let bar = screen.progress("rendering", poses.len());
    let mut files = Vec::with_capacity(poses.len());
    let mut listed = Vec::with_capacity(poses.len());
    for (number, pose) in poses.iter().enumerate() {
        // Noise of its own for every picture.
        let settings = RenderSettings { seed: settings.seed.wrapping_add((number as u64) << 16), ..settings };
        let file = format!("pose-{:02}.png", number + 1);
        files.push((file.clone(), png(&picture(&problem, &pattern, pose, &settings))?));
        listed.push(PictureFile { pose: pose.id, file });
        bar.inc(1);
    }
    bar.finish_and_clear();
    let named: Vec<(&Path, &[u8])> = files.iter().map(|(name, bytes)| (Path::new(name), bytes.as_slice())).collect();
    writing(|| write_together(&folder, &named, &[]))?;
    screen.document(&PicturesDocument {
        header: PicturesDocument::header(),
        problem: ProblemReference::new(&problem),
        blur_px: settings.blur,
        gradient: settings.gradient,
        noise_grey: settings.noise,
        seed: settings.seed,
        pictures: listed,
    })?;
    let (first, last) = (files.first().map_or("", |file| &file.0), files.last().map_or("", |file| &file.0));
    screen.text(&format!("{} pictures written to {}: {first} to {last}.", files.len(), folder.display()))
}

impl RenderArguments {
    fn settings(&self) -> Result<RenderSettings, Failure> {
        let Self { blur, gradient, noise, supersampling, seed, .. } = *self;
        let named = [
            ("--blur-px", blur, 0.0, 50.0),
            ("--gradient", gradient, -1.0, 1.0),
            ("--noise", noise, 0.0, 255.0),
            ("--supersampling", f64::from(supersampling), 1.0, 32.0),
        ];
        for (name, value, least, most) in named {
            if !(least..=most).contains(&value) {
                return Err(Failure::Usage(format!("{name} is {value}; it must be from {least} to {most}")));
            }
        }
        Ok(RenderSettings { supersampling, blur, gradient, noise, seed })
    }
}

/// The picture that a pose should give.
fn picture(problem: &Problem, pattern: &Pattern, pose: &PlannedPose, settings: &RenderSettings) -> Picture {
    let Problem { robot, camera, target, .. } = problem;
    let q = &pose.joints_rad;
    let X_CB = robot.camera_pose(q).inverse();
    let X_BL = robot.link_poses(q);
    let links = robot.tree.links.iter().zip(&X_BL);
    let bodies =
        links.flat_map(|(link, X_BL)| link.bodies.iter().map(move |body| PlacedBody { body, X_CL: X_CB * X_BL }));
    render(camera, pattern, &(X_CB * target.X_BT), &Bodies::new(bodies), settings)
}

fn png(picture: &Picture) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(png::ColorType::Grayscale);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&picture.grey));
    written.map_err(|error| Failure::Table(error.to_string()))?;
    Ok(bytes)
}
