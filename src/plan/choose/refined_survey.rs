//! The candidates to choose from: the survey's, and more around the poses that a first choice picks.

use super::chooser::Chooser;
use super::error::PlanError;
use crate::plan::survey::{Survey, join, spacings, survey};
use crate::problem::{Method, Problem};

/// Neighbours of the picks are tried within this many spacings of the swept configurations in the first round; in each
/// further round within half of that.
const SPACINGS: f64 = 1.0;

/// Poses picked where their number is not asked for.
pub(crate) const PICKS: usize = 10;

/// The survey of `problem`, and as many rounds of refinement as it asks for: exchange picks poses by the problem's criteria,
/// and configurations around the picks that are views join the candidates. `observe` as in [`survey`](crate::plan::survey::survey).
///
/// # Errors
/// When no candidate is left, or nothing can be picked.
pub fn refined_survey(problem: &Problem, observe: &(dyn Fn(usize) + Sync)) -> Result<Survey, PlanError> {
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::problem::{Overrides, Refinement};
    use crate::target::AxisCase;

    #[test]
    fn refined_candidates_are_views_near_the_picks_and_better_ones() {
        let step = Overrides::new().set("sweep.step_deg=15").unwrap();
        let mut problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &step).unwrap();
        let coarse = refined_survey(&problem, &|_| {}).unwrap();
        assert_eq!(coarse, survey(&problem, &|_| {}).unwrap());
        problem.refinement = Refinement { rounds: 2, sample: 600 };
        let refined = refined_survey(&problem, &|_| {}).unwrap();
        assert_eq!(refined.refined, 1200);
        let added = &refined.views[coarse.views.len()..];
        assert!(added.len() > 100 && refined.information.len() == refined.views.len());
        assert!(refined.views.windows(2).all(|pair| pair[0].id < pair[1].id));
        let checks = problem.checks();
        for view in added {
            assert_eq!(checks.view(view.id, &view.q).as_ref(), Ok(view));
            assert_ne!(view.axis_case(&problem.target), AxisCase::Outside);
        }
        let value = |survey: &Survey| Chooser::new(&problem, survey).unwrap().best(10, 0).unwrap().0.log_value;
        assert!(value(&refined) > value(&coarse) + 0.05);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(alone.install(|| refined_survey(&problem, &|_| {}).unwrap()), refined);
    }
}
