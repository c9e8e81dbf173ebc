//! `calipose score` judges anyone's poses against what the problem could have had.

use serde_json::{Value, json};

use crate::desk::{Desk, text};

/// A desk with a plan of nine poses, and the plan.
fn planned() -> (Desk, Value) {
    let desk = Desk::new();
    let plan = desk.json("plan coarse.toml -k 9 --set selection.tour_tolerance=0 --trials 0 -o out --json");
    (desk, plan)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

fn near(a: &Value, b: &Value, tolerance: f64) {
    assert!((number(a) / number(b) - 1.0).abs() <= tolerance, "{a} {b}");
}

#[test]
fn a_plan_is_worth_what_it_says_in_every_format() {
    let (desk, plan) = planned();
    let formats = "joint-trajectory,robot-calibration,moveit-calibration,csv";
    let exported = desk.json(&format!("export out/plan.json --to {formats} --json"));
    let mut lists: Vec<(String, String)> =
        vec![("plan".into(), "out/plan.json".into()), ("csv".into(), "out/plan.csv".into())];
    for file in exported["files"].as_array().unwrap() {
        let name = |key: &str| file[key].as_str().unwrap().to_owned();
        lists.push((name("format"), format!("out/export/{}", name("file"))));
    }
    assert_eq!(lists.len(), 6);
    for (format, file) in lists {
        let score = desk.json(&format!("score {file} --problem coarse.toml --json"));
        assert_eq!(score["read_as"], format.as_str(), "{file}");
        assert_eq!((&score["listed"], &score["count"]), (&json!(9), &json!(9)), "{file}");
        near(&score["set"]["map_error_px"], &plan["map_error_px"], 1e-9);
        near(&score["set"]["value"], &plan["value"], 1e-9);
        near(&score["efficiency"], &plan["efficiency"], 1e-6);
        near(&score["best"]["bound"], &plan["bound"], 1e-6);
        for (name, sigma) in
            plan["intrinsics"]["names"].as_array().unwrap().iter().zip(plan["intrinsics"]["sigma"].as_array().unwrap())
        {
            near(&score["set"]["sigma"][name.as_str().unwrap()], sigma, 1e-9);
        }
        assert_eq!((&score["swaps"], &score["equal_best_count"]), (&json!([]), &json!(9)), "{file}");
    }
}

#[test]
fn losses_and_swaps_are_those_of_the_lists_that_they_make() {
    let (desk, plan) = planned();
    // Poses that were not chosen together: the plan's, one of them a degree off, and one twice.
    let names: Vec<String> = serde_json::from_value(plan["joints"].clone()).unwrap();
    let mut rows: Vec<Vec<f64>> = plan["poses"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pose| serde_json::from_value(pose["joints_deg"].clone()).unwrap())
        .collect();
    rows[2][0] += 1.0;
    let again = rows[4].clone();
    rows.push(again);
    let write = |name: &str, rows: &[Vec<f64>]| {
        let header: Vec<String> = names.iter().map(|name| format!("{name}_deg")).collect();
        let lines = rows.iter().map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        let table: Vec<String> = std::iter::once(header.join(",")).chain(lines).collect();
        std::fs::write(desk.path(name), table.join("\n") + "\n").unwrap();
        desk.json(&format!("score {name} --problem coarse.toml --json"))
    };
    let score = write("all.csv", &rows);
    assert_eq!(score["count"], 10);
    assert_eq!(score["poses"][9]["excluded"], "repeated");
    let (value, efficiency) = (number(&score["set"]["value"]), number(&score["efficiency"]));
    assert!(efficiency < number(&score["best"]["efficiency"]) && efficiency > 0.5, "{efficiency}");
    assert_eq!(score["equal_best_count"], 10);

    // Without the third.
    let mut fewer = rows.clone();
    fewer.remove(2);
    let without = write("fewer.csv", &fewer);
    near(&score["poses"][2]["map_error_without_px"], &without["set"]["map_error_px"], 1e-9);
    let loss = 1.0 - value / number(&without["set"]["value"]);
    assert!((number(&score["poses"][2]["loss"]) - loss).abs() < 1e-9);

    // Each swap done.
    let degrees = |swap: &Value| -> Vec<f64> { serde_json::from_value(swap["joints_deg"].clone()).unwrap() };
    let place = |swap: &Value| swap["out"].as_str().unwrap().parse::<usize>().unwrap() - 1;
    let swaps = score["swaps"].as_array().unwrap();
    let gains: Vec<f64> = swaps.iter().map(|swap| number(&swap["gain"])).collect();
    assert!(gains.is_sorted_by(|a, b| a >= b) && gains.iter().all(|&gain| gain > 0.0), "{gains:?}");
    let mut swapped = rows.clone();
    swapped[place(&swaps[0])] = degrees(&swaps[0]);
    near(&swaps[0]["map_error_px"], &write("swapped.csv", &swapped)["set"]["map_error_px"], 1e-9);
    let exchange = score["exchange"].as_array().unwrap();
    assert_eq!(exchange[0], swaps[0]);
    for swap in &exchange[1..] {
        swapped[place(swap)] = degrees(swap);
    }
    let after = write("exchanged.csv", &swapped);
    let last = exchange.last().unwrap();
    near(&last["map_error_px"], &after["set"]["map_error_px"], 1e-9);
    near(&last["value"], &after["set"]["value"], 1e-9);
    assert!(number(&last["gain"]) > gains[0] || exchange.len() == 1);
}

#[test]
fn what_cannot_be_used_is_told_with_its_reason() {
    let (desk, plan) = planned();
    let mut poses = String::new();
    for pose in plan["poses"].as_array().unwrap() {
        poses += &format!("- {{joints: [waist, shoulder, elbow, neck], positions: {}}}\n", pose["joints_rad"]);
    }
    // Beyond a limit; looking away; a corner outside.
    poses += "- {joints: [neck, elbow, shoulder, waist], positions: [0.5, 0.7, 0.3, 0.1]}\n";
    poses += "- {joints: [waist, shoulder, elbow, neck], positions: [2.0, 1.0, -0.5, 3.0]}\n";
    std::fs::write(desk.path("poses.yaml"), poses).unwrap();
    let output = desk.stdout("score poses.yaml --problem coarse.toml");
    let prose = output.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(prose.contains("poses.yaml read as robot-calibration, 11 poses, 9 of which can be used."), "{output}");
    assert!(prose.contains("- 10: joint limit: elbow is at 40.107°; its limits are -216.9° and 0°"), "{output}");
    assert!(prose.contains("- 11: "), "{output}");
    insta::assert_snapshot!("score", output);

    // Of a pinhole camera one view leaves a focal length open that distances make up for.
    let few: String = std::fs::read_to_string(desk.path("poses.yaml")).unwrap().lines().take(1).collect();
    std::fs::write(desk.path("few.yaml"), few).unwrap();
    let lens = "[camera.distortion]\nmodel = \"brown-conrady\"\nk1 = -0.2\nk2 = 0.05\n";
    desk.change("pinhole.toml", &[(lens, ""), (", \"k1\", \"k2\", \"p1\", \"p2\", \"k3\"", "")]);
    let said = desk.bad("score few.yaml --problem pinhole.toml");
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("This pose leaves a combination of the intrinsics open: "), "{said}");
    assert!(said.contains("No best pose to hold it against: "), "{said}");
    std::fs::write(desk.path("none.csv"), "waist_deg,shoulder_deg,elbow_deg,neck_deg\n0,0,90,0\n").unwrap();
    let said = desk.bad("score none.csv --problem coarse.toml");
    assert!(said.contains("1 pose, none of which can be used"), "{said}");
}

#[test]
fn detections_are_scored_by_the_corners_that_they_have() {
    let desk = Desk::new();
    let corners = std::path::Path::new("problems/examples/servosila-corners.vnl").canonicalize().unwrap();
    let score = desk.json(&format!("score {} --problem coarse.toml --json", corners.display()));
    assert_eq!((&score["read_as"], &score["count"]), (&json!("detections"), &json!(10)));
    assert!(
        score["poses"]
            .as_array()
            .unwrap()
            .iter()
            .all(|pose| pose["joints_rad"].is_null() && pose["excluded"] == "taken")
    );
    // The corners are those of ten good poses of a finer grid, which scatter a little.
    let map_error = number(&score["set"]["map_error_px"]);
    assert!(map_error > 1.4 && map_error < 2.2, "{map_error}");
    assert!(number(&score["efficiency"]) > 0.7, "{}", score["efficiency"]);
    let calibrated = desk.json(&format!("calibrate {} --problem coarse.toml -o camera --json", corners.display()));
    assert!(calibrated["map_error_px"].is_number() || calibrated.is_object());
}

#[test]
fn transforms_of_the_flange_are_taken_by_inverse_kinematics() {
    let (desk, plan) = planned();
    let problem = calipose::problem::Problem::read(&desk.path("coarse.toml")).unwrap();
    let mut samples = "parameters: {calibration_type: eye_in_hand}\nsamples:\n".to_owned();
    let mut add = |X_BF: calipose::spatial::Pose| {
        let (t, r) = (X_BF.translation.vector, X_BF.rotation.coords);
        samples += &format!(
            "- robot:\n    translation: {{x: {}, y: {}, z: {}}}\n    rotation: {{x: {}, y: {}, z: {}, w: {}}}\n",
            t.x, t.y, t.z, r.x, r.y, r.z, r.w
        );
    };
    for pose in plan["poses"].as_array().unwrap() {
        let q: Vec<f64> = serde_json::from_value(pose["joints_rad"].clone()).unwrap();
        add(problem.robot.chain.flange_pose(&q));
    }
    add(calipose::spatial::Pose::translation(0.0, 0.0, 9.0));
    std::fs::write(desk.path("a.samples"), samples).unwrap();
    let score = desk.json("score a.samples --problem coarse.toml --json");
    assert_eq!(
        (&score["read_as"], &score["listed"], &score["count"]),
        (&json!("easy-handeye2"), &json!(10), &json!(9))
    );
    assert_eq!(score["poses"][9]["reason"], "unreached");
    near(&score["set"]["map_error_px"], &plan["map_error_px"], 1e-5);
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let desk = Desk::new();
    let mut complaints = String::new();
    let mut refuse = |name: &str, content: &str, options: &str| {
        std::fs::write(desk.path(name), content).unwrap();
        let output = desk.run(&format!("score {name} --problem coarse.toml {options}"));
        let code = output.status.code().unwrap();
        complaints += &format!("== {name} {options}: exit code {code}\n{}\n", text(&output.stderr).trim_end());
        assert_eq!(text(&output.stdout), "");
    };
    refuse("unknown.yaml", "- joints: [waist, shoulder, elbow, wrist]\n  positions: [0, 0, 0, 0]\n", "");
    refuse("missing.yaml", "- joints: [waist, shoulder]\n  positions: [0, 0]\n", "");
    refuse("short.yaml", "joint_names: [waist, shoulder, elbow, neck]\njoint_values:\n- [0, 0, 0]\n", "");
    refuse("nan.yaml", "joint_names: [waist, shoulder, elbow, neck]\npoints:\n- positions: [0, .nan, 0, 0]\n", "");
    refuse("unit.csv", "waist,shoulder,elbow,neck\n1,2,3,4\n", "");
    refuse("cells.csv", "waist_deg,shoulder_deg,elbow_deg,neck_deg\n1,2,3\n", "");
    refuse("other.yaml", "a: 1\n", "");
    refuse("other.json", "{\"format\": \"calipose.comparison\", \"version\": 2, \"calipose\": \"0.1.0\"}", "");
    refuse("old.json", "{\"format\": \"calipose.plan\", \"version\": 1, \"calipose\": \"0.1.0\"}", "");
    refuse("beside.samples", "parameters: {calibration_type: eye_on_base}\nsamples: [{robot: {}}]\n", "");
    refuse("a.yaml", "- {joints: [], positions: []}\n", "--format csv");
    refuse("b.yaml", "- {joints: [], positions: []}\n", "--images '*'");
    refuse("a.vnl", "# filename x y level\na.png 1 2 0\n", "");
    insta::assert_snapshot!("score_refused", complaints);
    let complaint = desk.complaint("score none.yaml --problem coarse.toml", 3);
    assert!(complaint.contains("none.yaml: cannot be read: there is no such file"), "{complaint}");
    assert!(desk.complaint("score a.yaml", 2).contains("--problem"));
    let failure = desk.run("score unknown.yaml --problem coarse.toml --json");
    let failure: Value = serde_json::from_slice(&failure.stderr).unwrap();
    assert_eq!((&failure["kind"], &failure["faults"][0]["line"]), (&json!("pose-list"), &json!(1)));
}
