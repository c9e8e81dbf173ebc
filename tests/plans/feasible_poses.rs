//! Poses that the robot can take, on the shipped Servosila problem with bodies and masses (whose shapes are assumed).

use std::ops::ControlFlow;
use std::path::Path;
use std::process::Command;

use calipose::feasibility::{Occlusion, Rejection, View, feasible_views};
use calipose::plan::assess::verify;
use calipose::plan::choose::{Chooser, decide};
use calipose::plan::document::{Document, Plan};
use calipose::plan::survey::survey;
use calipose::problem::{Goal, Method, Overrides, Problem};
use calipose::sweep::sweep;
use calipose::target::{Corners, Marker};
use calipose::verification::{Disturbance, Weighing};
use nalgebra::Point3;

fn on_grid(file: &str) -> Problem {
    let on_grid = Overrides::new().set("selection.off_grid=false").unwrap();
    Problem::read_with(Path::new(&format!("problems/{file}.toml")), &on_grid).unwrap()
}

fn bodies() -> Problem {
    on_grid("servosila-engineer-bodies")
}

/// The problem with views that need `corners` of the 48 only.
fn partial(corners: usize) -> Problem {
    let text = std::fs::read_to_string("problems/servosila-engineer-bodies.toml").unwrap();
    let text = text.replace("[selection]", "[selection]\noff_grid = false");
    let text = text.replace("[visibility]", &format!("[visibility]\nmin_corners = {corners}"));
    Problem::parse(&text, Path::new("partial.toml")).unwrap()
}

fn views(problem: &Problem) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let found = sweep(&problem.robot, &problem.target, &problem.space, problem.axis, &|_| {});
    feasible_views(&problem.checks(), &problem.space, &found.candidates)
}

#[test]
fn bodies_only_take_views_away() {
    let plain = on_grid("servosila-engineer");
    let (seen, seen_rejected) = views(&plain);
    let (left, rejected) = views(&bodies());
    assert_eq!(seen.len(), 4534);
    let ids: Vec<usize> = seen.iter().map(|view| view.id).collect();
    assert!(left.iter().all(|view| ids.binary_search(&view.id).is_ok()));
    // Rejected for the reasons of visibility as before, for the new ones what is missing now.
    let visibility = Rejection::Unstable as usize;
    assert_eq!(rejected[..visibility], seen_rejected[..visibility]);
    assert_eq!(rejected[visibility..].iter().sum::<usize>(), seen.len() - left.len());
    // The figures of the book.
    assert_eq!((&rejected[visibility..], left.len()), (&[72, 36, 0, 2545, 0][..], 1881));
}

/// Each view anew, by the tests themselves.
#[test]
fn views_are_stable_free_of_collision_and_seen_whole() {
    let problem = bodies();
    let checks = problem.checks();
    let stability = problem.stability.as_ref().unwrap();
    let tree = &problem.robot.tree;
    for view in views(&problem).0 {
        let X_BL = tree.link_poses(&view.q);
        let margin = stability.margin_at(tree, &X_BL);
        assert_eq!(view.stability_margin, margin);
        assert!(margin.unwrap() >= 0.02);
        assert!(checks.collision().gaps(&X_BL).iter().all(|&(_, gap)| gap > 0.005 - 1e-9));
        assert_eq!(view.seen, Corners::All);
    }
}

#[test]
fn verdicts_are_the_same_on_any_number_of_threads() {
    let problem = partial(30);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| views(&problem))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn plans_have_the_tip_over_margin_of_every_pose() {
    let problem = bodies();
    let survey = survey(&problem, &|_| {}).unwrap();
    let mut settings = problem.clone();
    settings.selection.goal =
        Goal::Best { criteria: problem.selection.goal.criteria().into(), count: 8, method: Method::Best };
    let chooser = Chooser::new(&settings, &survey).unwrap();
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let plan = Plan::new(&chooser, &decision).unwrap();
    let json: serde_json::Value = serde_json::from_str(&plan.to_json()).unwrap();
    for (pose, &i) in json["poses"].as_array().unwrap().iter().zip(&decision.choice.selected) {
        assert_eq!(pose["stability_margin_m"].as_f64(), survey.views[i].stability_margin);
        assert_eq!(pose.get("corners_seen"), None);
    }
    for reason in ["self_collision", "occluded", "unstable"] {
        assert!(json["survey"]["rejected"][reason].as_u64().unwrap() > 0);
    }
    assert_eq!(Plan::from_json(&plan.to_json()).unwrap(), plan);
    let csv = String::from_utf8(plan.to_csv(&problem.robot.chain.joints).unwrap()).unwrap();
    assert!(csv.lines().next().unwrap().ends_with(",share,stability_margin_m"));
}

#[test]
fn check_tells_what_is_tested() {
    let check = |file: &str| -> serde_json::Value {
        let output = Command::new(env!("CARGO_BIN_EXE_calipose")).args(["check", file, "--json"]).output().unwrap();
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let document = check("problems/servosila-engineer-bodies.toml");
    assert!((document["mass_kg"].as_f64().unwrap() - 18.72).abs() < 1e-9);
    let pairs = &document["self_collision"];
    assert_eq!(pairs["clearance_mm"], 5.0);
    assert_eq!(pairs["adjacent"].as_array().unwrap().len(), 5);
    assert_eq!(pairs["always_in_contact"], serde_json::json!([]));
    assert_eq!(pairs["never_seen"], serde_json::json!([["waist", "board"], ["shoulder", "neck"]]));
    let tested = pairs["tested"].as_array().unwrap();
    assert_eq!(tested.len(), 10);
    let never = tested.iter().filter(|pair| pair["share"] == 0.0);
    assert_eq!(never.count(), 2, "pairs never seen in contact are tested all the same");
    let plain = check("problems/servosila-engineer.toml");
    assert_eq!((&plain["self_collision"], &plain["mass_kg"]), (&serde_json::Value::Null, &serde_json::Value::Null));
}

#[test]
fn boards_read_in_part_keep_the_corners_that_are_seen() {
    let (whole, _) = views(&bodies());
    let problem = partial(20);
    let (some, _) = views(&problem);
    assert!(some.len() > whole.len());
    let seen_whole = some.iter().filter(|view| view.seen == Corners::All).count();
    assert_eq!(seen_whole, whole.len());
    let checks = problem.checks();
    for view in some.iter().step_by(50) {
        let indices = view.seen.indices(48);
        assert!(indices.len() >= 20 && indices.is_sorted() && problem.target.board.fix_homography(&indices));
        assert_eq!(checks.view(view.id, &view.q).as_ref(), Ok(view));
        // Every corner left out is outside the image's margin, or hidden; every corner kept is inside.
        for (i, corner) in problem.target.board.corners().enumerate() {
            let pixel = problem.camera.project(&(view.X_CT * corner));
            let inside = pixel.is_some_and(|pixel| problem.camera.contains(&pixel, problem.visibility.margin));
            assert!(inside || !view.seen.contains(i));
        }
    }
}

/// Each view of the ChArUco board anew, by the tests themselves.
#[test]
fn corners_of_boards_with_markers_count_where_both_of_theirs_are_read() {
    let problem = on_grid("servosila-engineer-charuco");
    let (views, _) = views(&problem);
    let markers = problem.target.board.markers();
    let occlusion = Occlusion::new(&problem.robot.tree, problem.robot.camera_link);
    assert!(views.iter().any(|view| view.seen != Corners::All) && views.iter().any(|view| view.seen == Corners::All));
    for view in views.iter().step_by(60) {
        let X_BL = problem.robot.link_poses(&view.q);
        let is_hidden =
            |points: &[Point3<f64>]| occlusion.hidden(&X_BL, &view.X_BC, &problem.target.X_BT, points).contains(&true);
        let pixel = |point: &Point3<f64>| problem.camera.project(&(view.X_CT * point));
        let is_read = |marker: &Marker| {
            let Some(pixels) = marker.outline.iter().map(pixel).collect::<Option<Vec<_>>>() else { return false };
            let side = |i: usize| (pixels[i] - pixels[(i + 1) % 4]).norm();
            // OpenCV's `minDistanceToBorder`.
            pixels.iter().all(|pixel| problem.camera.contains(pixel, 3.0))
                && (0..4).all(|i| side(i) >= problem.visibility.min_marker)
                && !is_hidden(&marker.outline)
                && !is_hidden(&marker.inside)
        };
        let read: Vec<bool> = markers.iter().map(is_read).collect();
        for (i, corner) in problem.target.board.corners().enumerate() {
            let of: Vec<bool> =
                (0..markers.len()).filter(|&m| markers[m].corners.contains(&i)).map(|m| read[m]).collect();
            assert_eq!(of.len(), 2);
            let is_in = pixel(&corner).is_some_and(|pixel| problem.camera.contains(&pixel, problem.visibility.margin));
            let counts = is_in && !is_hidden(&[corner]) && of == [true, true];
            assert_eq!(view.seen.contains(i), counts, "view {}, corner {i}", view.id);
        }
    }
}

/// The information of partial views is what calibrations from their corners alone attain.
#[test]
fn plans_of_partial_views_do_what_they_predict() {
    let problem = partial(20);
    let survey = survey(&problem, &|_| {}).unwrap();
    let (choice, _) = Chooser::new(&problem, &survey).unwrap().best(12, 0).unwrap();
    let chosen: Vec<&View> = choice.selected.iter().map(|&i| &survey.views[i]).collect();
    assert!(chosen.iter().any(|view| view.seen != Corners::All), "the plan must use the partial views");
    let configurations: Vec<_> = chosen.iter().map(|view| view.q.clone()).collect();
    let found =
        verify(&problem, &configurations, &Disturbance::default(), Weighing::default(), 200, 1, &|_| {}).unwrap();
    assert!(found.failures.is_empty(), "{:?}", found.failures);
    assert!((found.map_error.predicted / choice.map_error - 1.0).abs() < 1e-9);
    for parameter in &found.parameters {
        // 99 % intervals, widened a little: nine of them are asked at once.
        let (low, high) = parameter.interval;
        assert!(low < 1.05 && high > 0.95, "{parameter:?}");
    }
}
