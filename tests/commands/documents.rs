//! Every document that the program writes is as its JSON Schema says, and the schema tells all that is in it.

use std::collections::BTreeSet;
use std::path::Path;

use calipose::plan::document::Kind;
use calipose::problem::Problem;
use calipose::verification::simulate;
use serde_json::{Value, json};

use crate::desk::{Desk, text};

/// What in `value` is not as `schema` says, with the place. Stricter than JSON Schema in one thing: a key that the schema does
/// not describe is a fault. Knows the words that the program's schemas use, and refuses others.
fn faults(root: &Value, schema: &Value, value: &Value, place: &str) -> Vec<String> {
    const KNOWN: [&str; 20] = [
        "$ref",
        "$defs",
        "$schema",
        "title",
        "description",
        "format",
        "type",
        "const",
        "anyOf",
        "oneOf",
        "properties",
        "required",
        "additionalProperties",
        "items",
        "minItems",
        "maxItems",
        "minimum",
        "maximum",
        "default",
        "enum",
    ];
    let Value::Object(words) = schema else {
        assert_eq!(*schema, json!(true), "{place}");
        return Vec::new();
    };
    let strange: Vec<&String> = words.keys().filter(|word| !KNOWN.contains(&word.as_str())).collect();
    assert!(strange.is_empty(), "{place}: the test does not know {strange:?}");
    let is_anything = !["$ref", "type", "anyOf", "oneOf", "const", "enum"].iter().any(|&word| words.contains_key(word));
    if is_anything {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut fault = |what: String| found.push(format!("{place}: {what}"));
    if let Some(name) = schema["$ref"].as_str() {
        return faults(root, root.pointer(name.trim_start_matches('#')).unwrap(), value, place);
    }
    if let Some(options) = schema["anyOf"].as_array() {
        let all: Vec<Vec<String>> = options.iter().map(|option| faults(root, option, value, place)).collect();
        return if all.iter().any(Vec::is_empty) { Vec::new() } else { all.concat() };
    }
    if let Some(options) = schema["oneOf"].as_array() {
        let all: Vec<Vec<String>> = options.iter().map(|option| faults(root, option, value, place)).collect();
        return if all.iter().filter(|faults| faults.is_empty()).count() == 1 { Vec::new() } else { all.concat() };
    }
    if let Some(only) = words.get("const").filter(|only| *only != value) {
        fault(format!("{value} in place of {only}"));
    }
    if let Some(names) = schema["enum"].as_array().filter(|names| !names.contains(value)) {
        fault(format!("{value} is none of {names:?}"));
    }
    let of_type = |name: &Value| match name.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("{place}: {other}"),
    };
    let is_of_type = match &words.get("type") {
        None => true,
        Some(Value::Array(names)) => names.iter().any(of_type),
        Some(name) => of_type(name),
    };
    if !is_of_type {
        fault(format!("{value} is no {}", schema["type"]));
    }
    if let Some(number) = value.as_f64() {
        let (least, most) = (schema["minimum"].as_f64(), schema["maximum"].as_f64());
        if least.is_some_and(|least| number < least) || most.is_some_and(|most| number > most) {
            fault(format!("{number} is out of range"));
        }
    }
    if let Some(list) = value.as_array() {
        let (least, most) = (schema["minItems"].as_u64(), schema["maxItems"].as_u64());
        let count = list.len() as u64;
        if least.is_some_and(|least| count < least) || most.is_some_and(|most| count > most) {
            fault(format!("{count} entries"));
        }
        for (i, entry) in list.iter().enumerate() {
            found.extend(faults(root, &schema["items"], entry, &format!("{place}[{i}]")));
        }
    } else if let Some(object) = value.as_object() {
        for key in schema["required"].as_array().into_iter().flatten() {
            if !object.contains_key(key.as_str().unwrap()) {
                fault(format!("{key} is missing"));
            }
        }
        for (key, value) in object {
            match schema["properties"].get(key).or(words.get("additionalProperties")) {
                Some(below) => found.extend(faults(root, below, value, &format!("{place}.{key}"))),
                None => found.push(format!("{place}: `{key}` is not described")),
            }
        }
    }
    found
}

/// Documents that were held against their schemas.
#[derive(Default)]
struct Held(BTreeSet<&'static str>);

impl Held {
    /// Holds a document against the schema of its kind.
    fn hold(&mut self, document: &Value) {
        let format = document["format"].as_str().unwrap();
        let kind = Kind::ALL.into_iter().find(|kind| kind.format == format).unwrap();
        let schema = kind.schema();
        assert_eq!(faults(&schema, &schema, document, kind.name()), [""; 0]);
        let keys: Vec<&String> = document.as_object().unwrap().keys().take(3).collect();
        assert_eq!(keys, ["format", "version", "calipose"], "{format}");
        self.0.insert(kind.name());
    }

    fn hold_file(&mut self, path: &Path) {
        self.hold(&serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap());
    }
}

/// Detections of the plan's poses, as `calibrate` and `next` read them.
fn observations(plan: &Value, problem: &Problem) -> Value {
    let pose = |pose: &Value| {
        let q: Vec<f64> = serde_json::from_value(pose["joints_rad"].clone()).unwrap();
        problem.robot.camera_pose(&q).inverse() * problem.target.X_BT
    };
    let poses: Vec<_> = plan["poses"].as_array().unwrap().iter().map(pose).collect();
    let board = &problem.target.board;
    let (columns, rows, square) = board.grid().unwrap();
    let seen = simulate(&problem.camera, board, &poses, problem.noise, 4).unwrap();
    let views = seen.views().iter().enumerate().map(|(i, corners)| {
        let mut pixels = vec![Value::Null; board.corner_count()];
        for corner in corners {
            // One that does not fit.
            let off = if i == 0 && corner.index == 3 { 9.0 } else { 0.0 };
            pixels[corner.index] = json!([corner.pixel.x + off, corner.pixel.y]);
        }
        json!({ "name": format!("{i}.png"), "corners": pixels })
    });
    json!({
        "format": "calipose.observations",
        "version": 1,
        "board": { "columns": columns, "rows": rows, "square_mm": square * 1e3 },
        "image": { "width_px": problem.camera.width(), "height_px": problem.camera.height() },
        "views": views.collect::<Vec<_>>(),
    })
}

#[test]
fn every_document_is_as_its_schema_says() {
    let mut held = Held::default();
    let desk = Desk::new();
    let plan = desk.json("plan coarse.toml -k 12 --criterion d --trials 2 -o out --json");
    held.hold(&plan);
    for file in ["plan.json", "run.json", "verification.json"] {
        held.hold_file(&desk.path("out").join(file));
    }
    let problem = Problem::read(&desk.path("coarse.toml")).unwrap();
    std::fs::write(desk.path("seen.json"), observations(&plan, &problem).to_string()).unwrap();
    let corner = |i: usize| (100 + 20 * (i % 8), 400 - 20 * (i / 8));
    let twice = ["a", "b"].iter().zip([0.1, 0.0]).flat_map(|(name, moved)| {
        (0..48).map(move |i| format!("{name}.png {} {} 0\n", corner(i).0 as f64 + moved * (i % 3) as f64, corner(i).1))
    });
    std::fs::write(desk.path("twice.vnl"), "# filename x y level\n".to_owned() + &twice.collect::<String>()).unwrap();
    // A quarter of the camera is a sixteenth of the work.
    let quarter =
        [("= 1280", "= 320"), ("= 720", "= 180"), ("fx_px = 1000", "fx_px = 250"), ("fy_px = 1000", "fy_px = 250")];
    desk.change("small.toml", &quarter);
    std::fs::write(desk.path("study.toml"), "problems = [\"coarse.toml\"]\nchoose.counts = [9, 12]\n").unwrap();
    for line in [
        "report out/plan.json",
        "figures out/plan.json --format svg",
        "verify out/plan.json -n 30",
        "certify out/plan.json",
        "plan small.toml -k 9 --trials 0 -o small",
        "render small/plan.json --supersampling 1",
        "explain out/plan.json --most 13 --spares 1",
        "polish out/plan.json --cycles 1",
        "next out/plan.json seen.json -k 2",
        "compare coarse.toml -k 9 --seeds 1 --limit 20 --trials 2",
        "score out/plan.csv --problem coarse.toml",
        "diff out small",
        "calibrate seen.json --problem coarse.toml -o camera --map-error-px 9",
        "noise twice.vnl --problem coarse.toml",
        "sweep coarse.toml --step 20",
        "sweep coarse.toml",
        "reach coarse.toml --distance-mm 400",
        "check coarse.toml",
        "board coarse.toml",
        "init new.toml",
        "study check study.toml",
        "study run study.toml -o study",
        "study cell study.toml 0 -o study",
        "study submit study.toml --engine slurm -o study --dry-run",
    ] {
        let output = desk.run(&format!("{line} --json"));
        let document = serde_json::from_slice(&output.stdout);
        held.hold(&document.unwrap_or_else(|_| panic!("{line}: {}", text(&output.stderr))));
    }
    // The tour's events are several.
    let events = text(&desk.run("follow out/plan.json --watch . --json").stdout);
    events.lines().for_each(|event| held.hold(&serde_json::from_str(event).unwrap()));
    let state = desk.path("out/follow.json");
    held.hold_file(&state);
    let study = "problems = [\"coarse.toml\"]\nset = [\"sweep.step_deg=20\"]\n[simulate]\ntrials = 2\n[[factors]]\nkey = \
                 \"noise.sigma_px\"\nvalues = [0.3, 0.6]\n";
    std::fs::write(desk.path("study.toml"), study).unwrap();
    let design = "problem = \"coarse.toml\"\nset = [\"visibility.min_distance_mm=200\"]\n[search]\nscreened = 2\nrounds = \
                  1\nmap = 2\n[[free]]\nkey = \"target.pose.position_mm[0]\"\nuniform = [200, 300]\n[[free]]\nkey = \
                  \"target.pose.position_mm[1]\"\nuniform = [0, 100]\n";
    std::fs::write(desk.path("design.toml"), design).unwrap();
    for line in [
        "study check study.toml",
        "study cell study.toml 0 -o st",
        "study run study.toml -o st",
        "check design.toml",
        "export out/plan.json --to csv",
        "design design.toml -o de",
    ] {
        held.hold(&desk.json(&format!("{line} --json")));
    }
    for sub in std::fs::read_dir(desk.path("st/cells")).unwrap() {
        for cell in std::fs::read_dir(sub.unwrap().path()).unwrap() {
            held.hold_file(&cell.unwrap().path());
        }
    }
    for file in ["polished.json", "next.json"] {
        held.hold_file(&desk.path("out").join(file));
    }
    held.hold_file(&desk.path("camera/calibration.json"));
    let cells = std::fs::read_dir(desk.path("study/cells")).unwrap().flatten();
    for cell in cells.flat_map(|folder| std::fs::read_dir(folder.path()).unwrap().flatten()) {
        held.hold_file(&cell.path());
    }
    desk.change("typo.toml", &[("width_px", "widht_px")]);
    for line in ["check typo.toml", "check none.toml", "plan", "verify seen.json"] {
        held.hold(&serde_json::from_slice(&desk.run(&format!("{line} --json")).stderr).unwrap());
    }
    assert_eq!(held.0, Kind::ALL.into_iter().map(Kind::name).collect::<BTreeSet<_>>(), "every kind is written");
}

/// What only some plans have: a search, and the proof that fewer poses do not suffice; and a robot with bodies.
#[test]
fn the_rarer_parts_of_documents_are_as_their_schemas_say() {
    let mut held = Held::default();
    let desk = Desk::new();
    desk.change("exact.toml", &[("method = \"best\"", "method = \"exact\"\nnode_limit = 9")]);
    let exact = desk.json("plan exact.toml --trials 0 -o exact --json");
    assert!(exact["search"]["open_views"].is_u64());
    held.hold(&exact);
    let chosen = "criterion = \"v\"\nmethod = \"best\"\ncount = 10";
    desk.change("accurate.toml", &[(chosen, "accuracy = { map_error_px = 5.0 }\nnode_limit = 9")]);
    let accurate = desk.json("plan accurate.toml --trials 0 -o accurate --json");
    assert!(accurate["fewest"]["least"].is_u64());
    held.hold(&accurate);
    held.hold(&desk.json("certify accurate/plan.json --json"));
    held.hold(&desk.json("check accurate.toml --json"));
    let tiled = desk.json("board coarse.toml --tile --json");
    assert!(tiled["tiles"].is_object());
    held.hold(&tiled);
    let rover = Path::new("problems/six-axis-rover.toml").canonicalize().unwrap();
    let checked = desk.json(&format!("check {} --json", rover.display()));
    assert!(checked["self_collision"].is_object());
    held.hold(&checked);
}

#[test]
fn the_command_prints_the_schema_of_each_kind_and_of_problem_files_without_one() {
    let desk = Desk::new();
    for kind in Kind::ALL {
        let schema = desk.json(&format!("schema --for {}", kind.name()));
        assert_eq!(schema, kind.schema());
        assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
        assert_eq!(schema["properties"]["version"]["const"], kind.version);
        let undescribed =
            schema["properties"].as_object().unwrap().iter().filter(|(_, key)| key.get("description").is_none());
        assert_eq!(undescribed.count(), 0, "{}", kind.name());
    }
    assert_eq!(desk.json("schema"), desk.json("schema --for problem"));
    assert!(desk.complaint("schema --for nothing", 2).contains("explanation"));
}
