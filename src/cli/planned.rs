//! A plan read back, with the problem it was made for.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::screen::Screen;
use crate::plan::{Chooser, Plan, RecallError, Survey, candidates};
use crate::problem::Problem;

/// A plan and its problem.
pub(super) struct Planned {
    pub(super) plan: Plan,
    pub(super) problem: Problem,
    /// The plan's text.
    pub(super) text: String,
}

impl Planned {
    /// Reads the plan at `path` and its problem: `problem` if given, else the file that `run.json` beside the plan names. The
    /// plan must be of the problem's robot and camera.
    pub(super) fn read(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        let planned = Self::open(path, problem)?;
        let fitted = planned.plan.fit(&planned.problem);
        fitted.map_err(|error| Failure::PlanFile { path: path.to_owned(), reason: error.to_string() })?;
        Ok(planned.asked())
    }

    /// As [`Planned::read`], but whether the plan fits its problem is left open.
    pub(super) fn open(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        let refused = |reason: String| Failure::PlanFile { path: path.to_owned(), reason };
        let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
        let plan = Plan::from_json(&text).map_err(|error| refused(error.to_string()))?;
        let problem_path = problem
            .map(Path::to_owned)
            .or_else(|| named_by_run(path))
            .ok_or_else(|| refused("no run.json beside it tells the problem file; name it with --problem".into()))?;
        let problem = Problem::read(&problem_path)?;
        if problem.sha256 != plan.problem.sha256 {
            return Err(refused(format!(
                "it was made from another version of {}; make a new plan, or name the old file with --problem",
                problem_path.display()
            )));
        }
        Ok(Self { plan, problem, text })
    }

    /// The problem as it was when the plan was made: the command line may have asked for something else than the file, and
    /// candidates are refined for what was asked.
    pub(super) fn asked(mut self) -> Self {
        let selection = &mut self.problem.selection;
        if let Some(criteria) = self.plan.criteria() {
            selection.criteria = criteria;
            selection.count = self.plan.count;
        }
        selection.seed = self.plan.seed;
        self
    }

    /// Surveys the problem anew.
    pub(super) fn survey(&self, screen: &Screen) -> Result<Survey, Failure> {
        let bar = screen.progress("sweeping", self.problem.space.len());
        let surveyed = candidates(&self.problem, &|swept| bar.inc(swept as u64));
        bar.finish_and_clear();
        Ok(surveyed?)
    }

    /// The chooser that made the plan read from `path`, and the plan's poses among the survey's views.
    pub(super) fn recall<'a>(&'a self, path: &Path, survey: &'a Survey) -> Result<(Chooser<'a>, Vec<usize>), Failure> {
        self.plan.recall(&self.problem, survey).map_err(|error| match error {
            RecallError::Plan(error) => error.into(),
            refused => Failure::PlanFile { path: path.to_owned(), reason: refused.to_string() },
        })
    }
}

fn named_by_run(plan: &Path) -> Option<PathBuf> {
    let text = std::fs::read_to_string(plan.with_file_name("run.json")).ok()?;
    let run: serde_json::Value = serde_json::from_str(&text).ok()?;
    run["problem"]["file"].as_str().map(PathBuf::from)
}
