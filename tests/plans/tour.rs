//! The order of a plan's poses.

use std::ops::ControlFlow;
use std::path::Path;

use calipose::motion::timing::Profile;
use calipose::plan::assess::certify;
use calipose::plan::choose::{Chooser, decide, plan_survey};
use calipose::plan::document::{Plan, TourDocument};
use calipose::plan::survey::Survey;
use calipose::problem::{Overrides, Problem};

fn planned(set: &[&str]) -> (Problem, Survey, Plan) {
    let coarse = ["sweep.step_deg=20", "selection.off_grid=false"];
    let overrides = coarse.iter().chain(set).fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap();
    let survey = plan_survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let plan = Plan::new(&chooser, &decision).unwrap();
    (problem, survey, plan)
}

/// Time of the moves from place to place, home (if any) before them and, where the tour returns, after them.
fn time(problem: &Problem, way: &[&[f64]]) -> f64 {
    let duration = |pair: &[&[f64]]| Profile::between(pair[0], pair[1], &problem.motion.limits()).duration();
    let home = problem.motion.home.as_ref();
    let start = home.map(|home| home.q.as_slice());
    let end = home.filter(|home| home.returns).map(|home| home.q.as_slice());
    let way: Vec<&[f64]> = start.into_iter().chain(way.iter().copied()).chain(end).collect();
    way.windows(2).map(duration).sum()
}

/// The least time of all orders of what follows the first `fixed` ones.
fn least(problem: &Problem, way: &mut [&[f64]], fixed: usize) -> f64 {
    if fixed == way.len() {
        return time(problem, way);
    }
    let mut found = f64::INFINITY;
    for i in fixed..way.len() {
        way.swap(fixed, i);
        found = found.min(least(problem, way, fixed + 1));
        way.swap(fixed, i);
    }
    found
}

#[test]
fn the_order_of_a_plan_takes_least_time() {
    let home = "motion.home=[0, 60, -100, 90]";
    for set in [vec![], vec![home], vec![home, "motion.return_home=false", "motion.max_acceleration_deg_s2={neck=3}"]] {
        let (problem, survey, plan) = planned(&[&["selection.count=7"], set.as_slice()].concat());
        let TourDocument { order, moves_s, moving_s, least_moving_s, moving_by_id_s, total_s, .. } =
            plan.tour.as_ref().unwrap();
        let mut ids = order.clone();
        ids.sort_unstable();
        assert!(ids.into_iter().eq(plan.poses.iter().map(|pose| pose.id)));
        let mut by_id: Vec<&[f64]> = plan.poses.iter().map(|pose| pose.joints_rad.as_slice()).collect();
        let in_order: Vec<&[f64]> = plan.in_order().iter().map(|pose| pose.joints_rad.as_slice()).collect();
        assert!((time(&problem, &in_order) - moving_s).abs() < 1e-9);
        assert!((time(&problem, &by_id) - moving_by_id_s).abs() < 1e-9);
        let best = least(&problem, &mut by_id, 0);
        assert!(
            (moving_s - best).abs() < 1e-9 && (least_moving_s - best).abs() < 1e-9,
            "{moving_s} {least_moving_s} {best}"
        );
        assert!(moving_by_id_s > moving_s);
        assert!((moves_s.iter().sum::<f64>() - moving_s).abs() < 1e-9 && (total_s - moving_s - 7.0).abs() < 1e-9);
        certify(&plan, &problem, &survey).unwrap();
    }
}

/// Where hardly any time goes into speeding up, half the speed takes twice the time.
#[test]
fn a_slower_robot_takes_longer_in_the_same_order() {
    let (_, _, fast) = planned(&["motion.max_acceleration_deg_s2={waist=1e6,shoulder=1e6,elbow=1e6,neck=1e6}"]);
    let (_, _, slow) = planned(&[
        "motion.max_acceleration_deg_s2={waist=1e6,shoulder=1e6,elbow=1e6,neck=1e6}",
        "motion.speed_percent=50",
        "motion.dwell_s=0",
    ]);
    let (fast, slow) = (fast.tour.unwrap(), slow.tour.unwrap());
    assert_eq!(fast.order, slow.order);
    assert!((slow.moving_s / fast.moving_s - 2.0).abs() < 1e-3, "{} {}", slow.moving_s, fast.moving_s);
    assert_eq!((slow.total_s, fast.total_s), (slow.moving_s, fast.moving_s + 10.0));
    assert_eq!(slow.assumed_speeds, ["waist", "shoulder", "elbow", "neck"]);
}
