//! The module as a whole on simulated views.

use nalgebra::{Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;
use crate::camera::Lens;
use crate::spatial::Pose;
use crate::target::Board;

const BOARD: Board = Board::checkerboard(8, 6, 0.035);

fn camera(lens: Lens) -> Camera {
    let coefficients: &[f64] = match lens {
        Lens::Rational => &[0.9, 0.4, 1e-3, -5e-4, 0.03, 1.2, 0.7, 0.12],
        _ => lens.typical(),
    };
    let focal = if lens.is_fisheye() { 450.0 } else { 900.0 };
    Camera::new(lens, 1280, 960, &[&[focal, 0.99 * focal, 641.0, 472.0], coefficients].concat()).unwrap()
}

/// Random views of the whole board, seen from its printed side.
fn poses(camera: &Camera, count: usize, tilt: f64, seed: u64) -> Vec<Pose> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut poses = Vec::new();
    while poses.len() < count {
        let mut within = |a: f64| rng.gen_range(-a..a);
        let turned = Pose::rotation(Vector3::new(tilt * within(1.0), tilt * within(1.0), within(0.5)));
        let upright = Pose::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        let z = 0.4 + within(0.15);
        let X_CT = Pose::translation(z * within(0.8), z * within(0.6), z) * turned * upright;
        let visible = |p: Point3<f64>| camera.project(&(X_CT * p)).is_some_and(|pixel| camera.contains(&pixel, 2.0));
        if BOARD.corners().all(visible) {
            poses.push(X_CT);
        }
    }
    poses
}

fn views(camera: &Camera, poses: &[Pose], sigma: f64) -> Vec<View> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(99);
    let noise = Normal::new(0.0, sigma).unwrap();
    let mut see = |X_CT: &Pose, p: Point3<f64>| {
        camera.project(&(X_CT * p)).unwrap() + Vector2::new(noise.sample(&mut rng), noise.sample(&mut rng))
    };
    poses
        .iter()
        .map(|X| {
            BOARD.corners().enumerate().map(|(index, p)| Corner { index, pixel: see(X, p), weight: 1.0 }).collect()
        })
        .collect()
}

fn observe(camera: &Camera, poses: &[Pose], sigma: f64) -> Observations {
    Observations::new(BOARD, camera.width(), camera.height(), views(camera, poses, sigma)).unwrap()
}

/// A camera that knows nothing but lens and image.
fn ignorant(camera: &Camera) -> Camera {
    let mut θ = vec![0.0; camera.intrinsics().len()];
    (θ[0], θ[1]) = (1.0, 1.0);
    camera.with_intrinsics(&θ).unwrap()
}

fn all(camera: &Camera) -> Vec<usize> {
    (0..camera.intrinsics().len()).collect()
}

fn solve(camera: &Camera, observations: &Observations) -> Result<Calibration, CalibrationError> {
    calibrate(observations, &ignorant(camera), &all(camera), &CalibrationSettings::default())
}

#[test]
fn noise_free_views_give_back_every_camera_and_pose() {
    for lens in Lens::ALL {
        let truth = camera(lens);
        let poses = poses(&truth, 10, 0.7, 1);
        let found = solve(&truth, &observe(&truth, &poses, 0.0)).unwrap();
        assert!(found.convergence.converged, "{lens:?}: {:?}", found.convergence);
        assert!(found.rms < 1e-9, "{lens:?}: {}", found.rms);
        // The rational model's numerator and denominator nearly cancel: what counts is the projection.
        let tolerance = if lens.denominator().is_empty() { 1e-8 } else { 1e-4 };
        for (a, b) in found.camera.intrinsics().iter().zip(truth.intrinsics()) {
            assert!((a - b).abs() < tolerance * b.abs().max(1.0), "{lens:?}: {a} for {b}");
        }
        for (a, b) in found.poses.iter().zip(&poses) {
            assert!((a.translation.vector - b.translation.vector).norm() < 1e-9, "{lens:?}");
            assert!(a.rotation.angle_to(&b.rotation) < 1e-7, "{lens:?}");
            assert!((a.rotation * Vector3::z()).dot(&a.translation.vector) < 0.0, "z of T points at the camera");
        }
    }
}

#[test]
fn the_gradient_vanishes_at_the_optimum() {
    let truth = camera(Lens::BrownConrady);
    let observations = observe(&truth, &poses(&truth, 8, 0.7, 2), 0.3);
    let found = solve(&truth, &observations).unwrap();
    let cost = |camera: &Camera, poses: &[Pose]| -> f64 {
        let views = observations.views().iter().zip(poses);
        views
            .flat_map(|(view, X)| view.iter().map(move |c| (c, X)))
            .map(|(c, X)| {
                let p = BOARD.corner(c.index);
                (camera.project(&(X * p)).unwrap() - c.pixel).norm_squared()
            })
            .sum()
    };
    let best = cost(&found.camera, &found.poses);
    assert!((best - found.convergence.cost).abs() < 1e-9 * best);
    for j in 0..9 {
        let moved = |h: f64| {
            let mut θ = found.camera.intrinsics().to_vec();
            θ[j] += h;
            cost(&found.camera.with_intrinsics(&θ).unwrap(), &found.poses)
        };
        // A parabola through three points has its vertex here, by far less than a standard deviation.
        let h = found.covariance[(j, j)].sqrt();
        let (low, high) = (moved(-h) - best, moved(h) - best);
        assert!(low > 0.0 && high > 0.0);
        assert!((low - high).abs() < 1e-2 * (low + high), "{j}: {low} {high}");
    }
}

#[test]
fn only_the_named_intrinsics_move() {
    let truth = camera(Lens::BrownConrady);
    let observations = observe(&truth, &poses(&truth, 8, 0.7, 3), 0.2);
    let mut θ = truth.intrinsics().to_vec();
    (θ[0], θ[1], θ[4]) = (1.0, 1.0, 5.0);
    let nominal = truth.with_intrinsics(&θ).unwrap();
    let found = calibrate(&observations, &nominal, &[4, 0, 1], &CalibrationSettings::default()).unwrap();
    for j in [2, 3, 5, 6, 7, 8] {
        assert_eq!(found.camera.intrinsics()[j], truth.intrinsics()[j]);
    }
    for (i, j) in [(0, 4), (1, 0), (2, 1)] {
        let deviation = found.covariance[(i, i)].sqrt();
        assert!((found.camera.intrinsics()[j] - truth.intrinsics()[j]).abs() < 4.5 * deviation);
    }
    let again = calibrate(&observations, &truth, &[4, 0, 1], &CalibrationSettings::default()).unwrap();
    assert_eq!(again, found, "the nominal values of estimated intrinsics are not read");
}

#[test]
fn noise_is_estimated_and_explains_the_errors() {
    for lens in [Lens::Pinhole, Lens::BrownConrady, Lens::KannalaBrandt] {
        let truth = camera(lens);
        let found = solve(&truth, &observe(&truth, &poses(&truth, 20, 0.7, 4), 0.3)).unwrap();
        assert!((found.sigma / 0.3 - 1.0).abs() < 0.1, "{}", found.sigma);
        assert!(found.outliers.is_empty());
        assert_eq!(found.view_rms.len(), 20);
        let p = truth.intrinsics().len();
        let δ = nalgebra::DVector::from_fn(p, |j, _| found.camera.intrinsics()[j] - truth.intrinsics()[j]);
        let distance = δ.dot(&found.covariance.clone().cholesky().unwrap().solve(&δ));
        // χ² of at most nine degrees: beyond 28 once in a thousand.
        assert!(distance < 28.0, "{lens:?}: {distance}");
    }
}

#[test]
fn outliers_are_named_and_a_robust_loss_resists_them() {
    let truth = camera(Lens::BrownConrady);
    let poses = poses(&truth, 12, 0.7, 5);
    let mut views = views(&truth, &poses, 0.2);
    let planted = [(1, 3), (4, 40), (4, 11), (9, 0), (11, 25)];
    for (view, index) in planted {
        views[view][index].pixel += Vector2::new(6.0, -5.0);
    }
    let observations = Observations::new(BOARD, 1280, 960, views).unwrap();
    let errors = |loss: Loss| {
        let refinement = RefinementSettings { loss, ..RefinementSettings::default() };
        let settings = CalibrationSettings { refinement, ..CalibrationSettings::default() };
        let found = calibrate(&observations, &ignorant(&truth), &all(&truth), &settings).unwrap();
        assert!(found.convergence.converged, "{loss:?}: {:?}", found.convergence);
        let mut named: Vec<_> = found.outliers.iter().map(|o| (o.view, o.index)).collect();
        if loss == Loss::Squared {
            // Least squares lets an outlier drag its neighbours along; they follow it in the list.
            named.truncate(planted.len());
        }
        named.sort_unstable();
        let mut expected = planted.to_vec();
        expected.sort_unstable();
        assert_eq!(named, expected, "{loss:?}");
        (found.camera.intrinsics()[0] - 900.0).abs()
    };
    let squared = errors(Loss::Squared);
    assert!(errors(Loss::Huber { scale: 0.27 }) < squared);
    assert!(errors(Loss::Cauchy { scale: 0.48 }) < squared);
}

#[test]
fn degenerate_sets_are_refused_with_their_reason() {
    let truth = camera(Lens::Pinhole);
    let single = observe(&truth, &poses(&truth, 1, 0.7, 6), 0.0);
    let error = solve(&truth, &single).unwrap_err();
    assert_eq!(error, CalibrationError::TooFewViews { found: 1, needed: 2, pinhole_parameters: 4 });
    assert!(
        error.to_string().starts_with("1 view of a planar board without lens distortion determines at most 2"),
        "{error}"
    );
    for (seed, sigma) in [(7, 0.0), (8, 0.01), (9, 0.3)] {
        for tilt in [0.0, 0.3] {
            let mut poses = poses(&truth, 8, 0.2, seed);
            let rotation = Pose::rotation(Vector3::new(std::f64::consts::PI + tilt, 0.0, 0.0)).rotation;
            for X_CT in &mut poses {
                X_CT.rotation = rotation;
            }
            let error = solve(&truth, &observe(&truth, &poses, sigma)).unwrap_err();
            assert!(matches!(error, CalibrationError::ParallelBoards { .. }), "{sigma} {tilt}: {error}");
        }
    }
}

#[test]
fn arguments_that_do_not_fit_are_refused() {
    let truth = camera(Lens::BrownConrady);
    let observations = observe(&truth, &poses(&truth, 4, 0.7, 10), 0.1);
    let settings = CalibrationSettings::default();
    for estimated in [&[][..], &[0, 0], &[9]] {
        let error = calibrate(&observations, &truth, estimated, &settings).unwrap_err();
        assert!(matches!(error, CalibrationError::Parameters { count: 9, .. }));
    }
    let other = Camera::new(Lens::Pinhole, 640, 480, &[500.0, 500.0, 320.0, 240.0]).unwrap();
    assert!(matches!(calibrate(&observations, &other, &[0], &settings), Err(CalibrationError::ImageSize { .. })));
    let refinement = RefinementSettings { loss: Loss::Huber { scale: 0.0 }, ..RefinementSettings::default() };
    let bad = CalibrationSettings { refinement, ..settings };
    assert!(matches!(calibrate(&observations, &truth, &[0], &bad), Err(CalibrationError::Setting { value: 0.0, .. })));
    let tied = CalibrationSettings { ties: Ties::default().and(0, 1), ..settings };
    assert_eq!(calibrate(&observations, &truth, &[0, 2, 3], &tied), Err(CalibrationError::Tied { a: "fx", b: "fy" }));
    let few: Vec<View> = views(&truth, &poses(&truth, 2, 0.7, 11), 0.1)
        .into_iter()
        .map(|view| [0, 7, 40, 47].map(|i| view[i]).to_vec())
        .collect();
    let few = Observations::new(BOARD, 1280, 960, few).unwrap();
    assert_eq!(
        calibrate(&few, &truth, &all(&truth), &settings),
        Err(CalibrationError::TooFewMeasurements { measured: 16, unknown: 21 })
    );
}

#[test]
fn running_out_of_iterations_is_said() {
    let truth = camera(Lens::BrownConrady);
    let observations = observe(&truth, &poses(&truth, 10, 0.7, 12), 0.3);
    let refinement = RefinementSettings { max_iterations: 1, ..RefinementSettings::default() };
    let settings = CalibrationSettings { refinement, ..CalibrationSettings::default() };
    let found = calibrate(&observations, &truth, &all(&truth), &settings).unwrap();
    assert!(!found.convergence.converged && found.convergence.iterations == 1);
}

#[test]
fn tied_intrinsics_share_one_value_and_are_known_better_for_it() {
    let lens = Lens::BrownConrady;
    let truth = Camera::new(lens, 1280, 960, &[900.0, 900.0, 641.0, 472.0, -0.2, 0.05, 1e-3, -2e-3, 0.01]).unwrap();
    let observations = observe(&truth, &poses(&truth, 8, 0.7, 14), 0.3);
    let settings = CalibrationSettings { ties: Ties::default().and(1, 0), ..CalibrationSettings::default() };
    let free = solve(&truth, &observations).unwrap();
    let tied = calibrate(&observations, &ignorant(&truth), &all(&truth), &settings).unwrap();
    assert!(tied.convergence.converged && tied.convergence.cost > free.convergence.cost);
    let (θ, C) = (tied.camera.intrinsics(), &tied.covariance);
    assert_eq!(θ[0], θ[1]);
    assert_eq!((C[(0, 0)], C[(0, 5)]), (C[(1, 1)], C[(1, 5)]));
    assert_eq!(C[(0, 0)], C[(0, 1)]);
    assert!(C[(0, 0)] < free.covariance[(0, 0)] && (θ[0] - 900.0).abs() < 4.5 * C[(0, 0)].sqrt());
    // As the estimate on the line fx = fy of the free one, whose covariance says how far that is: chi² of one degree.
    let c = nalgebra::DVector::from_fn(9, |j, _| [1.0, -1.0].get(j).copied().unwrap_or(0.0));
    let along = &free.covariance * &c;
    let (gap, variance) = (free.camera.intrinsics()[0] - free.camera.intrinsics()[1], c.dot(&along));
    for j in 0..9 {
        let expected = free.camera.intrinsics()[j] - along[j] * gap / variance;
        assert!((θ[j] - expected).abs() < 0.02 * C[(j, j)].sqrt(), "{j}: {} for {expected}", θ[j]);
    }
}

#[test]
fn weights_are_relative_and_small_ones_take_a_corner_out() {
    let truth = camera(Lens::BrownConrady);
    let poses = poses(&truth, 8, 0.7, 15);
    let changed = |change: &dyn Fn(usize, &mut Corner)| {
        let mut views = views(&truth, &poses, 0.2);
        for view in &mut views {
            view.iter_mut().enumerate().for_each(|(i, corner)| change(i, corner));
        }
        solve(&truth, &Observations::new(BOARD, 1280, 960, views).unwrap()).unwrap()
    };
    let plain = changed(&|_, _| ());
    let doubled = changed(&|_, corner| corner.weight = 2.0);
    assert!((doubled.camera.intrinsics()[0] - plain.camera.intrinsics()[0]).abs() < 1e-6);
    assert!((doubled.sigma / plain.sigma - 2.0).abs() < 1e-9 && (doubled.rms - plain.rms).abs() < 1e-9);
    assert!((doubled.covariance[(4, 4)] / plain.covariance[(4, 4)] - 1.0).abs() < 1e-6);

    let shifted = changed(&|i, corner| {
        if i % 7 == 0 {
            corner.pixel.x += 20.0;
            corner.weight = 1e-5;
        }
    });
    let mut views = views(&truth, &poses, 0.2);
    for view in &mut views {
        let mut i = 0..;
        view.retain(|_| i.next().is_none_or(|i| i % 7 != 0));
    }
    let without = solve(&truth, &Observations::new(BOARD, 1280, 960, views).unwrap()).unwrap();
    for (j, (a, b)) in shifted.camera.intrinsics().iter().zip(without.camera.intrinsics()).enumerate() {
        assert!((a - b).abs() < 1e-3 * without.covariance[(j, j)].sqrt(), "{j}: {a} {b}");
    }
    assert!(shifted.outliers.is_empty(), "{:?}", shifted.outliers);
}

/// Each view of a plane gives a homography, of eight numbers, six of which are its pose; but a lens that bends it gives more.
#[test]
fn one_view_of_a_fisheye_can_do() {
    let truth = camera(Lens::KannalaBrandt);
    let rotation = Vector3::new(std::f64::consts::PI + 0.5, 0.3, 0.1);
    let X_CT = Pose::new(Vector3::new(0.02, 0.01, 0.16), rotation);
    let found = solve(&truth, &observe(&truth, &[X_CT], 0.05)).unwrap();
    for (j, (a, b)) in found.camera.intrinsics().iter().zip(truth.intrinsics()).enumerate() {
        assert!((a - b).abs() < 4.5 * found.covariance[(j, j)].sqrt(), "{j}: {a} for {b}");
    }
}
