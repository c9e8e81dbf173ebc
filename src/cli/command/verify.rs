//! `calipose verify`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use crate::cli::loaded_plan::Planned;
use crate::cli::output::failure::Failure;
use crate::cli::output::verdict::Verdict;
use crate::cli::output::{Screen, short, table};
use crate::cli::trials;
use crate::plan::assess::verify;
use crate::plan::document::Plan;
use crate::verification::{Disturbance, MonteCarlo, deviation_interval};

#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// Plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Number of simulated calibrations
    #[arg(long, short = 'n', default_value_t = 500, value_parser = trials())]
    trials: usize,
    /// Seed of the simulation
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    disturbance: DisturbanceArguments,
}

/// What the prediction leaves out.
#[derive(Debug, Args)]
#[command(next_help_heading = "What the prediction leaves out")]
struct DisturbanceArguments {
    /// Nominal focal lengths and principal point off by this many percent (one standard deviation)
    #[arg(long, default_value_t = 0.0, value_name = "PERCENT")]
    intrinsics_off: f64,
    /// Standard deviation of every revolute joint, in degrees
    #[arg(long, default_value_t = 0.0, value_name = "DEG")]
    joint_noise: f64,
    /// Error of the camera mount's orientation, in degrees about each axis
    #[arg(long, default_value_t = 0.0, value_name = "DEG")]
    mount_rotation: f64,
    /// Error of the camera mount's position, in mm along each axis
    #[arg(long, default_value_t = 0.0, value_name = "MM")]
    mount_translation: f64,
    /// Noise grows by this factor times (1/cos(tilt) - 1)
    #[arg(long, default_value_t = 0.0, value_name = "FACTOR")]
    noise_with_tilt: f64,
    /// Noise grows by this factor times (distance / nearest view's distance - 1)
    #[arg(long, default_value_t = 0.0, value_name = "FACTOR")]
    noise_with_distance: f64,
    /// Share of the corners that go undetected, in percent
    #[arg(long, default_value_t = 0.0, value_name = "PERCENT")]
    missing: f64,
}

impl DisturbanceArguments {
    fn disturbance(&self) -> Result<Disturbance, Failure> {
        let named = [
            ("--intrinsics-off", self.intrinsics_off, 50.0),
            ("--joint-noise", self.joint_noise, 180.0),
            ("--mount-rotation", self.mount_rotation, 180.0),
            ("--mount-translation", self.mount_translation, 1e6),
            ("--noise-with-tilt", self.noise_with_tilt, 1e6),
            ("--noise-with-distance", self.noise_with_distance, 1e6),
            ("--missing", self.missing, 99.0),
        ];
        for (name, value, most) in named {
            if !(0.0..=most).contains(&value) {
                return Err(Failure::Usage(format!("{name} is {value}; it must be from 0 to {most}")));
            }
        }
        Ok(Disturbance {
            intrinsics: self.intrinsics_off / 100.0,
            joints: self.joint_noise.to_radians(),
            mount_rotation: self.mount_rotation.to_radians(),
            mount_translation: self.mount_translation / 1e3,
            noise_with_tilt: self.noise_with_tilt,
            noise_with_distance: self.noise_with_distance,
            missing: self.missing / 100.0,
        })
    }
}

pub(crate) fn run(arguments: &VerifyArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    if arguments.trials == 0 {
        return Err(Failure::Usage("--trials must be at least 2".into()));
    }
    let disturbance = arguments.disturbance.disturbance()?;
    let Planned { plan, problem, .. } = Planned::read(&arguments.plan, arguments.problem.as_deref())?;
    let bar = screen.progress("calibrating", arguments.trials);
    let configurations: Vec<Vec<f64>> = plan.poses.iter().map(|pose| pose.joints_rad.clone()).collect();
    let verified = verify(&problem, &configurations, &disturbance, arguments.trials, arguments.seed, &|_| bar.inc(1));
    bar.finish_and_clear();
    let found = verified?;
    screen.document(&document(&plan, &found, arguments.seed).to_string())?;
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
        judgement(&found).sentence,
    ))?;
    Ok(judgement(&found).verdict())
}

/// How many trials failed, and why.
pub(crate) fn failures(found: &MonteCarlo) -> String {
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

/// Fewer successful trials tell too little for a verdict: the interval of a ratio is wider than ±35 %.
const LEAST_TRIALS: usize = 30;

/// Failed trials listed in documents; more are only counted.
const LISTED_FAILURES: usize = 1000;

/// A greater share of failed trials is said in the verdict.
const MANY_FAILURES: f64 = 0.01;

/// What the trials say of the plan.
pub(crate) struct Judgement {
    /// Whether it does what it predicts; `None` if they are too few to tell.
    pub(crate) holds: Option<bool>,
    /// The same in words.
    pub(crate) sentence: String,
}

impl Judgement {
    pub(crate) fn verdict(&self) -> Verdict {
        Verdict::good_if(self.holds != Some(false))
    }
}

/// Judges the plan by its trials. The judgement as a whole errs once in a hundred plans that do as predicted: each of the p
/// intervals is taken at a confidence of 1 − 0.01/p.
pub(crate) fn judgement(found: &MonteCarlo) -> Judgement {
    let good = found.count - found.failures.len();
    let failed = found.failures.len() as f64 / found.count as f64;
    if good < LEAST_TRIALS {
        let (holds, sentence) = match good {
            0 => (Some(false), "Verdict: the plan does not lead to a calibration.".into()),
            _ if failed > 0.5 => (Some(false), format!("Verdict: {:.0} % of the calibrations fail.", 100.0 * failed)),
            _ => (None, format!("Verdict: none; {good} of {LEAST_TRIALS} calibrations that a verdict takes.")),
        };
        return Judgement { holds, sentence };
    }
    let (low, high) = deviation_interval(good, 1.0 - 0.01 / found.parameters.len() as f64);
    let worse: Vec<&str> = found.parameters.iter().filter(|p| p.ratio * low > 1.0).map(|p| p.name).collect();
    let better: Vec<&str> = found.parameters.iter().filter(|p| p.ratio * high < 1.0).map(|p| p.name).collect();
    let scatter = match (worse.is_empty(), better.is_empty()) {
        (true, true) => String::from("the plan does what it predicts; the scatter of every intrinsic agrees"),
        (true, false) => format!("the plan does better than predicted in {}", better.join(", ")),
        (false, _) => format!("the plan does worse than predicted in {}", worse.join(", ")),
    };
    let sentence = if failed > MANY_FAILURES {
        format!("Verdict: {:.0} % of the calibrations fail; of the others, {scatter}.", 100.0 * failed)
    } else {
        format!("Verdict: {scatter}.")
    };
    Judgement { holds: Some(worse.is_empty() && failed <= MANY_FAILURES), sentence }
}

/// The document of `--json`, and of `verification.json`.
pub(crate) fn document(plan: &Plan, found: &MonteCarlo, seed: u64) -> Value {
    let judgement = judgement(found);
    let parameters: Vec<Value> = found
        .parameters
        .iter()
        .map(|p| {
            json!({
                "name": p.name,
                "predicted_sigma": p.predicted_sigma,
                "sampled_sigma": p.sampled_sigma,
                "ratio": p.ratio,
                "ratio_interval": [p.interval.0, p.interval.1],
                "bias": p.bias,
            })
        })
        .collect();
    json!({
        "format": "calipose.verification",
        "version": 1,
        "problem": { "name": plan.problem.name, "sha256": plan.problem.sha256 },
        "count": plan.count,
        "trials": found.count,
        "seed": seed,
        "confidence": 0.99,
        "parameters": parameters,
        "map_error_px": {
            "predicted": found.map_error.predicted,
            "measured": found.map_error.measured,
            "standard_error": found.map_error.standard_error,
        },
        "rms_px": found.rms,
        "failed": found.failures.len(),
        "failures": found
            .failures
            .iter()
            .take(LISTED_FAILURES)
            .map(|failure| json!({ "trial": failure.trial, "reason": failure.reason.to_string() }))
            .collect::<Vec<_>>(),
        "holds": judgement.holds,
        "verdict": judgement.sentence,
    })
}
