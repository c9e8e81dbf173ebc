//! Plans with a board that may bulge: what is predicted is what simulated calibrations of bent boards come to, with its heights estimated
//! and without.

use std::path::Path;

use calipose::plan::assess::{certify, verify};
use calipose::plan::choose::{Chooser, decide};
use calipose::plan::document::Plan;
use calipose::plan::survey::survey;
use calipose::problem::{Overrides, Problem};
use calipose::verification::{Disturbance, Weighing};

fn problem(set: &[&str]) -> Problem {
    let set = ["sweep.step_deg=12", "target.warp_mm=0.5"].iter().chain(set);
    let overrides = set.fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap()
}

fn plan(problem: &Problem) -> Plan {
    let survey = survey(problem, &|_| {}).unwrap();
    let chooser = Chooser::new(problem, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
    Plan::new(&chooser, &decision).unwrap()
}

#[test]
fn calibrations_of_bent_boards_scatter_as_predicted() {
    for noise in ["noise.model=edges", "noise.model=constant"] {
        let problem = problem(&[noise]);
        let plan = plan(&problem);
        let configurations: Vec<Vec<f64>> = plan.poses.iter().map(|pose| pose.joints_rad.clone()).collect();
        let mut predicted = Vec::new();
        for weighing in [Weighing::Weighted, Weighing::Unweighted] {
            let found = verify(&problem, &configurations, &Disturbance::default(), weighing, 300, 1, &|_| {}).unwrap();
            assert!(found.failures.is_empty(), "{:?}", found.failures);
            for parameter in &found.parameters {
                // 99 % intervals, widened a little: nine of them are asked at once.
                let (low, high) = parameter.interval;
                assert!(low < 1.05 && high > 0.95, "{noise} {weighing:?}: {parameter:?}");
            }
            predicted.push(found.map_error.predicted);
        }
        assert!((predicted[0] / plan.map_error_px - 1.0).abs() < 1e-9);
        // Who takes a board for flat that bulges by half a millimetre errs much more.
        assert!(predicted[1] > 1.3 * predicted[0], "{noise}: {predicted:?}");
        assert!((plan.unweighted.unwrap().map_error_px / predicted[1] - 1.0).abs() < 1e-9);
    }
}

/// What is to be known beside the heights is proven and recomputed by every criterion.
#[test]
fn plans_for_boards_that_may_bulge_are_certified() {
    for goal in
        ["criterion='d'", "criterion='a'", "criterion='e'", "criterion={v=0.6, d=0.4}", "accuracy={map_error_px=3}"]
    {
        let count = if goal.starts_with("accuracy") { "" } else { ", count=7" };
        let problem = problem(&[&format!("selection={{ {goal}{count} }}")]);
        let plan = plan(&problem);
        let survey = survey(&problem, &|_| {}).unwrap();
        certify(&plan, &problem, &survey).unwrap_or_else(|error| panic!("{goal}: {error}"));
    }
}

/// The less a board may bulge, the more is known of the camera, and of a board that hardly may as much as of a flat one.
#[test]
fn a_stiffer_board_tells_more() {
    let map_error = |warp: &str| {
        let problem = problem(&["selection.count=8", warp]);
        plan(&problem).map_error_px
    };
    let [bent, stiff, nearly_flat] = ["5", "0.1", "0.001"].map(|mm| map_error(&format!("target.warp_mm={mm}")));
    let flat = Problem {
        target: calipose::target::Target { warp: None, ..problem(&[]).target },
        ..problem(&["selection.count=8"])
    };
    let flat = plan(&flat).map_error_px;
    assert!(bent > stiff && stiff > nearly_flat, "{bent} {stiff} {nearly_flat}");
    assert!((nearly_flat / flat - 1.0).abs() < 1e-3, "{nearly_flat} {flat}");
}
