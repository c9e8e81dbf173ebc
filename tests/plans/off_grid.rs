//! Plans whose poses leave the grid: better than any swept ones, at joint values that the robot can be told, and certified like
//! others.

use std::ops::ControlFlow;
use std::path::Path;

use calipose::plan::assess::{CertifyError, ExplainSettings, certify, explain};
use calipose::plan::choose::{Chooser, decide, plan_survey, refined_survey};
use calipose::plan::document::{ContinuumDocument, Document, Plan};
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
    let pictures: Vec<[f64; 12]> = views.map(|view| view.picture(&problem.camera, &problem.target.board)).collect();
    let distance = |a: &[f64; 12], b: &[f64; 12]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
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
    again.good.clone_from(&survey.good);
    again.near.clone_from(&survey.near);
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
    // A pose's with another one.
    let mut moved = plan.clone();
    let is_posed = |q: &Vec<f64>| plan.poses.iter().any(|pose| pose.joints_rad == *q);
    let posed = plan.off_grid.iter().position(is_posed).unwrap();
    moved.off_grid.swap(posed, (posed + 1) % last);
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

/// A pose that failed on the robot does not come back a hundredth of a degree beside.
#[test]
fn no_pose_comes_near_a_forbidden_one() {
    let mut problem = problem("servosila-engineer", &["sweep.step_deg=12"]);
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let near = |q: &[f64], other: &[f64]| q.iter().zip(other).all(|(a, b)| (a - b).abs() < 5.999f64.to_radians());
    let poses = plan(&problem, &survey).poses;
    let is_near = |id: &usize| poses.iter().any(|pose| near(&pose.joints_rad, &problem.space.configuration(*id)));
    let forbidden: Vec<usize> = (0..problem.space.len()).filter(is_near).collect();
    assert!(forbidden.len() > 5, "{}", forbidden.len());
    problem.constraints.forbidden.clone_from(&forbidden);
    let poses = plan(&problem, &plan_survey(&problem, &|_| {}).unwrap()).poses;
    for pose in &poses {
        let beside = |id: &usize| near(&pose.joints_rad, &problem.space.configuration(*id));
        assert!(!forbidden.iter().any(beside), "{:?}", pose.joints_deg);
    }
}

/// What stays where it was swept is no second view.
#[test]
fn no_joint_values_are_two_views() {
    let mut problem = problem("servosila-engineer", &["sweep.step_deg=15", "constraints.picture_separation_px=0"]);
    let swept = refined_survey(&problem, &|_| {}).unwrap();
    problem.constraints.required = vec![swept.views[swept.views.len() / 2].id];
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    assert!(survey.off_grid > 5 && survey.good.len() == 10);
    for (i, view) in survey.views.iter().enumerate() {
        assert!(survey.views[..i].iter().all(|other| other.q != view.q), "{}", view.id);
    }
    assert!(plan(&problem, &survey).poses.iter().any(|pose| pose.id == problem.constraints.required[0]));
}

/// Near repetitions of a pose do not stand in for it.
#[test]
fn spares_are_not_beside_the_poses_they_replace() {
    let problem = problem("servosila-engineer", &["sweep.step_deg=12"]);
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let (choice, _) = chooser.best(10, 1).unwrap();
    let settings = ExplainSettings { most: 10, spares: 4 };
    let explained = explain(&problem, &chooser, &choice.selected, &settings, &|_| {}).unwrap();
    let picture = |id: usize| {
        let view = &survey.views[survey.index_of(id).unwrap()];
        view.picture(&problem.camera, &problem.target.board)
    };
    for pose in &explained.poses {
        assert_eq!(pose.spares.len(), 4);
        for spare in &pose.spares {
            let (a, b) = (picture(pose.id), picture(spare.id));
            let distance = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!(distance >= problem.picture_separation(), "{} {}", pose.id, spare.id);
        }
    }
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

/// An arm that hardly moves, of which all joint values are bounded in no time.
fn narrow(set: &[&str]) -> Problem {
    let mut text = std::fs::read_to_string("problems/servosila-engineer.toml").unwrap();
    let ranges = [
        ("[-214.2, 137.3]", "[-44, -38]"),
        ("[-16.4, 114.2]", "[31, 37]"),
        ("[-216.9, 0]", "[-216, -210]"),
        ("[0, 188.8]", "[19, 25]"),
    ];
    for (from, to) in ranges {
        assert!(text.contains(from));
        text = text.replace(from, to);
    }
    let set = ["sweep.step_deg=1.5", "selection.count=5", "estimate.intrinsics=[\"fx\", \"fy\", \"cx\", \"cy\"]"]
        .iter()
        .chain(set);
    let overrides = set.fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    Problem::parse_with(&text, Path::new("problem.toml"), &overrides).unwrap()
}

#[test]
fn all_joint_values_are_bounded_and_certified() {
    for (criterion, most) in [("v", 200_000), ("e", 200_000), ("d", 40)] {
        let boxes = format!("selection.continuum_boxes={most}");
        let problem =
            narrow(&[&format!("selection.criterion={criterion}"), &boxes, "constraints.picture_separation_px=0"]);
        let survey = plan_survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
        let mut told = 0;
        let bound = chooser.continuum(&decision.choice, &decision.certificate, &mut |_| {
            told += 1;
            ControlFlow::Continue(())
        });
        let bound = bound.unwrap().unwrap();
        assert!(told > 0);
        let plan = Plan::new(&chooser, &decision).unwrap().within_continuum(&chooser, &decision, &bound);
        let plan = Plan::from_json(&plan.to_json()).unwrap();
        let continuum = plan.certificate.continuum.clone().unwrap();
        // Poses may repeat there, and may not on a list of views.
        assert!(continuum.efficiency < 1.0, "{continuum:?}");
        if criterion == "d" {
            assert_eq!(continuum.end, "box limit");
        } else {
            assert_eq!(continuum.end, "closed");
            assert!(continuum.efficiency > 0.7, "{continuum:?}");
        }
        let confirmed = certify(&plan, &problem, &survey).unwrap();
        assert!((confirmed.continuum.unwrap()[1] / continuum.efficiency - 1.0).abs() < 1e-8);
        let refused = |change: &dyn Fn(&mut Plan)| {
            let mut changed = plan.clone();
            change(&mut changed);
            certify(&changed, &problem, &survey).unwrap_err()
        };
        let continuum = |plan: &mut Plan| plan.certificate.continuum.clone().unwrap();
        let with = |change: &dyn Fn(&mut ContinuumDocument)| {
            refused(&|plan| {
                let mut document = continuum(plan);
                change(&mut document);
                plan.certificate.continuum = Some(document);
            })
        };
        with(&|document| document.bound *= 1.001);
        with(&|document| document.efficiency *= 1.001);
        with(&|document| document.score *= 0.999);
        with(&|document| document.count += 1);
        with(&|document| document.tolerance *= 2.0);
        with(&|document| document.terms[0].matrix[0][0] *= 1.001);
        with(&|document| document.terms[0].share = 0.9);
        with(&|document| document.terms[0].criterion = "a".into());
        with(&|document| document.end = "done".into());
    }
}

/// What scores less in balls of pictures is paid for once.
#[test]
fn pictures_that_are_kept_apart_are_bounded_and_certified() {
    let problem = narrow(&["selection.continuum_boxes=200000", "constraints.picture_separation_px=8"]);
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let bound = chooser.continuum(&decision.choice, &decision.certificate, &mut |_| ControlFlow::Continue(()));
    let bound = bound.unwrap().unwrap();
    let plan = Plan::new(&chooser, &decision).unwrap().within_continuum(&chooser, &decision, &bound);
    let plan = Plan::from_json(&plan.to_json()).unwrap();
    let continuum = plan.certificate.continuum.clone().unwrap();
    assert!(continuum.balls.len() > 1 && continuum.end == "closed", "{continuum:?}");
    // Of poses that may repeat, the bound says less.
    let free = narrow(&["selection.continuum_boxes=200000", "constraints.picture_separation_px=0"]);
    let free_survey = plan_survey(&free, &|_| {}).unwrap();
    let free_chooser = Chooser::new(&free, &free_survey).unwrap();
    let free_decision = decide(&free_chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let repeated =
        free_chooser.continuum(&free_decision.choice, &free_decision.certificate, &mut |_| ControlFlow::Continue(()));
    let gain = repeated.unwrap().unwrap().log_bound - bound.log_bound;
    assert!(gain > 0.01, "{gain}");
    certify(&plan, &problem, &survey).unwrap();
    let refused = |change: &dyn Fn(&mut ContinuumDocument)| {
        let (mut changed, mut document) = (plan.clone(), continuum.clone());
        change(&mut document);
        changed.certificate.continuum = Some(document);
        certify(&changed, &problem, &survey).unwrap_err()
    };
    refused(&|document| document.balls[0].price *= 1.001);
    refused(&|document| document.balls[0].price *= -1.0);
    refused(&|document| document.balls.swap(0, 1));
    refused(&|document| drop(document.balls.pop()));
    refused(&|document| document.balls[0].between_rad[0].push(0.0));
    refused(&|document| {
        let ball = document.balls[0].clone();
        document.balls.insert(0, ball);
    });
    // Elsewhere it fits itself, but views score more there.
    let moved = refused(&|document| document.balls.iter_mut().for_each(|ball| ball.between_rad[1][3] += 0.05));
    assert!(matches!(moved, CertifyError::Continuum { .. }), "{moved}");
}

/// A claim that fits itself, of a score that some views exceed.
#[test]
fn a_score_that_views_exceed_is_not_certified() {
    let problem = narrow(&["selection.continuum_boxes=200000", "constraints.picture_separation_px=0"]);
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let bound = chooser.continuum(&decision.choice, &decision.certificate, &mut |_| ControlFlow::Continue(()));
    let mut bound = bound.unwrap().unwrap();
    // Without priors the bound is the score's, to its scale.
    bound.score *= 0.8;
    bound.log_bound += 0.8f64.ln();
    let plan = Plan::new(&chooser, &decision).unwrap().within_continuum(&chooser, &decision, &bound);
    let error = certify(&plan, &problem, &survey).unwrap_err();
    assert!(matches!(error, CertifyError::Continuum { .. }), "{error}");
}
