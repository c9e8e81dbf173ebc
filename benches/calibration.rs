//! One calibration of 20 views of 48 corners, by lens, and its two stages.
#![allow(missing_docs, mixed_script_confusables, clippy::unwrap_used, reason = "a benchmark")]

use calipose::calibration::{CalibrationSettings, Observations, calibrate, start};
use calipose::camera::{Camera, Lens};
use calipose::information::{Noise, NoiseModel};
use calipose::spatial::Pose;
use calipose::target::Board;
use calipose::verification::simulate;
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector3;

const BOARD: Board = Board::checkerboard(8, 6, 0.035);

fn camera(lens: Lens) -> Camera {
    let coefficients: &[f64] = match lens {
        Lens::Pinhole => &[],
        Lens::BrownConrady => &[-0.2, 0.05, 1e-3, -2e-3, 0.01],
        Lens::Rational => &[0.9, 0.4, 1e-3, -5e-4, 0.03, 1.2, 0.7, 0.12],
        Lens::KannalaBrandt => &[-0.02, 0.01, -0.004, 0.001],
    };
    Camera::new(lens, 1280, 960, &[&[900.0, 900.0, 641.0, 472.0], coefficients].concat()).unwrap()
}

fn observations(camera: &Camera) -> Observations {
    let pose = |i: i32| {
        let φ = 2.4 * f64::from(i);
        let tilt = Pose::rotation(0.6 * Vector3::new(φ.cos(), φ.sin(), 0.0));
        let place = Pose::translation(0.1 * (2.0 * φ).cos(), 0.06 * (3.0 * φ).sin(), 0.45 + 0.005 * f64::from(i));
        place * tilt * Pose::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0))
    };
    let poses: Vec<Pose> = (0..20).map(pose).collect();
    simulate(camera, &BOARD, &poses, Noise { sigma: 0.3, model: NoiseModel::Constant }, 1).unwrap()
}

fn calibration(criterion: &mut Criterion) {
    for lens in Lens::ALL {
        let camera = camera(lens);
        let observations = observations(&camera);
        let estimated: Vec<usize> = (0..camera.intrinsics().len()).collect();
        let settings = CalibrationSettings::default();
        criterion.bench_function(&format!("calibrate/{}", lens.name()), |b| {
            b.iter(|| calibrate(&observations, &camera, &estimated, &settings));
        });
        criterion.bench_function(&format!("start/{}", lens.name()), |b| {
            b.iter(|| start(&observations, &camera, &estimated));
        });
    }
}

criterion_group!(benches, calibration);
criterion_main!(benches);
