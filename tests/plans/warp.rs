//! Plans with a board that may bulge: what is predicted is what simulated calibrations of bent boards come to, with its heights estimated
//! and without.

use std::path::Path;

use calipose::calibration::{CalibrationSettings, ExpectedWarp, calibrate};
use calipose::camera::{Camera, Lens};
use calipose::information::NoiseModel;
use calipose::plan::assess::{certify, verify};
use calipose::plan::choose::{Chooser, decide};
use calipose::plan::document::Plan;
use calipose::plan::survey::survey;
use calipose::problem::{Overrides, Problem};
use calipose::spatial::Pose;
use calipose::target::{Board, Corners, Surface, Target, Warp, viewpoint};
use calipose::verification::{Disturbance, Scene, Weighing};

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
    let flat = Problem { target: Target { warp: None, ..problem(&[]).target }, ..problem(&["selection.count=8"]) };
    let flat = plan(&flat).map_error_px;
    assert!(bent > stiff && stiff > nearly_flat, "{bent} {stiff} {nearly_flat}");
    assert!((nearly_flat / flat - 1.0).abs() < 1e-3, "{nearly_flat} {flat}");
}

/// A board that is bent by more than a corner's noise: its heights are found, with the camera, and taken for flat it spoils the camera.
#[test]
fn a_bent_board_is_recovered_with_the_camera() {
    let camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 990.0, 640.0, 360.0]).unwrap();
    let board = Board::checkerboard(9, 6, 0.03);
    let warp = Warp::new(5e-4, &board);
    let from = |(tilt, azimuth): (f64, f64)| viewpoint(0.35, tilt, azimuth, azimuth / 3.0).inverse();
    let poses: Vec<Pose> = [(0.5, 0.0), (0.5, 1.6), (0.6, 3.1), (0.6, 4.7), (0.4, 0.8), (0.1, 2.0)].map(from).into();
    let scene = Scene {
        camera: camera.clone(),
        seen: vec![Corners::All; poses.len()],
        sigma: vec![0.05; poses.len()],
        poses,
        noise: NoiseModel::Constant,
        missing: 0.0,
        surface: Surface::new(warp, [1.4, -0.8]),
    };
    let observations = scene.observe(&board, 1).unwrap();
    let calibrated = |warp| {
        let settings = CalibrationSettings { warp, ..CalibrationSettings::default() };
        calibrate(&observations, &camera, &[0, 1, 2, 3], &settings).unwrap()
    };
    let found = calibrated(Some(ExpectedWarp { warp, sigma: 0.05 }));
    assert!(found.convergence.converged);
    assert!((found.sigma / 0.05 - 1.0).abs() < 0.1, "{}", found.sigma);
    for ([height, sigma], truth) in found.warp().unwrap().into_iter().zip([7e-4, -4e-4]) {
        assert!((height - truth).abs() < 4.0 * sigma && sigma < 5e-5, "{height} ± {sigma}, {truth}");
    }
    for (j, truth) in camera.intrinsics().iter().enumerate() {
        assert!((found.camera.intrinsics()[j] - truth).abs() < 4.0 * found.sigma_of(j), "{j}");
    }
    assert_eq!(found.joint_covariance.view((2, 2), (4, 4)), found.covariance);
    let flat = calibrated(None);
    assert_eq!((flat.warp(), &flat.joint_covariance), (None, &flat.covariance));
    assert!(flat.rms > 2.0 * found.rms, "{} {}", flat.rms, found.rms);
    assert!((flat.camera.intrinsics()[0] - 1000.0).abs() > 8.0 * found.sigma_of(0), "{:?}", flat.camera);
}
