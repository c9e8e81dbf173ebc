//! More candidates where they count: around poses that were picked.

use super::{Survey, SurveyError};
use crate::feasibility::View;
use crate::problem::Problem;
use crate::robot::Limits;
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
    let samples: Vec<HaltonSample> = picks.iter().map(|pick| HaltonSample::new(&around(pick), each)).collect();
    let checks = problem.checks();
    // Numbers go on after those of the swept configurations and of the rounds before.
    let first = problem.space.len() + survey.refined;
    let tried = each * samples.len();
    let view = |n: usize| -> Option<View> {
        let view = checks.view(first + n, samples[n / each].configuration(n % each)).ok()?;
        (problem.axis == AxisRule::Any || view.axis_case(&problem.target) != AxisCase::Outside).then_some(view)
    };
    let views: Vec<View> = (0..tried).into_par_iter().with_min_len(64).filter_map(view).collect();
    let board = &problem.target.board;
    let information = problem
        .measurement()
        .information_set(views.par_iter().map(|view| (&view.X_CT, &view.seen)))
        .ok_or(SurveyError::PoseUndetermined { board: board.to_string() })?;
    survey.information.append(&information);
    survey.views.extend(views);
    survey.refined += tried;
    Ok(())
}
