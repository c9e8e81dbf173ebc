//! `calipose report`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::cli::interrupt::writing;
use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::cli::own_files::bears;
use crate::formats::read_at_most;
use crate::plan::assess::{ExplainSettings, explain, review};
use crate::plan::choose::Chooser;
use crate::plan::document::{
    CalibrationDocument, ComparisonDocument, DesignDocument, DiffDocument, Document, Explanation, Header, Plan, Review,
    StudyDocument, Verification,
};
use crate::plan::results::{add_results, probe, write_atomically};
use crate::problem::Method;
use crate::report::{
    PAGE_MARK, PlanDocuments, calibration_page, comparison_page, design_page, diff_page, plan_page, study_page,
    verification_page,
};

#[derive(Debug, Args)]
pub(crate) struct ReportArguments {
    /// plan.json, verification.json, calibration.json, study.json, design.json, or what `calipose verify`, `compare`, `diff` or `calibrate` printed with --json
    document: PathBuf,
    /// Problem file of a plan [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
}

/// Name of a plan's report.
pub(super) const REPORT_FILE: &str = "report.html";

/// Bytes of a document; a larger file is something else.
const LARGEST: u64 = 1_000_000_000;

pub(crate) fn run(arguments: &ReportArguments, screen: &mut Screen) -> Result<(), Failure> {
    let path = &arguments.document;
    // What is no document is told by what reads plans.
    let format = Opened::read(path).map(|opened| opened.format);
    match format.as_deref() {
        Some(Verification::FORMAT) => of::<Verification>(path, verification_page, screen),
        Some(ComparisonDocument::FORMAT) => of::<ComparisonDocument>(path, comparison_page, screen),
        Some(DiffDocument::FORMAT) => of::<DiffDocument>(path, diff_page, screen),
        Some(CalibrationDocument::FORMAT) => of::<CalibrationDocument>(path, calibration_page, screen),
        Some(StudyDocument::FORMAT) => of::<StudyDocument>(path, study_page, screen),
        Some(DesignDocument::FORMAT) => of::<DesignDocument>(path, design_page, screen),
        Some(other) if other.starts_with("calipose.") && other != Plan::FORMAT => Err(Failure::Document {
            path: path.clone(),
            reason: format!(
                "its key `format` is \"{other}\"; pages are made of {}, {}, {}, {}, {}, {} and {}",
                Plan::FORMAT,
                Verification::FORMAT,
                ComparisonDocument::FORMAT,
                DiffDocument::FORMAT,
                CalibrationDocument::FORMAT,
                StudyDocument::FORMAT,
                DesignDocument::FORMAT
            ),
        }),
        _ => of_plan(arguments, screen),
    }
}

/// What a document says of itself.
#[derive(Deserialize)]
struct Opened {
    format: String,
}

impl Opened {
    fn read(path: &Path) -> Option<Self> {
        serde_json::from_slice(&read_at_most(path, LARGEST).ok()?).ok()
    }
}

/// Writes the page of a document that stands alone beside it, under its name.
fn of<D: Document + DeserializeOwned>(path: &Path, page: fn(&D) -> String, screen: &mut Screen) -> Result<(), Failure> {
    let refused = |reason: String| Failure::Document { path: path.to_owned(), reason };
    let bytes = read_at_most(path, LARGEST).map_err(|error| refused(error.to_string()))?;
    let header: Header = serde_json::from_slice(&bytes).map_err(|error| refused(error.to_string()))?;
    if header.version != D::VERSION {
        return Err(refused(format!(
            "it is of version {} of {}, and this calipose reads version {}; make it again",
            header.version,
            D::FORMAT,
            D::VERSION
        )));
    }
    let document: D = serde_json::from_slice(&bytes).map_err(|error| refused(error.to_string()))?;
    let target = path.with_extension("html");
    write_page(&target, &page(&document))?;
    screen.document(&document)?;
    screen.text(&format!("Written to {}.", target.display()))
}

/// Writes a page to `target`, if what is there is none, or one that this program wrote.
pub(super) fn write_page(target: &Path, page: &str) -> Result<(), Failure> {
    if target.symlink_metadata().is_ok() && !bears(target, PAGE_MARK) {
        return Err(Failure::Exists(target.to_owned()));
    }
    Ok(writing(|| write_atomically(target, page.as_bytes()))?)
}

fn of_plan(arguments: &ReportArguments, screen: &mut Screen) -> Result<(), Failure> {
    let path = &arguments.document;
    let loaded = LoadedPlan::read_to_add(path, arguments.problem.as_deref(), &[REPORT_FILE])?;
    let folder = path.parent().unwrap_or(Path::new(""));
    probe(folder)?;
    let survey = loaded.survey(path, screen)?;
    let (chooser, selected) = loaded.locate(path, &survey)?;
    let reported = Reported::beside(path, &loaded.plan, &chooser, &selected)?;
    let page = plan_page(&reported.documents(&loaded.plan)?);
    writing(|| add_results(path, loaded.text.as_bytes(), None, &[(REPORT_FILE, page.into_bytes())]))?;
    screen.document(&reported.review)?;
    screen.text(&format!("Written to {}.", folder.join(REPORT_FILE).display()))
}

/// Spares listed for each pose.
const SPARES: usize = 3;

/// What a plan's report and figures are made of, beside the plan.
pub(super) struct Reported {
    review: Review,
    explanation: Explanation,
    verification: Option<Verification>,
}

impl Reported {
    /// Of `plan`, whose poses are the views `selected` of the chooser's survey.
    pub(super) fn new(
        plan: &Plan,
        chooser: &Chooser,
        selected: &[usize],
        verification: Option<Verification>,
    ) -> Result<Self, Failure> {
        // The review has a curve of its own.
        let settings = ExplainSettings { most: 0, spares: SPARES };
        let explanation = explain(chooser.problem(), chooser, selected, &settings, &|_| {})?;
        Ok(Self { review: review(plan, chooser, selected)?, explanation, verification })
    }

    /// With the verification that is beside the plan at `path`, if there is one.
    pub(super) fn beside(path: &Path, plan: &Plan, chooser: &Chooser, selected: &[usize]) -> Result<Self, Failure> {
        let verification = Verification::read(path.parent().unwrap_or(Path::new("")), plan);
        Self::new(plan, chooser, selected, verification)
    }

    /// Map error of as many poses by k-means on joints, in px.
    pub(super) fn of_kmeans_on_joints(&self) -> Option<f64> {
        self.review.others.iter().find(|other| other.method == Method::KMeansJoints.name())?.map_error_px
    }

    pub(super) fn documents<'a>(&'a self, plan: &'a Plan) -> Result<PlanDocuments<'a>, Failure> {
        let Self { review, explanation, verification } = self;
        Ok(PlanDocuments::new(plan, review, explanation, verification.as_ref())?)
    }
}
