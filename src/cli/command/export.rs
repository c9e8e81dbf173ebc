//! `calipose export`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::by_name;
use crate::cli::interrupt::writing;
use crate::cli::loaded_plan::LoadedPoses;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, wrapped};
use crate::export::{ExportFile, ExportFormat, Home, Program, ProgramJoint, Setup, Stop};
use crate::feasibility::{Collision, LinkPair};
use crate::motion::JointLimits;
use crate::motion::timing::duration;
use crate::plan::document::{Document, ExportDocument, ExportedFile, PlannedPoses, ProblemReference};
use crate::plan::results::{probe, write_together};
use crate::problem::{MotionSettings, Problem};

#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// plan.json of the plan, as `calipose plan` wrote it, or the polished.json of `calipose polish`
    plan: PathBuf,
    /// Format to write, or several
    #[arg(long = "to", value_name = "FORMAT", value_delimiter = ',', required = true,
          value_parser = by_name(&ExportFormat::ALL, ExportFormat::name))]
    to: Vec<ExportFormat>,
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
    let LoadedPoses { planned, problem } = LoadedPoses::read(path, arguments.problem.as_deref())?;
    let motion = arguments.motion(&problem.motion)?;
    let folder = arguments.output.clone().unwrap_or_else(|| path.parent().unwrap_or(Path::new("")).join("export"));
    probe(&folder)?;
    let limits = motion.limits();
    let joints = problem.robot.chain.joints.iter().zip(motion.greatest.iter().zip(&limits));
    // The share is of speeds; accelerations and jerks are those at this share.
    let joints = joints.map(|(joint, (greatest, &JointLimits { acceleration, jerk, .. }))| ProgramJoint {
        name: joint.name.clone(),
        kind: joint.kind,
        speed: greatest.speed,
        acceleration,
        jerk,
    });
    let joints: Vec<ProgramJoint> = joints.collect();
    let (stops, home) = stops(&planned, &motion);
    let program =
        Program { name: &problem.name, joints: &joints, stops: &stops, home, dwell: motion.dwell, share: motion.share };
    let untested = untested(&problem);
    let Problem { robot, camera, target, .. } = &problem;
    let setup = Setup { program: &program, robot, camera, target, untested: &untested };
    let mut files: Vec<(ExportFormat, ExportFile)> = Vec::new();
    for &format in &arguments.to {
        files.extend(format.write(&setup)?.into_iter().map(|file| (format, file)));
    }
    // Models share what they name.
    let mut named: Vec<(&Path, &[u8])> = files.iter().map(|(_, file)| (Path::new(&file.name), &*file.bytes)).collect();
    named.sort_by_key(|&(name, _)| name);
    named.dedup_by_key(|(name, _)| *name);
    writing(|| write_together(&folder, &named, &[]))?;
    let listed =
        files.iter().map(|(format, file)| ExportedFile { format: format.name().into(), file: file.name.clone() });
    screen.document(&ExportDocument {
        header: ExportDocument::header(),
        problem: ProblemReference::new(&problem),
        folder: folder.display().to_string(),
        dwell_s: motion.dwell,
        speed_percent: 100.0 * motion.share,
        files: listed.collect(),
    })?;
    let names: Vec<&str> = named.iter().filter_map(|(name, _)| name.to_str()).collect();
    let mut said = format!("Written to {}: {}.", folder.display(), names.join(", "));
    if arguments.holds_tour() {
        said += &caution(&planned, path, program.home.is_some());
    }
    screen.text(&wrapped(&said))
}

/// What to heed before the robot moves along the tour of the plan at `path`.
fn caution(planned: &PlannedPoses, path: &Path, has_home: bool) -> String {
    let safe = match &planned.tour {
        Some(tour) if tour.blocked().next().is_some() => {
            format!(" NOT ALL MOVES ARE SAFE: see `tour.moves` in {}.", path.display())
        }
        Some(tour) if tour.moves.iter().all(|found| found.clearance_m.is_some()) => String::new(),
        _ => " The moves from pose to pose were not tested for collision.".to_owned(),
    };
    let start = if has_home { "home" } else { "the first pose" };
    format!(
        " Try them in simulation first, then at low speed with a hand on the stop.{safe} The way to {start} is not planned."
    )
}

/// The pairs of links that are not tested for collision.
fn untested(problem: &Problem) -> Vec<LinkPair> {
    let collision = Collision::new(&problem.robot, problem.clearance);
    let pairs = collision.links();
    [&pairs.adjacent, &pairs.disabled, &pairs.always].into_iter().flatten().copied().collect()
}

impl ExportArguments {
    /// Whether any of the files holds the tour.
    fn holds_tour(&self) -> bool {
        self.to.iter().any(|format| format.holds_tour())
    }

    /// The problem's settings with what the command line says instead.
    fn motion(&self, stated: &MotionSettings) -> Result<MotionSettings, Failure> {
        for (name, value) in [("--dwell-s", self.dwell), ("--speed-percent", self.speed)] {
            if value.is_some() && !self.holds_tour() {
                let formats: Vec<&str> = self.to.iter().map(|format| format.name()).collect();
                let formats = formats.join(", ");
                return Err(Failure::Usage(format!(
                    "{name} does not apply to {formats}, without times and speeds; leave it out"
                )));
            }
        }
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

/// The poses in the order of their tour and the turns between them, and where it begins, with the times of the moves.
fn stops(planned: &PlannedPoses, motion: &MotionSettings) -> (Vec<Stop>, Option<Home>) {
    let limits = motion.limits();
    let home = motion.home.as_ref();
    let poses = planned.in_order();
    let turns = |place: usize| {
        let moves = planned.tour.iter().filter_map(move |tour| tour.moves.get(place));
        moves.flat_map(|found| found.via_rad.iter().map(Vec::as_slice))
    };
    let stop = |label: String, q: &[f64], picture| Stop { label, q: q.to_vec(), seconds: 0.0, picture };
    let mut stops: Vec<Stop> = Vec::new();
    for (place, pose) in poses.iter().enumerate() {
        // Without a home no move leads to the first pose.
        let way = if home.is_some() { Some(place) } else { place.checked_sub(1) };
        stops.extend(way.into_iter().flat_map(turns).map(|q| stop(format!("way to pose {}", pose.id), q, false)));
        stops.push(stop(format!("pose {}", pose.id), &pose.joints_rad, true));
    }
    let returns = home.filter(|home| home.returns);
    stops.extend(returns.iter().flat_map(|_| turns(poses.len())).map(|q| stop("way home".to_owned(), q, false)));
    let mut from = home.map(|home| home.q.clone());
    for stop in &mut stops {
        stop.seconds = from.map_or(0.0, |from| duration(&from, &stop.q, &limits));
        from = Some(stop.q.clone());
    }
    let back = returns.and_then(|home| Some(duration(&from?, &home.q, &limits)));
    (stops, home.map(|home| Home { q: home.q.clone(), back }))
}
