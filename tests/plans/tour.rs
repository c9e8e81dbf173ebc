//! The order of a plan's poses.

use std::ops::ControlFlow;
use std::path::Path;

use calipose::feasibility::Collision;
use calipose::motion::Safety;
use calipose::motion::journey::{Arm, Journey, Move};
use calipose::motion::timing::{Profile, duration};
use calipose::motion::tour::Ends;
use calipose::plan::assess::certify;
use calipose::plan::choose::{Chooser, PlanError, decide, home_is_safe, plan_survey};
use calipose::plan::document::{Plan, TourDocument};
use calipose::plan::survey::Survey;
use calipose::problem::{Overrides, Problem};

fn planned(set: &[&str]) -> (Problem, Survey, Plan) {
    planned_of("servosila-engineer", set)
}

fn planned_of(file: &str, set: &[&str]) -> (Problem, Survey, Plan) {
    let coarse = ["sweep.step_deg=20", "selection.off_grid=false"];
    let overrides = coarse.iter().chain(set).fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    let problem = Problem::read_with(Path::new(&format!("problems/{file}.toml")), &overrides).unwrap();
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
    let jerks = "motion.max_jerk_deg_s3={waist=20, neck=2}";
    let one_way = "motion.return_home=false";
    for set in
        [vec![], vec![home], vec![home, one_way, "motion.max_acceleration_deg_s2={neck=3}"], vec![home, one_way, jerks]]
    {
        let (problem, survey, plan) = planned(&[&["selection.count=7"], set.as_slice()].concat());
        let TourDocument { order, moves, moving_s, least_moving_s, moving_by_id_s, total_s, .. } =
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
        assert!(
            (moves.iter().map(|found| found.seconds).sum::<f64>() - moving_s).abs() < 1e-9
                && (total_s - moving_s - 7.0).abs() < 1e-9
        );
        certify(&plan, &problem, &survey).unwrap();
    }
}

#[test]
fn with_a_limit_of_jerk_moves_take_longer_and_less_is_found_out() {
    let (problem, survey, mut plan) = planned(&["motion.max_jerk_deg_s3={waist=20, neck=2}"]);
    let without = Problem { motion: planned(&[]).0.motion, ..problem.clone() };
    let error = certify(&plan, &without, &survey).unwrap_err();
    assert!(error.to_string().contains("time"), "{error}");
    certify(&plan, &problem, &survey).unwrap();
    let tour = plan.tour.as_mut().unwrap();
    tour.moves[3].seconds -= 1e-6;
    tour.moving_s -= 1e-6;
    tour.total_s -= 1e-6;
    let error = certify(&plan, &problem, &survey).unwrap_err();
    assert!(error.to_string().contains("the time of a move"), "{error}");
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

/// Every move of the plan in a thousand steps: nothing is nearer than stated, and the robot no nearer to tipping over.
#[test]
fn safe_moves_are_safe_all_along() {
    let home = "motion.home=[0, 60, -150, 90]";
    let (problem, survey, plan) = planned_of("servosila-engineer-bodies", &[home]);
    let tour = plan.tour.as_ref().unwrap();
    let home = tour.home_rad.clone().unwrap();
    let in_order = plan.in_order().into_iter().map(|pose| &pose.joints_rad);
    let stops: Vec<&Vec<f64>> = std::iter::once(&home).chain(in_order).chain([&home]).collect();
    let (checks, tree) = (problem.checks(), &problem.robot.tree);
    let stability = problem.stability.as_ref().unwrap();
    assert_eq!(tour.moves.len(), plan.count + 1);
    for (found, ends) in tour.moves.iter().zip(stops.windows(2)) {
        assert_eq!(found.safe, Some(true), "{found:?}");
        let (clearance, margin) = (found.clearance_m.unwrap(), found.tip_over_margin_m.unwrap());
        assert!(clearance > problem.clearance - 1e-3 && margin > stability.margin - 1e-3);
        let corners: Vec<&Vec<f64>> = std::iter::once(ends[0]).chain(&found.via_rad).chain([ends[1]]).collect();
        let (mut nearest, mut steadiest) = (f64::INFINITY, f64::INFINITY);
        for pair in corners.windows(2) {
            for step in 0..=1000 {
                let t = f64::from(step) / 1000.0;
                let q: Vec<f64> = pair[0].iter().zip(pair[1]).map(|(a, b)| (1.0 - t) * a + t * b).collect();
                let X_BL = tree.link_poses(&q);
                let gaps = checks.collision().gaps(&X_BL).into_iter().map(|(_, gap)| gap);
                nearest = gaps.fold(nearest, f64::min);
                steadiest = steadiest.min(stability.margin_at(tree, &X_BL).unwrap());
            }
        }
        assert!(nearest >= clearance - 1e-6 && steadiest >= margin - 1e-6, "{found:?} {nearest} {steadiest}");
        assert!(nearest <= clearance + 3e-3 && steadiest <= margin + 3e-3, "{found:?} {nearest} {steadiest}");
    }
    certify(&plan, &problem, &survey).unwrap();
    // What is said of a move is held against the move.
    let mut changed = plan.clone();
    changed.tour.as_mut().unwrap().moves[1].clearance_m = Some(1.0);
    assert!(certify(&changed, &problem, &survey).unwrap_err().to_string().contains("margin on a move"));
    let mut changed = plan;
    changed.tour.as_mut().unwrap().moves[2].via_rad = vec![vec![0.0, 2.2, -0.1, 0.1]];
    assert!(certify(&changed, &problem, &survey).is_err());
}

/// Two bars in a plane, and a post beside them, `far` mm from the first joint.
fn bars(far: u32) -> Problem {
    let text = format!(
        r#"
        [robot]
        joints = [
            {{ name = "one", a_mm = 400, limits_deg = [-170, 170] }},
            {{ name = "two", a_mm = 300, limits_deg = [-160, 160] }},
        ]
        bodies = [
            {{ link = "one", capsule_mm = [20, 400], pose = {{ position_mm = [-200, 0, 0], rpy_deg = [0, 90, 0] }} }},
            {{ link = "two", capsule_mm = [20, 300], pose = {{ position_mm = [-150, 0, 0], rpy_deg = [0, 90, 0] }} }},
        ]
        [[scene.bodies]]
        name = "post"
        cylinder_mm = [30, 400]
        pose = {{ position_mm = [0, {far}, 0] }}
        [collision]
        clearance_mm = 10
        [camera]
        width_px = 640
        height_px = 480
        fx_px = 500
        [target]
        columns = 4
        rows = 3
        square_mm = 30
        pose = {{}}
        [sweep]
        step_deg = 30
        [selection]
        count = 6
        "#
    );
    Problem::parse(&text, Path::new("bars.toml")).unwrap()
}

/// The journey between such places, in degrees.
fn journey(problem: &Problem, places: &[[f64; 2]]) -> Journey {
    let collision = Collision::new(&problem.robot, problem.clearance);
    let arm = Arm::new(&problem.robot, problem.motion.limits(), Safety::new(&problem.robot, &collision, None));
    let stops: Vec<[f64; 2]> = places.iter().map(|place| place.map(f64::to_radians)).collect();
    Journey::new(&arm, &stops.iter().map(<[f64; 2]>::as_slice).collect::<Vec<_>>(), Ends::Open, 0)
}

#[test]
fn the_arm_goes_round_what_stands_in_its_way() {
    // Stretched out, the second bar sweeps over the post; folded, it does not reach it.
    let problem = bars(550);
    let Journey { order, moves, least, as_numbered } = journey(&problem, &[[0.0, 0.0], [150.0, 0.0]]);
    let [Move { via, seconds, safety: Some(Ok(clear)) }] = &moves[..] else { panic!("{moves:?}") };
    assert_eq!(order, [0, 1]);
    assert!(!via.is_empty() && *seconds > as_numbered && least == as_numbered, "{moves:?}");
    assert!(clear.clearance.unwrap() >= 0.009, "{clear:?}");
    let limits = problem.motion.limits();
    let ends = [vec![0.0, 0.0], vec![150f64.to_radians(), 0.0]];
    let corners: Vec<&Vec<f64>> = std::iter::once(&ends[0]).chain(via).chain([&ends[1]]).collect();
    let time: f64 = corners.windows(2).map(|pair| duration(pair[0], pair[1], &limits)).sum();
    assert!((time - seconds).abs() < 1e-9);
    // A stop that is folded already is worth a detour.
    let folded = journey(&problem, &[[0.0, 0.0], [150.0, 0.0], [75.0, 150.0]]);
    assert_eq!(folded.order, [0, 2, 1]);
    assert!(folded.moves.iter().all(|found| matches!(found.safety, Some(Ok(_)))), "{folded:?}");
}

#[test]
fn a_move_that_nothing_leads_round_is_named() {
    // The first bar itself cannot pass the post, and cannot go the other way round.
    let Journey { moves, .. } = journey(&bars(300), &[[0.0, 0.0], [150.0, 0.0], [10.0, 0.0]]);
    let blocked: Vec<bool> = moves.iter().map(|found| matches!(found.safety, Some(Err(_)))).collect();
    assert_eq!(blocked.iter().filter(|&&blocked| blocked).count(), 1, "{moves:?}");
    assert!(moves.iter().all(|found| found.via.is_empty()));
}

#[test]
fn home_must_be_free() {
    let home = |degrees: &str| {
        let overrides = Overrides::new().set(&format!("motion.home={degrees}")).unwrap();
        let problem = Problem::read_with(Path::new("problems/servosila-engineer-bodies.toml"), &overrides).unwrap();
        home_is_safe(&problem)
    };
    home("[0, 60, -150, 90]").unwrap();
    let error = home("[0, -16, -5, 90]").unwrap_err();
    assert!(matches!(error, PlanError::UnsafeHome { .. }), "{error}");
    assert!(error.to_string().contains("the robot cannot be at `motion.home`"), "{error}");
}
