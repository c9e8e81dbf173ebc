//! Several pictures at each pose.

use std::path::Path;

use calipose::plan::assess::{certify, verify};
use calipose::plan::choose::{Chooser, decide};
use calipose::plan::document::Plan;
use calipose::plan::survey::survey;
use calipose::problem::{Overrides, Problem};
use calipose::verification::{Disturbance, Weighing};

fn planned(set: &[&str]) -> (Problem, Plan) {
    let set = ["sweep.step_deg=12", "selection.off_grid=false"].iter().chain(set);
    let overrides = set.fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap();
    let survey = survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
    let plan = Plan::new(&chooser, &decision).unwrap();
    certify(&plan, &problem, &survey).unwrap();
    (problem, plan)
}

#[test]
fn four_pictures_at_each_pose_halve_the_error_and_change_no_pose() {
    let (_, one) = planned(&[]);
    let (problem, four) = planned(&["selection.pictures=4"]);
    let ids = |plan: &Plan| plan.poses.iter().map(|pose| pose.id).collect::<Vec<_>>();
    assert_eq!(ids(&one), ids(&four));
    assert!((four.map_error_px / one.map_error_px - 0.5).abs() < 1e-9);
    let configurations: Vec<Vec<f64>> = four.poses.iter().map(|pose| pose.joints_rad.clone()).collect();
    for (weighing, predicted) in
        [(Weighing::Weighted, four.map_error_px), (Weighing::Unweighted, four.unweighted.unwrap().map_error_px)]
    {
        let found = verify(&problem, &configurations, &Disturbance::default(), weighing, 200, 3, &|_| {}).unwrap();
        assert!((found.map_error.predicted / predicted - 1.0).abs() < 1e-9, "{weighing:?}");
        assert!((found.map_error.measured / predicted - 1.0).abs() < 0.1, "{weighing:?}: {:?}", found.map_error);
    }
}

/// A picture taken already is one, however many are to be taken at each pose.
#[test]
fn captured_views_are_of_one_picture() {
    let captured = "constraints.captured=[[-34.2, 3.6, -156.9, 0.0], [-14.2, 83.6, -136.9, 0.0]]";
    let views = |pictures: &str| {
        let (problem, plan) = planned(&["selection.count=9", captured, "selection.criterion=d", pictures]);
        (problem, plan.value)
    };
    let ((problem, one), (_, three)) = (views("selection.pictures=1"), views("selection.pictures=3"));
    // Were it three, log det would grow by p log 3.
    let p = problem.estimated.len() as f64;
    assert!(three - one < p * 3f64.ln() - 1e-3, "{one} {three}");
}
