//! A plan read back, with the problem it was made for.

use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::failure::Failure;
use super::screen::Screen;
use crate::plan::{Chooser, Plan, RecallError, Survey, candidates};
use crate::problem::Problem;

/// A plan and its problem.
pub(super) struct Planned {
    pub(super) plan: Plan,
    pub(super) problem: Problem,
}

impl Planned {
    /// Reads the plan at `path` and its problem: `problem` if given, else the file that `run.json` beside the plan names.
    pub(super) fn read(path: &Path, problem: Option<&Path>) -> Result<Self, Failure> {
        let refused = |reason: String| Failure::PlanFile { path: path.to_owned(), reason };
        let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
        let plan = Plan::from_json(&text).map_err(|error| refused(error.to_string()))?;
        let problem_path = problem
            .map(Path::to_owned)
            .or_else(|| named_by_run(path))
            .ok_or_else(|| refused("no run.json beside it tells the problem file; name it with --problem".into()))?;
        let mut problem = Problem::read(&problem_path)?;
        if problem.sha256 != plan.problem.sha256 {
            return Err(refused(format!(
                "it was made from another version of {}; make a new plan, or name the old file with --problem",
                problem_path.display()
            )));
        }
        // The hash is of the problem file alone; a camera file that it names may have changed.
        let nominal: Vec<f64> = problem.estimated.iter().map(|&i| problem.camera.intrinsics()[i]).collect();
        if plan.intrinsics.nominal != nominal {
            return Err(refused("it was made for another nominal camera; make a new plan".into()));
        }
        let dof = problem.robot.chain.dof();
        if plan.poses.is_empty() || plan.poses.iter().any(|pose| pose.joints_rad.len() != dof) {
            return Err(refused(format!("its poses do not have the robot's {dof} joint values")));
        }
        // Nor is it of a robot's description: every pose must still be where the plan has it.
        let moved = plan.poses.iter().any(|pose| {
            let X_BC = problem.robot.camera_pose(&pose.joints_rad);
            let [x, y, z] = pose.camera_in_base.position_m;
            let [i, j, k, w] = pose.camera_in_base.quaternion_xyzw;
            let planned = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
            !((X_BC.translation.vector - Vector3::new(x, y, z)).norm() < 1e-9
                && X_BC.rotation.angle_to(&planned) < 1e-7)
        });
        if moved {
            return Err(refused(
                "its joint values lead elsewhere than it says: the robot was changed, or the plan; make a new plan"
                    .into(),
            ));
        }
        // The command line may have asked for something else than the file; candidates are refined for what was asked.
        if let Some(criteria) = plan.criteria() {
            problem.selection.criteria = criteria;
            problem.selection.count = plan.count;
        }
        problem.selection.seed = plan.seed;
        Ok(Self { plan, problem })
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
