//! More candidates where they count: around the poses that selection picks.

use super::{Survey, SurveyError, survey};
use crate::feasibility::View;
use crate::plan::choose::{Chooser, PlanError};
use crate::problem::Method;
use crate::problem::Problem;
use crate::robot::Limits;
use crate::sweep::{AxisRule, HaltonSample, JointSpace};
use crate::target::AxisCase;

use rayon::prelude::*;

/// Neighbours of the picks are tried within this many spacings of the swept configurations in the first round; in each
/// further round within half of that.
const SPACINGS: f64 = 1.0;

/// Poses picked where their number is not asked for.
pub(super) const PICKS: usize = 10;

/// The survey of `problem`, and as many rounds of refinement as it asks for: exchange picks poses by the problem's criteria,
/// and configurations around the picks that are views join the candidates. The certificate of a plan chosen from them holds
/// over all of them. `observe` as in [`survey`].
///
/// # Errors
/// When no candidate is left, or nothing can be picked.
pub fn candidates(problem: &Problem, observe: &(dyn Fn(usize) + Sync)) -> Result<Survey, PlanError> {
    let mut survey = survey(problem, observe)?;
    let mut radii: Vec<f64> = spacings(problem).iter().map(|spacing| SPACINGS * spacing).collect();
    for _ in 0..problem.refinement.rounds {
        let count = problem.selection.goal.count().unwrap_or(PICKS).min(survey.views.len());
        let chooser = Chooser::new(problem, &survey)?;
        // Where nothing can be picked there is nothing to refine; the selection itself says why.
        let Ok(picked) = chooser.choose(Method::Exchange, count, problem.selection.seed) else { break };
        let picked = picked.selected;
        let picks: Vec<Vec<f64>> = picked.iter().map(|&i| survey.views[i].q.clone()).collect();
        join(problem, &mut survey, &picks, &radii)?;
        for radius in &mut radii {
            *radius *= 0.5;
        }
    }
    Ok(survey)
}

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
pub(crate) fn join(problem: &Problem, survey: &mut Survey, picks: &[Vec<f64>], radii: &[f64]) -> Result<(), PlanError> {
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
        .ok_or(SurveyError::PoseUndetermined { columns: board.columns, rows: board.rows })?;
    survey.information.append(&information);
    survey.views.extend(views);
    survey.refined += tried;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::problem::{Overrides, Refinement};

    #[test]
    fn refined_candidates_are_views_near_the_picks_and_better_ones() {
        let step = Overrides::new().set("sweep.step_deg=15").unwrap();
        let mut problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &step).unwrap();
        let coarse = candidates(&problem, &|_| {}).unwrap();
        assert_eq!(coarse, survey(&problem, &|_| {}).unwrap());
        problem.refinement = Refinement { rounds: 2, sample: 600 };
        let refined = candidates(&problem, &|_| {}).unwrap();
        assert_eq!(refined.refined, 1200);
        let added = &refined.views[coarse.views.len()..];
        assert!(added.len() > 100 && refined.information.len() == refined.views.len());
        assert!(refined.views.windows(2).all(|pair| pair[0].id < pair[1].id));
        let checks = problem.checks();
        for view in added {
            assert_eq!(checks.view(view.id, view.q.clone()).as_ref(), Ok(view));
            assert_ne!(view.axis_case(&problem.target), AxisCase::Outside);
        }
        let value = |survey: &Survey| Chooser::new(&problem, survey).unwrap().best(10, 0).unwrap().0.log_value;
        assert!(value(&refined) > value(&coarse) + 0.05);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(alone.install(|| candidates(&problem, &|_| {}).unwrap()), refined);
    }
}
