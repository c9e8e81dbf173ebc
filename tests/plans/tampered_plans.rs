//! `certify` notices whatever is changed in a plan, or says that it does not check it, and takes no honest plan for a changed one.
//!
//! What this does not prove: that two changes made to fit each other are noticed. The bound and the value are computed anew
//! from the poses and the matrix alone, whatever else the plan says.

use std::ops::ControlFlow;
use std::path::Path;

use crate::desk::Desk;
use calipose::information::Criterion;
use calipose::plan::assess::{BrokenConstraint, CertifyError, Confirmed, certify};
use calipose::plan::choose::{Chooser, Decision, Trade, decide, refined_survey};
use calipose::plan::document::{Document, Plan};
use calipose::plan::survey::Survey;
use calipose::problem::{Goal, JointRegion, Method, PoseGroup, Problem, ProblemError};
use calipose::robot::Limits;
use serde_json::{Value, json};

/// A problem and its survey, and a plan of it as read back.
struct Planned {
    problem: Problem,
    survey: Survey,
    plan: Plan,
}

/// A problem that ships with some of its text replaced, and more sections.
fn problem(file: &str, replacements: &[(&str, &str)], sections: &str) -> Problem {
    stated(file, replacements, sections).unwrap()
}

fn stated(file: &str, replacements: &[(&str, &str)], sections: &str) -> Result<Problem, ProblemError> {
    let mut text = std::fs::read_to_string(format!("problems/{file}.toml")).unwrap();
    for (from, to) in replacements {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text = text.replace("[selection]\n", "[selection]\noff_grid = false\n");
    Problem::parse(&(text + sections), Path::new("problem.toml"))
}

fn made(problem: &Problem, survey: &Survey) -> Option<Plan> {
    let chooser = Chooser::new(problem, survey).ok()?;
    let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).ok()?;
    let plan = Plan::new(&chooser, &decision).unwrap();
    // Criteria that are not of the intrinsics may choose poses that leave some of them open.
    plan.map_error_px.is_finite().then(|| Plan::from_json(&plan.to_json()).unwrap())
}

impl Planned {
    fn new(problem: Problem) -> Self {
        let survey = refined_survey(&problem, &|_| {}).unwrap();
        let plan = made(&problem, &survey).unwrap();
        Self { problem, survey, plan }
    }

    fn certify(&self, plan: &Plan) -> Result<Confirmed, CertifyError> {
        certify(plan, &self.problem, &self.survey)
    }

    /// All of so many changes at least are noticed.
    fn notices_all(&self, changes: &[Change], least: usize) {
        assert!(changes.len() > least, "{}", changes.len());
        let unnoticed = changes.iter().filter(|change| !self.notices(&change.changed, &change.field));
        let unnoticed: Vec<&str> = unnoticed.map(|change| change.what.as_str()).collect();
        assert_eq!(unnoticed, [""; 0], "of {} changes", changes.len());
    }

    /// Whether a changed plan is refused, or what was changed is listed as not checked.
    fn notices(&self, changed: &Value, field: &str) -> bool {
        let Ok(plan) = Plan::from_json(&changed.to_string()) else { return true };
        match self.certify(&plan) {
            Err(_) => true,
            Ok(confirmed) => confirmed.unchecked.iter().any(|unchecked| unchecked.field == field),
        }
    }
}

/// A plan's JSON with one thing changed: what, in words, and the field as `certify` lists it.
struct Change {
    what: String,
    field: String,
    changed: Value,
}

/// Every number, text and truth value changed; neighbours in every list swapped, its last entry left out; every key left out.
fn changes(plan: &Value) -> Vec<Change> {
    fn pointers(value: &Value, pointer: String, found: &mut Vec<String>) {
        match value {
            Value::Object(fields) => {
                fields.iter().for_each(|(key, value)| pointers(value, format!("{pointer}/{key}"), found));
            }
            Value::Array(entries) => {
                entries.iter().enumerate().for_each(|(i, value)| pointers(value, format!("{pointer}/{i}"), found));
            }
            _ => {}
        }
        found.push(pointer);
    }
    let mut found = Vec::new();
    pointers(plan, String::new(), &mut found);
    let mut changes = Vec::new();
    for pointer in found {
        let mut change = |what: &str, change: &dyn Fn(&mut Value)| {
            let mut changed = plan.clone();
            change(changed.pointer_mut(&pointer).unwrap());
            if changed == *plan {
                return;
            }
            let field = pointer.trim_start_matches('/').replace('/', ".");
            changes.push(Change { what: format!("{pointer} {what}"), field, changed });
        };
        // A price may move a little without moving the bound that it proves.
        let factor = if pointer.ends_with("/price") { 3.0 } else { 1.001 };
        match plan.pointer(&pointer).unwrap() {
            Value::Number(number) if number.is_f64() => {
                let number = number.as_f64().unwrap();
                change("changed", &|value| *value = json!(if number == 0.0 { 0.001 } else { factor * number }));
            }
            Value::Number(number) => {
                let number = number.as_u64().unwrap();
                change("raised", &|value| *value = json!(number + 1));
                if number > 0 {
                    change("lowered", &|value| *value = json!(number - 1));
                }
            }
            Value::String(text) => {
                change("changed", &|value| *value = json!(format!("{text}x")));
                for other in ["d", "greedy", "node limit", "0123abcd"] {
                    change(other, &|value| *value = json!(other));
                }
            }
            Value::Bool(truth) => change("turned", &|value| *value = json!(!truth)),
            Value::Null => change("filled", &|value| *value = json!([0.1, 0.2, 0.3])),
            Value::Array(entries) => {
                for (i, pair) in entries.windows(2).enumerate() {
                    if pair[0] != pair[1] {
                        change(&format!("with {i} and its neighbour swapped"), &|value| {
                            value.as_array_mut().unwrap().swap(i, i + 1);
                        });
                    }
                }
                if !entries.is_empty() {
                    change("shortened", &|value| drop(value.as_array_mut().unwrap().pop()));
                }
            }
            Value::Object(fields) => {
                for key in fields.keys() {
                    change(&format!("without {key}"), &|value| drop(value.as_object_mut().unwrap().remove(key)));
                }
            }
        }
    }
    changes
}

/// Every change of the plan is noticed. `keys` are there, or the plan is not what it is for.
fn every_change_is_noticed(planned: &Planned, keys: &[&str]) {
    let confirmed = planned.certify(&planned.plan).unwrap();
    assert!(confirmed.tolerance < 1e-6, "{confirmed:?}");
    let plan: Value = serde_json::from_str(&planned.plan.to_json()).unwrap();
    for key in keys {
        assert!(plan.pointer(key).is_some_and(|value| !value.is_null()), "{key} is what this plan is for");
    }
    planned.notices_all(&changes(&plan), 300);
}

const COARSE: (&str, &str) = ("step_deg = 8\n", "step_deg = 20\n");

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn every_change_of_an_ordinary_plan_is_noticed() {
    let coarse = ("step_deg = 8\naxis", "step_deg = 20\nrefine = 1\nrefine_sample = 300\naxis");
    let planned = Planned::new(problem("servosila-engineer", &[coarse], ""));
    every_change_is_noticed(&planned, &["/survey/refined", "/poses/0/target_point_m"]);
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn every_change_of_a_plan_for_accuracies_is_noticed() {
    let accuracy = ("criterion = \"v\"\nmethod = \"best\"\ncount = 10", "accuracy = { map_error_px = 3.2, fx = 4.5 }");
    let planned = Planned::new(problem("servosila-engineer", &[COARSE, accuracy], ""));
    every_change_is_noticed(&planned, &["/fewest/refutation/bound", "/certificate/grid/mixture/1"]);
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn every_change_of_a_plan_under_constraints_is_noticed() {
    let criterion =
        ("criterion = \"v\"\nmethod = \"best\"\ncount = 10", "criterion = { v = 3, diversity = 1 }\ncount = 8");
    let groups = "\n[constraints]\njoint_separation_deg = 40\n[[constraints.groups]]\nname = \"left\"\n\
                  joints = { waist = [0, 200] }\nmost = 2\n";
    let planned = Planned::new(problem("servosila-engineer", &[COARSE, criterion], groups));
    every_change_is_noticed(
        &planned,
        &["/certificate/grid/balls/0/price", "/certificate/grid/balls/0/between/0", "/certificate/grid/terms/1/share"],
    );
    // One that is negative would lower the bound of sets that leave room in the group.
    let mut negative = planned.plan.clone();
    negative.certificate.grid.balls[0].price *= -1.0;
    assert!(matches!(planned.certify(&negative), Err(CertifyError::Prices)));
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn every_change_of_a_plan_with_bodies_and_stability_is_noticed() {
    let partly = ("max_tilt_deg = 70", "max_tilt_deg = 70\nmin_corners = 40");
    let planned = Planned::new(problem("servosila-engineer-bodies", &[COARSE, partly], ""));
    every_change_is_noticed(&planned, &["/poses/0/stability_margin_m", "/collision/clearance_m"]);
    let corners = planned.plan.poses.iter().any(|pose| pose.corners_seen.is_some());
    assert!(corners, "one pose sees a part of the board");
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn every_change_of_a_robust_plan_is_noticed() {
    let few = ("criterion = \"v\"\nmethod = \"best\"\ncount = 10", "criterion = \"v\"\ncount = 6");
    let robust = "\n[robust]\ngoal = \"mean\"\nmount_rotation_deg = 2\njoint_zero_deg = 0.5\nscenarios = 2\ndraws = 20\nseen_share = 0.8\n";
    let planned = Planned::new(problem("servosila-engineer", &[COARSE, few], robust));
    planned.certify(&planned.plan).unwrap();
    let plan: Value = serde_json::from_str(&planned.plan.to_json()).unwrap();
    let scenarios = planned.plan.certificate.grid.terms.iter().map(|term| term.scenario);
    assert_eq!(scenarios.collect::<Vec<_>>(), [Some(0), Some(1)]);
    // What other plans have too is changed there.
    let mut changes = changes(&plan);
    let own = ["robust", "worst_loss", "certificate.terms.1"];
    changes.retain(|change| own.iter().any(|key| change.field.starts_with(key)));
    planned.notices_all(&changes, 200);
}

#[test]
fn every_change_of_a_proven_optimum_is_noticed() {
    let exact =
        ("criterion = \"v\"\nmethod = \"best\"\ncount = 10", "criterion = \"d\"\nmethod = \"exact\"\ncount = 6");
    let planned = Planned::new(problem("servosila-engineer", &[COARSE, exact], ""));
    assert_eq!(planned.plan.search.as_ref().unwrap().end, "optimal");
    every_change_is_noticed(&planned, &["/search/nodes"]);
}

/// `certify` has its own reading of what is known: what one criterion forgot would not agree.
#[test]
fn what_is_known_beforehand_counts_in_every_criterion() {
    let known = "\n[constraints]\ncaptured = [[-34.2, 3.6, -156.9, 0.0], [-14.2, 83.6, -136.9, 0.0]]\n";
    let prior = ("[estimate]", "[estimate]\nprior_sigma = { fx = 5, cx = 10, k1 = 0.05 }");
    let nothing = problem("servosila-engineer", &[COARSE], "");
    let problem = problem("servosila-engineer", &[COARSE, prior], known);
    let survey = refined_survey(&problem, &|_| {}).unwrap();
    for criterion in Criterion::ALL {
        let by = |problem: &Problem| {
            let mut problem = problem.clone();
            problem.selection.goal = Goal::Best { criteria: vec![(criterion, 1.0)], count: 8, method: Method::Best };
            problem
        };
        let plan = made(&by(&problem), &survey).unwrap();
        certify(&plan, &by(&problem), &survey).unwrap_or_else(|error| panic!("{}: {error}", criterion.name()));
        let without = made(&by(&nothing), &survey).unwrap();
        assert_ne!(plan.value, without.value, "{}", criterion.name());
        assert!(certify(&without, &by(&problem), &survey).is_err(), "{}", criterion.name());
    }
}

/// A bound that is claimed with the efficiency that fits it, and matrices that prove nothing.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn a_better_bound_than_the_matrix_proves_is_noticed() {
    let planned = Planned::new(problem("servosila-engineer", &[COARSE], ""));
    let refused = |change: &dyn Fn(&mut Plan)| {
        let mut changed = planned.plan.clone();
        change(&mut changed);
        planned.certify(&changed).unwrap_err()
    };
    let proven = refused(&|plan| (plan.bound, plan.efficiency) = (plan.value, 1.0));
    assert!(matches!(&proven, CertifyError::Number { what, .. } if what == "the bound"), "{proven}");
    for change in [
        (&|rows: &mut Vec<Vec<f64>>| rows[0][0] = -rows[0][0]) as &dyn Fn(&mut Vec<Vec<f64>>),
        &|rows| rows[0][1] *= 1.001,
        &|rows| rows[0][0] = f64::NAN,
        &|rows| drop(rows.pop()),
    ] {
        let error = refused(&|plan| change(&mut plan.certificate.grid.terms[0].matrix));
        assert!(matches!(error, CertifyError::Matrix { .. }), "{error}");
    }

    // A search may claim what lies between the poses' value and the matrix's bound, and no more than them if it was ended.
    let exact =
        ("criterion = \"v\"\nmethod = \"best\"\ncount = 10", "criterion = \"e\"\nmethod = \"exact\"\ncount = 6");
    let planned = Planned::new(problem("servosila-engineer", &[COARSE, exact], ""));
    let Plan { value, certificate, .. } = &planned.plan;
    let bounds = [value * 0.99, *value, f64::midpoint(*value, certificate.grid.bound), certificate.grid.bound * 1.01];
    for (end, holds) in [("optimal", [false, true, false, false]), ("node limit", [false, true, true, false])] {
        for (bound, holds) in bounds.into_iter().zip(holds) {
            let mut changed = planned.plan.clone();
            changed.search.as_mut().unwrap().end = end.into();
            (changed.bound, changed.efficiency) = (bound, value / bound);
            assert_eq!(planned.certify(&changed).is_ok(), holds, "{end}: {bound} of {bounds:?}");
        }
    }
}

/// Every number is honest, but the poses miss the accuracies, or the matrix does not exclude fewer.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn a_plan_for_accuracies_that_proves_less_than_it_says_is_noticed() {
    let accuracy = ("criterion = \"v\"\nmethod = \"best\"\ncount = 10", "accuracy = { map_error_px = 3.2, fx = 4.5 }");
    let problem = problem("servosila-engineer", &[COARSE, accuracy], "");
    let survey = refined_survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let made = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
    let count = made.choice.selected.len();

    let spaced = (0..count).map(|c| c * survey.views.len() / count).collect();
    let trade = Some(Trade { best: None, least_seconds: Some(0.0), most_poses: None });
    let choice = chooser.assess(spaced);
    let poor = Decision { journey: chooser.journey(&choice), choice, trade, ..made.clone() };
    let poor = Plan::new(&chooser, &poor).unwrap();
    assert!(matches!(certify(&poor, &problem, &survey), Err(CertifyError::Accuracy { .. })));

    // Here the matrix leaves something to a search, which is said; without one it refutes nothing.
    let mut plan = Plan::new(&chooser, &made).unwrap();
    let confirmed = certify(&plan, &problem, &survey).unwrap();
    assert_eq!((confirmed.least, plan.fewest.as_ref().unwrap().least), (None, count));
    assert!(confirmed.unchecked.iter().any(|unchecked| unchecked.field == "fewest.least"));
    plan.fewest.as_mut().unwrap().nodes = 0;
    assert!(matches!(certify(&plan, &problem, &survey), Err(CertifyError::Refutation { .. })));

    // Those that were best may not be chosen: the bound does not count them.
    let ids: Vec<usize> = plan.poses.iter().map(|pose| pose.id).collect();
    let mut without = problem.clone();
    without.constraints.forbidden.clone_from(&ids);
    let planned = Planned::new(without);
    planned.certify(&planned.plan).unwrap();

    // Where those required do there is nothing to refute.
    let mut required = problem.clone();
    required.constraints.required = ids;
    let planned = Planned::new(required);
    planned.certify(&planned.plan).unwrap();
    assert_eq!(planned.plan.fewest.as_ref().unwrap().refutation, None);
    for (least, nodes) in [(count - 1, 0), (count + 1, 0), (count, 1)] {
        let mut changed = planned.plan.clone();
        let fewest = changed.fewest.as_mut().unwrap();
        (fewest.least, fewest.nodes) = (least, nodes);
        assert!(planned.certify(&changed).is_err());
    }
}

#[test]
fn a_pose_that_is_off_by_little_is_noticed() {
    let planned = Planned::new(problem("servosila-engineer-bodies", &[COARSE], ""));
    let plan: Value = serde_json::from_str(&planned.plan.to_json()).unwrap();
    let pose = plan["poses"][0].clone();
    let mut pointers: Vec<String> =
        ["tilt_deg", "distance_m", "share", "stability_margin_m"].map(|key| format!("/{key}")).into();
    for list in
        ["joints_rad", "joints_deg", "camera_in_base/position_m", "camera_in_base/quaternion_xyzw", "target_point_m"]
    {
        let length = pose.pointer(&format!("/{list}")).unwrap().as_array().unwrap().len();
        pointers.extend((0..length).map(|i| format!("/{list}/{i}")));
    }
    for pointer in pointers {
        let mut changed = plan.clone();
        let value = changed["poses"][0].pointer_mut(&pointer).unwrap();
        *value = json!(value.as_f64().unwrap() + 1e-5);
        assert!(planned.notices(&changed, ""), "{pointer}");
    }
}

#[test]
fn poses_that_break_a_constraint_are_refused_for_it() {
    let Planned { problem, survey, plan } = Planned::new(problem("servosila-engineer", &[COARSE], ""));
    let ids: Vec<usize> = plan.poses.iter().map(|pose| pose.id).collect();
    let broken = |change: &dyn Fn(&mut Problem)| {
        let mut constrained = problem.clone();
        change(&mut constrained);
        match certify(&plan, &constrained, &survey) {
            Err(CertifyError::Constraint(broken)) => broken,
            other => panic!("{other:?}"),
        }
    };
    let outside = survey.views.iter().map(|view| view.id).find(|id| !ids.contains(id)).unwrap();
    let at = |pose: usize| {
        let q = plan.poses[pose].joints_rad[0];
        JointRegion(vec![(0, Limits { min: q, max: q })])
    };
    let there = at(0);
    let count = plan.poses.iter().filter(|pose| there.contains(&pose.joints_rad)).count();
    let required = broken(&|problem| problem.constraints.required = vec![ids[0], outside]);
    assert_eq!(required, BrokenConstraint::Missing { id: outside });
    let forbidden = broken(&|problem| problem.constraints.forbidden = vec![ids[1]]);
    assert_eq!(forbidden, BrokenConstraint::Forbidden { id: ids[1] });
    let kept_out = broken(&|problem| problem.constraints.keep_out = vec![at(0)]);
    assert_eq!(kept_out, BrokenConstraint::Forbidden { id: ids[0] });
    let group = |most: usize| PoseGroup { name: "here".into(), region: at(0), most };
    let crowded = broken(&|problem| problem.constraints.groups = vec![group(count - 1)]);
    assert_eq!(crowded, BrokenConstraint::Crowded { group: "here".into(), count, most: count - 1 });
    for separate in [
        (&|problem: &mut Problem| problem.constraints.joint_separation = 6.0) as &dyn Fn(&mut Problem),
        &|problem: &mut Problem| problem.constraints.view_separation = 2.0,
    ] {
        assert!(matches!(broken(separate), BrokenConstraint::Close { .. }));
    }
}

/// Focal lengths from a door viewer's to a telescope's, every lens model and criterion.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn honest_plans_of_all_cameras_hold_and_what_is_beyond_the_tolerance_is_noticed() {
    let mut certified = 0;
    let mut loosest: f64 = 0.0;
    for (f, square, size, step) in [
        (10, 35.0, "60\nheight_px = 36", 30),
        (10, 100.0, "1280\nheight_px = 720", 30),
        (100, 35.0, "640\nheight_px = 360", 30),
        (1000, 35.0, "1280\nheight_px = 720", 20),
        (9000, 3.0, "1280\nheight_px = 720", 15),
        (10000, 3.0, "1280\nheight_px = 720", 15),
        (20000, 1.0, "5000\nheight_px = 4000", 15),
    ] {
        for (lens, prior) in [
            ("none\"", ""),
            ("brown-conrady\"\nk1 = -0.2\nk2 = 0.05", ""),
            (
                "rational\"\nk1 = 0.5\nk2 = 0.1\nk4 = 0.7\nk5 = 0.3",
                "prior_sigma = { k1 = 0.3, k2 = 0.3, k5 = 0.3, k6 = 0.3 }",
            ),
            ("kannala-brandt\"\nk1 = -0.02", ""),
        ] {
            // No fisheye sees more than all around.
            let Ok(problem) = stated(
                "servosila-engineer",
                &[
                    ("step_deg = 8\naxis", &format!("step_deg = {step}\naxis")),
                    ("square_mm = 35", &format!("square_mm = {square}")),
                    ("width_mm = 378.25\nheight_mm = 350.5", "width_mm = 1000\nheight_mm = 1000"),
                    ("width_px = 1280\nheight_px = 720", &format!("width_px = {size}")),
                    ("fx_px = 1000\nfy_px = 1000", &format!("fx_px = {f}\nfy_px = {f}")),
                    ("brown-conrady\"\nk1 = -0.2\nk2 = 0.05", lens),
                    ("max_tilt_deg = 70", "max_tilt_deg = 70\nmargin_px = 1\nmin_corner_spacing_px = 0.1"),
                    ("intrinsics = [\"fx\", \"fy\", \"cx\", \"cy\", \"k1\", \"k2\", \"p1\", \"p2\", \"k3\"]", prior),
                    ("count = 10", "count = 12"),
                ],
                "",
            ) else {
                continue;
            };
            let Ok(survey) = refined_survey(&problem, &|_| {}) else { continue };
            for criterion in Criterion::ALL {
                let mut asked = problem.clone();
                asked.selection.goal = Goal::Best { criteria: vec![(criterion, 1.0)], count: 12, method: Method::Best };
                let Some(plan) = made(&asked, &survey) else { continue };
                let what = || format!("f {f}, {square} mm, {lens}: {}", criterion.name());
                let confirmed = match certify(&plan, &asked, &survey) {
                    Ok(confirmed) => confirmed,
                    // Where the least eigenvalue is all rounding there is nothing to confirm.
                    Err(CertifyError::Rounding { share, .. }) if share > 1.0 => continue,
                    Err(error) => panic!("{}: {error}", what()),
                };
                certified += 1;
                if !lens.starts_with("rational") {
                    loosest = loosest.max(confirmed.tolerance);
                }
                let little = 1.0 + 3.0 * confirmed.tolerance;
                let p = plan.certificate.grid.terms[0].matrix.len() as f64;
                let more = |value: f64| match criterion {
                    Criterion::D | Criterion::Diversity => value + p * little.ln(),
                    _ => value * little,
                };
                let changes: [&dyn Fn(&mut Plan); 6] = [
                    &|plan| plan.value = more(plan.value),
                    &|plan| plan.bound = more(plan.bound),
                    &|plan| plan.certificate.grid.bound = more(plan.certificate.grid.bound),
                    &|plan| plan.efficiency *= little,
                    &|plan| plan.map_error_px *= little,
                    &|plan| plan.intrinsics.sigma[0] *= little,
                ];
                for (i, change) in changes.into_iter().enumerate() {
                    let mut changed = plan.clone();
                    change(&mut changed);
                    assert!(certify(&changed, &asked, &survey).is_err(), "{}: change {i}", what());
                }
            }
        }
    }
    assert!(certified > 120, "{certified}");
    // The rational lens's coefficients are told apart by rounding alone at times; the others are not.
    assert!(loosest < 1e-4, "{loosest:e}");
}

/// The program's exit codes: 1 where a plan does not hold, 3 where a command cannot use it.
#[test]
fn names_that_do_not_fit_are_refused_by_every_command_that_reads_plans() {
    let desk = Desk::new();
    let plan = desk.json("plan coarse.toml -k 6 --trials 0 -o out --json");
    // Beside it the plan would be a file that was changed.
    std::fs::remove_file(desk.path("out/run.json")).unwrap();
    let swapped = |key: &str| {
        let mut changed = plan.clone();
        changed.pointer_mut(key).unwrap().as_array_mut().unwrap().swap(1, 2);
        std::fs::write(desk.path("out/plan.json"), changed.to_string()).unwrap();
    };
    for (key, words) in [
        ("/joints", "the robot's are waist, shoulder, elbow, neck"),
        ("/intrinsics/names", "the problem estimates fx, fy, cx"),
        ("/intrinsics/nominal", "another nominal camera"),
        ("/poses/0/joints_deg", "lead to another camera pose"),
        ("/poses/0/joints_rad", "lead to another camera pose"),
        ("/poses/0/camera_in_base/position_m", "lead to another camera pose"),
    ] {
        swapped(key);
        assert!(desk.complaint("certify out/plan.json --problem coarse.toml", 1).contains(words), "{key}");
        for command in ["verify", "explain", "polish"] {
            assert!(
                desk.complaint(&format!("{command} out/plan.json --problem coarse.toml"), 3).contains(words),
                "{key}: {command}"
            );
        }
        assert!(desk.complaint("next out/plan.json --problem coarse.toml none.vnl", 3).contains(words), "{key}");
    }
    // A file that is no plan, or one of another problem, is refused before anything is certified.
    for (key, value, words) in
        [("/format", "calipose.polished", "calipose.polished"), ("/problem/sha256", "00", "another version")]
    {
        let mut changed = plan.clone();
        *changed.pointer_mut(key).unwrap() = json!(value);
        std::fs::write(desk.path("out/plan.json"), changed.to_string()).unwrap();
        assert!(desk.complaint("certify out/plan.json --problem coarse.toml", 3).contains(words), "{key}");
    }
}

#[test]
fn what_is_not_checked_is_said() {
    let desk = Desk::new();
    let mut plan = desk.json("plan coarse.toml -k 6 --trials 0 -o out --json");
    // Beside it the plan would be a file that was changed.
    std::fs::remove_file(desk.path("out/run.json")).unwrap();
    let said = desk.stdout("certify out/plan.json --problem coarse.toml");
    assert!(said.contains("Not checked: `calipose`: "), "{said}");
    plan["calipose"] = json!("0.0.1");
    plan["poses"][1]["note"] = json!("safe");
    std::fs::write(desk.path("out/plan.json"), plan.to_string()).unwrap();
    let said = desk.stdout("certify out/plan.json --problem coarse.toml");
    assert!(said.contains("Not checked: `poses[1].note`: is not known to this version"), "{said}");
    let document = desk.json("certify out/plan.json --problem coarse.toml --json");
    let fields: Vec<&str> =
        document["not_checked"].as_array().unwrap().iter().map(|entry| entry["field"].as_str().unwrap()).collect();
    let fields: Vec<&str> = fields.into_iter().filter(|field| *field != "tour.order").collect();
    let of_trade = ["tour.trade.kept", "tour.trade.best_total_s", "tour.trade.least_total_s"];
    assert_eq!(fields, [&["calipose", "tour.least_moving_s"], &of_trade[..], &["poses[1].note"]].concat());
    assert!(document["tolerance"].as_f64().unwrap() < 1e-6);
}
