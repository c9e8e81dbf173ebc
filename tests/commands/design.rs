//! The design of a set-up: better than what was given, as it says, and the same on any number of threads.

use serde_json::Value;

use crate::desk::Desk;

const DESIGN: &str = r#"
name = "Small"
problem = "coarse.toml"
set = ["sweep.step_deg=15", "visibility.min_distance_mm=250", "target.zone={}", "selection.count=8"]

[[free]]
key = "camera.roll_deg"
range = { from = 0, to = 135, step = 45 }

[[free]]
key = "target.pose.position_mm[0]"
uniform = [100, 300]
round_to = 10

[[free]]
key = "target.pose.position_mm[1]"
uniform = [-100, 100]
round_to = 10

[surface]
x_mm = [-50, 450]
y_mm = [-200, 200]

[search]
screened = 16
finalists = 4
rounds = 2
map = 3
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    std::fs::write(desk.path("design.toml"), DESIGN).unwrap();
    desk
}

#[test]
fn the_kind_of_the_target_may_be_free() {
    let desk = desk();
    let charuco = |dictionary: &str| {
        let keys = ["kind=charuco", "columns=9", "rows=7", "square_mm=35", "marker_mm=26"];
        let keys: Vec<String> = keys.iter().map(|key| format!("target.{key}")).collect();
        format!(
            "{{ name = \"{dictionary}\", set = {:?} }}",
            [keys, vec![format!("target.dictionary={dictionary}")]].concat()
        )
    };
    let levels = ["DICT_4X4_50", "DICT_7X7_50"].map(charuco).join(", ");
    let free = "[[free]]\nkey = \"camera.roll_deg\"\nrange = { from = 0, to = 135, step = 45 }";
    assert!(DESIGN.contains(free));
    let design = DESIGN.replace(free, &format!("[[free]]\nname = \"board\"\nlevels = [{levels}]"));
    std::fs::write(desk.path("kinds.toml"), design).unwrap();
    desk.stdout("design kinds.toml -o kinds --quiet");
    let found: Value = serde_json::from_slice(&std::fs::read(desk.path("kinds/design.json")).unwrap()).unwrap();
    let text = std::fs::read_to_string(desk.path("kinds/best.toml")).unwrap();
    let dictionary = found["best"]["values"][0]["value"].as_str().unwrap();
    let line = format!("dictionary = \"{dictionary}\"");
    assert!(dictionary.starts_with("DICT_") && text.contains("kind = \"charuco\"") && text.contains(&line), "{text}");
    let plan = desk.json("plan kinds/best.toml --set selection.tour_tolerance=0 --trials 0 -o plan --json");
    assert_eq!(plan["map_error_px"], found["best"]["map_error_px"]);
}

#[test]
fn the_best_set_up_is_what_it_is_said_to_be() {
    let desk = desk();
    let told = desk.prose("design design.toml -o out");
    assert!(told.contains("times smaller than the file's own set-up"), "{told}");
    let found: Value = serde_json::from_slice(&std::fs::read(desk.path("out/design.json")).unwrap()).unwrap();
    let map_error = |set_up: &Value| set_up["map_error_px"].as_f64().unwrap();
    assert!(map_error(&found["best"]) < map_error(&found["as_given"]));
    assert_eq!(found["best"], found["ranking"][0]);
    // Its problem file has its comments, and gives the same plan.
    let text = std::fs::read_to_string(desk.path("out/best.toml")).unwrap();
    assert!(text.contains("# The finest of the paper's grids") && text.contains("roll_deg = "), "{text}");
    let plan = desk.json("plan out/best.toml --trials 0 -o plan --json");
    assert_eq!(plan["map_error_px"], found["best"]["map_error_px"]);
    assert_eq!(plan["problem"].get("set"), None, "everything is in the file");
    let nearest = plan["poses"].as_array().unwrap().iter().map(|pose| pose["distance_m"].as_f64().unwrap());
    let nearest = 1e3 * nearest.fold(f64::INFINITY, f64::min);
    assert!((nearest - found["best"]["nearest_mm"].as_f64().unwrap()).abs() < 1e-6 && nearest >= 250.0);
    // No plan for any set-up examined is better than the bound; those of the ranking are not.
    let bound = found["proof"]["map_error_bound_px"].as_f64().unwrap();
    let ranking = found["ranking"].as_array().unwrap();
    assert!(ranking.iter().all(|set_up| map_error(set_up) >= bound));
    assert!(ranking.is_sorted_by(|a, b| map_error(a) <= map_error(b)));
    // As an independent run has it: the best set-up moved, by hand.
    let moved = &found["sensitivity"][1]["points"][0];
    let plan = desk.json(&format!(
        "plan out/best.toml --set target.pose.position_mm[0]={} --trials 0 -o moved --json",
        moved["number"]
    ));
    assert_eq!(plan["map_error_px"], moved["map_error_px"]);
    assert_eq!(found["map"]["map_error_px"].as_array().unwrap().len(), 3);
    assert!(desk.path("out/figures/map.svg").exists() && desk.path("out/report.html").exists());
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn what_is_discarded_is_worse_and_threads_do_not_matter() {
    let desk = desk();
    desk.stdout("design design.toml -o one --threads 1 --quiet");
    desk.stdout("design design.toml -o three --threads 3 --quiet");
    for file in ["design.json", "ranking.csv", "best.toml", "report.html"] {
        let read = |folder: &str| std::fs::read(desk.path(folder).join(file)).unwrap();
        assert!(read("one") == read("three"), "{file}");
    }
    let found: Value = serde_json::from_slice(&std::fs::read(desk.path("one/design.json")).unwrap()).unwrap();
    assert!(found["proof"]["proven_worse"].as_u64().unwrap() > 0);
}

#[test]
fn what_is_wrong_with_a_design_is_told_under_its_line() {
    let desk = desk();
    let wrong = |from: &str, to: &str, code: i32| {
        assert!(DESIGN.contains(from), "{from}");
        std::fs::write(desk.path("wrong.toml"), DESIGN.replace(from, to)).unwrap();
        desk.complaint("design wrong.toml -o out", code)
    };
    let cases = [
        ("camera.roll_deg", "camera.roll", "there is no key `camera.roll`", "did you mean `roll_deg`"),
        ("uniform = [100, 300]", "uniform = [300, 100]", "runs from 300 down to 100", "[min, max]"),
        ("x_mm = [-50, 450]", "x_mm = [450, -50]", "`surface.x_mm` runs from 450 down to -50", "[min, max]"),
        ("selection.count=8", "selection.accuracy={map_error_px=2}", "asks for accuracies", "selection.count=10"),
        (
            "selection.count=8",
            "selection.criterion=diversity",
            "cannot be compared by the criterion",
            "selection.criterion=v",
        ),
        ("camera.roll_deg", "selection.count", "does not apply to the design of a set-up", "calipose study"),
        (
            "key = \"camera.roll_deg\"\nrange = { from = 0, to = 135, step = 45 }",
            "name = \"few\"\nlevels = [{ name = \"five\", set = [\"selection={count=5}\"] }]",
            "does not apply to the design of a set-up",
            "calipose study",
        ),
        ("screened = 16", "screened = 0", "`search.screened` is 0", "from 1 to"),
        ("problem = \"coarse.toml\"", "problem = \"none.toml\"", "No such file", "relative to the folder"),
    ];
    for (from, to, what, hint) in cases {
        let told = wrong(from, to, 3);
        assert!(told.contains(what) && told.contains(hint), "{to}: {told}");
    }
    let told = wrong("x_mm = [-50, 450]", "x_mm = [-50, 0]", 1);
    assert!(told.contains("does not fit the surface"), "{told}");
    assert!(!desk.path("out").exists());
    desk.stdout("design design.toml -o out --quiet");
    let other = wrong("\"Small\"", "\"Other\"", 1);
    assert!(other.contains("is of the design \"Small\""), "{other}");
    // Without a least distance the camera's focus is spoken of.
    std::fs::write(desk.path("near.toml"), DESIGN.replace("\"visibility.min_distance_mm=250\", ", "")).unwrap();
    let output = desk.run("design near.toml -o near");
    assert!(crate::desk::text(&output.stderr).contains("nearer than the camera can focus"));
}
