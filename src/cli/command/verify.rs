//! `calipose verify`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::output::failure::Failure;
use crate::cli::output::verdict::Verdict;
use crate::cli::output::{Screen, short, table};
use crate::cli::trials;
use crate::plan::assess::verify;
use crate::plan::document::Verification;
use crate::problem::StatedDisturbance;
use crate::verification::{Disturbance, Judgement, MonteCarlo, Weighing};

#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one named in run.json beside the plan]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Number of simulated calibrations
    #[arg(long, short = 'n', default_value_t = 500, value_parser = trials())]
    trials: usize,
    /// Seed of the simulation
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Calibrate without weights, as OpenCV's calibrateCamera does, where the noise depends on the view
    #[arg(long)]
    unweighted: bool,
    #[command(flatten)]
    disturbance: DisturbanceArguments,
}

/// What the prediction leaves out.
#[derive(Debug, Args)]
#[command(next_help_heading = "What the prediction leaves out")]
struct DisturbanceArguments {
    /// Standard deviation of the error of the nominal focal lengths and principal point, in percent
    #[arg(long, default_value_t = 0.0, value_name = "PERCENT")]
    intrinsics_off: f64,
    /// Standard deviation of the error of every revolute joint, in degrees
    #[arg(long, default_value_t = 0.0, value_name = "DEG")]
    joint_noise: f64,
    /// Error of the camera mount's orientation, in degrees about each axis
    #[arg(long, default_value_t = 0.0, value_name = "DEG")]
    mount_rotation: f64,
    /// Error of the camera mount's position, in mm along each axis
    #[arg(long, default_value_t = 0.0, value_name = "MM")]
    mount_translation: f64,
    /// Growth of the noise with tilt: by this factor times (1/cos(tilt) - 1)
    #[arg(long, default_value_t = 0.0, value_name = "FACTOR")]
    noise_with_tilt: f64,
    /// Growth of the noise with distance: by this factor times (distance / distance of the nearest view - 1)
    #[arg(long, default_value_t = 0.0, value_name = "FACTOR")]
    noise_with_distance: f64,
    /// Share of the corners that are not detected, in percent
    #[arg(long, default_value_t = 0.0, value_name = "PERCENT")]
    missing: f64,
}

impl DisturbanceArguments {
    fn disturbance(&self) -> Result<Disturbance, Failure> {
        let mut stated = StatedDisturbance {
            intrinsics_off_percent: self.intrinsics_off,
            joint_noise_deg: self.joint_noise,
            mount_rotation_deg: self.mount_rotation,
            mount_translation_mm: self.mount_translation,
            noise_with_tilt: self.noise_with_tilt,
            noise_with_distance: self.noise_with_distance,
            missing_percent: self.missing,
        };
        for (name, value, most) in stated.numbers() {
            if !(0.0..=most).contains(value) {
                // The options leave the units to their help.
                let units = ["_percent", "_deg", "_mm"];
                let option = units.iter().fold(name, |name, unit| name.trim_end_matches(unit)).replace('_', "-");
                return Err(Failure::Usage(format!("--{option} is {value}; it must be from 0 to {most}")));
            }
        }
        Ok(stated.disturbance())
    }
}

pub(crate) fn run(arguments: &VerifyArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    if arguments.trials == 0 {
        return Err(Failure::Usage("--trials must be at least 2".into()));
    }
    let disturbance = arguments.disturbance.disturbance()?;
    let LoadedPlan { plan, problem, .. } = LoadedPlan::read(&arguments.plan, arguments.problem.as_deref())?;
    let bar = screen.progress("calibrating", arguments.trials);
    let configurations: Vec<Vec<f64>> = plan.poses.iter().map(|pose| pose.joints_rad.clone()).collect();
    let weighing = if arguments.unweighted { Weighing::Unweighted } else { Weighing::Weighted };
    let (trials, seed) = (arguments.trials, arguments.seed);
    let verified = verify(&problem, &configurations, &disturbance, weighing, trials, seed, &|_| bar.inc(1));
    bar.finish_and_clear();
    let found = verified?;
    let judgement = Judgement::new(&found);
    screen.document(&Verification::new(&plan, &found, &judgement, weighing, seed))?;
    let rows: Vec<Vec<String>> = found
        .parameters
        .iter()
        .map(|p| {
            vec![
                p.name.to_owned(),
                short(p.predicted_sigma),
                short(p.sampled_sigma),
                format!("{:.3}", p.ratio),
                format!("{:.3} - {:.3}", p.interval.0, p.interval.1),
                short(p.bias),
            ]
        })
        .collect();
    let header = ["intrinsic", "predicted sigma", "sampled sigma", "ratio", "99 % interval", "bias"];
    screen.text(&format!(
        "{}: {} poses, {} simulated calibrations.\n\n{}\n\nMap error: {} px predicted, {} px measured (standard error {}).\n{}\n{}",
        plan.problem.name,
        plan.count,
        found.count,
        table(&header, &rows),
        short(found.map_error.predicted),
        short(found.map_error.measured),
        short(found.map_error.standard_error),
        failures(&found),
        judgement,
    ))?;
    Ok(verdict(&judgement))
}

/// A plan is bad where it is known not to do what it predicts.
pub(crate) fn verdict(judgement: &Judgement) -> Verdict {
    Verdict::good_if(judgement.holds() != Some(false))
}

/// How many trials failed, and why.
fn failures(found: &MonteCarlo) -> String {
    if found.failures.is_empty() {
        return String::from("Every calibration converged.");
    }
    let mut reasons: Vec<(String, usize)> = Vec::new();
    for failure in &found.failures {
        let reason = failure.reason.to_string();
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, count)) => *count += 1,
            None => reasons.push((reason, 1)),
        }
    }
    reasons.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let lines: Vec<String> = reasons.iter().take(5).map(|(reason, count)| format!("  {count}: {reason}")).collect();
    format!("{} of {} calibrations failed:\n{}", found.failures.len(), found.count, lines.join("\n"))
}
