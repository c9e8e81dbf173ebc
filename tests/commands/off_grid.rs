//! Plans whose poses leave the grid, from the command line.

use serde_json::Value;

use crate::desk::Desk;

const FREE: &str = "--set selection.off_grid=true";

#[test]
fn a_plan_that_leaves_the_grid_goes_through_every_command() {
    let desk = Desk::new();
    let number = |plan: &Value, key: &str| plan[key].as_f64().unwrap();
    let swept = desk.json("plan coarse.toml --trials 0 -o swept --json");
    let free = desk.json(&format!("plan coarse.toml --trials 0 -o free {FREE} --json"));
    assert!(number(&free, "map_error_px") < 0.9 * number(&swept, "map_error_px"));
    let found = free["off_grid"].as_array().unwrap().len();
    assert_eq!(free["survey"]["off_grid"], found);
    assert!(found >= 8 && swept.get("off_grid").is_none());
    assert!(desk.prose("certify free/plan.json").contains("the certificate holds"));
    for command in ["explain", "report", "polish", "verify --trials 20", "figures --format svg", "render"] {
        let (command, options) = command.split_once(' ').unwrap_or((command, ""));
        desk.stdout(&format!("{command} free/plan.json {options}"));
    }
    let again = desk.json(&format!("plan coarse.toml --trials 0 -o again {FREE} --json"));
    assert_eq!(free, again);
}

#[test]
fn a_view_off_the_grid_that_is_none_is_named() {
    let desk = Desk::new();
    desk.stdout(&format!("plan coarse.toml --trials 0 -q -o free {FREE}"));
    let path = desk.path("free/plan.json");
    let mut plan: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    plan["off_grid"][1][0] = 0.123_456.into();
    std::fs::write(desk.path("changed.json"), plan.to_string()).unwrap();
    let complaint = desk.complaint("certify changed.json --problem coarse.toml", 3);
    let complaint = complaint.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(complaint.contains("number 2 of the views off the grid that it was made from is none"), "{complaint}");
}

#[test]
fn compare_has_the_best_poses_on_the_grid_and_off_it() {
    let desk = Desk::new();
    let compared = desk.json(&format!("compare coarse.toml -k 8 --seeds 1 --trials 2 --limit 20 {FREE} --json"));
    let rows = compared["rows"].as_array().unwrap();
    let row = |method: &str| rows.iter().find(|row| row["method"] == method).unwrap()["map_error_px"].as_f64().unwrap();
    assert!(row("best-off-grid") < 0.9 * row("best"));
    let compared = desk.json("compare coarse.toml -k 8 --seeds 1 --trials 2 --limit 20 --json");
    assert!(compared["rows"].as_array().unwrap().iter().all(|row| row["method"] != "best-off-grid"));
}

#[test]
fn margins_and_steps_that_leave_no_joint_value_are_refused() {
    let desk = Desk::new();
    for (value, said) in [
        ("robot.limit_margin_deg=64", "from 0 to 63.99"),
        ("robot.limit_margin_deg=-1", "from 0 to 63.99"),
        ("robot.joint_resolution_deg=16", "from 0 to 15"),
        ("robot.joint_resolution_mm=1", "prismatic"),
        ("selection.continuum_tolerance=0", "from 1e-6 to 10"),
    ] {
        let complaint = desk.complaint(&format!("plan coarse.toml --set {value}"), 3);
        let complaint = complaint.split_whitespace().collect::<Vec<_>>().join(" ");
        let key = value.split(['.', '=']).nth(1).unwrap();
        assert!(complaint.contains(key) && complaint.contains(said), "{complaint}");
    }
}
