//! `calipose noise` finds the noise that simulated pictures were made with, and which model of it holds.

use std::fmt::Write as _;

use calipose::camera::{Camera, Lens};
use calipose::information::{Blur, NoiseModel};
use calipose::spatial::Pose;
use calipose::target::{Board, Corners, Surface, viewpoint};
use calipose::verification::Scene;
use serde_json::Value;

use crate::desk::command;

const BOARD: Board = Board::checkerboard(8, 6, 0.025);
const OPTIONS: [&str; 6] = ["--board", "8x6", "--square-mm", "25", "--image", "1280x720"];

/// Pictures of scenes from square-on to steep, near and far, one file each.
fn pictures(folder: &std::path::Path, noise: NoiseModel, shake: f64) -> Vec<String> {
    let camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5]).unwrap();
    let scene = |(number, (tilt, distance)): (usize, (f64, f64))| {
        let X_CT = viewpoint(distance, tilt, 0.7, 0.3).inverse();
        let mut text = "# filename x y level\n".to_owned();
        for picture in 0..40 {
            let moved = Pose::translation(shake * f64::from(picture), 0.0, 0.0) * X_CT;
            let scene = Scene {
                camera: camera.clone(),
                poses: vec![moved],
                seen: vec![Corners::All],
                sigma: vec![0.1],
                noise,
                missing: 0.0,
                surface: Surface::FLAT,
            };
            let seen = scene.observe(&BOARD, (100 * number) as u64 + picture as u64).unwrap();
            for corner in &seen.views()[0] {
                writeln!(text, "{picture}.png {} {} 0", corner.pixel.x, corner.pixel.y).unwrap();
            }
        }
        let name = format!("scene-{number}.vnl");
        std::fs::write(folder.join(&name), text).unwrap();
        name
    };
    [(0.0, 0.6), (0.8, 0.7), (1.1, 0.8), (0.3, 2.0)].into_iter().enumerate().map(scene).collect()
}

fn measured(folder: &std::path::Path, files: &[String]) -> Value {
    let output = command(folder, "noise").args(files).args(OPTIONS).arg("--json").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_model_and_its_numbers_are_found() {
    let folder = tempfile::tempdir().unwrap();
    for (noise, name, window) in [
        (NoiseModel::Constant, "constant", None),
        (NoiseModel::Edges { window: 5.0, blur: Blur::NONE }, "edges", Some(5.0)),
    ] {
        let found = measured(folder.path(), &pictures(folder.path(), noise, 0.0));
        assert_eq!(found["corners"], 4 * 48);
        let [best, other] = [0, 1].map(|i| &found["models"][i]);
        assert_eq!((best["model"].as_str(), best["window_px"].as_f64()), (Some(name), window));
        assert!((best["sigma_px"].as_f64().unwrap() / 0.1 - 1.0).abs() < 0.03, "{best}");
        let misfit = |model: &Value| model["misfit"].as_f64().unwrap();
        assert!(misfit(best) < 0.04 && misfit(other) > misfit(best) + 0.02, "{found}");
        assert_eq!(found["moved"], false);
    }
}

#[test]
fn what_moved_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let files = pictures(folder.path(), NoiseModel::Constant, 2e-5);
    assert_eq!(measured(folder.path(), &files)["moved"], true);
    let output = command(folder.path(), "noise").args(&files).args(OPTIONS).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("camera or board moved") && text.contains("[noise]\nsigma_px = "), "{text}");
}

#[test]
fn single_pictures_and_copies_say_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |name: &str, names: &[&str]| {
        let corners = names
            .iter()
            .flat_map(|name| (0..48).map(move |i| format!("{name} {} {} 0\n", 100 + 20 * (i % 8), 400 - 20 * (i / 8))));
        let text = "# filename x y level\n".to_owned() + &corners.collect::<String>();
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    picture("one.vnl", &["a.png"]);
    picture("copies.vnl", &["a.png", "b.png"]);
    for (file, what) in [
        ("one.vnl", "no corner is seen in two pictures of one scene; 1 picture is given"),
        ("copies.vnl", "copies of one"),
    ] {
        let output = command(folder.path(), "noise").arg(file).args(OPTIONS).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && error.contains(what) && error.contains("ten or more pictures"), "{error}");
    }
}
