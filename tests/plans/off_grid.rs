//! Plans whose poses leave the grid: better than any swept ones, at joint values that the robot can be told, and certified like
//! others.

use std::ops::ControlFlow;
use std::path::Path;

use calipose::plan::assess::certify;
use calipose::plan::choose::{Chooser, decide, plan_survey, refined_survey};
use calipose::plan::document::{Document, Plan};
use calipose::plan::survey::{NoView, Survey};
use calipose::problem::{Overrides, Problem};
use calipose::sweep::JointSpace;

fn problem(file: &str, set: &[&str]) -> Problem {
    let overrides = set.iter().fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    Problem::read_with(Path::new(&format!("problems/{file}.toml")), &overrides).unwrap()
}

fn plan(problem: &Problem, survey: &Survey) -> Plan {
    let chooser = Chooser::new(problem, survey).unwrap();
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    Plan::new(&chooser, &decision).unwrap()
}

/// The directions of the outer corners of two pictures, at half the focal length, in the root sum of squares.
fn least_distance(problem: &Problem, survey: &Survey, plan: &Plan) -> f64 {
    let views = plan.poses.iter().map(|pose| &survey.views[survey.index_of(pose.id).unwrap()]);
    let pictures: Vec<Vec<f64>> = views.map(|view| view.picture(&problem.camera, &problem.target.board)).collect();
    let distance = |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let pairs = pictures.iter().enumerate().flat_map(|(i, a)| pictures[..i].iter().map(move |b| distance(a, b)));
    pairs.fold(f64::INFINITY, f64::min)
}

#[test]
fn poses_off_the_grid_are_better_and_can_be_taken() {
    for criterion in ["v", "d"] {
        let set = ["sweep.step_deg=12", &format!("selection.criterion={criterion}")];
        let problem = problem("servosila-engineer", &set);
        let mut on_grid = problem.clone();
        on_grid.selection.off_grid = false;
        let swept = refined_survey(&problem, &|_| {}).unwrap();
        assert_eq!(plan_survey(&on_grid, &|_| {}).unwrap(), swept);
        let survey = plan_survey(&problem, &|_| {}).unwrap();
        assert_eq!(survey.views[..swept.views.len()], swept.views);
        assert_eq!(survey.off_grid_views().len(), survey.off_grid);
        let plan_on_grid = plan(&on_grid, &swept);
        let plan = plan(&problem, &survey);
        // On so coarse a grid there is much to gain.
        assert!(
            plan.map_error_px < 0.9 * plan_on_grid.map_error_px,
            "{} {}",
            plan.map_error_px,
            plan_on_grid.map_error_px
        );
        assert!(plan.efficiency > 0.9, "{}", plan.efficiency);
        let off = plan.poses.iter().filter(|pose| pose.id >= problem.space.len()).count();
        assert!(off >= 7, "{off}");
        assert!(least_distance(&problem, &survey, &plan) >= 20.0);
        let checks = problem.checks();
        for pose in &plan.poses {
            assert!(checks.view(pose.id, &pose.joints_rad).is_ok());
            for ((q, degrees), joint) in pose.joints_rad.iter().zip(&pose.joints_deg).zip(&problem.robot.chain.joints) {
                let hundredths = degrees * 100.0;
                assert!((hundredths - hundredths.round()).abs() < 1e-8, "{degrees}");
                let [least, greatest] = [joint.limits.min, joint.limits.max].map(f64::to_degrees);
                assert!((least + 0.5 - 1e-9..=greatest - 0.5 + 1e-9).contains(degrees) && q.to_degrees() == *degrees);
            }
        }
        let confirmed = certify(&plan, &problem, &survey).unwrap();
        assert!((confirmed.value / plan.value - 1.0).abs() < 1e-9);
        // Another number of threads finds the same.
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(one.install(|| plan_survey(&problem, &|_| {}).unwrap()), survey);
    }
}

#[test]
fn a_plan_holds_what_certifying_it_needs() {
    let problem = problem("servosila-engineer", &["sweep.step_deg=15", "selection.count=8"]);
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let plan = Plan::from_json(&plan(&problem, &survey).to_json()).unwrap();
    let swept = refined_survey(&problem, &|_| {}).unwrap();
    let mut again = swept.clone();
    again.take_off_grid(&problem, &plan.off_grid).unwrap();
    assert_eq!(again, survey);
    certify(&plan, &problem, &again).unwrap();
    // Without the views off the grid, and with other ones.
    certify(&plan, &problem, &swept).unwrap_err();
    let refused = |place: usize, change: &dyn Fn(&mut Vec<Vec<f64>>)| {
        let mut changed = plan.off_grid.clone();
        change(&mut changed);
        assert_eq!(swept.clone().take_off_grid(&problem, &changed), Err(NoView { place }));
    };
    refused(0, &|all| all[0][2] += 1e-5);
    refused(1, &|all| all[1][1] = problem.robot.chain.joints[1].limits.max);
    refused(1, &|all| all[1].pop().map_or((), drop));
    refused(0, &|all| all[0] = problem.robot.chain.mid_range());
    let last = plan.off_grid.len();
    refused(last, &|all| all.push(all[0].clone()));
    let mut moved = plan.clone();
    moved.off_grid.swap(0, 1);
    let mut other = swept.clone();
    other.take_off_grid(&problem, &moved.off_grid).unwrap();
    certify(&moved, &problem, &other).unwrap_err();
}

/// Fewer poses reach the same accuracy.
#[test]
fn accuracies_need_fewer_poses_off_the_grid() {
    let accuracy = "selection={accuracy={map_error_px=1.9}}";
    let problem = problem("servosila-engineer", &["sweep.step_deg=12", accuracy]);
    let mut on_grid = problem.clone();
    on_grid.selection.off_grid = false;
    let swept = plan(&on_grid, &plan_survey(&on_grid, &|_| {}).unwrap());
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let plan = plan(&problem, &survey);
    assert!(plan.count < swept.count && plan.map_error_px <= 1.9, "{} {}", plan.count, swept.count);
    certify(&plan, &problem, &survey).unwrap();
}

/// The baselines stay on the grid, whatever the file says.
#[test]
fn clusters_are_of_swept_poses() {
    let method = "selection.method=kmeans-joints";
    let problem = problem("servosila-engineer", &["sweep.step_deg=12", "selection.count=12", method]);
    assert_eq!(plan_survey(&problem, &|_| {}).unwrap().off_grid, 0);
}

#[test]
fn margins_and_resolutions_shape_the_sweep_too() {
    let problem = problem("servosila-engineer", &["robot.joint_resolution_deg=0.5", "robot.limit_margin_deg=5"]);
    let JointSpace::Grid(grid) = &problem.space else { panic!() };
    assert_eq!(grid.len(), 502_656);
    let survey = refined_survey(&problem, &|_| {}).unwrap();
    // The joint limits of the paper's table I.
    let limits = [(-214.2, 137.3), (-16.4, 114.2), (-216.9, 0.0), (0.0, 188.8)];
    for view in &survey.views {
        for (q, (least, greatest)) in view.q.iter().zip(limits) {
            let degrees = q.to_degrees();
            assert!((degrees * 2.0 - (degrees * 2.0).round()).abs() < 1e-9, "{degrees}");
            assert!(degrees >= least + 5.0 - 1e-9 && degrees <= greatest - 5.0 + 1e-9, "{degrees}");
        }
    }
}
