//! Off the grid: the chosen poses moved to better joint values between the swept ones.
//!
//! Block-coordinate ascent of log Φ: one pose at a time, the others held, by the simplex method of Nelder and Mead over its
//! joint values, from cycle to cycle until one gains next to nothing. A pose moves only where it stays a view and the
//! constraints allow it. What comes out is a local optimum at best, and never worse than what went in; nothing is proven of
//! it.

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;
use nalgebra::DVector;

use crate::feasibility::View;
use crate::plan::choose::{Chooser, Objective, PlanError, allows};
use crate::plan::document::{
    Document, GridPlan, Intrinsics, PROVEN, Plan, PlannedPose, PolishedPlan, RobustnessDocument, UnweightedAccuracy,
};
use crate::plan::survey::{Scene, SurveyError};
use crate::problem::Problem;
use crate::selection::{Constraints, Instance};
use crate::sweep::JointSpace;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolishSettings {
    /// Most cycles over all poses.
    pub cycles: usize,
    /// Gain in log Φ below which a cycle is the last.
    pub least_gain: f64,
}

impl Default for PolishSettings {
    fn default() -> Self {
        Self { cycles: 100, least_gain: 1e-4 }
    }
}

/// Poses off the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Polished {
    /// The views, in the order of the poses they started from and under their ids.
    pub views: Vec<View>,
    /// log Φ of the poses on the grid.
    pub grid_log_value: f64,
    /// log Φ of the views; at least that of the grid.
    pub log_value: f64,
    /// Each view's share of the information at hand, as [`Chooser::shares`].
    pub shares: Vec<f64>,
    /// Standard deviation of each estimated intrinsic; empty if one is undetermined.
    pub sigma: Vec<f64>,
    /// Expected RMS map error in px; infinite if an intrinsic is undetermined.
    pub map_error: f64,
    /// Cycles over all poses.
    pub cycles: usize,
    /// Whether the last cycle gained less than the least gain.
    pub converged: bool,
}

impl Polished {
    /// What is written of the poses, which `chooser` polished from those of `plan`.
    pub fn document(&self, problem: &Problem, chooser: &Chooser, plan: &Plan) -> PolishedPlan {
        let gain = (self.log_value - self.grid_log_value).exp();
        let poses = self.views.iter().zip(&self.shares);
        PolishedPlan {
            header: PolishedPlan::header(),
            problem: plan.problem.clone(),
            criterion: plan.criterion.clone(),
            count: plan.count,
            pictures: plan.pictures,
            value: chooser.natural(self.log_value),
            gain: gain - 1.0,
            efficiency_by_grid_bound: plan.efficiency * gain,
            intrinsics: Intrinsics { sigma: self.sigma.clone(), ..plan.intrinsics.clone() },
            map_error_px: self.map_error,
            unweighted: UnweightedAccuracy::new(chooser, &self.views),
            robust: RobustnessDocument::new(chooser, &self.views),
            cycles: self.cycles,
            converged: self.converged,
            proven: PROVEN.into(),
            grid: GridPlan {
                value: plan.value,
                bound: plan.bound,
                efficiency: plan.efficiency,
                map_error_px: plan.map_error_px,
                certificate: plan.certificate.clone(),
            },
            joints: plan.joints.clone(),
            poses: poses.map(|(view, &share)| PlannedPose::new(problem, view, share)).collect(),
        }
    }
}

/// Iterations of the simplex method per pose and joint; restarts in the next cycle do more than patience in one.
const ITERATIONS_PER_JOINT: u64 = 40;

/// The simplex has come to rest when log Φ at its vertices scatters less than this.
const SIMPLEX_TOLERANCE: f64 = 1e-8;

/// First step along a joint, as a share of the grid's step, and of the joint's range where the problem sweeps a sample.
const SHARE_OF_STEP: f64 = 0.5;
const SHARE_OF_RANGE: f64 = 0.02;

/// First steps of one cycle's two tries, as multiples: beside the border of what is seen a simplex may collapse, and another
/// one, opened the other way, gets on.
const TRIES: [f64; 2] = [1.0, -0.4];

/// Softnesses of functions with kinks, where moving a single pose rarely gains, before the function itself.
const SOFTNESSES: [f64; 3] = [0.3, 0.1, 0.03];

/// Polishes the poses `selected` (indices into the survey's views) by the criteria of `chooser`; poses that the constraints
/// require stay where they are. `observe` is called after each cycle with log Φ.
///
/// # Errors
/// When the poses leave a combination of the parameters undetermined.
pub fn polish(
    problem: &Problem,
    chooser: &Chooser,
    selected: &[usize],
    settings: &PolishSettings,
    observe: &mut dyn FnMut(f64),
) -> Result<Polished, PlanError> {
    let grid = chooser.assess(selected.to_vec());
    chooser.require_observable(&grid)?;
    let objective = chooser.objective();
    let instance = chooser.instance(grid.selected.len())?;
    let setting = Setting { problem, objective, scenes: chooser.survey().scenes(problem) };
    let start = grid.selected.iter().map(|&i| chooser.survey().views[i].clone());
    let undetermined = || SurveyError::undetermined(problem);
    let mut current = Poses::new(&setting, start.collect()).ok_or_else(undetermined)?;
    let mut best = current.clone();
    let mut best_value = grid.log_value;
    let fixed: Vec<bool> = grid.selected.iter().map(|i| instance.required().contains(i)).collect();
    let softnesses = if instance.is_smooth() { &[][..] } else { &SOFTNESSES[..] };
    let stages = softnesses.iter().map(|&softness| instance.softened(softness)).chain([instance.clone()]);
    let (mut cycles, mut converged) = (0, false);
    for stage in stages {
        converged = false;
        while cycles < settings.cycles && !converged {
            cycles += 1;
            let before = stage.log_value_at(&current.total(&stage));
            for place in (0..fixed.len()).filter(|&place| !fixed[place]) {
                for steps in TRIES {
                    current.improve(&setting, &stage, place, steps);
                }
            }
            converged = stage.log_value_at(&current.total(&stage)) - before < settings.least_gain;
            let value = instance.log_value_at(&current.total(&instance));
            if value > best_value {
                (best, best_value) = (current.clone(), value);
            }
            observe(best_value);
        }
        // The next function goes on from the best by the last one.
        current = best.clone();
    }
    drop(instance);
    let mut M = chooser.information(&[]);
    for view in &best.views {
        let information = setting.scenes[0].measurement.information(&view.X_CT, &view.seen).ok_or_else(undetermined)?;
        M += crate::selection::packed::unpack(&information, M.nrows());
    }
    let (sigma, map_error) = chooser.accuracy(&M);
    Ok(Polished {
        shares: shares(chooser, &best)?,
        views: best.views,
        grid_log_value: grid.log_value,
        log_value: best_value,
        sigma,
        map_error,
        cycles,
        converged,
    })
}

/// What poses are judged by.
struct Setting<'a> {
    problem: &'a Problem,
    objective: &'a Objective<'a>,
    /// The set-up as stated, and the scenarios.
    scenes: Vec<Scene<'a>>,
}

impl Setting<'_> {
    /// The view from joint values, moved into the limits, and its matrices; `None` if it is no view, in too many of the scenarios none,
    /// or not allowed.
    fn look(&self, id: usize, q: &DVector<f64>, others: &[&View]) -> Option<(View, Vec<f64>)> {
        let joints = q.iter().zip(&self.problem.robot.chain.joints);
        let q: Vec<f64> = joints.map(|(q, joint)| q.clamp(joint.limits.min, joint.limits.max)).collect();
        let view = self.scenes[0].look(id, &q)?;
        if !allows(self.problem, others, &view) || !self.is_certain(&view) {
            return None;
        }
        let information = self.objective.information(&self.scenes, &view)?;
        Some((view, information))
    }

    /// Whether it is a view in about as many of the scenarios as swept ones must be of all draws.
    fn is_certain(&self, view: &View) -> bool {
        let Some(robust) = &self.problem.robust else { return true };
        let seen = self.scenes.iter().filter(|scene| scene.view(view).is_some()).count();
        seen as f64 >= (robust.seen_share * self.scenes.len() as f64).round()
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
}

/// Views and their matrices.
#[derive(Debug, Clone)]
struct Poses {
    views: Vec<View>,
    information: Vec<Vec<f64>>,
}

impl Poses {
    fn new(setting: &Setting, views: Vec<View>) -> Option<Self> {
        let information = views.iter().map(|view| setting.objective.information(&setting.scenes, view));
        let information = information.collect::<Option<_>>()?;
        Some(Self { views, information })
    }

    fn total(&self, instance: &Instance) -> Vec<f64> {
        self.without(instance, usize::MAX)
    }

    /// The total of all but one.
    fn without(&self, instance: &Instance, place: usize) -> Vec<f64> {
        let mut total = instance.prior();
        for (_, information) in self.information.iter().enumerate().filter(|(other, _)| *other != place) {
            add(&mut total, information);
        }
        total
    }

    /// Moves one pose to where log Φ of `instance` is greater, if the simplex method finds such a place; `steps` as in
    /// [`TRIES`].
    fn improve(&mut self, setting: &Setting, instance: &Instance, place: usize, steps: f64) {
        let others = self.views.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, view)| view);
        let pose = OnePose {
            setting,
            instance,
            id: self.views[place].id,
            others: others.collect(),
            rest: self.without(instance, place),
        };
        let q = DVector::from_column_slice(&self.views[place].q);
        let before = pose.value_with(&self.information[place]);
        let Some(q) = pose.best_near(&q, steps) else { return };
        let Some((view, information)) = pose.setting.look(pose.id, &q, &pose.others) else { return };
        if pose.value_with(&information) > before {
            self.views[place] = view;
            self.information[place] = information;
        }
    }
}

/// The problem of placing one pose, the others held.
struct OnePose<'a> {
    setting: &'a Setting<'a>,
    instance: &'a Instance<'a>,
    id: usize,
    others: Vec<&'a View>,
    /// The total of the others.
    rest: Vec<f64>,
}

impl OnePose<'_> {
    fn value_with(&self, information: &[f64]) -> f64 {
        let mut total = self.rest.clone();
        add(&mut total, information);
        self.instance.log_value_at(&total)
    }

    /// −log Φ; infinite where the pose is no view or not allowed.
    fn cost_at(&self, q: &DVector<f64>) -> f64 {
        match self.setting.look(self.id, q, &self.others) {
            Some((_, information)) => -self.value_with(&information),
            None => f64::INFINITY,
        }
    }

    /// Where the simplex method ends.
    fn best_near(&self, q: &DVector<f64>, steps: f64) -> Option<DVector<f64>> {
        let vertex = |(joint, &step): (usize, &f64)| {
            let moved = |share: f64| {
                let mut vertex = q.clone();
                vertex[joint] += steps * share * step;
                vertex
            };
            // Beside the border of what is allowed a vertex is better inside than infinite.
            let inside = [1.0, -1.0, 0.5, -0.5, 0.25, -0.25].map(moved);
            let inside = inside.into_iter().find(|vertex| self.cost_at(vertex) < f64::INFINITY);
            inside.unwrap_or_else(|| moved(0.125))
        };
        let first = self.setting.steps();
        let simplex: Vec<DVector<f64>> =
            std::iter::once(q.clone()).chain(first.iter().enumerate().map(vertex)).collect();
        let solver = NelderMead::new(simplex).with_sd_tolerance(SIMPLEX_TOLERANCE).ok()?;
        let iterations = ITERATIONS_PER_JOINT * q.len() as u64;
        let executor = Executor::new(self, solver).configure(|state| state.max_iters(iterations)).timer(false);
        executor.run().ok()?.state.best_param
    }
}

impl CostFunction for &OnePose<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, q: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.cost_at(q))
    }
}

/// Each view's share of the information.
fn shares(chooser: &Chooser, poses: &Poses) -> Result<Vec<f64>, PlanError> {
    let objective = chooser.objective().on(&poses.information);
    let all: Vec<usize> = (0..poses.views.len()).collect();
    let instance = objective.instance(all.len(), Constraints::default()).map_err(|error| chooser.explain(error))?;
    Ok(match instance.gradient_at(&instance.total(&all)) {
        Some(gradient) => instance.scores_of(&gradient.y, &all),
        None => vec![f64::NAN; all.len()],
    })
}

fn add(total: &mut [f64], information: &[f64]) {
    for (sum, entry) in total.iter_mut().zip(information) {
        *sum += entry;
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nalgebra::DMatrix;

    use super::*;
    use crate::information::Criterion;
    use crate::plan::survey::survey;
    use crate::problem::{Accuracy, Goal, JointRegion, Method, Overrides, PoseGroup};
    use crate::robot::Limits;
    use crate::selection::packed::unpack;
    use crate::target::AxisCase;

    fn coarse() -> Problem {
        let step = Overrides::new().set("sweep.step_deg=20").unwrap();
        Problem::read_with(Path::new("problems/servosila-engineer.toml"), &step).unwrap()
    }

    const SETTINGS: PolishSettings = PolishSettings { cycles: 3, least_gain: 1e-4 };

    /// Every view shows the board within the limits, by what the sweep itself uses.
    fn assert_views(problem: &Problem, views: &[View]) {
        let checks = problem.checks();
        for view in views {
            for (q, joint) in view.q.iter().zip(&problem.robot.chain.joints) {
                assert!((joint.limits.min - 1e-9..=joint.limits.max + 1e-9).contains(q), "{view:?}");
            }
            assert_eq!(checks.view(view.id, &view.q).as_ref(), Ok(view));
            assert_ne!(view.axis_case(&problem.target), AxisCase::Outside);
        }
    }

    /// Against the definition of `v`: the information of the new views, summed and inverted.
    #[test]
    fn polishing_gains_what_it_says() {
        let problem = coarse();
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let grid = chooser.choose(Method::Exchange, 10, 0).unwrap();
        let mut told = vec![];
        let found = polish(&problem, &chooser, &grid.selected, &SETTINGS, &mut |value| told.push(value)).unwrap();
        assert_views(&problem, &found.views);
        assert_eq!(found.views.iter().map(|view| view.id).collect::<Vec<_>>(), {
            grid.selected.iter().map(|&i| survey.views[i].id).collect::<Vec<_>>()
        });
        assert_eq!(told.len(), found.cycles);
        assert!(told.is_sorted() && told.last() == Some(&found.log_value));
        // On so coarse a grid there is much to gain.
        assert!(found.log_value > grid.log_value + 0.05, "{} {}", found.log_value, grid.log_value);
        let measurement = problem.measurement();
        let M = found.views.iter().fold(DMatrix::zeros(9, 9), |M, view| {
            M + unpack(&measurement.information(&view.X_CT, &view.seen).unwrap(), 9)
        });
        let C = M.try_inverse().unwrap();
        let variance = (&survey.map_weight * &C).trace();
        assert!((found.log_value + variance.ln()).abs() < 1e-6);
        assert!((found.map_error - variance.sqrt()).abs() < 1e-6);
        assert!((found.sigma[0] - C[(0, 0)].sqrt()).abs() < 1e-6);
        assert!((found.shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        assert_eq!(found, polish(&problem, &chooser, &grid.selected, &SETTINGS, &mut |_| {}).unwrap());
    }

    /// The matrices off the grid are those on it, where the two meet.
    #[test]
    fn every_objective_is_polished_and_never_loses() {
        let mut problem = coarse();
        problem.selection.goal =
            Goal::Fewest { accuracies: vec![(Accuracy::MapError, 3.0), (Accuracy::Intrinsic(0), 4.0)] };
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let criteria = [
            vec![(Criterion::D, 1.0)],
            vec![(Criterion::A, 1.0)],
            vec![(Criterion::E, 1.0)],
            vec![(Criterion::Zhang, 1.0)],
            vec![(Criterion::Diversity, 1.0)],
            vec![(Criterion::V, 0.6), (Criterion::E, 0.2), (Criterion::Diversity, 0.2)],
        ];
        let choosers = criteria
            .iter()
            .map(|criteria| chooser.by(criteria).unwrap())
            .chain([Chooser::new(&problem, &survey).unwrap()]);
        for chooser in choosers {
            let grid = chooser.choose(Method::Greedy, 8, 0).unwrap();
            let setting =
                Setting { problem: &problem, objective: chooser.objective(), scenes: survey.scenes(&problem) };
            let poses = Poses::new(&setting, grid.selected.iter().map(|&i| survey.views[i].clone()).collect()).unwrap();
            let instance = chooser.instance(8).unwrap();
            assert_eq!(poses.total(&instance), instance.total(&grid.selected), "{}", chooser.criterion());
            drop(instance);
            let found = polish(&problem, &chooser, &grid.selected, &SETTINGS, &mut |_| {}).unwrap();
            assert_views(&problem, &found.views);
            assert_eq!(found.grid_log_value, grid.log_value);
            assert!(found.log_value > grid.log_value, "{}", chooser.criterion());
            assert_pictures_differ(&problem, &found.views, 20.0);
            assert!((found.shares.iter().sum::<f64>() - 1.0).abs() < 0.2, "{:?}", found.shares);
        }
    }

    /// A pose goes only where the scenarios show the board too, by their own tests.
    #[test]
    fn a_pose_moves_only_to_views_of_the_scenarios() {
        let robust = "robust={mount_rotation_deg=8, scenarios=4, draws=8, seen_share=0.75}";
        let set = Overrides::new().set("sweep.step_deg=20").unwrap().set(robust).unwrap();
        let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &set).unwrap();
        let stated = survey(&Problem { robust: None, ..problem.clone() }, &|_| {}).unwrap();
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let setting = Setting { problem: &problem, objective: chooser.objective(), scenes: survey.scenes(&problem) };
        let drawn = problem.scenarios();
        let checks: Vec<_> = drawn.iter().map(Problem::checks).collect();
        let (mut certain, mut uncertain) = (0, 0);
        for view in &stated.views {
            let seen = 1 + checks.iter().filter(|checks| checks.view(view.id, &view.q).is_ok()).count();
            let found = setting.look(view.id, &view.q.clone().into(), &[]);
            assert_eq!(found.is_some(), seen >= 3, "{} in {seen} of 4", view.id);
            *(if seen >= 3 { &mut certain } else { &mut uncertain }) += 1;
        }
        assert!(certain > 50 && uncertain > 10, "{certain} {uncertain}");
    }

    /// The directions of their outer corners are apart by `least` px at least, at half the focal length, in the root sum of squares.
    fn assert_pictures_differ(problem: &Problem, views: &[View], least: f64) {
        let (columns, rows, square) = problem.target.board.grid().unwrap();
        let [width, height] = [columns, rows].map(|count| (count + 1) as f64 * square);
        let outer = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| (x * width, y * height));
        let half_focal = (problem.camera.intrinsics()[0] + problem.camera.intrinsics()[1]) / 4.0;
        let toward = |view: &View, (x, y)| (view.X_CT * nalgebra::Point3::new(x, y, 0.0)).coords.normalize();
        for (a, one) in views.iter().enumerate() {
            for other in &views[..a] {
                let squares = outer.map(|corner| (toward(one, corner) - toward(other, corner)).norm_squared());
                let distance = half_focal * squares.iter().sum::<f64>().sqrt();
                assert!(distance >= least, "{distance}");
            }
        }
    }

    #[test]
    fn constraints_hold_off_the_grid() {
        let mut problem = coarse();
        let unconstrained = survey(&problem, &|_| {}).unwrap();
        let (joint, half) = (1, Limits { min: 0.5, max: 9.0 });
        let id = unconstrained.views[unconstrained.views.len() / 2].id;
        problem.constraints.required = vec![id];
        problem.constraints.groups =
            vec![PoseGroup { name: "raised".into(), region: JointRegion(vec![(joint, half)]), most: 5 }];
        problem.constraints.keep_out = vec![JointRegion(vec![(0, Limits { min: -9.0, max: -1.0 })])];
        problem.constraints.joint_separation = 0.3;
        problem.constraints.view_separation = 0.05;
        problem.constraints.picture_separation = Some(60.0);
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let grid = chooser.choose(Method::Exchange, 9, 0).unwrap();
        let found = polish(&problem, &chooser, &grid.selected, &SETTINGS, &mut |_| {}).unwrap();
        assert!(found.log_value > grid.log_value);
        assert_views(&problem, &found.views);
        assert!(found.views.contains(unconstrained.views.iter().find(|view| view.id == id).unwrap()));
        assert!(found.views.iter().filter(|view| (0.5..=9.0).contains(&view.q[joint])).count() <= 5);
        assert!(found.views.iter().all(|view| view.q[0] > -1.0));
        assert_pictures_differ(&problem, &found.views, 60.0);
        for (a, one) in found.views.iter().enumerate() {
            for other in &found.views[..a] {
                let apart = one.q.iter().zip(&other.q).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                assert!(apart >= 0.3);
                let direction = |view: &View| view.X_CT.inverse().translation.vector;
                assert!(direction(one).angle(&direction(other)) >= 0.05 - 1e-9);
            }
        }
    }
}
