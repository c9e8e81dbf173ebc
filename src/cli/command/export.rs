//! `calipose export`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::by_name;
use crate::cli::interrupt::writing;
use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::export::{Home, Program, ProgramFormat, ProgramJoint, Stop};
use crate::motion::timing::duration;
use crate::plan::document::{Document, ExportDocument, ExportedFile, Plan, PlannedPose, ProblemReference};
use crate::plan::results::{probe, write_together};
use crate::problem::MotionSettings;

#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Format to write, or several
    #[arg(long = "to", value_name = "FORMAT", value_delimiter = ',', required = true,
          value_parser = by_name(&ProgramFormat::ALL, ProgramFormat::name))]
    to: Vec<ProgramFormat>,
    /// Problem file [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Folder for the files [default: `export` beside the plan]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Time at each pose in seconds [default: the problem's `motion.dwell_s`]
    #[arg(long = "dwell-s", value_name = "S")]
    dwell: Option<f64>,
    /// Share of the joints' greatest speeds in percent [default: the problem's `motion.speed_percent`]
    #[arg(long = "speed-percent", value_name = "PERCENT")]
    speed: Option<f64>,
}

pub(crate) fn run(arguments: &ExportArguments, screen: &mut Screen) -> Result<(), Failure> {
    let path = &arguments.plan;
    let LoadedPlan { plan, problem, .. } = LoadedPlan::read(path, arguments.problem.as_deref())?;
    let motion = arguments.motion(&problem.motion)?;
    let folder = arguments.output.clone().unwrap_or_else(|| path.parent().unwrap_or(Path::new("")).join("export"));
    probe(&folder)?;
    let joints = problem.robot.chain.joints.iter().zip(&motion.greatest);
    let joints: Vec<ProgramJoint> = joints.map(|(joint, greatest)| ProgramJoint::new(joint, greatest)).collect();
    let (stops, home) = stops(&plan, &motion);
    let program =
        Program { name: &problem.name, joints: &joints, stops: &stops, home, dwell: motion.dwell, share: motion.share };
    let mut files = Vec::with_capacity(arguments.to.len());
    for format in &arguments.to {
        files.push((format.file_name(&program), format.write(&program)?));
    }
    let named: Vec<(&Path, &[u8])> = files.iter().map(|(name, text)| (Path::new(name), text.as_bytes())).collect();
    writing(|| write_together(&folder, &named, &[]))?;
    let formats = arguments.to.iter().zip(&files);
    screen.document(&ExportDocument {
        header: ExportDocument::header(),
        problem: ProblemReference::new(&problem),
        folder: folder.display().to_string(),
        dwell_s: motion.dwell,
        speed_percent: 100.0 * motion.share,
        files: formats
            .map(|(format, (file, _))| ExportedFile { format: format.name().into(), file: file.clone() })
            .collect(),
    })?;
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    screen.text(&format!(
        "Written to {}: {}. Try them in simulation first, then at low speed with a hand on the stop: between the poses nothing was \
         tested for collision.",
        folder.display(),
        names.join(", ")
    ))
}

impl ExportArguments {
    /// The problem's settings with what the command line says instead.
    fn motion(&self, stated: &MotionSettings) -> Result<MotionSettings, Failure> {
        let within = |name: &str, value: Option<f64>, usual: f64, least: f64, most: f64| match value {
            Some(value) if !(least..=most).contains(&value) => {
                Err(Failure::Usage(format!("{name} is {value}; it must be from {least} to {most}")))
            }
            value => Ok(value.unwrap_or(usual)),
        };
        Ok(MotionSettings {
            dwell: within("--dwell-s", self.dwell, stated.dwell, 0.0, 3600.0)?,
            share: within("--speed-percent", self.speed, 100.0 * stated.share, 0.1, 100.0)? / 100.0,
            ..stated.clone()
        })
    }
}

/// The plan's poses in the order of its tour, and where it begins, with the times of the moves.
fn stops(plan: &Plan, motion: &MotionSettings) -> (Vec<Stop>, Option<Home>) {
    let limits = motion.limits();
    let poses = plan.in_order();
    let home = motion.home.as_ref();
    let starts = home.map(|home| &home.q).into_iter().chain(poses.iter().map(|pose| &pose.joints_rad));
    // Without a home nothing is known of the way to the first pose.
    let first = usize::from(home.is_none());
    let seconds = vec![0.0; first].into_iter().chain(
        starts.zip(&poses[first.min(poses.len())..]).map(|(from, pose)| duration(from, &pose.joints_rad, &limits)),
    );
    let stop = |(pose, seconds): (&&PlannedPose, f64)| Stop {
        label: format!("pose {}", pose.id),
        q: pose.joints_rad.clone(),
        seconds,
    };
    let stops: Vec<Stop> = poses.iter().zip(seconds).map(stop).collect();
    let home = home.map(|home| Home {
        q: home.q.clone(),
        back: poses.last().filter(|_| home.returns).map(|last| duration(&last.joints_rad, &home.q, &limits)),
    });
    (stops, home)
}
