//! `calipose next`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::calibration::{CalibrationSettings, calibrate};
use crate::cli::interrupt::writing;
use crate::cli::known::{known_by, read_detections};
use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::long_work::sweeping;
use crate::cli::output::collision::untested_text;
use crate::cli::output::failure::Failure;
use crate::cli::output::pose_table::pose_table;
use crate::cli::output::verdict::Verdict;
use crate::cli::output::{Screen, short, table};
use crate::plan::assess::{Proposal, Request, next};
use crate::plan::document::{Document, EstimatedIntrinsics};
use crate::plan::results::{add_results, probe};

/// Nine of ten map errors are below this multiple of the expected RMS, as long as linearisation holds: 1.645, or less.
const MORE_THAN_EXPECTED: f64 = 2.0;

#[derive(Debug, Args)]
pub(crate) struct NextArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// File of corners detected in the views taken so far: mrcal's vnl, or calipose's JSON
    observations: PathBuf,
    /// Problem file [default: the one named in run.json beside the plan]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Number of poses to propose
    #[arg(long, short = 'k', default_value_t = 1, conflicts_with = "map_error")]
    count: usize,
    /// Propose the fewest poses that bring the expected map error down to this, in px
    #[arg(long = "map-error-px", value_name = "PX")]
    map_error: Option<f64>,
    /// Leave out poses that would show the board where a view already taken does
    #[arg(long)]
    new: bool,
    /// Use only images whose names match, with `*` for any text, as in '*cam0*'
    #[arg(long, value_name = "PATTERN")]
    images: Option<String>,
    /// Maximum number of poses to propose for --map-error-px
    #[arg(long, default_value_t = 30)]
    most: usize,
}

impl NextArguments {
    fn request(&self) -> Result<Request, Failure> {
        let refused = |what: &str| Err(Failure::Usage(what.into()));
        match self.map_error {
            Some(map_error) if !(map_error > 0.0 && map_error.is_finite()) => {
                refused("--map-error-px must be positive")
            }
            Some(_) if self.most == 0 => refused("--most must be at least 1"),
            Some(map_error) => Ok(Request::Accuracy { map_error, most: self.most }),
            None if self.count == 0 => refused("--count must be at least 1"),
            None => Ok(Request::Count(self.count)),
        }
    }
}

/// What is written beside the plan; what was there before is of no account.
const FILES: [&str; 2] = ["next.json", "next.csv"];

pub(crate) fn run(arguments: &NextArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let request = arguments.request()?;
    let loaded = LoadedPlan::read_to_add(&arguments.plan, arguments.problem.as_deref(), &FILES)?;
    let LoadedPlan { plan, problem, text, .. } = loaded;
    let folder = arguments.plan.parent().unwrap_or(Path::new(""));
    probe(folder)?;
    let path = &arguments.observations;
    let detections = read_detections(path, &known_by(&problem, arguments.images.clone()))?;
    let settings =
        CalibrationSettings { noise: problem.noise.model, warp: problem.target.warp, ..CalibrationSettings::default() };
    let calibration =
        calibrate(&detections.observations, &problem.camera, &problem.estimated, &settings).map_err(|error| {
            Failure::Calibration {
                error: Box::new(error),
                path: path.clone(),
                names: detections.names.clone(),
                fits: None,
            }
        })?;
    let proposed = sweeping(screen, &problem, |observe| {
        next(&problem, &detections.observations, &calibration, request, arguments.new, observe)
    });
    let proposal = proposed?;

    let document = proposal.document(&plan, &calibration, &detections.names);
    let table_of_poses = proposal.to_csv(&problem).map_err(|error| Failure::Table(error.to_string()))?;
    let [document_name, table_name] = FILES;
    let files = [(table_name, table_of_poses), (document_name, document.to_json().into_bytes())];
    writing(|| add_results(&arguments.plan, text.as_bytes(), None, &files))?;
    screen.document(&document)?;
    let EstimatedIntrinsics { names, values, sigma } = &document.intrinsics;
    let rows: Vec<Vec<String>> =
        (0..names.len()).map(|i| vec![names[i].clone(), short(values[i]), short(sigma[i])]).collect();
    let known = format!(
        "{}: {} views taken.\n\n{}\n\nMap error after these views: {} px.",
        plan.problem.name,
        detections.names.len(),
        table(&["intrinsic", "estimate", "sigma"], &rows),
        short(proposal.known),
    );
    if proposal.poses.is_empty() {
        screen.text(&format!("{known} This is enough; no more poses are needed."))?;
        return Ok(Verdict::Good);
    }
    let one = proposal.poses.len() == 1;
    let bring = match (document.pictures, one) {
        (1, true) => "pose brings".to_owned(),
        (1, false) => "poses bring".to_owned(),
        (pictures, true) => format!("pose, with {pictures} pictures, brings"),
        (pictures, false) => format!("poses, with {pictures} pictures each, bring"),
    };
    let mut text = format!(
        "{known}\n{} more {bring} it to {} px:\n\n{}",
        proposal.poses.len(),
        short(proposal.expected),
        pose_table(&problem, &proposal.poses.iter().collect::<Vec<_>>()),
    );
    text += &simulated(&proposal);
    text += &repeated(&document.repeats);
    if !proposal.fulfilled {
        text += &format!(
            "\n{} poses do not bring it down to {} px; allow more with --most.",
            proposal.poses.len(),
            short(arguments.map_error.unwrap_or_default()),
        );
    }
    text += &untested_text(&problem).map(|line| format!("\n{line}")).unwrap_or_default();
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    screen.text(&format!("{text}\n\nWritten to {}: next.json, next.csv.", folder.display()))?;
    Ok(Verdict::good_if(proposal.fulfilled))
}

/// What the simulation adds to the expectation.
fn simulated(proposal: &Proposal) -> String {
    let Some(simulated) = proposal.rehearsal else {
        return "\nThe views taken so far are too few to simulate what the next ones bring; take these, and run `next` again."
            .into();
    };
    let (median, most) = (short(simulated.median), short(simulated.percentile_90));
    let mut text = format!(
        "\nIn simulated calibrations, with cameras drawn from what is known, its median is {median} px, and it is below \
         {most} px in nine of ten."
    );
    if simulated.failed > 0 {
        text += &format!(" {} of {} calibrations failed.", simulated.failed, simulated.trials);
    }
    if simulated.percentile_90 > MORE_THAN_EXPECTED * proposal.expected {
        text += " So little is known yet that the expectation above, linearised about the camera found so far, is too optimistic: \
                 take these poses, and run `next` again.";
    }
    text
}

/// Which of the poses repeat a view, by the names of the views.
fn repeated(repeats: &[Option<String>]) -> String {
    let names: Vec<&str> = repeats.iter().flatten().map(String::as_str).collect();
    let which = match (names.len(), repeats.len()) {
        (0, _) => return String::new(),
        (1, 1) => "It repeats a view".to_owned(),
        (1, all) => format!("1 of these {all} repeats a view"),
        (some, all) if some == all => format!("All {all} repeat views"),
        (some, all) => format!("{some} of these {all} repeat views"),
    };
    format!(
        "\n{which} taken already ({}): another picture there only averages noise. --new leaves such poses out.",
        names.join(", "),
    )
}
