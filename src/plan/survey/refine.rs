//! More candidates where they count: around poses that were picked.

use std::ops::Range;

use super::scenarios::certain;
use super::{Survey, SurveyError};
use crate::feasibility::{Checks, View};
use crate::problem::Problem;
use crate::robot::{Limits, Resolution};
use crate::sweep::{AxisRule, HaltonSample, JointSpace};
use crate::target::AxisCase;

use rayon::prelude::*;

/// Distance of neighbouring configurations along each joint: the grid's step, or for a sample of n in d joints the share
/// n^(−1/d) of the joint's range.
pub(crate) fn spacings(problem: &Problem) -> Vec<f64> {
    match &problem.space {
        JointSpace::Grid(grid) => grid.steps(),
        JointSpace::Sample(sample) => {
            let limits = sample.limits();
            let share = (problem.space.len() as f64).powf(-1.0 / limits.len() as f64);
            limits.iter().map(|limits| share * (limits.max - limits.min)).collect()
        }
    }
}

/// Configurations that are tried in a row, at most.
const ROW: usize = 64;

/// Tries configurations within `radii` of the picks, evenly among them, and adds those that are views.
pub(crate) fn join(
    problem: &Problem,
    survey: &mut Survey,
    picks: &[Vec<f64>],
    radii: &[f64],
) -> Result<(), SurveyError> {
    let joints = &problem.robot.chain.joints;
    let around = |pick: &Vec<f64>| {
        let box_of = |((q, joint), radius): ((&f64, &crate::robot::Joint), &f64)| Limits {
            min: (q - radius).max(joint.limits.min),
            max: (q + radius).min(joint.limits.max),
        };
        pick.iter().zip(joints).zip(radii).map(box_of).collect::<Vec<_>>()
    };
    let each = problem.refinement.sample / picks.len().max(1);
    let told: Vec<Resolution> = joints.iter().map(|joint| joint.resolution).collect();
    let sample = |pick| JointSpace::Sample(HaltonSample::new(&around(pick), each)).told(told.clone());
    let samples: Vec<JointSpace> = picks.iter().map(sample).collect();
    let checks = problem.checks();
    // Numbers go on after those of the swept configurations and of the rounds before.
    let first = problem.space.len() + survey.refined;
    let tried = each * samples.len();
    let views_of = |(pick, points): (usize, Range<usize>)| {
        let mut views: Vec<View> = vec![];
        samples[pick].visit(points, |n, q| {
            let Ok(view) = checks.view(first + pick * each + n, q) else { return };
            if problem.axis == AxisRule::Any || view.axis_case(&problem.target) != AxisCase::Outside {
                views.push(view);
            }
        });
        views
    };
    let rows = |pick| (0..each).step_by(ROW).map(move |start| (pick, start..each.min(start + ROW)));
    let rows: Vec<(usize, Range<usize>)> = (0..samples.len()).flat_map(rows).collect();
    let views: Vec<View> = rows.into_par_iter().flat_map_iter(views_of).collect();
    survey.append(Survey::of(problem, certain(problem, views))?);
    survey.refined += tried;
    Ok(())
}

/// Joint values that should give a view give none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoView {
    /// Which of the configurations.
    pub place: usize,
}

impl Survey {
    /// Adds the views from joint values off the grid, in their order; those that the survey has already, or that are none in as many
    /// of the set-ups as the problem demands, are left out.
    ///
    /// # Errors
    /// When a view's pose is not determined by its own corners.
    pub(crate) fn add_off_grid(&mut self, problem: &Problem, configurations: &[Vec<f64>]) -> Result<(), SurveyError> {
        let checks = problem.checks();
        let mut views: Vec<View> = Vec::new();
        let known = self.views.par_iter().filter(|view| configurations.contains(&view.q));
        let known: Vec<&[f64]> = known.map(|view| view.q.as_slice()).collect();
        for q in configurations {
            let is_known =
                known.iter().copied().chain(views.iter().map(|view| view.q.as_slice())).any(|known| known == q);
            if !is_known && let Some(view) = off_grid_view(problem, &checks, 0, q) {
                views.push(view);
            }
        }
        let mut views = certain(problem, views);
        let first = problem.space.len() + self.refined + self.off_grid;
        for (view, id) in views.iter_mut().zip(first..) {
            view.id = id;
        }
        self.off_grid += views.len();
        self.append(Survey::of(problem, views)?);
        Ok(())
    }

    /// Adds the views off the grid that a plan was made from, in their order; each of the configurations must be one.
    ///
    /// # Errors
    /// The first of the configurations that is not.
    pub fn take_off_grid(&mut self, problem: &Problem, configurations: &[Vec<f64>]) -> Result<(), NoView> {
        let checks = problem.checks();
        let first = problem.space.len() + self.refined;
        let is_view = |(i, q): (usize, &Vec<f64>)| {
            q.len() == problem.robot.chain.dof()
                && !configurations[..i].contains(q)
                && off_grid_view(problem, &checks, first + i, q).is_some()
        };
        let none = configurations.iter().enumerate().position(|entry| !is_view(entry));
        if let Some(place) = none {
            return Err(NoView { place });
        }
        let before = self.off_grid;
        let added = self.add_off_grid(problem, configurations);
        // Twice the same, or seen in too few of the set-ups.
        if added.is_err() || self.off_grid - before != configurations.len() {
            let has = |q: &Vec<f64>| self.off_grid_views().iter().any(|view| view.q == *q);
            return Err(NoView { place: configurations.iter().position(|q| !has(q)).unwrap_or(0) });
        }
        Ok(())
    }

    /// Puts the views of another survey of the same problem behind its own.
    pub(super) fn append(&mut self, found: Self) {
        self.information.append(&found.information);
        for (scenario, found) in self.scenarios.iter_mut().zip(&found.scenarios) {
            scenario.information.append(&found.information);
        }
        self.views.extend(found.views);
    }
}

/// The view from joint values that poses may have; `None` if they may not, or it is no view.
fn off_grid_view(problem: &Problem, checks: &Checks, id: usize, q: &[f64]) -> Option<View> {
    let ranges = problem.robot.pose_ranges();
    let mut joints = problem.robot.chain.joints.iter().zip(&ranges).zip(q);
    let settable = joints.all(|((joint, range), &q)| joint.resolution.nearest(q, range) == q && range.holds(q));
    let view = if settable { checks.view(id, q).ok()? } else { return None };
    (problem.axis == AxisRule::Any || view.axis_case(&problem.target) != AxisCase::Outside).then_some(view)
}
