//! Plans with a board that may bulge: what is predicted is what simulated calibrations of bent boards come to, with its heights
//! estimated and without.

use std::path::Path;

use calipose::calibration::{CalibrationSettings, LossKind, Observations, Ties, calibrate, calibrate_by};
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
    let set = ["sweep.step_deg=12", "target.warp_mm=0.5", "selection.off_grid=false"].iter().chain(set);
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

const CRITERIA: [&str; 4] = ["criterion='d'", "criterion='a'", "criterion='e'", "criterion={v=0.6, d=0.4}"];
const ACCURACY: [&str; 1] = ["accuracy={map_error_px=3}"];

/// What is to be known beside the heights is proven and recomputed.
fn assert_certified(goals: &[&str], set: &[&str]) {
    for goal in goals {
        let count = if goal.starts_with("accuracy") { "" } else { ", count=7" };
        let problem = problem(&[&[format!("selection={{ {goal}{count} }}").as_str()], set].concat());
        let plan = plan(&problem);
        let survey = survey(&problem, &|_| {}).unwrap();
        certify(&plan, &problem, &survey).unwrap_or_else(|error| panic!("{goal} {set:?}: {error}"));
    }
}

#[test]
fn plans_for_boards_that_may_bulge_are_certified() {
    assert_certified(&CRITERIA, &[]);
    assert_certified(&ACCURACY, &[]);
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn robust_plans_for_boards_that_may_bulge_are_certified() {
    let robust = |goal: &str| {
        format!(
            "robust={{ mount_rotation_deg=1, focal_length_percent=3, scenarios=2, draws=20, seen_share=0.9{goal} }}"
        )
    };
    for goal in [", goal='mean'", ", goal='worst'"] {
        assert_certified(&CRITERIA, &[&robust(goal)]);
    }
    assert_certified(&ACCURACY, &[&robust("")]);
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

/// Corners of a board bent by `heights`, in deviations of half a millimetre, as a camera sees them from six sides.
fn bent(camera: &Camera, heights: [f64; 2], sigma: f64, seed: u64) -> (Observations, Warp) {
    let board = Board::checkerboard(9, 6, 0.03);
    let warp = Warp::new(5e-4, &board);
    let from = |(tilt, azimuth): (f64, f64)| viewpoint(0.35, tilt, azimuth, azimuth / 3.0).inverse();
    let poses: Vec<Pose> = [(0.5, 0.0), (0.5, 1.6), (0.6, 3.1), (0.6, 4.7), (0.4, 0.8), (0.1, 2.0)].map(from).into();
    let scene = Scene {
        camera: camera.clone(),
        seen: vec![Corners::All; poses.len()],
        sigma: vec![sigma; poses.len()],
        poses,
        noise: NoiseModel::Constant,
        missing: 0.0,
        surface: Surface::new(warp, heights),
    };
    (scene.observe(&board, seed).unwrap(), warp)
}

/// A board that is bent by more than a corner's noise: its heights are found, with the camera, and taken for flat it spoils the
/// camera.
#[test]
fn a_bent_board_is_recovered_with_the_camera() {
    let camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 990.0, 640.0, 360.0]).unwrap();
    let (observations, warp) = bent(&camera, [1.4, -0.8], 0.05, 1);
    let calibrated = |warp| {
        let settings = CalibrationSettings { warp, ..CalibrationSettings::default() };
        calibrate(&observations, &camera, &[0, 1, 2, 3], &settings).unwrap()
    };
    let found = calibrated(Some(warp));
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

/// What is expected of the heights weighs as much as the corners' noise that is found says, however little that is.
#[test]
fn expected_heights_do_not_pull_at_those_that_clean_corners_show() {
    let camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 990.0, 640.0, 360.0]).unwrap();
    let settings = |warp| CalibrationSettings { warp: Some(warp), ..CalibrationSettings::default() };
    let mut off = [0.0; 2];
    for seed in 0..16 {
        let (observations, warp) = bent(&camera, [1.0, -1.0], 0.01, seed);
        let found = calibrate(&observations, &camera, &[0, 1, 2, 3], &settings(warp)).unwrap();
        for (off, ([height, sigma], truth)) in off.iter_mut().zip(found.warp().unwrap().into_iter().zip([5e-4, -5e-4]))
        {
            *off += (height - truth) / sigma / 4.0;
        }
    }
    // Each the mean of sixteen in its standard deviations.
    assert!(off.iter().all(|off| off.abs() < 3.5), "{off:?}");
}

/// By a fisheye, with intrinsics that are tied, and by losses that withstand outliers.
#[test]
fn heights_are_found_by_every_lens_and_loss() {
    for lens in Lens::ALL {
        let focal = if lens.is_fisheye() { 450.0 } else { 900.0 };
        let mut intrinsics = vec![0.0; lens.parameter_names().len()];
        intrinsics[..4].copy_from_slice(&[focal, focal, 640.0, 360.0]);
        if let Some(first) = intrinsics.get_mut(4) {
            *first = -0.05;
        }
        let camera = Camera::new(lens, 1280, 720, &intrinsics).unwrap();
        let (observations, warp) = bent(&camera, [1.4, -0.8], 0.05, 2);
        for loss in [LossKind::Squared, LossKind::Huber, LossKind::Cauchy] {
            let ties = Ties::default().and(0, 1);
            let settings = CalibrationSettings { warp: Some(warp), ties, ..CalibrationSettings::default() };
            let estimated = [0, 1, 2, 3, 4][..intrinsics.len().min(5)].to_vec();
            let found = calibrate_by(loss, &observations, &camera, &estimated, &settings).unwrap();
            for ([height, sigma], truth) in found.warp().unwrap().into_iter().zip([7e-4, -4e-4]) {
                assert!((height - truth).abs() < 4.0 * sigma && sigma < 2e-4, "{lens:?} {loss:?}: {height} ± {sigma}");
            }
        }
    }
}
