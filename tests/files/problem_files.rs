//! The problem files that ship load, and mean what they say.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use calipose::feasibility::feasible_views;
use calipose::motion::JointLimits;
use calipose::problem::{Overrides, Problem, STARTER, schema_json};
use calipose::robot::{JointKind, Shape};
use calipose::sweep::sweep;
use nalgebra::{Point3, Vector2, Vector3};
use serde_json::Value;

fn load(text: &str) -> Problem {
    Problem::parse(text, Path::new("problem.toml")).map_err(miette::Report::new).unwrap()
}

fn shipped() -> Vec<PathBuf> {
    let files = std::fs::read_dir("problems").unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

/// The starter with one of its commented keys, or one of its commented sections, uncommented.
fn starter_variants() -> Vec<(String, String)> {
    let lines: Vec<&str> = STARTER.lines().collect();
    let is_toml = |line: &str| {
        let word = line.strip_prefix("# ").unwrap_or_default();
        let key = word.split(" = ").next().unwrap_or_default();
        word.starts_with('[')
            || (key != word && key.chars().all(|c| c.is_ascii_lowercase() || c == '_' || c.is_ascii_digit()))
    };
    let uncommented = |chosen: &dyn Fn(usize) -> bool| {
        let line = |(i, line): (usize, &&str)| line[if chosen(i) && is_toml(line) { 2 } else { 0 }..].to_owned() + "\n";
        lines.iter().enumerate().map(line).collect::<String>()
    };
    let mut variants = Vec::new();
    let mut start = 0;
    for run in lines.chunk_by(|a, b| a.starts_with('#') == b.starts_with('#')) {
        let run = start..start + run.len();
        start = run.end;
        if lines[run.clone()].iter().any(|line| line.starts_with("# [")) {
            variants.push((lines[run.clone()].join("\n"), uncommented(&|i| run.contains(&i))));
        } else {
            let keys = run.filter(|&i| is_toml(lines[i]));
            variants.extend(keys.map(|key| (lines[key].to_owned(), uncommented(&|i| i == key))));
        }
    }
    variants
}

#[test]
fn whatever_is_commented_out_in_the_starter_may_be_uncommented() {
    let variants = starter_variants();
    assert!(variants.len() > 25, "{}", variants.len());
    for (what, text) in variants {
        assert_ne!(text, STARTER, "{what}");
        if let Err(error) = Problem::parse(&text, Path::new("starter.toml")) {
            panic!("{what}\n{:?}", error.faults());
        }
    }
}

#[test]
fn every_shipped_file_loads() {
    assert!(!shipped().is_empty());
    for path in shipped() {
        Problem::read(&path).map_err(miette::Report::new).unwrap();
    }
}

/// The arms made for this project: their plans can be what the problem files promise.
#[test]
fn described_robots_see_the_board_from_many_configurations() {
    for (name, joints, disabled) in [("six-axis-rover", 6, 0), ("seven-axis-carrier", 7, 15)] {
        let path = PathBuf::from(format!("problems/{name}.toml"));
        let problem = Problem::read(&path).map_err(miette::Report::new).unwrap();
        assert_eq!(problem.robot.chain.dof(), joints);
        assert_eq!(problem.robot.tree.disabled.len(), disabled);
        assert!(problem.robot.tree.links.iter().all(|link| link.mass.is_none() || !link.bodies.is_empty()));
        let X_BL = problem.robot.tree.link_poses(&vec![0.0; joints]);
        let mass = problem.robot.tree.center_of_mass(&X_BL).unwrap().mass;
        assert!((80.0..130.0).contains(&mass), "{name}: {mass} kg");
        let found = sweep(&problem.robot, &problem.target, &problem.space, problem.axis, &|_| {});
        let (views, rejected) = feasible_views(&problem.checks(), &problem.space, &found.candidates);
        assert!(
            views.len() > 200 * problem.selection.goal.count().unwrap(),
            "{name}: {} views, {rejected:?}",
            views.len()
        );
    }
}

#[test]
fn the_starter_has_views_to_choose_from() {
    let problem = load(STARTER);
    let found = sweep(&problem.robot, &problem.target, &problem.space, problem.axis, &|_| {});
    let (views, rejected) = feasible_views(&problem.checks(), &problem.space, &found.candidates);
    assert!(views.len() > 100 * problem.selection.goal.count().unwrap(), "{} views, {rejected:?}", views.len());
}

/// The starter shows the defaults as comments; with the comment signs taken off it must say the same.
#[test]
fn the_defaults_that_the_starter_shows_are_the_defaults() {
    let mut shown = STARTER.to_owned();
    for key in [
        "margin_px",
        "max_incidence_deg",
        "max_tilt_deg",
        "min_corner_spacing_px",
        "axis",
        "refine",
        "refine_sample",
        "criterion",
        "method",
        "seed",
        "tolerance",
        "time_limit_s",
        "node_limit",
    ] {
        let comment = format!("# {key} = ");
        assert!(shown.contains(&comment), "{key}");
        shown = shown.replace(&comment, &format!("{key} = "));
    }
    for (comment, key) in [("# [estimate]\n# intrinsics", "[estimate]\nintrinsics"), ("# flange = ", "flange = ")] {
        assert!(shown.contains(comment));
        shown = shown.replace(comment, key);
    }
    let shown = Problem { sha256: String::new(), ..load(&shown) };
    assert_eq!(shown, Problem { sha256: String::new(), ..load(STARTER) });
}

#[test]
fn units_become_metres_and_radians() {
    let problem = Problem::read(Path::new("problems/servosila-engineer.toml")).unwrap();
    let joints = &problem.robot.chain.joints;
    assert_eq!(joints[0].limits.max, 137.3f64.to_radians());
    assert_eq!(problem.target.board.grid().unwrap().2, 0.035);
    assert_eq!(problem.target.zone.width, 0.378_25);
    assert_eq!(problem.camera.intrinsics(), [1000.0, 1000.0, 639.5, 359.5, -0.2, 0.05, 0.0, 0.0, 0.0]);
    assert_eq!(problem.output, Path::new("plans/servosila-engineer"));
    assert_eq!(problem.sha256.len(), 64);
    // The paper's figure 9, and where its camera looks.
    let X_BC = problem.robot.camera_pose(&[-0.2478, 1.4591, -0.644 - PI, -2.618 + PI]);
    let ahead = X_BC * Point3::new(0.0, 0.0, 0.72488);
    assert!((ahead - Point3::new(0.22119, -0.05596, -0.098)).norm() < 1e-5, "{ahead}");
}

#[test]
fn prismatic_joints_modified_tables_and_poses() {
    let problem = load(
        r#"
        [robot]
        convention = "modified"
        flange = { position_mm = [0, 0, 50], rpy_deg = [90, 0, 90] }
        [[robot.joints]]
        name = "slide"
        kind = "prismatic"
        alpha_deg = 90
        a_mm = 100
        limits_mm = [0, 500]
        max_speed_mm_s = 250
        [camera]
        mount = { position_mm = [10, 0, 0], quaternion_xyzw = [0, 0, 0.7071, 0.7071] }
        width_px = 640
        height_px = 480
        fx_px = 500
        [target]
        columns = 4
        rows = 3
        square_mm = 30
        pose = {}
        [sweep]
        step_mm = [100]
        [selection]
        count = 6
        "#,
    );
    let joint = &problem.robot.chain.joints[0];
    assert_eq!((joint.kind, joint.limits.max, joint.max_speed), (JointKind::Prismatic, 0.5, Some(0.25)));
    assert_eq!(problem.space.len(), 6);
    assert_eq!(problem.name, "problem");
    assert_eq!(problem.camera.intrinsics(), [500.0, 500.0, 319.5, 239.5]);
    assert_eq!((problem.target.zone.width, problem.target.zone.height), (0.15, 0.12));
    // Rx(90°)·Tx(100 mm)·Tz(q + 50 mm), then Rz(90°)·Rx(90°), then 10 mm along x and Rz(90°).
    let X_BC = problem.robot.camera_pose(&[0.2]);
    assert!((X_BC.translation.vector - Vector3::new(0.1, -0.25, 0.01)).norm() < 1e-12, "{X_BC}");
    assert!((X_BC.rotation * Vector3::x() - Vector3::new(0.0, -1.0, 0.0)).norm() < 1e-12, "{X_BC}");
}

#[test]
fn joints_without_a_speed_are_slow_and_reach_it_in_a_second() {
    let text = std::fs::read_to_string("problems/servosila-engineer.toml").unwrap();
    let text = text.replace("d_mm = 60\n", "d_mm = 60\nmax_speed_deg_s = 90\n");
    let motion = load(
        &(text + "\n[motion]\nspeed_percent = 50\nmax_acceleration_deg_s2 = { elbow = 20 }\nmax_jerk_deg_s3 = { elbow = 90 }\nhome = [0, 0, -90, 45]\n"),
    )
    .motion;
    let in_degrees = |limits: &JointLimits| {
        [limits.speed, limits.acceleration, limits.jerk].map(|x| (x.to_degrees() * 1e9).round() / 1e9)
    };
    let limits: Vec<[f64; 3]> = motion.limits().iter().map(in_degrees).collect();
    let none = f64::INFINITY;
    assert_eq!(limits, [[5.0, 5.0, none], [5.0, 5.0, none], [5.0, 10.0, 45.0], [45.0, 45.0, none]]);
    assert_eq!((motion.assumed, motion.dwell), (vec![0, 1, 2], 1.0));
    let home = motion.home.unwrap();
    assert!(home.returns && home.q == [0.0, 0.0, -90f64.to_radians(), 45f64.to_radians()]);
}

#[test]
fn a_fisheye_is_a_camera_too() {
    let text = STARTER.replace("model = \"brown-conrady\"", "model = \"kannala-brandt\"");
    let camera = load(&text).camera;
    assert_eq!(camera.intrinsics()[4..], [-0.1, 0.0, 0.0, 0.0]);
    assert!(camera.unproject(&Vector2::new(0.0, 0.0)).is_some());
}

#[test]
fn whole_numbers_stand_for_fractions_and_line_ends_may_be_windows() {
    let unix = load(STARTER);
    let windows = load(&STARTER.replace('\n', "\r\n").replace("sigma_px = 0.3", "sigma_px = 3e-1"));
    assert_eq!(windows.robot, unix.robot);
    assert_ne!(windows.sha256, unix.sha256);
}

/// The mounts that need no numbers, against the same in roll, pitch and yaw; ROS's own is that of its optical frames.
#[test]
fn named_mounts_are_the_rotations_that_they_say() {
    let mounted = |mount: &str| {
        let text =
            STARTER.replace("mount = { position_mm = [0, -60, 40], rpy_deg = [0, 0, 0] }", &format!("mount = {mount}"));
        assert_ne!(text, STARTER);
        load(&text).robot.X_FC
    };
    for (name, rpy) in [
        ("optical-axis-z", "0, 0, 0"),
        ("ros-optical", "0, 0, 0"),
        ("ros-body", "-90, 0, -90"),
        ("opengl", "180, 0, 0"),
        ("optical-axis-x", "0, -90, 180"),
    ] {
        let (named, given) = (mounted(&format!("\"{name}\"")), mounted(&format!("{{ rpy_deg = [{rpy}] }}")));
        assert!(named.rotation.angle_to(&given.rotation) < 1e-7, "{name}: {named}, {given}");
    }
    let X_FC = mounted("\"ros-body\"");
    let axis = |v: Vector3<f64>| X_FC.rotation * v;
    // Forward is x, right is −y, up in the picture is z.
    assert!((axis(Vector3::z()) - Vector3::x()).norm() < 1e-15 && (axis(Vector3::x()) + Vector3::y()).norm() < 1e-15);
    assert!((axis(-Vector3::y()) - Vector3::z()).norm() < 1e-15);
}

/// The starter's robot has bodies and stands on a table, and what it shows as comments of masses and stability is right.
#[test]
fn the_starter_is_tested_for_collision_with_its_table_and_its_masses_are_right() {
    let mut shown = STARTER.to_owned();
    for line in STARTER.lines() {
        let starts =
            ["# [[robot.masses", "# link", "# mass", "# center_mm", "# [stability]", "# support", "# margin_mm"];
        if starts.iter().any(|start| line.starts_with(start)) {
            shown = shown.replacen(&format!("\n{line}\n"), &format!("\n{}\n", &line[2..]), 1);
        }
    }
    let problem = load(&shown);
    let robot = &problem.robot;
    assert_eq!(robot.joints_without_bodies().count(), 0);
    let [table] = robot.obstacles[..] else { panic!("{:?}", robot.obstacles) };
    assert_eq!(robot.tree.links[table].name, "table");
    let links = problem.checks().collision().links().clone();
    assert_eq!((links.always.len(), links.close.len()), (0, 0), "{links:?}");
    assert!(links.tested.iter().filter(|(pair, share)| pair.contains(&table) && *share > 0.0).count() > 1, "{links:?}");
    assert!(links.adjacent.contains(&[0, table]), "the base stands on it");
    assert_eq!(robot.tree.center_of_mass(&robot.tree.link_poses(&[0.0; 6])).unwrap().mass, 8.0);
    assert_eq!((problem.clearance, problem.stability.unwrap().margin), (0.01, 0.0));
}

/// The starter without bodies and scene.
fn bare_starter() -> String {
    let (from, to) = ("# What the robot is made of", "# The joint configurations to try");
    let (start, end) = (STARTER.find(from).unwrap(), STARTER.find(to).unwrap());
    let text = format!("{}{}", &STARTER[..start], &STARTER[end..]);
    text.lines().filter(|line| !line.starts_with("housing = ")).collect::<Vec<_>>().join("\n")
}

#[test]
fn bodies_masses_and_ground_in_metres_on_their_links() {
    let text = bare_starter().replace(
        "[sweep]",
        r#"
        [[robot.bodies]]
        link = "base"
        box_mm = [400, 300, 200]
        pose = { position_mm = [0, 0, 100] }
        [[robot.bodies]]
        link = "waist"
        capsule_mm = [60, 300]
        [camera.housing]
        sphere_mm = 30
        [[robot.masses]]
        link = "base"
        mass_kg = 10
        center_mm = [0, 0, 100]
        [[robot.masses]]
        link = "base"
        mass_kg = 30
        center_mm = [40, 0, 20]
        [collision]
        clearance_mm = 5
        ignore = [["camera", "board"]]
        [stability]
        support_mm = [[-200, -150], [200, -150], [200, 150], [0, 0], [-200, 150]]
        margin_mm = 20
        [sweep]
        "#,
    );
    let problem = load(&text.replace("[visibility]", "[visibility]\nmin_corners = 20"));
    let tree = &problem.robot.tree;
    let number = |name: &str| tree.links.iter().position(|link| link.name == name).unwrap();
    assert_eq!(tree.links[0].bodies[0].shape, Shape::Box { half_extents: Vector3::new(0.2, 0.15, 0.1) });
    assert_eq!(tree.links[number("waist")].bodies[0].shape, Shape::Capsule { radius: 0.06, length: 0.3 });
    let mass = tree.links[0].mass.unwrap();
    assert_eq!(mass.mass, 40.0);
    assert!((mass.center - Point3::new(0.03, 0.0, 0.04)).norm() < 1e-15);
    assert_eq!(tree.disabled, [[number("camera"), number("board")]]);
    assert_eq!((problem.clearance, problem.visibility.min_corners), (0.005, Some(20)));
    let stability = problem.stability.as_ref().unwrap();
    assert_eq!((stability.polygon().len(), stability.margin), (4, 0.02));
    // The housing is at the camera, the board's printed side in its plane.
    let q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
    let X_BL = tree.link_poses(&q);
    let camera = problem.robot.camera_pose(&q);
    assert!((X_BL[number("camera")].to_homogeneous() - camera.to_homogeneous()).norm() < 1e-12);
    let board = number("board");
    let body = &tree.links[board].bodies[0];
    assert_eq!(X_BL[board], problem.target.X_BT);
    let Shape::Box { half_extents } = body.shape else { panic!("{:?}", body.shape) };
    assert!((half_extents - Vector3::new(0.125, 0.0875, 0.0025)).norm() < 1e-15);
    assert_eq!(body.X_LG.translation.vector.z, -0.0025);
    // The camera is no neighbour of the waist: the arm between has no bodies, but five joints.
    let links = problem.checks().collision().links().clone();
    let pair = |a: &str, b: &str| [number(a), number(b)];
    assert_eq!(links.adjacent, [pair("base", "waist"), pair("base", "board")]);
    assert_eq!(links.disabled, [pair("camera", "board")]);
}

/// Not a validator: every key of the file must be a property of its object in the schema, every required key present.
fn assert_accepted(root: &Value, schema: &Value, value: &Value, path: &str) {
    let schema = match schema.get("$ref").and_then(Value::as_str) {
        Some(name) => root.pointer(name.trim_start_matches('#')).unwrap(),
        None => schema,
    };
    if let Some(reference) = schema.get("allOf").and_then(|all| all.get(0)) {
        return assert_accepted(root, reference, value, path);
    }
    if let Some(options) = schema.get("anyOf").and_then(Value::as_array) {
        let fits = |option: &&Value| option.get("$ref").is_some() || option["type"] == json_type(value);
        return assert_accepted(root, options.iter().find(fits).expect(path), value, path);
    }
    if let Some(names) = schema.get("enum").and_then(Value::as_array) {
        assert!(names.contains(value), "{path}: {value}");
    }
    match value {
        Value::Object(object) => {
            for required in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
                assert!(object.contains_key(required.as_str().unwrap()), "{path}: {required}");
            }
            for (key, value) in object {
                let path = format!("{path}.{key}");
                let below = schema.get("properties").and_then(|properties| properties.get(key));
                let below = below.or_else(|| schema.get("additionalProperties").filter(|more| more.is_object()));
                assert_accepted(root, below.expect(&path), value, &path);
            }
        }
        Value::Array(list) if schema.get("items").is_some() => {
            for entry in list {
                assert_accepted(root, &schema["items"], entry, path);
            }
        }
        _ => {}
    }
}

fn json_type(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

#[test]
fn the_schema_knows_every_key_of_the_files() {
    let schema = schema_json();
    let texts = shipped().into_iter().map(|path| std::fs::read_to_string(path).unwrap());
    for text in texts.chain([STARTER.to_owned()]) {
        let value: Value = toml::from_str(&text).unwrap();
        assert_accepted(&schema, &schema, &value, "");
    }
}

#[test]
fn the_schema_describes_every_key() {
    for (key, property) in properties(&schema_json()) {
        assert!(property.get("description").is_some(), "{key}");
    }
}

#[test]
fn the_reference_names_every_key() {
    let reference = std::fs::read_to_string("docs/src/problem-file.md").unwrap();
    for (key, property) in properties(&schema_json()) {
        let named =
            [format!("`{key}`"), format!("`{key} "), format!(" {key} "), format!(" {key}`"), format!("{key}]`")];
        assert!(named.iter().any(|name| reference.contains(name)), "{key}");
        for name in property.get("enum").and_then(Value::as_array).into_iter().flatten() {
            assert!(reference.contains(&format!("`{name}`")), "{key} = {name}");
        }
    }
}

fn properties(schema: &Value) -> Vec<(String, Value)> {
    let objects = schema["definitions"].as_object().unwrap().values().chain([schema]);
    let properties = objects.filter_map(|object| object["properties"].as_object());
    properties.flatten().map(|(key, property)| (key.clone(), property.clone())).collect()
}

#[test]
fn a_zone_of_exactly_the_board_holds_it_despite_binary_fractions() {
    let text = STARTER.replace("columns = 9", "columns = 2").replace("square_mm = 25", "square_mm = 0.1");
    load(&text.replace("[sweep]", "[target.zone]\nwidth_mm = 0.3\n[sweep]"));
}

#[test]
fn a_step_takes_the_place_of_a_sample() {
    let step = Overrides::new().set("sweep.step_deg=57.29577951308232").unwrap();
    let problem = Problem::parse_with(STARTER, Path::new("problem.toml"), &step).unwrap();
    assert_eq!(problem.space.len(), 3 * 2 * 3 * 4 * 2 * 7);
}
