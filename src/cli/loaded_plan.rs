//! A plan read back, with the problem it was made for.

use std::path::{Path, PathBuf};

use super::long_work::sweeping;
use super::output::Screen;
use super::output::failure::Failure;
use crate::formats::read_at_most;
use crate::plan::assess::LocateError;
use crate::plan::choose::{Chooser, refined_survey};
use crate::plan::document::{Plan, Run};
use crate::plan::results::{check_results, hold_to_read};
use crate::plan::survey::Survey;
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
        let fitted = loaded.plan.fit(&loaded.problem);
        fitted.map_err(|error| Failure::PlanFile { path: path.to_owned(), reason: error.to_string() })?;
        Ok(loaded)
    }

    /// As [`LoadedPlan::read`], but whatever is beside the plan, and whether it fits its problem or not.
    pub(crate) fn open(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        let refused = |reason: String| Failure::PlanFile { path: path.to_owned(), reason };
        let held = hold_to_read(path);
        let text = read_at_most(path, LARGEST).map_err(|error| refused(error.to_string()))?;
        let text = String::from_utf8(text).map_err(|_| refused("it is not UTF-8 text".into()))?;
        let mixed = check_results(path);
        drop(held);
        let plan = Plan::from_json(&text).map_err(|error| refused(error.to_string()))?;
        let problem_path = problem.map(Path::to_owned).or_else(|| named_by_run(path)).ok_or_else(|| {
            refused("no run.json beside it names the problem file; name it with --problem FILE".into())
        })?;
        let overrides = plan.problem.overrides().map_err(|error| refused(error.to_string()))?;
        if problem.is_none() && !problem_path.exists() {
            let path = problem_path.display();
            return Err(refused(format!(
                "run.json beside it names the problem file {path}, which does not exist; say where it is with --problem FILE"
            )));
        }
        let problem = Problem::read_with(&problem_path, &overrides)?;
        if problem.sha256 != plan.problem.sha256 {
            let path = problem_path.display();
            return Err(refused(if problem.name == plan.problem.name {
                format!(
                    "it was made from another version of {path}; make a new plan, or name the old file with --problem"
                )
            } else {
                format!("it is a plan for \"{}\", but {path} describes \"{}\"", plan.problem.name, problem.name)
            }));
        }
        Ok(Self { plan, problem, text, mixed })
    }

    /// That the plan at `path` and the files beside it are of one run, those of `except` aside.
    pub(crate) fn among_its_own(&self, path: &Path, except: &[&str]) -> Result<(), Failure> {
        let files: Vec<String> = self.mixed.iter().filter(|name| !except.contains(&name.as_str())).cloned().collect();
        if files.is_empty() { Ok(()) } else { Err(Failure::Mixed { path: path.to_owned(), files }) }
    }

    /// Surveys the problem anew.
    pub(crate) fn survey(&self, screen: &Screen) -> Result<Survey, Failure> {
        Ok(sweeping(screen, &self.problem, |observe| refined_survey(&self.problem, observe))?)
    }

    /// The chooser that made the plan read from `path`, and the plan's poses among the survey's views.
    pub(crate) fn locate<'a>(&'a self, path: &Path, survey: &'a Survey) -> Result<(Chooser<'a>, Vec<usize>), Failure> {
        self.plan.locate(&self.problem, survey).map_err(|error| match error {
            LocateError::Plan(error) => error.into(),
            refused => Failure::PlanFile { path: path.to_owned(), reason: refused.to_string() },
        })
    }
}

fn named_by_run(plan: &Path) -> Option<PathBuf> {
    Run::read(plan.parent().unwrap_or(Path::new("")))?.problem.file
}
