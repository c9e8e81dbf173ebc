//! The calibration finds the optimum that OpenCV's `calibrateCamera` and `fisheye.calibrate` find.
//!
//! The data sets and OpenCV's results are in `golden/opencv_calibration.json`, made by the script beside it. OpenCV's
//! restarts from its own result move parameters by up to 1e-7 of their size, which bounds what can be compared.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use calipose::calibration::{Calibration, CalibrationSettings, Corner, Observations, View, calibrate};
use calipose::camera::{Camera, Lens};
use calipose::target::Board;
use nalgebra::Vector2;
use serde_json::Value;

struct Set {
    name: String,
    observations: Observations,
    /// The right lens and image, nothing else.
    nominal: Camera,
    cost: f64,
    intrinsics: Vec<f64>,
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn count(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

fn read(number: usize, set: &Value, unit: f64) -> Set {
    let lens = Lens::ALL.into_iter().find(|lens| lens.name() == set["lens"]).unwrap();
    let image = [0, 1].map(|i| u32::try_from(set["image"][i].as_u64().unwrap()).unwrap());
    let board = Board {
        columns: count(&set["board"]["columns"]),
        rows: count(&set["board"]["rows"]),
        square: set["board"]["square"].as_f64().unwrap(),
    };
    let corner = |(index, pixel): (usize, &Value)| {
        // null where the corner was missed.
        let pixel = pixel.as_array()?;
        Some(Corner { index, pixel: Vector2::from_fn(|i, _| pixel[i].as_f64().unwrap() * unit) })
    };
    let views: Vec<View> = set["views"]
        .as_array()
        .unwrap()
        .iter()
        .map(|view| view.as_array().unwrap().iter().enumerate().filter_map(corner).collect())
        .collect();
    let intrinsics = numbers(&set["intrinsics"]);
    let mut ignorant = vec![0.0; intrinsics.len()];
    (ignorant[0], ignorant[1]) = (1.0, 1.0);
    Set {
        name: format!("set {number}: {}, {} views", lens.name(), views.len()),
        observations: Observations::new(board, image[0], image[1], views).unwrap(),
        nominal: Camera::new(lens, image[0], image[1], &ignorant).unwrap(),
        cost: set["cost"].as_f64().unwrap(),
        intrinsics,
    }
}

fn sets() -> Vec<Set> {
    let golden: Value = serde_json::from_str(include_str!("golden/opencv_calibration.json")).unwrap();
    let unit = golden["pixels_per_unit"].as_f64().unwrap();
    golden["sets"].as_array().unwrap().iter().enumerate().map(|(i, set)| read(i, set, unit)).collect()
}

fn solve(set: &Set) -> Calibration {
    let estimated: Vec<usize> = (0..set.intrinsics.len()).collect();
    let found = calibrate(&set.observations, &set.nominal, &estimated, &CalibrationSettings::default());
    let found = found.unwrap_or_else(|error| panic!("{}: {error}", set.name));
    assert!(found.convergence.converged, "{}: {:?}", set.name, found.convergence);
    found
}

#[test]
fn there_are_enough_sets_of_every_lens_and_size() {
    let sets = sets();
    assert!(sets.len() >= 50);
    for lens in Lens::ALL {
        assert!(sets.iter().filter(|set| set.nominal.lens() == lens).count() >= 10, "{lens:?}");
    }
    for views in [5, 40] {
        assert!(sets.iter().any(|set| set.observations.views().len() == views));
    }
}

#[test]
fn cost_and_parameters_are_opencvs() {
    let (mut worst_cost, mut worst_parameter) = (0.0f64, 0.0f64);
    let mut missed = Vec::new();
    for set in sets() {
        let found = solve(&set);
        let cost = found.convergence.cost / set.cost - 1.0;
        worst_cost = worst_cost.max(cost.abs());
        if cost.abs() > 1e-8 {
            missed.push(format!("{}: cost {} for {}", set.name, found.convergence.cost, set.cost));
        }
        for (j, (a, b)) in found.camera.intrinsics().iter().zip(&set.intrinsics).enumerate() {
            let error = (a / b - 1.0).abs();
            let sigma = found.covariance[(j, j)].sqrt();
            let deviations = ((a - b) / sigma).abs();
            // OpenCV comes to rest near the optimum in standard deviations, not in relative terms: so a parameter that
            // is smaller than its own deviation is compared by that. The coefficients of the rational model, whose
            // numerator and denominator nearly cancel, come out a little farther.
            let as_near = match set.nominal.lens() {
                Lens::Rational => deviations < 1e-5,
                _ => b.abs() < sigma && deviations < 1e-6,
            };
            if !as_near {
                worst_parameter = worst_parameter.max(error);
            }
            if error > 1e-6 && !as_near {
                let name = set.nominal.lens().parameter_names()[j];
                missed.push(format!("{}: {name} {a} for {b}, {deviations:.1e} deviations", set.name));
            }
        }
    }
    println!("worst relative differences: cost {worst_cost:.1e}, parameter {worst_parameter:.1e}");
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
