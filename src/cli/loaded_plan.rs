//! A plan read back, with the problem it was made for.

use std::path::{Path, PathBuf};

use super::long_work::sweeping;
use super::output::Screen;
use super::output::failure::Failure;
use crate::formats::read_at_most;
use crate::plan::assess::LocateError;
use crate::plan::choose::{Chooser, refined_survey};
use crate::plan::document::{Plan, PlannedPoses, ProblemReference, Run};
use crate::plan::results::{check_results, hold_to_read};
use crate::plan::survey::{NoView, Survey};
use crate::problem::Problem;

/// Bytes of a plan; a larger file is something else.
const LARGEST: u64 = 100_000_000;

/// A plan and its problem.
pub(crate) struct LoadedPlan {
    pub(crate) plan: Plan,
    pub(crate) problem: Problem,
    /// The plan's text.
    pub(crate) text: String,
    /// Names of the files beside it that are not of the run that wrote it.
    mixed: Vec<String>,
}

impl LoadedPlan {
    /// Reads the plan at `path` and its problem: `problem` if given, else the file that `run.json` beside the plan names. The
    /// plan must be of the problem's robot and camera, and among files of its own run.
    pub(crate) fn read(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        Self::read_to_add(path, problem, &[])
    }

    /// As [`LoadedPlan::read`], to write the `files` beside the plan, whatever is there under their names.
    pub(crate) fn read_to_add(path: &Path, problem: Option<&Path>, files: &[&str]) -> Result<Self, Failure> {
        let loaded = Self::open(path, problem)?;
        loaded.among_its_own(path, files)?;
        loaded.plan.fit(&loaded.problem).map_err(|error| refused(path, error.to_string()))?;
        Ok(loaded)
    }

    /// As [`LoadedPlan::read`], but whatever is beside the plan, and whether it fits its problem or not.
    pub(crate) fn open(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        let (text, mixed) = read_text(path)?;
        let plan = Plan::from_json(&text).map_err(|error| refused(path, error.to_string()))?;
        let problem = problem_of(path, &plan.problem, problem)?;
        Ok(Self { plan, problem, text, mixed })
    }

    /// That the plan at `path` and the files beside it are of one run, those of `except` aside.
    pub(crate) fn among_its_own(&self, path: &Path, except: &[&str]) -> Result<(), Failure> {
        among_its_own(path, &self.mixed, except)
    }

    /// Surveys the problem of the plan read from `path` anew.
    pub(crate) fn survey(&self, path: &Path, screen: &Screen) -> Result<Survey, Failure> {
        let mut survey = sweeping(screen, &self.problem, |observe| refined_survey(&self.problem, observe))?;
        survey.take_off_grid(&self.problem, &self.plan.off_grid).map_err(|NoView { place }| {
            refused(path, format!("number {} of the views off the grid that it was made from is none", place + 1))
        })?;
        Ok(survey)
    }

    /// The chooser that made the plan read from `path`, and the plan's poses among the survey's views.
    pub(crate) fn locate<'a>(&'a self, path: &Path, survey: &'a Survey) -> Result<(Chooser<'a>, Vec<usize>), Failure> {
        self.plan.locate(&self.problem, survey).map_err(|error| match error {
            LocateError::Plan(error) => error.into(),
            error => refused(path, error.to_string()),
        })
    }
}

/// The poses of a plan, on the grid or polished, and their problem.
pub(crate) struct LoadedPoses {
    pub(crate) planned: PlannedPoses,
    pub(crate) problem: Problem,
}

impl LoadedPoses {
    /// Reads the poses at `path` as [`LoadedPlan::read`] reads a plan.
    pub(crate) fn read(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        let (text, mixed) = read_text(path)?;
        let planned = PlannedPoses::from_json(&text).map_err(|error| refused(path, error.to_string()))?;
        let problem = problem_of(path, &planned.problem, problem)?;
        among_its_own(path, &mixed, &[])?;
        planned.fit(&problem).map_err(|error| refused(path, error.to_string()))?;
        Ok(Self { planned, problem })
    }
}

fn refused(path: &Path, reason: String) -> Failure {
    Failure::PlanFile { path: path.to_owned(), reason }
}

/// The plan at `path`, whatever its problem.
pub(crate) fn read_plan(path: &Path) -> Result<Plan, Failure> {
    let (text, mixed) = read_text(path)?;
    let plan = Plan::from_json(&text).map_err(|error| refused(path, error.to_string()))?;
    among_its_own(path, &mixed, &[])?;
    Ok(plan)
}

/// The plan's text, and the names of the files beside it that are not of the run that wrote it.
fn read_text(path: &Path) -> Result<(String, Vec<String>), Failure> {
    let held = hold_to_read(path);
    let text = read_at_most(path, LARGEST).map_err(|error| refused(path, error.to_string()))?;
    let text = String::from_utf8(text).map_err(|_| refused(path, "it is not UTF-8 text".into()))?;
    let mixed = check_results(path);
    drop(held);
    Ok((text, mixed))
}

/// The problem to which the plan at `path` refers by `reference`: in the file `problem`, else in that which `run.json` names.
fn problem_of(path: &Path, reference: &ProblemReference, problem: Option<&Path>) -> Result<Problem, Failure> {
    let refused = |reason: String| refused(path, reason);
    let problem_path = problem
        .map(Path::to_owned)
        .or_else(|| named_by_run(path))
        .ok_or_else(|| refused("no run.json beside it names the problem file; name it with --problem FILE".into()))?;
    let overrides = reference.overrides().map_err(|error| refused(error.to_string()))?;
    if problem.is_none() && !problem_path.exists() {
        let path = problem_path.display();
        return Err(refused(format!(
            "run.json beside it names the problem file {path}, which does not exist; say where it is with --problem FILE"
        )));
    }
    let problem = Problem::read_with(&problem_path, &overrides)?;
    if problem.sha256 != reference.sha256 {
        let path = problem_path.display();
        return Err(refused(if problem.name == reference.name {
            format!("it was made from another version of {path}; make a new plan, or name the old file with --problem")
        } else {
            format!("it is a plan for \"{}\", but {path} describes \"{}\"", reference.name, problem.name)
        }));
    }
    Ok(problem)
}

/// That the plan at `path` and the files beside it are of one run: none is `mixed` in, those of `except` aside.
fn among_its_own(path: &Path, mixed: &[String], except: &[&str]) -> Result<(), Failure> {
    let files: Vec<String> = mixed.iter().filter(|name| !except.contains(&name.as_str())).cloned().collect();
    if files.is_empty() { Ok(()) } else { Err(Failure::Mixed { path: path.to_owned(), files }) }
}

fn named_by_run(plan: &Path) -> Option<PathBuf> {
    Run::read(plan.parent().unwrap_or(Path::new("")))?.problem.file
}
