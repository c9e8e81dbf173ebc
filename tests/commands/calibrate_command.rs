//! `calipose calibrate` finds the camera that simulated detections come from, and refuses what is wrong with them.

use std::path::Path;
use std::process::Output;

use calipose::calibration::Observations;
use calipose::camera::{Camera, Lens};
use calipose::formats::{Known, StatedBoard, StatedCamera, read_board_file, read_camera_file, read_detections};
use calipose::information::{Noise, NoiseModel};
use calipose::problem::Problem;
use calipose::spatial::Pose;
use calipose::target::Board;
use calipose::verification::simulate;
use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::desk::command;

const BOARD: Board = Board::checkerboard(8, 6, 0.035);
const OPTIONS: [&str; 6] = ["--board", "8x6", "--square-mm", "35", "--image", "1280x720"];
const NOISE: f64 = 0.2;

fn camera() -> Camera {
    let intrinsics = [1000.0, 990.0, 645.0, 355.0, -0.2, 0.05, 1e-3, -5e-4, 0.01];
    Camera::new(Lens::BrownConrady, 1280, 720, &intrinsics).unwrap()
}

/// Twenty views, tilted differently; in some the board is partly outside the image.
fn simulated() -> Observations {
    simulated_of(&BOARD)
}

fn simulated_of(board: &Board) -> Observations {
    let pose = |i: usize| {
        let (turn, place) = (i as f64 * 2.4, i as f64 * 1.7);
        let rotation = Vector3::new(0.6 * turn.cos(), 0.6 * turn.sin(), 0.1 * place.sin());
        Pose::new(Vector3::new(0.18 * place.cos(), 0.11 * place.sin(), 0.5 + 0.01 * i as f64), rotation)
    };
    let poses: Vec<Pose> = (0..20).map(pose).collect();
    simulate(&camera(), board, &poses, Noise { sigma: NOISE, model: NoiseModel::Constant }, 5).unwrap()
}

/// Pixel of every corner of a view, if it was seen.
fn grid(observations: &Observations, view: usize) -> Vec<Option<[f64; 2]>> {
    let mut grid = vec![None; observations.board().corner_count()];
    for corner in &observations.views()[view] {
        grid[corner.index] = Some(corner.pixel.into());
    }
    grid
}

fn vnl(observations: &Observations) -> String {
    let mut text = "## made by a test\n# filename x y level\nempty.png - - -\n".to_owned();
    for view in 0..observations.views().len() {
        for corner in grid(observations, view) {
            text += &match corner {
                Some([u, v]) => format!("{view}.png {u} {v} 0\n"),
                None if view % 2 == 0 => format!("{view}.png - - -\n"),
                None => format!("{view}.png 0 0 -1\n"),
            };
        }
    }
    text
}

fn document(observations: &Observations) -> Value {
    let views = (0..observations.views().len())
        .map(|view| json!({ "name": format!("{view}.png"), "corners": grid(observations, view) }));
    json!({
        "format": "calipose.observations",
        "version": 1,
        "board": { "columns": 8, "rows": 6, "square_mm": 35 },
        "image": { "width_px": 1280, "height_px": 720 },
        "views": views.collect::<Vec<_>>(),
    })
}

fn calibrate(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, "calibrate").args(arguments).output().unwrap()
}

/// The `--json` document of a run that must succeed.
fn calibrated(folder: &Path, arguments: &[&str]) -> Value {
    let output = calibrate(folder, &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn assert_recovers_the_camera(document: &Value, sigmas: f64) {
    let intrinsics = &document["intrinsics"];
    for (i, truth) in camera().intrinsics().iter().enumerate() {
        let (value, sigma) = (intrinsics["values"][i].as_f64().unwrap(), intrinsics["sigma"][i].as_f64().unwrap());
        assert!((value - truth).abs() < sigmas * sigma, "{}: {value} ± {sigma} for {truth}", intrinsics["names"][i]);
    }
    let sigma = document["sigma_px"].as_f64().unwrap();
    assert!((sigma / NOISE - 1.0).abs() < 0.1, "{sigma}");
}

#[test]
fn vnl_and_json_give_the_camera_they_come_from() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let observations = simulated();
    assert!(observations.corner_count() < 20 * 48, "some corners are to be missing");
    std::fs::write(at("corners.vnl"), vnl(&observations)).unwrap();
    std::fs::write(at("corners.json"), document(&observations).to_string()).unwrap();
    let from_vnl = calibrated(folder.path(), &[&["corners.vnl", "-o", "one"], &OPTIONS[..]].concat());
    let from_json = calibrated(folder.path(), &["corners.json", "-o", "two"]);
    assert_recovers_the_camera(&from_vnl, 4.0);
    assert_eq!(from_vnl["skipped"], json!(["empty.png"]));
    assert_eq!((&from_vnl["intrinsics"], &from_vnl["views"]), (&from_json["intrinsics"], &from_json["views"]));
    assert_eq!(from_json["views"].as_array().unwrap().len(), 20);
    let error = |place: &str| from_json["map_error_px"][place].as_f64().unwrap();
    assert!(0.0 < error("centre") && error("centre") < error("corner") && error("rms") < error("corner"));
    // All files hold the camera of the document.
    for name in ["camera_info.yaml", "camera.opencv.yaml", "camera.opencv.json", "camera.cameramodel"] {
        let camera = read_camera_file(&at("two").join(name), &StatedCamera::default()).unwrap();
        assert_eq!(json!(camera.intrinsics()), from_json["intrinsics"]["values"], "{name}");
    }
    let written: Value = serde_json::from_slice(&std::fs::read(at("two").join("calibration.json")).unwrap()).unwrap();
    assert_eq!(written, from_json);
}

/// In part or whole, by the numbers that the kinds of boards give their corners; of the grids some views lack what is on cut
/// markers.
#[test]
fn boards_of_every_kind_give_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    for keys in [
        "kind = \"charuco\"\ncolumns = 9\nrows = 7\nsquare_mm = 35\nmarker_mm = 26\ndictionary = \"DICT_5X5_50\"",
        "kind = \"aprilgrid\"\ncolumns = 6\nrows = 4\ntag_mm = 40\ntag_spacing = 0.3",
        "kind = \"circles\"\ncolumns = 9\nrows = 7\nspacing_mm = 35\ndiameter_mm = 20",
        "kind = \"asymmetric-circles\"\ncolumns = 5\nrows = 11\nspacing_mm = 50\ndiameter_mm = 20",
        "kind = \"points\"\npoints_mm = [[0, 0, 1], [40, 3, 1], [38, 44, 1], [0, 90], [120, 10], [200, 0, 2], [200, 80, 2], [90, 140], \
         [260, 150], [30, 170], [150, 80], [250, 20], [70, 60], [180, 160]]",
    ] {
        let problem = format!(
            "[[robot.joints]]\nname = \"turn\"\nlimits_deg = [-90, 90]\n[camera]\nwidth_px = 1280\nheight_px = 720\nfx_px = 1000\n\
             [camera.distortion]\nmodel = \"brown-conrady\"\n[target]\n{keys}\npose = {{ position_mm = [300, 0, 0] }}\n\
             [sweep]\nstep_deg = 1\n[noise]\nmodel = \"constant\"\n"
        );
        std::fs::write(folder.path().join("problem.toml"), problem).unwrap();
        let board = Problem::read(&folder.path().join("problem.toml")).unwrap().target.board;
        let observations = simulated_of(&board);
        assert!(observations.corner_count() < 20 * board.corner_count(), "{keys}: some corners are to be missing");
        let mut document = document(&observations);
        document.as_object_mut().unwrap().remove("board");
        std::fs::write(folder.path().join("corners.json"), document.to_string()).unwrap();
        let found = calibrated(folder.path(), &["corners.json", "--problem", "problem.toml"]);
        assert_recovers_the_camera(&found, 4.0);
        let listed = found["views"][0]["residuals"].as_array().unwrap().len();
        assert_eq!(listed, observations.views()[0].len());
    }
    // Without the problem nothing says which board it is.
    let output = calibrate(folder.path(), &["corners.json"]);
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("board"));
}

#[test]
fn a_file_says_which_board_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| std::path::absolute(Path::new("tests/data/target-files").join(name)).unwrap();
    let StatedBoard::AprilGrid(grid) = read_board_file(&file("kalibr-aprilgrid.yaml")).unwrap() else { panic!() };
    let observations = simulated_of(&Board::AprilGrid(grid));
    std::fs::write(folder.path().join("corners.vnl"), vnl(&observations)).unwrap();
    let run = |name: &str, more: &[&str]| {
        let name = file(name);
        let arguments = ["corners.vnl", "--target", name.to_str().unwrap(), "--image", "1280x720", "--json"];
        let output = calibrate(folder.path(), &[&arguments[..], more].concat());
        let document = if output.status.success() { output.stdout } else { output.stderr };
        (output.status.code(), serde_json::from_slice::<Value>(&document).unwrap())
    };
    let (code, found) = run("kalibr-aprilgrid.yaml", &[]);
    assert_eq!(code, Some(0));
    assert_recovers_the_camera(&found, 4.0);
    // Those that leave something open name it, and what helps.
    for (name, code, kind, parts) in [
        ("opencv-charuco.json", 2, "command-line", ["does not tell how many squares", "--board"]),
        ("kalibr-circlegrid.yaml", 2, "command-line", ["does not tell the diameter", "--problem"]),
        ("nan.csv", 3, "target-file", ["nan.csv: line 4: `x_mm`", "finite"]),
        ("none.yaml", 3, "target-file", ["cannot use the target", "none.yaml"]),
    ] {
        let (found, told) = run(name, &[]);
        let message = told["message"].as_str().unwrap();
        assert_eq!((found, &told["kind"]), (Some(code), &json!(kind)), "{message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
    assert_eq!(run("points.csv", &["--board", "8x6", "--square-mm", "35"]).0, Some(2));
}

#[test]
fn a_robust_loss_withstands_outliers_and_names_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = document(&simulated());
    for (view, corner) in [(2, 11), (7, 30), (13, 20)] {
        let u = &mut document["views"][view]["corners"][corner][0];
        *u = json!(u.as_f64().unwrap() + 30.0);
    }
    std::fs::write(folder.path().join("corners.json"), document.to_string()).unwrap();
    for loss in ["huber", "cauchy"] {
        let found = calibrated(folder.path(), &["corners.json", "--loss", loss]);
        assert_recovers_the_camera(&found, 5.0);
        let outliers = found["outliers"].as_array().unwrap();
        let named = |view: &str, column: u64, row: u64| {
            outliers.iter().any(|o| o["view"] == view && o["column"] == column && o["row"] == row)
        };
        assert!(named("2.png", 3, 1) && named("7.png", 6, 3) && named("13.png", 4, 2), "{outliers:?}");
    }
    let text = calibrate(folder.path(), &["corners.json", "--loss", "cauchy", "--camera-format", "ros", "-o", "ros"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("Outlier: 2.png, column 3, row 1: "), "{text}");
    assert_eq!(std::fs::read_dir(folder.path().join("ros")).unwrap().count(), 3);
}

#[test]
fn a_problem_file_says_board_lens_and_what_to_estimate() {
    let folder = tempfile::tempdir().unwrap();
    let problem = calipose::problem::STARTER
        .replace("columns = 9", "columns = 8")
        .replace("square_mm = 25", "square_mm = 35")
        .replace("height_px = 960", "height_px = 720")
        .replace("# [estimate]\n# intrinsics", "[estimate]\nintrinsics");
    std::fs::write(folder.path().join("arm.toml"), &problem).unwrap();
    std::fs::write(folder.path().join("corners.vnl"), vnl(&simulated())).unwrap();
    let loaded = calipose::problem::Problem::parse(&problem, Path::new("arm.toml")).unwrap();
    assert_eq!((loaded.camera.width(), loaded.camera.height(), loaded.target.board.clone()), (1280, 720, BOARD));
    let found = calibrated(folder.path(), &["corners.vnl", "--problem", "arm.toml"]);
    assert_eq!(found["estimated"], json!(loaded.unknowns().names()));
    let both = calibrate(folder.path(), &["corners.vnl", "--problem", "arm.toml", "--lens", "none"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn wrong_detections_are_refused_with_line_and_value() {
    let observations = simulated();
    let text = vnl(&observations);
    let known = Known { board: Some(BOARD), image: Some([1280, 720]), images: None };
    let rows: Vec<&str> = text.lines().collect();
    let lines = |lines: &[&str]| lines.join("\n");
    let with = |line: usize, row: &str| {
        let mut rows = rows.clone();
        rows[line - 1] = row;
        lines(&rows)
    };
    let json = document(&observations);
    let edited = |edit: &dyn Fn(&mut Value)| {
        let mut json = json.clone();
        edit(&mut json);
        format!("{json:#}")
    };
    let pretty = format!("{json:#}");
    let cases = [
        ("empty", String::new()),
        ("header only", lines(&rows[..2])),
        ("no header", lines(&rows[2..])),
        ("other header", with(2, "# filename x y size")),
        ("weight too large", text.replace("x y level", "x y weight").replace(" 0\n", " 1e9\n")),
        ("no detection by weight", text.replace("x y level", "x y weight")),
        ("absurd level", text.replace(" 0\n", " 50\n")),
        ("cut within an image", lines(&rows[..80])),
        ("cut within a line", with(80, "1.png 640")),
        ("not a number", with(20, "0.png 640 wide 0")),
        ("NaN", with(20, "0.png 640 nan 0")),
        ("infinite", with(20, "0.png 1e999 5 0")),
        ("outside the image", with(20, "0.png 640 2000 0")),
        ("absurd pixel", with(20, "0.png 640 1e300 0")),
        ("negative pixel", with(20, "0.png -640 100 0")),
        ("image twice", format!("{text}0.png - - -\n")),
        ("three corners", format!("{text}z.png 1 1 0\nz.png 9 1 0\nz.png 9 9 0\n{}", "z.png - - -\n".repeat(45))),
        ("one point", format!("{text}{}", "z.png 1 1 0\n".repeat(48))),
        ("nothing detected", lines(&rows[..3])),
        ("JSON cut", pretty[..pretty.len() / 2].to_owned()),
        ("JSON of a plan", "{ \"format\": \"calipose.plan\" }".to_owned()),
        ("later version", edited(&|json| json["version"] = 2.into())),
        ("other board", edited(&|json| json["board"]["columns"] = 9.into())),
        ("other image", edited(&|json| json["image"]["width_px"] = 1920.into())),
        ("no squares", edited(&|json| json["board"]["square_mm"] = 0.into())),
        ("corner missing", edited(&|json| drop(json["views"][1]["corners"].as_array_mut().unwrap().pop()))),
        ("text for a corner", edited(&|json| json["views"][1]["corners"][2] = "x".into())),
        ("corner of one number", edited(&|json| json["views"][1]["corners"][2] = json!([1]))),
        ("text for a pixel", edited(&|json| json["views"][1]["corners"][2] = json!([1, "2"]))),
        ("far outside", edited(&|json| json["views"][1]["corners"][2] = json!([1, -1e300]))),
        ("no views", edited(&|json| json["views"] = json!([]))),
    ];
    let answers = cases.iter().map(|(name, text)| {
        let error = read_detections(text, &known).map(drop).expect_err(name);
        format!("{name}: {error}")
    });
    let answers: Vec<String> = answers.collect();
    insta::assert_snapshot!(answers.join("\n"));
    for (end, _) in text.char_indices().step_by(997) {
        let _ = read_detections(&text[..end], &known);
    }
}

#[test]
fn exit_codes_tell_the_file_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let observations = simulated();
    std::fs::write(folder.path().join("corners.vnl"), vnl(&observations)).unwrap();
    let few: String = vnl(&observations).lines().take(3 + 48).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.path().join("few.vnl"), few).unwrap();
    let run = |arguments: &[&str]| {
        let output = calibrate(folder.path(), arguments);
        assert!(output.stdout.is_empty());
        format!("{:?} → {:?}\n{}", arguments, output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let with = |file: &str, more: &[&str]| [&[file], &OPTIONS[..], more].concat().join(" ");
    let answers = [
        run(&["none.vnl"]),
        run(&["corners.vnl"]),
        run(&["corners.vnl", "--board", "8x6", "--square-mm", "35"]),
        run(&["corners.vnl", "--board", "6x8", "--square-mm", "35", "--image", "640x480"]),
        run(&["corners.vnl", "--board", "7x6", "--square-mm", "35", "--image", "1280x720"]),
        run(&["corners.vnl", "--board", "8"]),
        run(&with("few.vnl", &["--lens", "none"]).split(' ').collect::<Vec<_>>()),
        run(&with("corners.vnl", &["--lens", "kannala-brandt", "--camera-format", "mrcal"])
            .split(' ')
            .collect::<Vec<_>>()),
    ];
    insta::assert_snapshot!(answers.join("\n"));
}

/// The observations with the corners of some views listed column by column.
fn by_columns(observations: &Observations, swapped: &dyn Fn(usize) -> bool) -> String {
    let mut text = "# filename x y\n".to_owned();
    for view in 0..observations.views().len() {
        let grid = grid(observations, view);
        for n in 0..48 {
            let index = if swapped(view) { 8 * (n % 6) + n / 6 } else { n };
            text += &match grid[index] {
                Some([u, v]) => format!("{view}.png {u} {v}\n"),
                None => format!("{view}.png - -\n"),
            };
        }
    }
    text
}

#[test]
fn swapped_rows_and_columns_are_said_with_the_views() {
    let folder = tempfile::tempdir().unwrap();
    let observations = simulated();
    let answer = |text: String, board: &str| {
        std::fs::write(folder.path().join("corners.vnl"), text).unwrap();
        let options = ["corners.vnl", "--board", board, "--square-mm", "35", "--image", "1280x720"];
        let output = calibrate(folder.path(), &options);
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stderr).unwrap()
    };
    let answers = [
        answer(by_columns(&observations, &|view| view == 3 || view == 11), "8x6"),
        answer(by_columns(&observations, &|_| true), "8x6"),
        answer(by_columns(&observations, &|_| false), "6x8"),
        answer(by_columns(&observations, &|view| view != 5), "8x6"),
    ];
    insta::assert_snapshot!(answers.join("\n"));
}

#[test]
fn intrinsics_are_held_and_tied_as_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("corners.json"), document(&simulated()).to_string()).unwrap();
    let run = |line: &str| calibrated(folder.path(), &line.split(' ').collect::<Vec<_>>());
    let number = |value: &Value| value.as_f64().unwrap();
    let found = run("corners.json --tie fx=fy --zero-tangential --fix k3 --fix cx=645.5");
    let (values, sigma) = (&found["intrinsics"]["values"], &found["intrinsics"]["sigma"]);
    assert_eq!(found["estimated"], json!(["fx", "fy", "cy", "k1", "k2"]));
    assert_eq!(found["tied"], json!([["fx", "fy"]]));
    assert_eq!(values[0], values[1]);
    assert_eq!([2, 6, 7, 8].map(|i| number(&values[i])), [645.5, 0.0, 0.0, 0.0]);
    assert_eq!([2, 6, 7, 8].map(|i| number(&sigma[i])), [0.0; 4]);
    assert_eq!(found["covariance"].as_array().unwrap().len(), 5);
    assert_eq!(found["covariance"][0], found["covariance"][1]);
    let named = run("corners.json --estimate fx,fy,k1 --fix k3=0.01,k2=0.05");
    assert_eq!(named["estimated"], json!(["fx", "fy", "k1"]));
    // Held without a value: the image's centre, no distortion.
    assert_eq!([2, 3, 5, 6].map(|i| number(&named["intrinsics"]["values"][i])), [639.5, 359.5, 0.05, 0.0]);
    let text = calibrate(folder.path(), &["corners.json", "--tie", "fx=fy", "--fix", "k3"]).stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains(" = fx\n") && text.contains("fixed\n"), "{text}");

    for (line, answer) in [
        ("--fix k9", "the lens brown-conrady has no intrinsic `k9`; it has fx fy cx cy k1 k2 p1 p2 k3"),
        ("--fix k3=wide", "`wide` is not a number"),
        ("--fix fx", "no value is given at which to hold fx"),
        ("--estimate fx,fy --fix fy=900", "fy is both to be estimated and to be held fixed"),
        ("--estimate k1", "no value is given at which to hold fx"),
        ("--fix fy=900 --tie fx=fy", "fy is not estimated"),
        ("--tie fx", "give two intrinsics"),
        ("--lens kannala-brandt --zero-tangential", "has no intrinsic `p1`"),
    ] {
        let output = calibrate(folder.path(), &["corners.json"].into_iter().chain(line.split(' ')).collect::<Vec<_>>());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(answer), "{line}: {said}");
    }
}

const FISHEYE: [&str; 7] = ["circular-fisheye.vnl", "--board", "7x6", "--square-mm", "25", "--image", "1280x1024"];

/// A folder with the corners of tests/data/corners.
fn real_corners() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir("tests/data/corners").unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    folder
}

#[test]
fn the_lens_that_fits_is_named_where_the_one_asked_for_does_not() {
    let folder = real_corners();
    let answer = |more: &[&str]| {
        let output = calibrate(folder.path(), &[&FISHEYE[..], more].concat());
        (output.status.code(), String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap())
    };
    let (code, text) = answer(&[]);
    assert!(code == Some(1) && text.contains("use `--lens kannala-brandt`"), "{text}");
    let (code, text) = answer(&["--lens", "none"]);
    assert!(code != Some(0) && text.contains("`--lens kannala-brandt`"), "{text}");
    let (code, text) = answer(&["--lens", "kannala-brandt"]);
    assert!(code == Some(0) && text.contains("RMS 0.3088"), "{text}");
    // What is known least, and where to take the board.
    assert!(
        text.contains("Fair: ")
            && text.contains("one combination of k3, k4")
            && text.contains("There are no corners in the image's top"),
        "{text}"
    );
    let real = |n: &str, more: &str| {
        let line = format!("rational-real-{n}.vnl --board 9x6 --square-mm 25 --image 640x512 --lens rational {more}");
        let output = calibrate(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
        (output.status.code(), String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap())
    };
    let (code, text) = real("10-4", "");
    assert!(code == Some(1) && text.contains("use `--lens brown-conrady`") && text.contains("`--fix k3,k6`"), "{text}");
    // Of a board that may bulge the lens is sought again in the same way.
    for warp in ["--warp-mm 0.001", "--warp-mm 0.01"] {
        let (code, text) = real("10-4", warp);
        assert!(code == Some(1) && text.contains("`--fix k3,k6`"), "{code:?} {text}");
    }
    // Said to bulge by more, it fits a lens that does not fold.
    let (code, text) = real("10-4", "--warp-mm 0.1");
    assert!(code == Some(0) && text.contains("Board's middle above its rim"), "{code:?} {text}");
    // The advice can be followed.
    let (code, text) = real("10-4", "--fix k3,k6");
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn good_views_are_good_and_a_request_that_is_missed_is_an_exit_code() {
    let folder = real_corners();
    let run = |more: &str| {
        let line = format!("weights.vnl --board 9x6 --square-mm 25 --image 640x480 --json {more}");
        let output = calibrate(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), document["judgement"].clone(), document["verdict"].as_str().unwrap().to_owned())
    };
    let (code, judgement, verdict) = run("");
    assert!(code == Some(0) && judgement == "good" && verdict.starts_with("Good: "), "{verdict}");
    let (code, judgement, verdict) = run("--map-error-px 0.1");
    assert!(code == Some(4) && judgement == "missed" && verdict.contains("but 0.1 is requested"), "{verdict}");
    let (code, judgement, _) = run("--map-error-px 0.8");
    assert!(code == Some(0) && judgement == "good");
    let (_, judgement, verdict) = run("--loss cauchy --fix k1,k2,k3 --zero-tangential");
    assert!(judgement != "outliers" || !verdict.contains("--loss cauchy"), "{verdict}");
}

/// The ten poses planned for the Servosila robot are fair, eight of them are not.
#[test]
fn a_recommended_plan_is_not_called_weak() {
    let example = std::fs::read_to_string("problems/examples/servosila-corners.vnl").unwrap();
    let problem = std::path::absolute("problems/servosila-engineer.toml").unwrap();
    let judged = |views: usize| {
        let folder = tempfile::tempdir().unwrap();
        let last = format!("view{views:02}.png");
        let some: Vec<&str> = example.lines().take_while(|line| !line.starts_with(&last)).collect();
        std::fs::write(folder.path().join("corners.vnl"), some.join("\n")).unwrap();
        let output = calibrate(folder.path(), &["corners.vnl", "--problem", problem.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(0));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["judgement"].clone()
    };
    assert_eq!((judged(8), judged(10)), ("weak".into(), "fair".into()));
}

/// A problem file says how the corners scatter; constant noise is another estimate.
#[test]
fn corners_are_weighed_by_the_noise_of_the_problem_file_or_by_none() {
    let path = |path: &str| std::path::absolute(path).unwrap().to_str().unwrap().to_owned();
    let folder = tempfile::tempdir().unwrap();
    let (corners, problem) =
        (path("problems/examples/servosila-corners.vnl"), path("problems/servosila-engineer.toml"));
    let arguments = [corners.as_str(), "--problem", &problem];
    let weighted = calibrated(folder.path(), &arguments);
    let unweighted = calibrated(folder.path(), &[&arguments[..], &["--noise-model", "constant"]].concat());
    assert_eq!((&weighted["noise_model"], &unweighted["noise_model"]), (&json!("edges"), &json!("constant")));
    let text = std::fs::read_to_string(&problem).unwrap();
    let text = text.replace("[noise]\n", "[noise]\nmodel = \"constant\"\n");
    std::fs::write(folder.path().join("constant.toml"), text).unwrap();
    assert_eq!(
        calibrated(folder.path(), &[&corners, "--problem", "constant.toml"])["intrinsics"],
        unweighted["intrinsics"]
    );
    assert_ne!(weighted["intrinsics"], unweighted["intrinsics"]);
}

#[test]
fn weights_are_read_and_levels_are_weights() {
    let observations = simulated();
    let text = vnl(&observations);
    let known = Known { board: Some(BOARD), image: Some([1280, 720]), images: None };
    let read = |text: &str| read_detections(text, &known).unwrap().observations;
    let levels = read(&text.replace(" 0\n", " 1\n"));
    let weights = read(&text.replace("x y level", "x y weight").replace(" 0\n", " 0.5\n"));
    assert_eq!(levels, weights);
    assert!(levels.views().iter().flatten().all(|corner| corner.weight == 0.5));
    assert!(read(&text).views().iter().flatten().all(|corner| corner.weight == 1.0));
    let file = std::fs::read_to_string("tests/data/corners/weights.vnl").unwrap();
    let board = Board::checkerboard(9, 6, 0.025);
    let known = Known { board: Some(board), image: Some([640, 480]), images: None };
    assert_eq!(read_detections(&file, &known).unwrap().names.len(), 25);
}

#[test]
fn the_images_of_one_of_two_cameras_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "# filename x y level\n".to_owned();
    for (view, line) in vnl(&simulated()).lines().skip(3).filter_map(|line| line.split_once(".png ")) {
        let number: usize = view.parse().unwrap();
        text += &format!("frame{}-cam{}.png {line}\n", number / 2, number % 2);
    }
    std::fs::write(folder.path().join("corners.vnl"), text).unwrap();
    let answer = |more: &[&str]| {
        let output = calibrate(folder.path(), &[&["corners.vnl"], &OPTIONS[..], more].concat());
        (output.status.code(), String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap())
    };
    let (code, text) = answer(&[]);
    assert!(
        code == Some(2) && text.contains("images are from 2 cameras: cam0 (10 images), cam1 (10 images)"),
        "{text}"
    );
    assert!(text.contains("--images '*cam0*'"), "{text}");
    let (code, text) = answer(&["--images", "*-cam1.png"]);
    assert!(code == Some(0) && text.contains("10 views, ") && text.contains("frame9-cam1.png"), "{text}");
    assert!(!text.contains("cam0"), "{text}");
    let (code, text) = answer(&["--images", "*cam7*"]);
    assert!(code == Some(2) && text.contains("none of the 20 image names matches `*cam7*`"), "{text}");
}

#[test]
fn camera_files_of_an_older_calibration_go() {
    let folder = real_corners();
    let names = || {
        let entries = std::fs::read_dir(folder.path().join("calibration")).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| !name.starts_with('.'));
        names.sort();
        names
    };
    let run = |more: &[&str]| assert!(calibrate(folder.path(), &[&FISHEYE[..], more].concat()).stderr.is_empty());
    run(&["--lens", "none", "--fix", "cx,cy"]);
    assert!(names().contains(&"camera.cameramodel".to_owned()));
    std::fs::write(folder.path().join("calibration/notes.txt"), "mine").unwrap();
    run(&["--lens", "kannala-brandt"]);
    let expected = [
        "calibration.html",
        "calibration.json",
        "camchain.yaml",
        "camera.opencv.json",
        "camera.opencv.yaml",
        "camera_info.yaml",
        "notes.txt",
    ];
    assert_eq!(names(), expected);
    run(&["--lens", "kannala-brandt", "--camera-format", "ros"]);
    assert_eq!(names(), ["calibration.html", "calibration.json", "camera_info.yaml", "notes.txt"]);
}

#[test]
fn a_hundred_thousand_images_are_read_in_linear_time() {
    let mut text = vnl(&simulated());
    for i in 0..100_000 {
        text += &format!("none{i}.png - - -\n");
    }
    let known = Known { board: Some(BOARD), image: Some([1280, 720]), images: None };
    let start = std::time::Instant::now();
    assert_eq!(read_detections(&text, &known).unwrap().skipped.len(), 100_001);
    // A search of all the names for each takes half a minute.
    assert!(start.elapsed().as_secs_f64() < 10.0, "{:?}", start.elapsed());
}
