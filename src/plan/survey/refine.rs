//! More candidates where they count: around poses that were picked.

use std::ops::Range;

use super::scenarios::certain;
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
    let samples: Vec<HaltonSample> = picks.iter().map(|pick| HaltonSample::new(&around(pick), each)).collect();
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
    let found = Survey::of(problem, certain(problem, views))?;
    survey.information.append(&found.information);
    for (scenario, found) in survey.scenarios.iter_mut().zip(&found.scenarios) {
        scenario.information.append(&found.information);
    }
    survey.views.extend(found.views);
    survey.refined += tried;
    Ok(())
}
