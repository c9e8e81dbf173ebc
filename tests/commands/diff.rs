//! `calipose diff` shows what differs between two plans.

use std::fs;

use serde_json::{Value, json};

use crate::desk::Desk;

#[test]
fn plans_are_held_against_each_other() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 -o a");
    desk.stdout("plan coarse.toml -q -k 9 --trials 0 -o b");
    // A plan is itself, by its file and by its folder.
    let same = desk.json("diff a a/plan.json --json");
    assert_eq!((&same["same_problem"], &same["comparable"]), (&json!(true), &json!(true)));
    assert_eq!(same["same"].as_array().unwrap().len(), 8);
    assert_eq!([&same["moved"], &same["only_a"], &same["only_b"]], [&json!([]); 3]);

    let diff = desk.json("diff a b --json");
    let (a, b) = (read(&desk, "a"), read(&desk, "b"));
    for (side, plan) in [("a", &a), ("b", &b)] {
        for key in ["criterion", "method", "count", "value", "bound", "efficiency", "map_error_px"] {
            assert_eq!(diff[side][key], plan[key], "{key}");
        }
        assert_eq!(diff[side]["total_s"], plan["tour"]["total_s"]);
    }
    assert_eq!(
        diff["sigma"][0],
        json!({"name": "fx", "a": a["intrinsics"]["sigma"][0], "b": b["intrinsics"]["sigma"][0]})
    );
    let count = |key: &str| diff[key].as_array().unwrap().len();
    assert_eq!(
        [count("same") + count("moved") + count("only_a"), count("same") + count("moved") + count("only_b")],
        [8, 9]
    );
    let ids =
        |plan: &Value| plan["poses"].as_array().unwrap().iter().map(|pose| pose["id"].clone()).collect::<Vec<_>>();
    let both = ids(&a).iter().filter(|id| ids(&b).contains(id)).count();
    assert_eq!(count("same"), both, "on one grid poses are the same by their ids");

    let said = desk.stdout("diff a b");
    insta::assert_snapshot!("diff", said);
}

#[test]
fn other_problems_and_other_criteria_are_told() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 -o a");
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 --criterion d -o d");
    desk.change(
        "noisy.toml",
        &[("sigma_px = 0.3", "sigma_px = 0.4"), ("name = \"Servosila Engineer\"", "name = \"Noisy\"")],
    );
    desk.stdout("plan noisy.toml -q -k 8 --trials 0 -o noisy");
    let said = desk.prose("diff a d");
    assert!(said.contains("chosen by different criteria"), "{said}");
    let said = desk.prose("diff a noisy");
    assert!(said.contains("The plans answer different problems: their values may not compare."), "{said}");
    let other = desk.json("diff a noisy --json");
    assert_eq!((&other["same_problem"], &other["comparable"]), (&json!(false), &json!(false)));
}

#[test]
fn what_differs_has_a_page() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 -o a");
    desk.stdout("plan coarse.toml -q -k 9 --trials 0 -o b");
    let said = desk.stdout("diff a b --output diff.html");
    assert!(said.ends_with("Written to diff.html.\n"), "{said}");
    let page = fs::read_to_string(desk.path("diff.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("difference of two plans"));
    for section in ["numbers", "intrinsics", "same"] {
        assert!(page.contains(&format!("section id=\"{section}\"")), "{section}");
    }
    assert!(!page.contains(">NaN<"));
    // The document gives the same page.
    fs::write(desk.path("other.json"), desk.stdout("diff a b --json")).unwrap();
    desk.stdout("report other.json");
    assert!(page == fs::read_to_string(desk.path("other.html")).unwrap());
}

#[test]
fn what_is_no_plan_is_refused() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml -q -k 8 --trials 0 -o a");
    assert!(desk.complaint("diff a none", 3).contains("cannot use the plan none"));
    fs::create_dir(desk.path("empty")).unwrap();
    assert!(desk.complaint("diff a empty", 3).contains("cannot use the plan empty/plan.json"));
    assert!(desk.complaint("diff a coarse.toml", 3).contains("not a plan"));
    assert!(desk.complaint("diff a a -o page.pdf", 2).contains("--output is page.pdf; it must end in .html"));
    fs::write(desk.path("mine.html"), "my page").unwrap();
    assert!(desk.complaint("diff a a -o mine.html", 1).contains("mine.html exists already"));
    // Another robot's.
    let mut plan = read(&desk, "a");
    plan["joints"][3] = "wrist".into();
    fs::write(desk.path("other.json"), plan.to_string()).unwrap();
    let complaint = desk.complaint("diff a other.json", 3);
    assert!(complaint.contains("those of B are waist, shoulder, elbow, wrist"), "{complaint}");
    plan["joints"][3] = "neck".into();
    plan["poses"][2]["joints_rad"] = json!([0.0]);
    fs::write(desk.path("short.json"), plan.to_string()).unwrap();
    assert!(desk.complaint("diff a short.json", 3).contains("has 1 joint values; there are 4 joints"));
}

fn read(desk: &Desk, folder: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(desk.path(folder).join("plan.json")).unwrap()).unwrap()
}
