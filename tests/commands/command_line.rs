//! Every command does what its help says, as someone new to it would try: output, files and exit codes.

use std::path::Path;
use std::process::Stdio;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::Value;

use crate::desk::{Desk, text};

fn read_json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Header and rows of a CSV file of numbers.
fn read_csv(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader.headers().unwrap().iter().map(String::from).collect();
    let numbers = |record: csv::StringRecord| record.iter().map(|field| field.parse().unwrap()).collect();
    let rows = reader.records().map(|record| numbers(record.unwrap())).collect();
    (header, rows)
}

#[test]
fn plan_says_and_writes_what_it_found() {
    let desk = Desk::new();
    let summary = desk.prose("plan coarse.toml -k 10 -o out");
    for words in ["certified efficiency", "see the whole board", "predicted sigma", "k-means", "Written to out"] {
        assert!(summary.contains(words), "{words:?} is missing from\n{summary}");
    }
    assert_eq!(desk.files("out"), ["plan.csv", "plan.json", "report.html", "run.json", "verification.json"]);

    let plan = read_json(&desk.path("out/plan.json"));
    let documented = [
        "format",
        "version",
        "calipose",
        "problem",
        "criterion",
        "method",
        "count",
        "seed",
        "value",
        "bound",
        "efficiency",
        "survey",
        "intrinsics",
        "map_error_px",
        "certificate",
        "poses",
    ];
    for key in documented {
        assert!(keys(&plan).contains(&key), "{key}");
    }
    assert_eq!(plan["format"], "calipose.plan");
    assert_eq!(plan["version"], 5);
    assert_eq!(keys(&plan["problem"]), ["name", "sha256"]);
    assert_eq!(keys(&plan["survey"]), ["swept", "axis_inside", "axis_edge", "views", "rejected"]);
    assert_eq!(keys(&plan["intrinsics"]), ["names", "nominal", "sigma"]);
    assert_eq!(keys(&plan["certificate"]["grid"]), ["bound", "terms"]);
    assert_eq!(keys(&plan["certificate"]["grid"]["terms"][0]), ["criterion", "share", "matrix"]);
    let poses = plan["poses"].as_array().unwrap();
    assert_eq!(poses.len(), 10);
    for pose in poses {
        let documented =
            ["id", "joints_rad", "joints_deg", "camera_in_base", "target_point_m", "tilt_deg", "distance_m", "share"];
        assert_eq!(keys(pose), documented);
        assert_eq!(keys(&pose["camera_in_base"]), ["position_m", "quaternion_xyzw"]);
        for (rad, deg) in pose["joints_rad"].as_array().unwrap().iter().zip(pose["joints_deg"].as_array().unwrap()) {
            assert!((rad.as_f64().unwrap().to_degrees() - deg.as_f64().unwrap()).abs() < 1e-9);
        }
        assert!((pose["target_point_m"][2].as_f64().unwrap() + 0.098).abs() < 1e-9, "the board's plane");
    }
    let shares: f64 = poses.iter().map(|pose| pose["share"].as_f64().unwrap()).sum();
    assert!((shares - 1.0).abs() < 1e-9);
    let number = |key: &str| plan[key].as_f64().unwrap();
    assert!((number("efficiency") - number("bound") / number("value")).abs() < 1e-9, "v is a variance");
    assert!((number("map_error_px").powi(2) - number("value")).abs() < 1e-9);
    let rejected: u64 = plan["survey"]["rejected"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum();
    let count = |key: &str| plan["survey"][key].as_u64().unwrap();
    assert_eq!(count("axis_inside") + count("axis_edge"), count("views") + rejected);

    let (header, rows) = read_csv(&desk.path("out/plan.csv"));
    let joints = ["waist", "shoulder", "elbow", "neck"];
    assert_eq!(header[0], "id");
    assert_eq!(header[1..5], joints.map(|name| format!("joint_{name}_rad")));
    assert_eq!(header[5..9], joints.map(|name| format!("joint_{name}_deg")));
    assert_eq!(header[9], "camera_x_m");
    assert_eq!(rows.len(), 10);
    let in_order = plan["tour"]["order"].as_array().unwrap().iter();
    let in_order = in_order.map(|id| poses.iter().find(|pose| pose["id"] == *id).unwrap());
    for (row, pose) in rows.iter().zip(in_order) {
        assert_eq!(row[0], pose["id"].as_f64().unwrap());
        assert_eq!(row[1], pose["joints_rad"][0].as_f64().unwrap());
        assert_eq!(row[5], pose["joints_deg"][0].as_f64().unwrap());
        assert_eq!(row.last(), pose["share"].as_f64().as_ref());
    }
    assert_eq!(keys(&read_json(&desk.path("out/run.json"))["seconds"]), ["survey", "selection", "total"]);
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn every_method_and_criterion_can_be_asked_for() {
    let desk = Desk::new();
    let best = "plan coarse.toml --json -k 20 --trials 0 --set selection.tour_tolerance=0 -o best";
    let best = desk.json(best)["efficiency"].as_f64().unwrap();
    for method in ["relaxation", "exchange", "greedy", "random", "kmeans-joints", "kmeans-positions"] {
        let plan = desk.json(&format!("plan coarse.toml --json -k 20 --trials 0 --method {method} -o {method}"));
        assert_eq!(plan["method"], method);
        assert_eq!(plan["poses"].as_array().unwrap().len(), 20, "{method}");
        assert!(plan["efficiency"].as_f64().unwrap() <= best, "{method}");
    }
    let d = desk.json("plan coarse.toml --json --criterion d -o d");
    assert_eq!(d["criterion"], "d");
    let p = d["intrinsics"]["names"].as_array().unwrap().len() as f64;
    let lost = (d["value"].as_f64().unwrap() - d["bound"].as_f64().unwrap()) / p;
    assert!((lost.exp() - d["efficiency"].as_f64().unwrap()).abs() < 1e-9, "d is a log determinant");
}

#[test]
fn the_views_are_the_same_in_both_formats() {
    let desk = Desk::new();
    let views = desk.json("plan coarse.toml --json --views csv -o out")["survey"]["views"].as_u64().unwrap();
    assert_eq!(desk.stdout("plan coarse.toml --quiet --views parquet -o table"), "");
    let others = ["plan.csv", "plan.json", "report.html", "run.json", "verification.json"];
    assert_eq!(desk.files("out"), [&others[..], &["views.csv"]].concat());
    assert_eq!(desk.files("table"), [&others[..], &["views.parquet"]].concat());

    let (header, rows) = read_csv(&desk.path("out/views.csv"));
    assert_eq!(rows.len() as u64, views);
    assert_eq!(header[..5], ["id", "joint_waist_rad", "joint_shoulder_rad", "joint_elbow_rad", "joint_neck_rad"]);
    assert_eq!(header.len(), 1 + 4 + 7 + 3 + 2);
    let file = std::fs::File::open(desk.path("table/views.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let mut read = 0;
    for (record, row) in reader.get_row_iter(None).unwrap().zip(&rows) {
        let record = record.unwrap();
        for (((name, field), expected_name), &expected) in record.get_column_iter().zip(&header).zip(row) {
            assert_eq!(name, expected_name);
            match field {
                Field::Long(id) => assert_eq!(*id as f64, expected),
                Field::Double(number) => assert_eq!(*number, expected, "{name}"),
                other => panic!("{name} is {other:?}"),
            }
        }
        read += 1;
    }
    assert_eq!(read, rows.len());
}

#[test]
fn json_is_the_file_and_quiet_is_silent() {
    let desk = Desk::new();
    let printed = desk.stdout("plan coarse.toml --json -o out");
    assert_eq!(printed, std::fs::read_to_string(desk.path("out/plan.json")).unwrap());
    assert_eq!(desk.stdout("plan coarse.toml --quiet -o quiet"), "");
    assert_eq!(desk.files("quiet"), ["plan.csv", "plan.json", "report.html", "run.json", "verification.json"]);
    assert_eq!(desk.stdout("plan coarse.toml --quiet --json -o out"), printed);
    for line in [
        "sweep coarse.toml -q",
        "check coarse.toml -q",
        "init new.toml -q",
        "compare coarse.toml -q -k 10 --seeds 1 --limit 20 --trials 2",
    ] {
        assert_eq!(desk.stdout(line), "", "{line}");
    }
}

#[test]
fn a_plan_replaces_the_one_before_whole() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 12 -o out");
    std::fs::write(desk.path("out/plan.json"), "x".repeat(1 << 20)).unwrap();
    std::fs::write(desk.path("out/notes.txt"), "mine").unwrap();
    desk.stdout("plan coarse.toml -q -k 10 -o out");
    assert_eq!(read_json(&desk.path("out/plan.json"))["count"], 10);
    assert_eq!(read_csv(&desk.path("out/plan.csv")).1.len(), 10);
    assert_eq!(
        desk.files("out"),
        ["notes.txt", "plan.csv", "plan.json", "report.html", "run.json", "verification.json"]
    );
    assert_eq!(std::fs::read_to_string(desk.path("out/notes.txt")).unwrap(), "mine");
    // A run that fails leaves it alone.
    let before = std::fs::read(desk.path("out/plan.json")).unwrap();
    desk.complaint("plan coarse.toml -k 42000 -o out", 1);
    assert!(before == std::fs::read(desk.path("out/plan.json")).unwrap());
}

#[test]
fn an_output_folder_that_cannot_be_made_is_named() {
    let desk = Desk::new();
    std::fs::write(desk.path("taken"), "a file").unwrap();
    let complaint = desk.complaint("plan coarse.toml -o taken/out", 1);
    assert!(complaint.contains("cannot write taken/out"), "{complaint}");
    assert!(complaint.contains("writable"), "{complaint}");
    assert_eq!(std::fs::read_to_string(desk.path("taken")).unwrap(), "a file");
}

#[test]
fn too_many_or_too_few_poses_are_explained() {
    let desk = Desk::new();
    let complaint = desk.complaint("plan coarse.toml -k 42000", 1);
    assert!(complaint.contains("42 000 poses are asked for, but only"), "{complaint}");
    // Without distortion one view of a plane gives two constraints: two of the four parameters stay open.
    desk.change(
        "pinhole.toml",
        &[
            ("model = \"brown-conrady\"\nk1 = -0.2\nk2 = 0.05", "model = \"none\""),
            (", \"k1\", \"k2\", \"p1\", \"p2\", \"k3\"", ""),
        ],
    );
    for method in ["best", "greedy", "random", "kmeans-joints"] {
        let complaint = desk.complaint(&format!("plan pinhole.toml -k 1 --method {method}"), 1);
        assert!(complaint.contains("1 pose cannot determine all intrinsics; undetermined: 1.000 "), "{complaint}");
        assert!(complaint.contains("ask for more poses"), "{complaint}");
    }
    assert!(desk.complaint("plan coarse.toml -k 0", 3).contains("must be from 1 to 42120"));
    assert!(!desk.path("plans").exists());
}

#[test]
fn wrong_command_lines_end_with_two() {
    let desk = Desk::new();
    for (line, words) in [
        ("plan", "<FILE>"),
        ("plam coarse.toml", "similar"),
        ("compare coarse.toml -k -3,10", "must be a whole number, at least 1"),
        ("verify plan.json --missing -0.5", "--missing is -0.5; it must be from 0 to 99"),
        ("reach coarse.toml --distance-mm -500", "--distance-mm must be positive"),
        ("reach coarse.toml --distance-mm 500 --tilt-deg -5", "--tilt-deg must be at least 0"),
        ("plan coarse.toml --views xlsx", "parquet"),
        ("compare coarse.toml --seeds 0", "at least 1"),
        ("compare coarse.toml -k 0", "at least 1"),
    ] {
        let complaint = desk.complaint(line, 2);
        assert!(complaint.contains(words), "{line}: {complaint}");
    }
    // What stands for a key of the problem file is told as if it stood there.
    for (line, words) in [
        ("plan coarse.toml --method gredy", "did you mean `greedy`?"),
        ("plan coarse.toml --criterion z", "allowed: `d`, `a`, `e`, `v`, `zhang`, `diversity`"),
        ("plan coarse.toml --count ten", "`selection.count` is the string \"ten\""),
        ("plan coarse.toml --count -3", "must be a whole number, at least 1"),
        ("plan coarse.toml --seed 1.5", "must be a whole number, at least 0"),
        ("sweep coarse.toml --step -8", "`sweep.step_deg` is -8"),
        ("sweep coarse.toml --step 0", "`sweep.step_deg` is 0"),
        ("sweep coarse.toml --step NaN", "`sweep.step_deg` is the string \"NaN\""),
    ] {
        let complaint = desk.complaint(line, 3);
        assert!(complaint.contains(words), "{line}: {complaint}");
    }
}

#[test]
fn refused_problem_files_end_with_three() {
    let desk = Desk::new();
    desk.change("typo.toml", &[("width_px", "widht_px")]);
    for command in ["plan", "compare", "sweep", "check"] {
        let complaint = desk.complaint(&format!("{command} typo.toml"), 3);
        assert!(complaint.contains("widht_px") && complaint.contains("width_px"), "{complaint}");
        assert!(desk.complaint(&format!("{command} missing.toml"), 3).contains("missing.toml"));
    }
}

#[test]
fn a_board_out_of_sight_is_explained() {
    let desk = Desk::new();
    let far = ("position_mm = [232.875, 72.75, -98]", "position_mm = [90000, 0, 2000]");
    desk.change("far.toml", &[far, ("[visibility]", "[visibility]\nmax_distance_mm = 1500")]);
    let complaint = desk.complaint("plan far.toml", 1);
    assert!(complaint.contains("points the camera at the target zone"), "{complaint}");
    assert!(complaint.contains("rejected for the reason \"distance\""), "{complaint}");
    assert!(complaint.contains("Nearest miss: the closest camera is"), "{complaint}");
    desk.change("near.toml", &[("[visibility]", "[visibility]\nmin_distance_mm = 90000")]);
    let complaint = desk.complaint("plan near.toml", 1);
    assert!(complaint.contains("rejected, by reason: ") && complaint.contains("distance"), "{complaint}");
    assert!(
        complaint.contains("the farthest camera is") && complaint.contains("min_distance_mm is 90000"),
        "{complaint}"
    );
    let checked = desk.prose("check near.toml");
    assert!(checked.contains("Warning: no views. All of the "), "{checked}");
    assert!(checked.contains("the reason \"distance\". Nearest miss: the farthest camera is"), "{checked}");
    let diagnosis = &desk.json("check near.toml --json")["diagnosis"];
    assert_eq!(
        (&diagnosis["obstacle"]["reason"], &diagnosis["obstacle"]["stops_all"]),
        (&"distance".into(), &true.into())
    );
    assert!(desk.json("check coarse.toml --json")["diagnosis"].is_null());
}

#[test]
fn compare_sets_the_methods_side_by_side() {
    let desk = Desk::new();
    let line = "compare coarse.toml -k 10,15 --seeds 1 --limit 20 --trials 2";
    let told = desk.stdout(line);
    for words in ["kmeans-positions", "map error", "sigma fx", "efficiency", "k-means on joints"] {
        assert!(told.contains(words), "{words:?} is missing from\n{told}");
    }
    let document = desk.json(&format!("{line} --json"));
    assert_eq!(document["format"], "calipose.comparison");
    assert_eq!(keys(&document), ["format", "version", "calipose", "problem", "criterion", "rows", "equivalents"]);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 7);
    for row in rows {
        assert_eq!(
            keys(row),
            ["method", "count", "value", "map_error_px", "sigma", "measured", "efficiency", "seconds"]
        );
        assert!(row["efficiency"].as_f64().unwrap() <= 1.0);
    }
    for equivalent in document["equivalents"].as_array().unwrap() {
        assert_eq!(keys(equivalent), ["count", "method", "equivalent_count", "tried"]);
        assert!(equivalent["tried"].as_u64().unwrap() <= 20);
    }
    assert_eq!(desk.files(".").len(), 1, "compare writes no files");
}

#[test]
fn sweep_counts_at_several_steps() {
    let desk = Desk::new();
    let document = desk.json("sweep coarse.toml --step 20,10 --json");
    assert_eq!(document["format"], "calipose.sweep");
    let sweeps = document["sweeps"].as_array().unwrap();
    let counts = |key: &str| sweeps.iter().map(|sweep| sweep[key].as_u64().unwrap()).collect::<Vec<_>>();
    assert_eq!(counts("swept"), [13_860, 210_672]);
    assert_eq!(counts("candidates"), [364, 4_525]);
    for sweep in sweeps {
        let count = |key: &str| sweep[key].as_u64().unwrap();
        assert_eq!(count("axis_inside") + count("axis_edge") + count("axis_outside"), count("swept"));
        let rejected: u64 = sweep["rejected"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum();
        assert_eq!(count("views") + rejected, count("candidates"));
    }
    let told = desk.stdout("sweep coarse.toml --step 20,10");
    assert!(told.contains("Q*") && told.contains("210 672"), "{told}");
}

#[test]
fn init_check_and_plan_lead_a_newcomer_to_a_plan() {
    let desk = Desk::new();
    assert!(desk.stdout("init").contains("calipose plan problem.toml"));
    let complaint = desk.complaint("init problem.toml", 1);
    assert!(complaint.contains("problem.toml exists already"), "{complaint}");
    let checked = desk.stdout("check problem.toml");
    assert!(checked.contains("valid") && checked.contains("configurations"), "{checked}");
    let document = desk.json("check problem.toml --json");
    assert_eq!(document["format"], "calipose.check");
    for key in ["configurations", "estimated_views", "estimated_seconds", "estimated_memory_mb"] {
        assert!(document[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert_eq!(desk.json("init other.toml --json")["file"], "other.toml");
    desk.stdout("plan problem.toml -q -o out");
    assert!(read_json(&desk.path("out/plan.json"))["efficiency"].as_f64().unwrap() > 0.9);
}

#[test]
fn schema_describes_the_problem_file() {
    let desk = Desk::new();
    let schema = desk.json("schema");
    assert!(schema["$schema"].is_string());
    for section in ["robot", "camera", "target", "sweep", "visibility", "noise", "estimate", "selection"] {
        assert!(schema["properties"][section].is_object(), "{section}");
    }
}

/// `calipose plan --json | head -1`: the reader is gone before the document is written.
#[test]
fn a_reader_that_leaves_is_no_failure() {
    let desk = Desk::new();
    for line in ["plan coarse.toml --json -o out", "schema", "--help"] {
        let mut child = desk.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
        assert_eq!(text(&output.stderr), "", "{line}");
    }
}

#[test]
fn shells_complete_and_every_command_has_a_manual_page() {
    let desk = Desk::new();
    for (shell, words) in [("bash", "_calipose()"), ("zsh", "#compdef calipose"), ("fish", "complete -c calipose")] {
        let script = desk.stdout(&format!("completions {shell}"));
        assert!(script.contains(words) && script.contains("kmeans-joints"), "{shell}: {script}");
    }
    assert!(desk.complaint("completions tcsh", 2).contains("possible values: bash"));
    let page = desk.stdout("man");
    assert!(page.contains(".TH calipose 1") && page.contains("Exit codes"), "{page}");
    assert!(desk.stdout("man pages").contains("manual pages"));
    let pages = desk.files("pages");
    assert!(pages.len() > 15 && pages.contains(&"calipose-plan.1".to_owned()), "{pages:?}");
    let plan = std::fs::read_to_string(desk.path("pages/calipose-plan.1")).unwrap();
    assert!(plan.contains("calipose plan") || plan.contains("calipose\\-plan"), "{plan}");
    assert!(plan.contains("branch and bound") && plan.contains("confidence ellipsoid"), "{plan}");
}

#[test]
fn help_and_version_are_there() {
    let desk = Desk::new();
    assert!(desk.stdout("--help").contains("Exit codes: 0 done"));
    let help = desk.stdout("plan --help");
    assert!(help.contains("--views"));
    assert!(help.contains("branch and bound") && help.contains("confidence ellipsoid"), "{help}");
    assert_eq!(desk.stdout("--version").trim(), format!("calipose {}", env!("CARGO_PKG_VERSION")));
}

#[test]
fn verify_holds_the_simulation_against_the_prediction() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 12 --trials 0 -o out");
    assert!(!desk.files("out").contains(&"verification.json".to_owned()));
    let told = desk.stdout("verify out/plan.json -n 60");
    for words in ["predicted sigma", "99 % interval", "Every calibration converged", "Verdict: "] {
        assert!(told.contains(words), "{words:?} is missing from\n{told}");
    }
    let line = "verify out/plan.json -n 60 --seed 3 --json";
    let document = desk.json(line);
    assert_eq!(document, desk.json(line));
    assert_eq!(document["format"], "calipose.verification");
    assert_eq!(document["parameters"].as_array().unwrap().len(), 9);
    for parameter in document["parameters"].as_array().unwrap() {
        let ratio = parameter["ratio"].as_f64().unwrap();
        assert!((0.6..1.5).contains(&ratio), "{parameter}");
    }
    // What the prediction leaves out makes the calibration worse.
    let bad = |options: &str| serde_json::from_str::<Value>(&desk.bad(&format!("{line} {options}"))).unwrap();
    let disturbed = bad("--noise-with-distance 3 --noise-with-tilt 3 --missing 20");
    assert_eq!((&document["holds"], &disturbed["holds"]), (&Value::Bool(true), &Value::Bool(false)));
    let measured = |document: &Value| document["map_error_px"]["measured"].as_f64().unwrap();
    assert!(measured(&disturbed) > 1.3 * measured(&document));
    // A board that leaves the image is lost, not an error.
    let lost = bad("--mount-rotation 40");
    assert!(lost["failed"].as_u64().unwrap() > 0 && lost["failures"][0]["reason"].is_string(), "{lost}");
}

/// Exit code 4: the plan is written, and a script that goes on to the robot is stopped.
#[test]
fn a_plan_that_does_worse_than_it_predicts_ends_with_four() {
    let desk = Desk::new();
    desk.change("noisy.toml", &[("sigma_px = 0.3", "sigma_px = 10")]);
    let told = desk.bad("plan noisy.toml -k 6 -o out");
    assert!(told.contains("Verdict: ") && told.contains("Written to out"), "{told}");
    assert_eq!(read_json(&desk.path("out/verification.json"))["holds"], false);
    assert!(desk.bad("verify out/plan.json -n 100").contains("Verdict: "));
    // Too few to tell are not held against it.
    assert_eq!(desk.json("verify out/plan.json -n 2 --json")["holds"], Value::Null);
    assert_eq!(desk.stdout("plan noisy.toml -q -k 6 --trials 0 -o out"), "");
}

#[test]
fn verify_refuses_what_is_no_plan_of_the_problem() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 12 --trials 0 -o out");
    assert!(desk.complaint("verify out/plan.json -n 1", 2).contains("--trials"));
    assert!(desk.complaint("verify out/plan.json --missing 100", 2).contains("--missing"));
    assert!(desk.complaint("verify out/missing.json", 3).contains("missing.json"));
    assert!(desk.complaint("verify out/run.json", 3).contains("calipose.run"));
    desk.change("changed.toml", &[("sigma_px = 0.3", "sigma_px = 0.4")]);
    assert!(desk.complaint("verify out/plan.json --problem changed.toml", 3).contains("another version"));
    std::fs::remove_file(desk.path("out/run.json")).unwrap();
    assert!(desk.complaint("verify out/plan.json", 3).contains("--problem"));
    desk.stdout("verify out/plan.json --problem coarse.toml -n 4");
    let plan = std::fs::read_to_string(desk.path("out/plan.json")).unwrap();
    std::fs::write(desk.path("out/plan.json"), &plan[..plan.len() / 2]).unwrap();
    assert!(desk.complaint("verify out/plan.json --problem coarse.toml", 3).contains("not a plan"));
    std::fs::write(desk.path("out/plan.json"), plan.replace("\"version\": 5", "\"version\": 9")).unwrap();
    assert!(desk.complaint("verify out/plan.json --problem coarse.toml", 3).contains("version 9"));
    std::fs::write(desk.path("out/plan.json"), plan.replace("\"version\": 5", "\"version\": 3")).unwrap();
    let older = desk.complaint("verify out/plan.json --problem coarse.toml", 3);
    assert!(older.contains("version 3, made by an older calipose") && older.contains("make a new plan"), "{older}");
}

/// The hash in a plan is of the problem file; the robot is in another.
#[test]
fn a_plan_for_a_robot_that_has_changed_is_refused() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("urdf")).unwrap();
    let urdf = std::fs::read_to_string("problems/urdf/six-axis-rover.urdf").unwrap();
    let problem = std::fs::read_to_string("problems/six-axis-rover.toml").unwrap();
    std::fs::write(desk.path("urdf/six-axis-rover.urdf"), &urdf).unwrap();
    std::fs::write(desk.path("rover.toml"), problem.replace("sample = 500_000", "sample = 30_000")).unwrap();
    desk.stdout("plan rover.toml -q --trials 0 -o out");
    desk.stdout("verify out/plan.json -n 4");
    let changed = urdf.replace("xyz=\"0 0.12 0.48\"", "xyz=\"0 0.12 0.481\"");
    assert_ne!(changed, urdf);
    std::fs::write(desk.path("urdf/six-axis-rover.urdf"), changed).unwrap();
    assert!(desk.complaint("verify out/plan.json -n 4", 3).contains("lead to another camera pose"));
}

/// Views that repeat each other exactly teach in proportion, where rounding decides what greedy sees.
#[test]
fn a_robot_that_cannot_move_the_camera_gets_an_answer() {
    let desk = Desk::new();
    let problem = r#"
        [[robot.joints]]
        name = "turn"
        limits_deg = [0, 0]
        [camera]
        mount = "optical-axis-z"
        width_px = 1280
        height_px = 720
        fx_px = 1200
        fy_px = 1200
        [camera.distortion]
        model = "rational"
        k1 = 0.1
        k2 = 0.02
        k4 = -0.05
        k5 = 0.3
        k6 = 0.1
        [target]
        columns = 8
        rows = 6
        square_mm = 35
        pose = { position_mm = [20, 10, 800], rpy_deg = [170, 12, 8] }
        [sweep]
        sample = 21
        [estimate]
        intrinsics = ["k1", "k2", "k3", "k4"]
        [selection]
        count = 5
    "#;
    std::fs::write(desk.path("still.toml"), problem).unwrap();
    for criterion in ["v", "d"] {
        let line = format!("plan still.toml --criterion {criterion} -o still");
        let output = desk.run(&line);
        assert!(matches!(output.status.code(), Some(0 | 1 | 4)), "{output:?}");
    }
}

#[test]
fn what_told_of_an_earlier_plan_does_not_stay_beside_a_new_one() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 10 --trials 2 --views csv -o out");
    assert!(desk.files("out").contains(&"views.csv".to_owned()));
    desk.stdout("plan coarse.toml -q -k 12 --trials 0 -o out");
    assert_eq!(desk.files("out"), ["plan.csv", "plan.json", "report.html", "run.json"]);
}

/// An even stride through the grid would always meet the last joint at one value.
#[test]
fn check_foresees_about_as_many_views_as_the_plan_finds() {
    let desk = Desk::new();
    let foreseen = desk.json("check coarse.toml --json")["estimated_views"].as_f64().unwrap();
    let found = desk.json("plan coarse.toml --json --trials 0 -o out")["survey"]["views"].as_f64().unwrap();
    assert!((foreseen / found - 1.0).abs() < 0.3, "{foreseen} foreseen, {found} found");
}

/// An accuracy decides on the number of poses; the forecast says about how many.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn check_foresees_the_poses_that_an_accuracy_takes() {
    let desk = Desk::new();
    let goal = "criterion = \"v\"\nmethod = \"best\"\ncount = 10";
    desk.change("fine.toml", &[(goal, "accuracy = { map_error_px = 1.2 }\ntime_limit_s = 1")]);
    let foreseen = desk.json("check fine.toml --json");
    let count = desk.json("plan fine.toml --json --trials 0 -o out")["count"].as_f64().unwrap();
    let told = foreseen["estimated_poses"].as_f64().unwrap();
    assert!((told / count - 1.0).abs() < 0.3, "{told} foreseen, {count} found");
    assert_eq!(foreseen["search_limit_seconds"], 1.0);
    assert!(desk.prose("check fine.toml").contains("the fewest poses that reach map_error_px 1.2 (about "));
}

#[test]
fn check_foresees_what_refinement_and_large_boards_cost() {
    let desk = Desk::new();
    let seconds = |name: &str| desk.json(&format!("check {name} --json"))["estimated_seconds"].as_f64().unwrap();
    desk.change("refined.toml", &[("[sweep]", "[sweep]\nrefine = 10\nrefine_sample = 1_000_000")]);
    assert!(seconds("refined.toml") > 5.0 + 5.0 * seconds("coarse.toml"));
    let board = std::fs::read_to_string(desk.path("coarse.toml")).unwrap();
    let columns = board.lines().find(|line| line.starts_with("columns")).unwrap().to_owned();
    let rows = board.lines().find(|line| line.starts_with("rows")).unwrap().to_owned();
    let square = board.lines().find(|line| line.starts_with("square_mm")).unwrap().to_owned();
    let thousand = [
        (columns.as_str(), "columns = 1000"),
        (rows.as_str(), "rows = 1000"),
        (square.as_str(), "square_mm = 0.15"),
        ("[visibility]", "[visibility]\nmin_corner_spacing_px = 0"),
    ];
    desk.change("large.toml", &thousand);
    let start = std::time::Instant::now();
    assert!(seconds("large.toml") > 100.0);
    assert!(start.elapsed().as_secs() < 20, "the forecast itself took {:?}", start.elapsed());
}

/// Its console block, but for what depends on the machine.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn the_readme_shows_what_the_program_prints() {
    let readme = std::fs::read_to_string("README.md").unwrap();
    let (command, rest) =
        readme.split_once("$ cargo run --release -- plan problems/servosila-engineer.toml\n").unwrap();
    assert!(command.ends_with("```console\n"));
    let shown = rest.split("```").next().unwrap();
    let problem = std::path::absolute("problems/servosila-engineer.toml").unwrap();
    let desk = Desk::new();
    let printed = desk.stdout(&format!("plan {} -o plans/servosila-engineer", problem.display()));
    let mut lines = printed.lines();
    let mut compared = 0;
    for line in shown.lines().filter(|line| *line != "[…]" && !line.starts_with("report.html")) {
        assert!(lines.any(|printed| printed == line), "the program does not print, or not there: {line}");
        compared += 1;
    }
    assert!(compared > 15, "{compared}");
}
