//! Plans whose tours count in the choice.

use std::ops::ControlFlow;
use std::path::Path;

use calipose::plan::assess::certify;
use calipose::plan::choose::{Chooser, Decision, PlanError, decide, plan_survey};
use calipose::plan::document::{Plan, TourDocument, TradeDocument};
use calipose::plan::survey::Survey;
use calipose::problem::{Overrides, Problem};

fn problem(file: &str, set: &[&str]) -> Problem {
    let overrides = set.iter().fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    Problem::read_with(Path::new(&format!("problems/{file}.toml")), &overrides).unwrap()
}

fn decided(problem: &Problem) -> Result<(Survey, Decision, Plan), PlanError> {
    let survey = plan_survey(problem, &|_| {})?;
    let chooser = Chooser::new(problem, &survey)?;
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(()))?;
    let plan = Plan::new(&chooser, &decision)?;
    Ok((survey, decision, plan))
}

fn trade(plan: &Plan) -> (&TourDocument, &TradeDocument) {
    let tour = plan.tour.as_ref().unwrap();
    (tour, tour.trade.as_ref().unwrap())
}

const SWEPT: [&str; 2] = ["sweep.step_deg=16", "selection.off_grid=false"];
const COUNT: &str = "selection.count=8";

#[test]
fn what_is_given_up_shortens_the_tour_and_no_more_is() {
    let mut before = f64::INFINITY;
    for tolerance in ["0", "0.01", "0.1"] {
        let given_up: f64 = tolerance.parse().unwrap();
        let set = format!("selection.tour_tolerance={tolerance}");
        let problem = problem("servosila-engineer", &[&SWEPT[..], &[COUNT, &set]].concat());
        let (survey, decision, plan) = decided(&problem).unwrap();
        certify(&plan, &problem, &survey).unwrap();
        let tour = plan.tour.as_ref().unwrap();
        assert!(tour.total_s <= before + 1e-9, "{} {before}", tour.total_s);
        before = tour.total_s;
        let Some(trade) = &tour.trade else {
            assert_eq!(given_up, 0.0);
            continue;
        };
        assert!(trade.least_total_s.unwrap() <= tour.total_s && trade.most_poses.is_none());
        let best = decision.trade.unwrap().best;
        assert_eq!(trade.kept.is_some(), best.is_some());
        if let (Some(kept), Some(best)) = (trade.kept, best) {
            assert!((1.0 - given_up..1.0).contains(&kept), "{kept}");
            assert!(best.seconds > tour.total_s);
            // What was given up is not claimed.
            assert!((plan.efficiency - (decision.choice.log_value - decision.log_bound).exp()).abs() < 1e-12);
            let mut claims = plan.clone();
            claims.tour.as_mut().unwrap().trade.as_mut().unwrap().kept = Some(0.5);
            let error = certify(&claims, &problem, &survey).unwrap_err().to_string();
            assert!(error.contains("the share of the best set's information"), "{error}");
        }
    }
    assert!(before < 33.0, "{before}");
}

/// Also of poses at other joint values than the sweep's, which are pulled together.
#[test]
fn poses_off_the_grid_are_pulled_together() {
    let of = |tolerance: &str| {
        let set = format!("selection.tour_tolerance={tolerance}");
        let problem = problem("servosila-engineer", &["sweep.step_deg=20", "selection.count=6", &set]);
        let (survey, _, plan) = decided(&problem).unwrap();
        certify(&plan, &problem, &survey).unwrap();
        (survey, plan)
    };
    let (_, best) = of("0");
    let (survey, near) = of("0.02");
    assert_eq!(survey.near.len(), 6);
    let (tour, trade) = trade(&near);
    assert!(tour.moving_s < 0.98 * best.tour.as_ref().unwrap().moving_s, "{}", tour.moving_s);
    assert!(trade.kept.unwrap() >= 0.98);
    assert!(near.value < 1.03 * best.value, "{} {}", near.value, best.value);
}

#[test]
fn a_tour_keeps_the_time_that_is_asked_for_and_more_time_tells_more() {
    let mut before = f64::INFINITY;
    let mut counts = Vec::new();
    for most in ["25", "40", "80"] {
        let set = format!("selection.time={{most_s={most}}}");
        let problem = problem("servosila-engineer", &[&SWEPT[..], &[set.as_str()]].concat());
        let (survey, _, plan) = decided(&problem).unwrap();
        let confirmed = certify(&plan, &problem, &survey).unwrap();
        let (tour, trade) = trade(&plan);
        let seconds: f64 = most.parse().unwrap();
        assert!(tour.total_s <= seconds && tour.total_s > 0.7 * seconds, "{} of {most}", tour.total_s);
        assert!(plan.value < before, "{} {before}", plan.value);
        before = plan.value;
        let most_poses = trade.most_poses.unwrap();
        assert!(most_poses >= plan.count && confirmed.efficiency > 0.2, "{}", confirmed.efficiency);
        counts.push(plan.count);
        // Fewer than may fit are no bound.
        if plan.count < most_poses {
            let mut claims = plan.clone();
            claims.tour.as_mut().unwrap().trade.as_mut().unwrap().most_poses = Some(most_poses - 1);
            let error = certify(&claims, &problem, &survey).unwrap_err().to_string();
            assert!(error.contains("the most poses whose tour may keep the time"), "{error}");
        }
    }
    assert!(counts.is_sorted() && counts[0] < counts[2], "{counts:?}");
}

#[test]
fn no_plan_takes_less_time_than_there_is() {
    let problem = problem("servosila-engineer", &[&SWEPT[..], &["selection.time={most_s=0.5}"]].concat());
    let error = decided(&problem).unwrap_err();
    let PlanError::NoTime { seconds: 0.5, .. } = error else { panic!("{error}") };
    assert!(error.to_string().starts_with("no tour of poses that determine all intrinsics was found that takes 0.5 s"));
}

#[test]
fn accuracies_are_reached_in_the_least_time() {
    let accuracy = "selection.accuracy={map_error_px=2.5}";
    let of = |least: &str| {
        let set = format!("selection.least=\"{least}\"");
        let tolerance = "selection.tour_tolerance=0";
        let sets: &[&str] = if least == "poses" { &[accuracy, &set, tolerance] } else { &[accuracy, &set] };
        let problem = problem("servosila-engineer", &[&SWEPT[..], sets, &["motion.dwell_s=0.2"]].concat());
        let (survey, _, plan) = decided(&problem).unwrap();
        let fewest = plan.fewest.as_ref().unwrap();
        assert!(plan.map_error_px <= 2.5 && fewest.least <= plan.count);
        certify(&plan, &problem, &survey).unwrap();
        plan
    };
    let (fewest, fastest) = (of("poses"), of("time"));
    let (tour, trade) = trade(&fastest);
    let before = fewest.tour.as_ref().unwrap().total_s;
    assert!(tour.total_s < 0.95 * before, "{} {before}", tour.total_s);
    assert!(trade.best_total_s.unwrap() <= before + 1e-9 && trade.least_total_s.unwrap() <= tour.total_s);
    let found = fastest.fewest.as_ref().unwrap().found;
    assert_eq!(found.unwrap_or(fastest.count), fewest.count);
}

/// A wall beside the arm, which it cannot pass: some of the best poses are on its other side.
#[test]
fn poses_that_nothing_leads_to_give_way_to_others() {
    let wall =
        r#"scene.bodies=[{name="wall", box_mm=[700, 10, 900], pose={position_mm=[445, 15, 465], rpy_deg=[0, 0, 2]}}]"#;
    let set = ["sweep.step_deg=16", "selection.off_grid=false", "selection.count=6", "motion.home=[90, 60, -150, 90]"];
    let problem = problem("servosila-engineer-bodies", &[&set[..], &[wall]].concat());
    let (survey, decision, plan) = decided(&problem).unwrap();
    let tour = plan.tour.as_ref().unwrap();
    assert!(!tour.gave_way.is_empty(), "{:?}", plan.poses.iter().map(|pose| &pose.joints_deg).collect::<Vec<_>>());
    assert!(tour.moves.iter().all(|found| found.safe == Some(true)), "{tour:?}");
    for gone in &tour.gave_way {
        assert!(plan.poses.iter().all(|pose| pose.id != gone.id));
        assert!(gone.endangered.iter().any(|name| name == "wall"), "{gone:?}");
    }
    assert_eq!(decision.gave_way.len(), tour.gave_way.len());
    certify(&plan, &problem, &survey).unwrap();
}
