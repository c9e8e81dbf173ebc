//! `calipose explain` and `calipose polish` answer in text and JSON, and refuse what is no plan of the problem.

use calipose::plan::document::{Document, Explanation, Plan, PolishedPlan};
use tempfile::TempDir;

use crate::desk::{complaint, stdout};

/// A folder with a coarse Servosila problem, some of its text replaced, and a plan of it in `out`.
fn desk(replacements: &[(&str, &str)], options: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut text = std::fs::read_to_string("problems/servosila-engineer.toml").unwrap();
    let coarse = [("step_deg = 8\naxis", "step_deg = 20\naxis"), ("[selection]", "[selection]\noff_grid = false")];
    for (from, to) in coarse.iter().chain(replacements) {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(folder.path().join("problem.toml"), text).unwrap();
    stdout(folder.path(), &format!("plan problem.toml --trials 0 -q -o out{options}"));
    folder
}

fn read_plan(folder: &TempDir) -> Plan {
    Plan::from_json(&std::fs::read_to_string(folder.path().join("out/plan.json")).unwrap()).unwrap()
}

#[test]
fn explain_tells_of_the_plan_that_was_written() {
    // Not by the file's criterion, but by the one it was made with.
    let desk = desk(&[], " --criterion d -k 9");
    let plan = read_plan(&desk);
    let told = stdout(desk.path(), "explain out/plan.json --most 11 --spares 2");
    for words in ["criterion `d`", "bound", "most affected", "take each pose's place", "The least known combination is"]
    {
        assert!(told.contains(words), "{words:?} is missing from\n{told}");
    }
    let line = "explain out/plan.json --most 11 --spares 2 --json";
    let printed = stdout(desk.path(), line);
    assert_eq!(printed, stdout(desk.path(), line));
    let explained: Explanation = serde_json::from_str(&printed).unwrap();
    assert_eq!((explained.header.format.as_str(), explained.header.version), ("calipose.explanation", 1));
    assert_eq!((explained.criterion, explained.count), (plan.criterion, 9));
    assert!((explained.value - plan.value).abs() < 1e-9);
    assert!((explained.map_error_px.unwrap() - plan.map_error_px).abs() < 1e-9);
    assert_eq!(explained.curve.len(), 11);
    let ids = |ids: &mut dyn Iterator<Item = usize>| ids.collect::<Vec<_>>();
    assert_eq!(ids(&mut explained.poses.iter().map(|pose| pose.id)), ids(&mut plan.poses.iter().map(|pose| pose.id)));
    for pose in &explained.poses {
        assert_eq!(pose.spares.len(), 2);
        assert!(pose.loss > pose.spares[0].loss && pose.spares[0].loss <= pose.spares[1].loss);
    }
    let twice: Explanation =
        serde_json::from_str(&stdout(desk.path(), "explain out/plan.json --spares 0 --json")).unwrap();
    assert_eq!(twice.curve.len(), 18);
    assert!(twice.poses.iter().all(|pose| pose.spares.is_empty()));
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn explain_and_polish_know_combinations_accuracies_and_constraints() {
    const GOAL: &str = "criterion = \"v\"\nmethod = \"best\"\ncount = 10";
    for criterion in [
        "criterion = { v = 0.8, diversity = 0.2 }",
        "accuracy = { map_error_px = 4.0, fx = 6.0 }",
        &format!("{GOAL}\n[constraints]\nview_separation_deg = 5"),
    ] {
        let desk = desk(&[(GOAL, criterion)], "");
        let plan = read_plan(&desk);
        let explained: Explanation =
            serde_json::from_str(&stdout(desk.path(), "explain out/plan.json --json")).unwrap();
        assert_eq!(explained.criterion, plan.criterion);
        assert!((explained.value / plan.value - 1.0).abs() < 1e-9, "{criterion}");
        let polished: PolishedPlan =
            serde_json::from_str(&stdout(desk.path(), "polish out/plan.json --cycles 1 --json")).unwrap();
        assert_eq!(polished.criterion, plan.criterion);
        assert!(polished.gain > 0.0, "{criterion}");
    }
}

#[test]
fn polish_writes_better_poses_beside_the_plan() {
    let desk = desk(&[], "");
    let plan = read_plan(&desk);
    let before = std::fs::read(desk.path().join("out/plan.json")).unwrap();
    let told = stdout(desk.path(), "polish out/plan.json --cycles 2");
    for words in ["more information", "on the grid", "off the grid nothing is proven", "polished.json, polished.csv"] {
        assert!(told.contains(words), "{words:?} is missing from\n{told}");
    }
    let written = std::fs::read_to_string(desk.path().join("out/polished.json")).unwrap();
    assert_eq!(stdout(desk.path(), "polish out/plan.json --cycles 2 --json"), written);
    let polished: PolishedPlan = serde_json::from_str(&written).unwrap();
    assert_eq!((polished.header.format.as_str(), polished.header.version), ("calipose.polished", 2));
    assert_eq!(polished.grid.certificate, plan.certificate.grid);
    assert_eq!((polished.grid.value, polished.grid.bound), (plan.value, plan.bound));
    // A variance.
    assert!(polished.value < plan.value && polished.map_error_px < plan.map_error_px);
    assert!((polished.gain - (plan.value / polished.value - 1.0)).abs() < 1e-9);
    assert!((polished.efficiency_by_grid_bound - plan.bound / polished.value).abs() < 1e-9);
    for (pose, grid) in polished.poses.iter().zip(&plan.poses) {
        assert_eq!(pose.id, grid.id);
    }
    assert_ne!(polished.poses[0].joints_rad, plan.poses[0].joints_rad);
    let tour = polished.tour.as_ref().unwrap();
    assert!(tour.moving_s > 0.0 && tour.moving_s <= tour.moving_by_id_s && tour.trade.is_none());
    let in_order = polished.in_order();
    assert!(in_order.len() == 10 && in_order.iter().map(|pose| pose.id).eq(tour.order.iter().copied()));
    assert!(told.contains("In this order the moves take"), "{told}");
    stdout(desk.path(), "export out/polished.json --to csv -o out/polished");
    let exported = std::fs::read_dir(desk.path().join("out/polished")).unwrap().next().unwrap().unwrap().path();
    let exported = std::fs::read_to_string(exported).unwrap();
    let table = std::fs::read_to_string(desk.path().join("out/polished.csv")).unwrap();
    let first = format!("{},{}", in_order[0].id, in_order[0].joints_rad[0]);
    assert!(exported.contains(&in_order[9].joints_rad[0].to_string()), "{exported}");
    assert!(table.lines().count() == 11 && table.lines().nth(1).unwrap().starts_with(&first), "{table}");
    assert_eq!(before, std::fs::read(desk.path().join("out/plan.json")).unwrap());
    // The same plan made again keeps what was polished of it; another takes it away, and says so.
    let again = stdout(desk.path(), &format!("plan problem.toml --trials 0 -k {} -o out", plan.count));
    assert!(!again.contains("Removed") && desk.path().join("out/polished.csv").exists(), "{again}");
    stdout(desk.path(), "polish out/plan.json --cycles 1 -q");
    let other = stdout(desk.path(), "plan problem.toml --trials 0 -k 9 -o out");
    let other = other.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(other.contains("Removed, because made from the previous plan: polished.json, polished.csv."), "{other}");
    assert!(!desk.path().join("out/polished.json").exists() && !desk.path().join("out/polished.csv").exists());
}

#[test]
fn what_is_no_plan_of_the_problem_is_refused() {
    let desk = desk(&[], "");
    assert!(complaint(desk.path(), "explain out/plan.json --most 0", 2).contains("--most"));
    assert!(complaint(desk.path(), "explain out/plan.json --spares 1001", 2).contains("--spares"));
    assert!(complaint(desk.path(), "polish out/plan.json --cycles 0", 2).contains("--cycles"));
    // Alone, a plan is judged by itself.
    let path = desk.path().join("alone/plan.json");
    std::fs::create_dir(desk.path().join("alone")).unwrap();
    let text = std::fs::read_to_string(desk.path().join("out/plan.json")).unwrap();
    let change = |change: &dyn Fn(&mut Plan)| {
        let mut plan = Plan::from_json(&text).unwrap();
        change(&mut plan);
        std::fs::write(&path, plan.to_json()).unwrap();
    };
    for command in ["explain", "polish"] {
        let plan = format!("{command} alone/plan.json --problem problem.toml");
        assert!(complaint(desk.path(), &format!("{command} out/missing.json"), 3).contains("missing.json"));
        assert!(complaint(desk.path(), &format!("{command} out/run.json"), 3).contains("calipose.run"));
        assert!(complaint(desk.path(), &format!("{command} problem.toml"), 3).contains("not a plan"));
        assert!(
            complaint(desk.path(), &format!("{command} out/plan.json --problem missing.toml"), 3)
                .contains("missing.toml")
        );
        change(&|plan| plan.poses[0].id += 1_000_000);
        assert!(complaint(desk.path(), &plan, 3).contains("is not among the"));
        change(&|plan| plan.poses[0].joints_rad[1] += 1e-3);
        assert!(complaint(desk.path(), &plan, 3).contains("lead to another camera pose"));
        change(&|plan| plan.poses[0] = plan.poses[1].clone());
        assert!(complaint(desk.path(), &plan, 3).contains("occurs twice"));
        change(&|plan| plan.certificate.grid.terms[0].criterion = "best".into());
        assert!(
            complaint(desk.path(), &plan, 3).contains("its certificate is for \"1 best\"; the problem asks for \"v\"")
        );
        change(&|plan| plan.poses.truncate(0));
        assert!(complaint(desk.path(), &plan, 3).contains("joint values"));
    }
    assert!(!desk.path().join("out/polished.json").exists());
}
