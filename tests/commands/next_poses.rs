//! `calipose next` proposes what still pays after the views taken so far, and stops when they suffice.

use std::path::Path;
use std::process::Output;

use calipose::problem::Problem;
use calipose::verification::simulate;
use serde_json::{Value, json};

use crate::desk::command;

fn json_of(folder: &Path, line: &str) -> Value {
    let output = calipose(folder, line);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn calipose(folder: &Path, line: &str) -> Output {
    command(folder, line).output().unwrap()
}

fn desk(views: usize) -> tempfile::TempDir {
    desk_of(views, "")
}

/// A folder with a coarse Servosila problem, a plan of it with the values that are `set`, and detections of the plan's first
/// `views` poses.
fn desk_of(views: usize, set: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string("problems/servosila-engineer.toml").unwrap();
    let text = text
        .replace("step_deg = 8\naxis", "step_deg = 10\naxis")
        .replace("sigma_px = 0.3", "sigma_px = 0.3\nmodel = \"constant\"");
    std::fs::write(folder.path().join("problem.toml"), &text).unwrap();
    let plan = json_of(folder.path(), &format!("plan problem.toml -k 12 --criterion d --trials 0 -o out --json {set}"));
    let problem = Problem::parse(&text, Path::new("problem.toml")).unwrap();
    let poses: Vec<_> = plan["poses"].as_array().unwrap()[..views]
        .iter()
        .map(|pose| {
            let q: Vec<f64> = serde_json::from_value(pose["joints_rad"].clone()).unwrap();
            problem.robot.camera_pose(&q).inverse() * problem.target.X_BT
        })
        .collect();
    let board = problem.target.board;
    let (columns, rows, square) = board.grid().unwrap();
    let seen = simulate(&problem.camera, &board, &poses, problem.noise, 4).unwrap();
    let view = |(i, corners): (usize, &Vec<calipose::calibration::Corner>)| {
        let mut pixels = vec![Value::Null; board.corner_count()];
        for corner in corners {
            pixels[corner.index] = json!([corner.pixel.x, corner.pixel.y]);
        }
        json!({ "name": format!("{i}.png"), "corners": pixels })
    };
    let document = json!({
        "format": "calipose.observations",
        "version": 1,
        "board": { "columns": columns, "rows": rows, "square_mm": square * 1e3 },
        "image": { "width_px": problem.camera.width(), "height_px": problem.camera.height() },
        "views": seen.views().iter().enumerate().map(view).collect::<Vec<_>>(),
    });
    std::fs::write(folder.path().join("seen.json"), document.to_string()).unwrap();
    folder
}

#[test]
fn the_next_poses_bring_the_map_error_down_to_the_request() {
    let desk = desk(10);
    let known = |document: &Value| document["known_map_error_px"].as_f64().unwrap();
    let expected = |document: &Value| document["expected_map_error_px"].as_f64().unwrap();
    let one = json_of(desk.path(), "next out/plan.json seen.json --json");
    assert_eq!(one["format"], "calipose.next");
    assert_eq!(one["views"], 10);
    assert_eq!(one["poses"].as_array().unwrap().len(), 1);
    assert!(expected(&one) < known(&one));

    let request = 0.7 * known(&one);
    let some = json_of(desk.path(), &format!("next out/plan.json seen.json --json --map-error-px {request}"));
    assert_eq!(some["fulfilled"], true);
    assert!(expected(&some) <= request);
    let fewer = some["poses"].as_array().unwrap().len() - 1;
    let line = format!("next out/plan.json seen.json --json --map-error-px {request} --most {fewer}");
    let output = calipose(desk.path(), &line);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let short: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(short["fulfilled"], false);

    let enough =
        json_of(desk.path(), &format!("next out/plan.json seen.json --json --map-error-px {}", 2.0 * known(&one)));
    assert_eq!(enough["poses"], json!([]));
    assert_eq!(enough["fulfilled"], true);
    let told = calipose(desk.path(), &format!("next out/plan.json seen.json --map-error-px {}", 2.0 * known(&one)));
    assert!(String::from_utf8_lossy(&told.stdout).contains("no more poses are needed"));
}

/// Of a board that may bulge its heights are estimated beside the camera, and poses are as many times pictured as the plan
/// says.
#[test]
fn heights_and_pictures_count_in_the_next_poses() {
    let known = |document: &Value| document["known_map_error_px"].as_f64().unwrap();
    let expected = |document: &Value| document["expected_map_error_px"].as_f64().unwrap();
    let flat = desk(10);
    let bent = desk_of(10, "--set target.warp_mm=0.5 --set selection.pictures=4");
    let line = "next out/plan.json seen.json -k 2 --json";
    let (of_flat, of_bent) = (json_of(flat.path(), line), json_of(bent.path(), line));
    let options = "--problem problem.toml --warp-mm 0.5 --noise-model constant -o camera --json";
    let calibrated = calipose(bent.path(), &format!("calibrate seen.json {options}"));
    let calibrated: Value = serde_json::from_slice(&calibrated.stdout).unwrap();
    let by_calibration = calibrated["map_error_px"]["rms"].as_f64().unwrap();
    assert!((known(&of_bent) / by_calibration - 1.0).abs() < 1e-9);
    assert!(expected(&of_bent) < known(&of_bent));
    // The simulated calibrations know of the heights too.
    let simulated = of_bent["simulated_map_error_px"]["median"].as_f64().unwrap();
    assert!((0.4..1.4).contains(&(simulated / expected(&of_bent))), "{simulated} {}", expected(&of_bent));
    let heights = &calibrated["warp_mm"];
    for axis in ["x", "y"] {
        let of = |key: String| heights[key].as_f64().unwrap();
        assert!(of(axis.into()).abs() < 4.0 * of(format!("{axis}_sigma")), "a flat board: {heights}");
    }
    assert_eq!((&of_bent["pictures"], &of_flat["pictures"]), (&json!(4), &Value::Null));
    let told = calipose(bent.path(), "next out/plan.json seen.json -k 2");
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("2 more poses, with 4 pictures each, bring it to"), "{told}");
}

#[test]
fn too_little_to_go_on_is_said() {
    let desk = desk(1);
    let code = |line: &str| calipose(desk.path(), line).status.code();
    let output = calipose(desk.path(), "next out/plan.json seen.json");
    assert_ne!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stderr).contains("view"), "{output:?}");
    assert_eq!(code("next out/plan.json seen.json --count 0"), Some(2));
    assert_eq!(code("next out/plan.json seen.json --map-error-px -1"), Some(2));
    assert_eq!(code("next out/plan.json missing.json"), Some(3));
    assert_eq!(code("next missing.json seen.json"), Some(3));
}

#[test]
fn repeated_views_are_said_and_left_out_on_request() {
    let desk = desk(12);
    let repeats = |document: &Value| -> Vec<Value> {
        document["repeats"].as_array().unwrap().iter().filter(|view| !view.is_null()).cloned().collect()
    };
    let some = json_of(desk.path(), "next out/plan.json seen.json -k 12 --json");
    assert_eq!(some["repeats"].as_array().unwrap().len(), 12);
    assert!(!repeats(&some).is_empty(), "the plan's poses are as good as ever");
    assert!(repeats(&some).iter().all(|view| view.as_str().unwrap().contains(".png")));
    let text = String::from_utf8(calipose(desk.path(), "next out/plan.json seen.json -k 12").stdout).unwrap();
    assert!(text.contains("taken already (") && text.contains("--new leaves such poses out"), "{text}");
    let new = json_of(desk.path(), "next out/plan.json seen.json -k 12 --new --json");
    assert_eq!(repeats(&new), [] as [Value; 0]);
    assert_eq!(new["poses"].as_array().unwrap().len(), 12);
}

#[test]
fn what_little_is_known_is_simulated_and_the_poses_are_written_for_the_robot() {
    let desk = desk(3);
    let few = json_of(desk.path(), "next out/plan.json seen.json -k 4 --json");
    let (expected, simulated) = (&few["expected_map_error_px"], &few["simulated_map_error_px"]);
    let number = |value: &Value| value.as_f64().unwrap();
    assert!(number(&simulated["median"]) < number(&simulated["percentile_90"]));
    assert!(number(&simulated["percentile_90"]) > 1.2 * number(expected), "{simulated} {expected}");
    let again = json_of(desk.path(), "next out/plan.json seen.json -k 4 --json");
    assert_eq!(again, few);
    let text = String::from_utf8(calipose(desk.path(), "next out/plan.json seen.json -k 4").stdout).unwrap();
    assert!(
        text.contains("In simulated calibrations") && text.contains("Written to out: next.json, next.csv"),
        "{text}"
    );
    let written = |name: &str| std::fs::read_to_string(desk.path().join("out").join(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&written("next.json")).unwrap(), few);
    let (next, plan) = (written("next.csv"), written("plan.csv"));
    assert_eq!(next.lines().count(), 5);
    assert_eq!(next.lines().next(), plan.lines().next(), "the same columns as those of the plan");
}
