//! Times the calibration of the data sets in a file like `tests/golden/opencv_calibration.json`: one line a set with
//! the median time in seconds, the cost in px² and the iterations. Used by `benches/against_opencv.py`.

#![allow(mixed_script_confusables, reason = "mathematical names")]
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a small program for people, not part of the library")]

use std::time::Instant;

use calipose::calibration::{CalibrationSettings, Corner, Observations, View, calibrate};
use calipose::camera::{Camera, Lens};
use calipose::target::Board;
use nalgebra::Vector2;
use serde_json::Value;

const REPEATS: usize = 51;

fn main() {
    let path = std::env::args().nth(1).unwrap();
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let unit = file["pixels_per_unit"].as_f64().unwrap();
    for set in file["sets"].as_array().unwrap() {
        let integer = |value: &Value| u32::try_from(value.as_u64().unwrap()).unwrap();
        let lens = Lens::ALL.into_iter().find(|lens| lens.name() == set["lens"]).unwrap();
        let (width, height) = (integer(&set["image"][0]), integer(&set["image"][1]));
        let board = Board::checkerboard(
            integer(&set["board"]["columns"]) as usize,
            integer(&set["board"]["rows"]) as usize,
            set["board"]["square"].as_f64().unwrap(),
        );
        let corner = |(index, pixel): (usize, &Value)| {
            let pixel = pixel.as_array()?;
            Some(Corner { index, pixel: Vector2::from_fn(|i, _| pixel[i].as_f64().unwrap() * unit), weight: 1.0 })
        };
        let views: Vec<View> = set["views"]
            .as_array()
            .unwrap()
            .iter()
            .map(|view| view.as_array().unwrap().iter().enumerate().filter_map(corner).collect())
            .collect();
        let p = lens.parameter_names().len();
        let mut θ = vec![0.0; p];
        (θ[0], θ[1]) = (1.0, 1.0);
        let nominal = Camera::new(lens, width, height, &θ).unwrap();
        let estimated: Vec<usize> = (0..p).collect();
        let settings = CalibrationSettings::default();
        let mut seconds = Vec::new();
        let mut last = None;
        for _ in 0..REPEATS {
            let views = views.clone();
            let begin = Instant::now();
            // Checking the detections is part of it, as it is of OpenCV's.
            let observations = Observations::new(board.clone(), width, height, views).unwrap();
            let found = calibrate(&observations, &nominal, &estimated, &settings).unwrap();
            seconds.push(begin.elapsed().as_secs_f64());
            last = Some(found);
        }
        seconds.sort_by(f64::total_cmp);
        let found = last.unwrap();
        println!("{} {} {}", seconds[REPEATS / 2], found.convergence.cost, found.convergence.iterations);
    }
}
