//! Off the grid: the chosen poses moved to better joint values between the swept ones.
//!
//! A plan that was free to leave the grid is polished already, and gains next to nothing; nothing is proven of what comes out.

use std::sync::Arc;

use crate::feasibility::View;
use crate::motion::journey::Journey;
use crate::plan::choose::{Chooser, Moved, PlanError, PolishSettings, Poses, journey, moved};
use crate::plan::document::{
    Document, GridPlan, Intrinsics, PROVEN, Plan, PlannedPose, PolishedPlan, RobustnessDocument, TourDocument,
    UnweightedAccuracy,
};
use crate::plan::survey::SurveyError;
use crate::problem::Problem;
use crate::selection::packed::unpack;

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
    /// The moves through the views, numbered as they are listed, home after them.
    pub journey: Journey,
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
        let poses: Vec<PlannedPose> = poses.map(|(view, &share)| PlannedPose::new(problem, view, share)).collect();
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
                certificate: plan.certificate.grid.clone(),
            },
            joints: plan.joints.clone(),
            tour: Some(TourDocument::through(problem, &poses, &self.journey)),
            poses,
        }
    }
}

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
    let Moved { poses, log_value, cycles, converged } = moved(problem, chooser, &grid, settings, observe)?;
    let measurement = problem.measurement();
    let mut M = chooser.information(&[]);
    for view in poses.views() {
        let information = measurement.information(&view.X_CT, &view.seen);
        M += unpack(&information.ok_or_else(|| SurveyError::undetermined(problem))?, M.nrows());
    }
    let (sigma, map_error) = chooser.accuracy(&M);
    let stops: Vec<&[f64]> = poses.views().map(|view| view.q.as_slice()).collect();
    Ok(Polished {
        journey: journey(problem, &stops),
        shares: shares(chooser, &poses)?,
        views: poses.views().cloned().collect(),
        grid_log_value: grid.log_value,
        log_value,
        sigma,
        map_error,
        cycles,
        converged,
    })
}

/// Each view's share of the information.
fn shares(chooser: &Chooser, poses: &Poses) -> Result<Vec<f64>, PlanError> {
    let matrices: Vec<Vec<f64>> = poses.information().cloned().collect();
    let objective = chooser.objective().on(&matrices);
    let all: Vec<usize> = (0..matrices.len()).collect();
    let instance = objective.instance(all.len(), &Arc::default()).map_err(|error| chooser.explain(error))?;
    Ok(match instance.gradient_at(&instance.total(&all)) {
        Some(gradient) => instance.scores_of(&gradient.y, &all),
        None => vec![f64::NAN; all.len()],
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nalgebra::DMatrix;

    use super::*;
    use crate::information::Criterion;
    use crate::plan::survey::survey;
    use crate::problem::{Accuracy, Goal, JointRegion, Least, Method, Overrides, PoseGroup};
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

    #[test]
    fn every_objective_is_polished_and_never_loses() {
        let mut problem = coarse();
        problem.selection.goal = Goal::Fewest {
            accuracies: vec![(Accuracy::MapError, 3.0), (Accuracy::Intrinsic(0), 4.0)],
            least: Least::Poses,
        };
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
            let found = polish(&problem, &chooser, &grid.selected, &SETTINGS, &mut |_| {}).unwrap();
            assert_views(&problem, &found.views);
            assert_eq!(found.grid_log_value, grid.log_value);
            assert!(found.log_value > grid.log_value, "{}", chooser.criterion());
            assert_pictures_differ(&problem, &found.views, 20.0);
            assert!((found.shares.iter().sum::<f64>() - 1.0).abs() < 0.2, "{:?}", found.shares);
        }
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
