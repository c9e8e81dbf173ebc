//! Better joint values near those of a view.

use std::cell::RefCell;
use std::collections::HashMap;

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;
use nalgebra::DVector;
use rand::Rng;
use rand_distr::StandardNormal;

use crate::feasibility::View;
use crate::plan::choose::constraints::allows;
use crate::plan::choose::objective::Objective;
use crate::plan::survey::{Scene, Survey};
use crate::problem::Problem;
use crate::robot::Limits;
use crate::sweep::JointSpace;

/// Iterations of the simplex method per joint; restarts do more than patience.
const ITERATIONS_PER_JOINT: u64 = 40;

/// The simplex has come to rest when the values at its vertices scatter less than this.
const TOLERANCE: f64 = 1e-8;

/// First step along a joint, as a share of the grid's step, and of the joint's range where the problem sweeps a sample.
const SHARE_OF_STEP: f64 = 0.5;
const SHARE_OF_RANGE: f64 = 0.02;

/// First steps of the tries from one place, as multiples: beside the border of what is seen a simplex may collapse, and another one,
/// opened the other way, gets on.
pub(crate) const TRIES: [f64; 2] = [1.0, -0.4];

/// What views are judged by, wherever they are.
pub(crate) struct LocalSearch<'a> {
    problem: &'a Problem,
    objective: &'a Objective<'a>,
    /// The set-up as stated, and the scenarios.
    scenes: Vec<Scene<'a>>,
    /// What poses may have of each joint.
    ranges: Vec<Limits>,
}

/// A view and its matrices, term after term of the objective.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) view: View,
    pub(crate) information: Vec<f64>,
}

impl<'a> LocalSearch<'a> {
    pub(crate) fn new(problem: &'a Problem, survey: &'a Survey, objective: &'a Objective<'a>) -> Self {
        Self { problem, objective, scenes: survey.scenes(problem), ranges: problem.robot.pose_ranges() }
    }

    /// A view of the survey; `None` if its corners do not fix what a criterion needs.
    pub(crate) fn candidate(&self, view: &View) -> Option<Candidate> {
        let information = self.objective.information(&self.scenes, view)?;
        Some(Candidate { view: view.clone(), information })
    }

    /// The view from the joint values next to `q` that poses may have; `None` if it is no view, in too many of the scenarios
    /// none, or not allowed beside `others`.
    pub(crate) fn look(&self, id: usize, q: &[f64], others: &[&View]) -> Option<Candidate> {
        self.look_at(id, &self.told(q), others)
    }

    /// The joint values next to `q` that poses may have and the robot can be told.
    fn told(&self, q: &[f64]) -> Vec<f64> {
        let joints = &self.problem.robot.chain.joints;
        let within = q.iter().zip(&self.ranges).map(|(q, range)| q.max(range.min).min(range.max));
        within.zip(joints).zip(&self.ranges).map(|((q, joint), range)| joint.resolution.nearest(q, range)).collect()
    }

    fn look_at(&self, id: usize, q: &[f64], others: &[&View]) -> Option<Candidate> {
        let view = self.scenes[0].look(id, q)?;
        if !self.allows(others, &view) || !self.is_certain(&view) {
            return None;
        }
        self.candidate(&view)
    }

    /// Whether it is a view in about as many of the scenarios as swept ones must be of all draws.
    fn is_certain(&self, view: &View) -> bool {
        let Some(robust) = &self.problem.robust else { return true };
        let seen = self.scenes.iter().filter(|scene| scene.view(view).is_some()).count();
        seen as f64 >= (robust.seen_share * self.scenes.len() as f64).round()
    }

    /// A view at joint values drawn around those of `view`, whose standard deviations are that share of the simplex's first steps; `None`
    /// where none is.
    pub(super) fn around(&self, view: &View, share: f64, rng: &mut impl Rng) -> Option<Candidate> {
        let mut drawn = |(q, step): (&f64, f64)| q + share * step * rng.sample::<f64, _>(StandardNormal);
        let q: Vec<f64> = view.q.iter().zip(self.steps()).map(&mut drawn).collect();
        self.look(view.id, &q, &[])
    }

    /// Whether the view is none of the `others` and the constraints allow it beside them.
    pub(super) fn allows(&self, others: &[&View], view: &View) -> bool {
        others.iter().all(|other| other.q != view.q) && allows(self.problem, others, view)
    }

    /// First steps of the simplex along the joints.
    fn steps(&self) -> Vec<f64> {
        match &self.problem.space {
            JointSpace::Grid(grid) => grid.steps().iter().map(|step| SHARE_OF_STEP * step).collect(),
            JointSpace::Sample(_) => {
                let joints = self.problem.robot.chain.joints.iter();
                joints.map(|joint| SHARE_OF_RANGE * (joint.limits.max - joint.limits.min)).collect()
            }
        }
    }

    /// Where the simplex method of Nelder and Mead ends that climbs `value` from `start`, opened by `stretch`
    /// times its first steps.
    pub(crate) fn climb(
        &self,
        start: &View,
        others: &[&View],
        stretch: f64,
        value: &dyn Fn(&Candidate) -> f64,
    ) -> Option<Candidate> {
        let slope = Slope { search: self, id: start.id, others, value, known: RefCell::default() };
        let q = DVector::from_column_slice(&start.q);
        let vertex = |(joint, &step): (usize, &f64)| {
            let moved = |share: f64| {
                let mut vertex = q.clone();
                vertex[joint] += stretch * share * step;
                vertex
            };
            // Beside the border of what is allowed a vertex is better inside than infinite.
            let inside = [1.0, -1.0, 0.5, -0.5, 0.25, -0.25].map(moved);
            let inside = inside.into_iter().find(|vertex| slope.cost_at(vertex) < f64::INFINITY);
            inside.unwrap_or_else(|| moved(0.125))
        };
        let simplex = std::iter::once(q.clone()).chain(self.steps().iter().enumerate().map(vertex)).collect();
        let solver = NelderMead::new(simplex).with_sd_tolerance(TOLERANCE).ok()?;
        let iterations = ITERATIONS_PER_JOINT * q.len() as u64;
        let executor = Executor::new(&slope, solver).configure(|state| state.max_iters(iterations)).timer(false);
        let end = executor.run().ok()?.state.best_param?;
        self.look(start.id, end.as_slice(), others)
    }
}

/// The problem of placing one view beside others.
struct Slope<'a> {
    search: &'a LocalSearch<'a>,
    id: usize,
    others: &'a [&'a View],
    value: &'a dyn Fn(&Candidate) -> f64,
    /// Costs by the bits of the joint values: a simplex that is hardly larger than what the robot can be told asks for the same ones
    /// again and again.
    known: RefCell<HashMap<Vec<u64>, f64>>,
}

impl Slope<'_> {
    /// Less its value; infinite where it is no view or not allowed.
    fn cost_at(&self, q: &DVector<f64>) -> f64 {
        let q = self.search.told(q.as_slice());
        let cost = || {
            let found = self.search.look_at(self.id, &q, self.others);
            found.map_or(f64::INFINITY, |found| -(self.value)(&found))
        };
        let place = q.iter().map(|q| q.to_bits()).collect();
        *self.known.borrow_mut().entry(place).or_insert_with(cost)
    }
}

impl CostFunction for &Slope<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, q: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.cost_at(q))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::information::Criterion;
    use crate::plan::choose::chooser::Chooser;
    use crate::plan::survey::survey;
    use crate::problem::{Accuracy, Goal, Least, Method, Overrides};

    fn coarse(set: &str) -> Problem {
        let step = Overrides::new().set("sweep.step_deg=20").unwrap().set("robot.limit_margin_deg=0").unwrap();
        let overrides = if set.is_empty() { step } else { step.set(set).unwrap() };
        Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap()
    }

    /// The matrices off the grid are those on it, where the two meet.
    #[test]
    fn the_matrices_of_every_objective_are_the_choosers() {
        let mut problem = coarse("");
        problem.selection.goal = Goal::Fewest {
            accuracies: vec![(Accuracy::MapError, 3.0), (Accuracy::Intrinsic(0), 4.0)],
            least: Least::Poses,
        };
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let single = [Criterion::D, Criterion::A, Criterion::E, Criterion::V, Criterion::Zhang, Criterion::Diversity];
        let criteria = single.map(|criterion| vec![(criterion, 1.0)]).into_iter();
        let mixed = vec![(Criterion::V, 0.6), (Criterion::E, 0.2), (Criterion::Diversity, 0.2)];
        let choosers = criteria.chain([mixed]).map(|criteria| chooser.by(&criteria).unwrap());
        for chooser in choosers.chain([Chooser::new(&problem, &survey).unwrap()]) {
            let choice = chooser.choose(Method::Greedy, 8, 0).unwrap();
            let search = LocalSearch::new(&problem, &survey, chooser.objective());
            let instance = chooser.instance(8).unwrap();
            let mut total = instance.prior();
            for &i in &choice.selected {
                let found = search.look(survey.views[i].id, &survey.views[i].q, &[]).unwrap();
                assert_eq!(found.view, survey.views[i]);
                for (sum, entry) in total.iter_mut().zip(&found.information) {
                    *sum += entry;
                }
            }
            assert_eq!(total, instance.total(&choice.selected), "{}", chooser.criterion());
        }
    }

    #[test]
    fn a_climb_ends_higher_at_joint_values_that_can_be_told() {
        let problem = coarse("robot.joint_resolution_deg=0.25");
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let search = LocalSearch::new(&problem, &survey, chooser.objective());
        // The first intrinsic's own information.
        let value = |candidate: &Candidate| candidate.information[0];
        let mut higher = 0;
        for view in survey.views.iter().step_by(7) {
            let start = search.candidate(view).unwrap();
            let Some(found) = search.climb(view, &[], 1.0, &value) else { continue };
            assert!(value(&found) >= value(&start));
            higher += usize::from(value(&found) > 1.05 * value(&start));
            for (q, joint) in found.view.q.iter().zip(&problem.robot.chain.joints) {
                let quarters = q.to_degrees() * 4.0;
                assert!((quarters - quarters.round()).abs() < 1e-9, "{quarters}");
                assert!(joint.range().min <= *q && *q <= joint.range().max);
            }
            assert_eq!(problem.checks().view(found.view.id, &found.view.q).as_ref(), Ok(&found.view));
        }
        assert!(higher > 10, "{higher}");
    }

    /// A pose goes only where the scenarios show the board too, by their own tests.
    #[test]
    fn a_pose_moves_only_to_views_of_the_scenarios() {
        let problem = coarse("robust={mount_rotation_deg=8, scenarios=4, draws=8, seen_share=0.75}");
        let stated = survey(&Problem { robust: None, ..problem.clone() }, &|_| {}).unwrap();
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let search = LocalSearch::new(&problem, &survey, chooser.objective());
        let drawn = problem.scenarios();
        let checks: Vec<_> = drawn.iter().map(Problem::checks).collect();
        let (mut certain, mut uncertain) = (0, 0);
        for view in &stated.views {
            let seen = 1 + checks.iter().filter(|checks| checks.view(view.id, &view.q).is_ok()).count();
            let found = search.look(view.id, &view.q, &[]);
            assert_eq!(found.is_some(), seen >= 3, "{} in {seen} of 4", view.id);
            *(if seen >= 3 { &mut certain } else { &mut uncertain }) += 1;
        }
        assert!(certain > 50 && uncertain > 10, "{certain} {uncertain}");
    }
}
