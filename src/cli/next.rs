//! `calipose next`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::collision::untested_text;
use super::failure::Failure;
use super::plan::pose_table;
use super::planned::Planned;
use super::screen::{Screen, short, table};
use super::verdict::Verdict;
use crate::calibration::{CalibrationSettings, calibrate};
use crate::formats::{Stated, read_detections_file};
use crate::plan::{Wish, next};

#[derive(Debug, Args)]
pub(super) struct NextArguments {
    /// Plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Detected corners of the views taken so far: mrcal's vnl, or calipose's JSON
    observations: PathBuf,
    /// Problem file [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Number of poses to propose
    #[arg(long, short = 'k', default_value_t = 1, conflicts_with = "map_error")]
    count: usize,
    /// Propose as few poses as bring the expected map error down to this, in px
    #[arg(long = "map-error-px", value_name = "PX")]
    map_error: Option<f64>,
    /// Most poses to propose for --map-error-px
    #[arg(long, default_value_t = 30)]
    most: usize,
}

impl NextArguments {
    fn wish(&self) -> Result<Wish, Failure> {
        let refused = |what: &str| Err(Failure::Usage(what.into()));
        match self.map_error {
            Some(map_error) if !(map_error > 0.0 && map_error.is_finite()) => {
                refused("--map-error-px must be positive")
            }
            Some(_) if self.most == 0 => refused("--most must be at least 1"),
            Some(map_error) => Ok(Wish::Accuracy { map_error, most: self.most }),
            None if self.count == 0 => refused("--count must be at least 1"),
            None => Ok(Wish::Count(self.count)),
        }
    }
}

pub(super) fn run(arguments: &NextArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let wish = arguments.wish()?;
    let Planned { plan, problem, .. } = Planned::read(&arguments.plan, arguments.problem.as_deref())?;
    let path = &arguments.observations;
    let stated =
        Stated { board: Some(problem.target.board), image: Some([problem.camera.width(), problem.camera.height()]) };
    let detections =
        read_detections_file(path, &stated).map_err(|error| Failure::Observations { path: path.clone(), error })?;
    let calibration =
        calibrate(&detections.observations, &problem.camera, &problem.estimated, &CalibrationSettings::default())
            .map_err(|error| Failure::Calibration { error, path: path.clone(), names: detections.names.clone() })?;
    let bar = screen.progress("sweeping", problem.space.len());
    let proposed = next(&problem, &calibration, wish, &|swept| bar.inc(swept as u64));
    bar.finish_and_clear();
    let proposal = proposed?;

    let names = problem.estimated_names();
    let θ: Vec<f64> = problem.estimated.iter().map(|&i| calibration.camera.intrinsics()[i]).collect();
    let σ: Vec<f64> = calibration.covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
    screen.document(
        &json!({
            "format": "calipose.next",
            "version": 1,
            "problem": { "name": plan.problem.name, "sha256": plan.problem.sha256 },
            "views": detections.names.len(),
            "intrinsics": { "names": names, "values": θ, "sigma": σ },
            "known_map_error_px": proposal.known,
            "expected_map_error_px": proposal.expected,
            "fulfilled": proposal.fulfilled,
            "joints": plan.joints,
            "poses": proposal.poses,
        })
        .to_string(),
    )?;
    let rows: Vec<Vec<String>> =
        (0..names.len()).map(|i| vec![names[i].to_owned(), short(θ[i]), short(σ[i])]).collect();
    let known = format!(
        "{}: {} views taken.\n\n{}\n\nMap error {} px by what they tell.",
        plan.problem.name,
        detections.names.len(),
        table(&["intrinsic", "estimate", "sigma"], &rows),
        short(proposal.known),
    );
    if proposal.poses.is_empty() {
        screen.text(&format!("{known} That is enough; no more poses are needed."))?;
        return Ok(Verdict::Good);
    }
    let verdict = match (proposal.fulfilled, arguments.map_error) {
        (true, _) => String::new(),
        (false, wished) => format!(
            "\n{} poses do not bring it down to {} px; allow more with --most.",
            proposal.poses.len(),
            short(wished.unwrap_or_default()),
        ),
    };
    screen.text(&format!(
        "{known}\n{} more, taken next, bring it to {} px:\n\n{}{verdict}{}",
        proposal.poses.len(),
        short(proposal.expected),
        pose_table(&problem, &proposal.poses),
        untested_text(&problem).map(|line| format!("\n{line}")).unwrap_or_default(),
    ))?;
    Ok(Verdict::good_if(proposal.fulfilled))
}
