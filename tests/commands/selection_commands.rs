//! Criteria, constraints, accuracies and proofs as a user asks for them.

use crate::desk::Desk;
use calipose::plan::choose::Chooser;
use calipose::plan::survey::survey;
use calipose::problem::Problem;
use serde_json::{Value, json};

/// Appends to the coarse problem's `[selection]`, its last section, under another name.
fn with(desk: &Desk, name: &str, selection: &str, sections: &str) {
    desk.change(name, &[("method = \"best\"", selection)]);
    let mut text = std::fs::read_to_string(desk.path(name)).unwrap();
    text.push_str(sections);
    std::fs::write(desk.path(name), text).unwrap();
}

/// As [`with`], for accuracies in place of criterion, method and number of poses.
fn accurate(desk: &Desk, name: &str, accuracy: &str, sections: &str) {
    let goal = "criterion = \"v\"\nmethod = \"best\"\ncount = 10";
    desk.change(name, &[(goal, &format!("accuracy = {accuracy}"))]);
    let text = std::fs::read_to_string(desk.path(name)).unwrap();
    std::fs::write(desk.path(name), text + sections).unwrap();
}

fn plan(desk: &Desk, line: &str) -> Value {
    desk.json(&format!("{line} --json --trials 0"))
}

fn ids(plan: &Value) -> Vec<u64> {
    plan["poses"].as_array().unwrap().iter().map(|pose| pose["id"].as_u64().unwrap()).collect()
}

fn joint(pose: &Value, j: usize) -> f64 {
    pose["joints_deg"][j].as_f64().unwrap()
}

#[test]
fn every_criterion_has_its_plan_and_certificate() {
    let desk = Desk::new();
    for criterion in ["d", "a", "e", "v", "zhang", "diversity"] {
        let plan = plan(&desk, &format!("plan coarse.toml --criterion {criterion} -k 9 -o {criterion}"));
        assert_eq!(plan["criterion"], criterion);
        let efficiency = plan["efficiency"].as_f64().unwrap();
        assert!((0.5..=1.0).contains(&efficiency), "{criterion}: {efficiency}");
        let said = desk.stdout(&format!("certify {criterion}/plan.json"));
        assert!(said.contains("the certificate holds"), "{said}");
    }
}

#[test]
fn combinations_are_one_objective_with_one_certificate() {
    let desk = Desk::new();
    with(&desk, "both.toml", "method = \"best\"\n", "");
    desk.change("both.toml", &[("criterion = \"v\"", "criterion = { v = 3, diversity = 1 }")]);
    let both = plan(&desk, "plan both.toml -k 9 -o both");
    assert_eq!(both["criterion"], "0.75 v + 0.25 diversity");
    assert_eq!(both["certificate"]["grid"]["terms"].as_array().unwrap().len(), 2);
    assert!(desk.stdout("certify both/plan.json").contains("the certificate holds"));
    // It gives up a little of the map error for the spread.
    let alone = plan(&desk, "plan coarse.toml -k 9 -o alone");
    assert!(both["map_error_px"].as_f64() >= alone["map_error_px"].as_f64());
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn the_proven_best_is_no_worse_than_the_best_found() {
    let desk = Desk::new();
    let best = plan(&desk, "plan coarse.toml -k 8 -o best");
    let exact = plan(&desk, "plan coarse.toml -k 8 --method exact -o exact");
    assert_eq!(exact["search"]["end"], "optimal");
    let value = |plan: &Value| plan["value"].as_f64().unwrap();
    assert!(value(&exact) <= value(&best) * (1.0 + 1e-9));
    assert!(exact["efficiency"].as_f64().unwrap() > 1.0 - 1e-8);
    assert!(desk.prose("plan coarse.toml -k 8 --method exact --trials 0 -o exact").contains("proven optimal"));
    assert!(desk.stdout("certify exact/plan.json").contains("found by search"));
    // What a search may claim lies between the value and what the matrix proves.
    for (name, bound) in [("below the value", value(&exact) * 1.01), ("beyond the matrix", value(&exact) * 0.5)] {
        let mut changed = exact.clone();
        changed["bound"] = json!(bound);
        changed["efficiency"] = json!(bound / value(&exact));
        std::fs::write(desk.path("exact/plan.json"), changed.to_string()).unwrap();
        assert!(desk.complaint("certify exact/plan.json", 1).contains("the bound"), "{name}");
    }
    // A search that may not search has the certificate's bound.
    with(&desk, "hasty.toml", "method = \"exact\"\nnode_limit = 0", "");
    let hasty = plan(&desk, "plan hasty.toml -k 8 -o hasty");
    assert_eq!(hasty["search"]["end"], "node limit");
    assert!(hasty["efficiency"].as_f64() <= best["efficiency"].as_f64());
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn the_fewest_poses_that_reach_an_accuracy_are_found_and_proven() {
    let desk = Desk::new();
    let eight = plan(&desk, "plan coarse.toml -k 8 -o eight");
    let requested = eight["map_error_px"].as_f64().unwrap() * 1.0001;
    accurate(&desk, "accurate.toml", &format!("{{ map_error_px = {requested} }}"), "");
    let fewest = plan(&desk, "plan accurate.toml -o fewest");
    assert!(fewest["map_error_px"].as_f64().unwrap() <= requested);
    let count = fewest["count"].as_u64().unwrap();
    assert!(count <= 8);
    assert_eq!(fewest["fewest"]["least"], count, "the proof is complete");
    assert!(desk.stdout("certify fewest/plan.json").contains("the certificate holds"));
    // One pose less, exactly searched, does not do.
    let less = plan(&desk, &format!("plan coarse.toml -k {} --method exact -o less", count - 1));
    assert_eq!(less["search"]["end"], "optimal");
    assert!(less["map_error_px"].as_f64().unwrap() > requested);

    assert!(
        desk.complaint("plan accurate.toml -k 5", 3)
            .contains("`selection.count` and `selection.accuracy` exclude each other")
    );
    let mut easier = fewest.clone();
    easier["fewest"]["accuracies"][0]["requested"] = json!(requested / 2.0);
    std::fs::write(desk.path("fewest/plan.json"), easier.to_string()).unwrap();
    assert!(desk.complaint("certify fewest/plan.json", 1).contains("not those of the problem file"));

    // Where constraints leave little room, fewer poses may still do.
    let narrow = format!("{{ map_error_px = {} }}", 10.0 * requested);
    accurate(&desk, "narrow.toml", &narrow, "\n[constraints]\njoint_separation_deg = 150\n");
    assert!(plan(&desk, "plan narrow.toml -o narrow")["map_error_px"].as_f64().unwrap() <= 10.0 * requested);
    accurate(&desk, "too_narrow.toml", &narrow, "\n[constraints]\njoint_separation_deg = 310\n");
    let complaint = desk.complaint("plan too_narrow.toml -o too_narrow", 1);
    assert!(
        complaint.contains("all that may be chosen") || complaint.contains("no set of poses was found"),
        "{complaint}"
    );

    accurate(&desk, "absurd.toml", "{ map_error_px = 0.001, fx = 50 }", "");
    let complaint = desk.complaint("plan absurd.toml -o absurd", 1);
    assert!(complaint.contains("the map error in px is") && !complaint.contains("sigma of fx"), "{complaint}");
}

#[test]
fn constraints_are_kept_and_the_certificate_is_theirs() {
    let desk = Desk::new();
    let free = plan(&desk, "plan coarse.toml -k 8 -o free");
    let first = ids(&free)[0];
    let waist = |pose: &Value| joint(pose, 0);
    let held = waist(&free["poses"][0]);
    let sections = format!(
        "\n[constraints]\nforbid = [{first}]\njoint_separation_deg = 40\nview_separation_deg = 5\n\
         [[constraints.keep_out]]\njoints = {{ waist = [{0}, {0}] }}\n\
         [[constraints.groups]]\nname = \"left\"\njoints = {{ waist = [0, 200] }}\nmost = 2\n",
        held + 15.0,
    );
    with(&desk, "held.toml", "method = \"best\"", &sections);
    let kept = plan(&desk, "plan held.toml -k 8 -o held");
    let poses = kept["poses"].as_array().unwrap();
    assert!(!ids(&kept).contains(&first));
    assert!(poses.iter().all(|pose| (waist(pose) - held - 15.0).abs() > 1e-6));
    assert!(poses.iter().filter(|pose| waist(pose) >= 0.0).count() <= 2);
    for (i, a) in poses.iter().enumerate() {
        for b in &poses[..i] {
            let distance = (0..4).map(|j| (joint(a, j) - joint(b, j)).powi(2)).sum::<f64>().sqrt();
            assert!(distance >= 40.0 - 1e-6, "{distance}");
        }
    }
    assert!(kept["value"].as_f64() >= free["value"].as_f64(), "constraints cost");
    assert!(desk.stdout("certify held/plan.json").contains("the certificate holds"));

    let required = ids(&free)[3];
    with(&desk, "required.toml", "method = \"best\"", &format!("\n[constraints]\nrequire = [{required}]\n"));
    let plan = plan(&desk, "plan required.toml -k 8 --criterion d -o required");
    assert!(ids(&plan).contains(&required));
    assert!(desk.stdout("certify required/plan.json").contains("the certificate holds"));
}

#[test]
fn what_is_known_beforehand_counts() {
    let desk = Desk::new();
    let nothing = plan(&desk, "plan coarse.toml -k 6 -o nothing");
    let captured: Vec<String> = nothing["poses"].as_array().unwrap()[..3]
        .iter()
        .map(|pose| format!("[{}, {}, {}, {}]", joint(pose, 0), joint(pose, 1), joint(pose, 2), joint(pose, 3)))
        .collect();
    let sections = format!("\n[constraints]\ncaptured = [{}]\n", captured.join(", "));
    with(&desk, "begun.toml", "method = \"best\"", &sections);
    let begun = plan(&desk, "plan begun.toml -k 6 -o begun");
    assert!(begun["map_error_px"].as_f64() < nothing["map_error_px"].as_f64());
    assert!(desk.stdout("certify begun/plan.json").contains("the certificate holds"));
    // By criteria that are not of the intrinsics too.
    for (criterion, least) in [("zhang", "3"), ("diversity", "6")] {
        let value = |file: &str| {
            let plan = plan(&desk, &format!("plan {file} -k {least} --criterion {criterion} -o counted-{file}"));
            assert!(desk.stdout(&format!("certify counted-{file}/plan.json")).contains("the certificate holds"));
            plan["value"].as_f64().unwrap()
        };
        assert!(value("begun.toml") > value("coarse.toml"), "{criterion}");
    }
    // Two views beside three are enough for the five numbers of `zhang`, which two alone are not.
    assert!(plan(&desk, "plan begun.toml -k 2 --criterion zhang -o two")["value"].as_f64().unwrap() > 0.0);
    // A prior makes few poses regular.
    desk.change(
        "prior.toml",
        &[("[estimate]", "[estimate]\nprior_sigma = { fx = 1, fy = 1, cx = 1, cy = 1, k3 = 0.01 }")],
    );
    let prior = plan(&desk, "plan prior.toml -k 3 -o prior");
    assert!(prior["intrinsics"]["sigma"][0].as_f64().unwrap() <= 1.0);
}

#[test]
fn contradictions_are_refused_and_say_what_to_do() {
    let desk = Desk::new();
    let free = plan(&desk, "plan coarse.toml -k 8 -o free");
    let [a, b] = [ids(&free)[0], ids(&free)[1]];
    let region = format!("{{ waist = [{0}, {0}] }}", joint(&free["poses"][0], 0));
    for (name, constraints, words) in [
        ("unseen", "require = [0]".to_owned(), "pose 0 is required, but it is not among"),
        ("kept_out", format!("require = [{a}]\nkeep_out = [{{ joints = {region} }}]"), "lies in region 1"),
        ("apart", format!("require = [{a}, {b}]\njoint_separation_deg = 3000"), "apart; the least separation is"),
        ("dead_end", "joint_separation_deg = 300".to_owned(), "allow at most"),
        ("none_left", "keep_out = [{ joints = { waist = [-300, 300] } }]".to_owned(), "0 allowed"),
        ("captured", "captured = [[0, 100, -10, 0]]".to_owned(), "captured view 1"),
        (
            "capped",
            format!("require = [{a}]\ngroups = [{{ name = \"g\", joints = {region}, most = 0 }}]"),
            "in group 0, which may have 0",
        ),
    ] {
        let file = format!("{name}.toml");
        with(&desk, &file, "method = \"best\"", &format!("\n[constraints]\n{constraints}\n"));
        let complaint = desk.complaint(&format!("plan {file} -k 8 -o {name}"), 1);
        assert!(complaint.contains(words), "{name}: {complaint}");
        assert!(!desk.path(name).exists(), "nothing is written");
    }
}

/// Every number that a plan claims is one that certify recomputes.
#[test]
fn a_plan_that_was_tampered_with_does_not_hold() {
    let desk = Desk::new();
    let plan = plan(&desk, "plan coarse.toml -k 8 -o out");
    let tampered = |change: &dyn Fn(&mut Value)| {
        let mut changed = plan.clone();
        change(&mut changed);
        std::fs::write(desk.path("out/plan.json"), changed.to_string()).unwrap();
        desk.complaint("certify out/plan.json", 1)
    };
    let scaled = |value: &mut Value| *value = json!(value.as_f64().unwrap() * 1.001);
    for (path, words) in [
        ("/value", "the value"),
        ("/bound", "the bound"),
        ("/efficiency", "the efficiency"),
        ("/certificate/grid/bound", "the certificate's bound"),
        ("/certificate/grid/terms/0/matrix/0/0", "the certificate's bound"),
        ("/certificate/grid/terms/0/matrix/0/1", "semidefinite"),
        ("/map_error_px", "the map error"),
        ("/intrinsics/sigma/2", "a predicted sigma"),
    ] {
        let complaint = tampered(&|plan| scaled(plan.pointer_mut(path).unwrap()));
        assert!(complaint.contains("does not hold") && complaint.contains(words), "{path}: {complaint}");
    }
    let complaint = tampered(&|plan| plan["poses"][0]["id"] = json!(1));
    assert!(complaint.contains("pose 1 is not among"), "{complaint}");
    let complaint = tampered(&|plan| plan["poses"][1] = plan["poses"][0].clone());
    assert!(complaint.contains("occurs twice"), "{complaint}");
    let complaint = tampered(&|plan| plan["criterion"] = json!("d"));
    assert!(complaint.contains("it optimises \"d\"; the problem asks for \"v\""), "{complaint}");
    let complaint = tampered(&|plan| plan["certificate"]["grid"]["terms"][0]["criterion"] = json!("d"));
    assert!(complaint.contains("its certificate is for \"1 d\""), "{complaint}");
}

/// The shipped robot and board with another lens, and sections of their own from `[sweep]` on.
fn from_sweep_on(desk: &Desk, name: &str, k2: f64, sections: &str) {
    let text = std::fs::read_to_string(desk.path("coarse.toml")).unwrap();
    let text = text.replace("k1 = -0.2\nk2 = 0.05", &format!("k1 = 0.05\nk2 = {k2}"));
    let (set_up, _) = text.split_once("[sweep]").unwrap();
    let sections = sections.replace("[selection]\n", "[selection]\noff_grid = false\n");
    std::fs::write(desk.path(name), format!("{set_up}[sweep]\naxis = \"zone\"\n{sections}")).unwrap();
}

/// Two views give `zhang` four equations for five numbers: its least eigenvalue is rounding, alone and in a combination.
#[test]
fn singular_sets_are_no_plans() {
    let desk = Desk::new();
    let sections = |criterion: &str, count: usize| {
        format!(
            "step_deg = [40.0, 36.0, 45.0, 27.0]\n[visibility]\nmargin_px = 5\nmax_tilt_deg = 70\n[noise]\nsigma_px = 0.3\n\
             [estimate]\nintrinsics = [\"fx\", \"cx\", \"k1\", \"k2\", \"p1\", \"k3\"]\nprior_sigma = {{ k2 = 0.13732616658755267, k3 = 0.5730055528867432 }}\n\
             [selection]\ncriterion = {criterion}\ncount = {count}\n[constraints]\njoint_separation_deg = 64.4\n"
        )
    };
    for criterion in ["\"zhang\"", "{ d = 1.0, zhang = 1.0 }", "{ v = 1.0, diversity = 1.0, zhang = 0.01 }"] {
        from_sweep_on(&desk, "two.toml", 0.02, &sections(criterion, 2));
        for method in ["best", "exact", "exchange", "greedy", "relaxation"] {
            let complaint = desk.complaint(&format!("plan two.toml --method {method} -o two"), 1);
            assert!(complaint.contains("2 poses cannot determine"), "{criterion} {method}: {complaint}");
            assert!(!desk.path("two").exists(), "nothing is written");
        }
        from_sweep_on(&desk, "three.toml", 0.02, &sections(criterion, 3));
        let plan = plan(&desk, "plan three.toml -o three");
        assert!(plan["efficiency"].as_f64().unwrap() > 1e-3, "{criterion}");
    }
    // Baselines look at no constraints, and may draw what is singular.
    let free = sections("\"zhang\"", 2).replace("[constraints]\njoint_separation_deg = 64.4\n", "");
    from_sweep_on(&desk, "two.toml", 0.02, &free);
    for method in ["random", "kmeans-joints", "kmeans-positions"] {
        let complaint = desk.complaint(&format!("plan two.toml --method {method} -o two"), 1);
        assert!(complaint.contains("2 poses cannot determine"), "{method}: {complaint}");
    }
}

/// The greatest weights of a relaxation may be a singular set; then it is repaired, or refused.
#[test]
fn a_rounded_relaxation_is_regular() {
    let desk = Desk::new();
    let sections = "step_deg = [33.0, 36.0, 27.0, 30.0]\n[visibility]\nmargin_px = 5\nmax_tilt_deg = 70\n[noise]\nsigma_px = 0.3\n\
                    [selection]\ncriterion = \"zhang\"\ncount = 3\n";
    from_sweep_on(&desk, "three.toml", 0.02, sections);
    let value = |method: &str| {
        let plan = plan(&desk, &format!("plan three.toml --method {method} -o three"));
        plan["value"].as_f64().unwrap()
    };
    let (relaxed, exact) = (value("relaxation"), value("exact"));
    assert!(relaxed > 1e-6 * exact && relaxed <= exact * (1.0 + 1e-9), "{relaxed} {exact}");
}

/// Picks made one by one come to a dead end here, yet 134 sets of five are allowed, as counting them shows.
#[test]
fn a_set_is_found_where_one_is_allowed() {
    let desk = Desk::new();
    let sections = |separation: f64, count: usize| {
        format!(
            "step_deg = [30.0, 45.0, 24.0, 40.0]\n[visibility]\nmargin_px = 5\nmax_tilt_deg = 70\n[noise]\nsigma_px = 0.3\n\
             [estimate]\nintrinsics = [\"fx\", \"fy\", \"cx\", \"k2\", \"p1\", \"p2\", \"k3\"]\n\
             prior_sigma = {{ cx = 11.448784735709765, p2 = 0.01748547881101475, k3 = 0.11668570288738325 }}\n\
             [selection]\ncriterion = \"a\"\ncount = {count}\n[constraints]\n\
             captured = [[55.788, 74.051, -145.064, 0.804]]\nview_separation_deg = {separation}\n"
        )
    };
    from_sweep_on(&desk, "wide.toml", 0.0, &sections(31.7, 5));
    let value = |method: &str| {
        let plan = plan(&desk, &format!("plan wide.toml --method {method} -o wide"));
        assert!(desk.stdout("certify wide/plan.json").contains("the certificate holds"));
        (plan["value"].as_f64().unwrap(), plan["search"]["end"].clone())
    };
    let (exact, end) = value("exact");
    assert_eq!(end, "optimal");
    for method in ["best", "exchange", "greedy", "relaxation"] {
        assert!(value(method).0 >= exact * (1.0 - 1e-9), "{method}");
    }
    // Every set tried.
    let problem = Problem::read(&desk.path("wide.toml")).unwrap();
    let survey = survey(&problem, &|_| {}).unwrap();
    let chooser = Chooser::new(&problem, &survey).unwrap();
    let toward = |i: usize| survey.views[i].X_CT.inverse().translation.vector.normalize();
    let apart = |i: usize, j: usize| toward(i).angle(&toward(j)) >= 31.7f64.to_radians();
    let mut sets: Vec<Vec<usize>> = vec![vec![]];
    for _ in 0..5 {
        let longer = |set: &Vec<usize>| {
            let next = set.last().map_or(0, |last| last + 1)..survey.views.len();
            let fits = next.filter(|&j| set.iter().all(|&i| apart(i, j)));
            fits.map(|j| [set.as_slice(), &[j]].concat()).collect::<Vec<_>>()
        };
        sets = sets.iter().flat_map(longer).collect();
    }
    assert_eq!(sets.len(), 134);
    let values = sets.into_iter().map(|set| chooser.natural(chooser.assess(set).log_value));
    let least = values.fold(f64::INFINITY, f64::min);
    assert!((exact - least).abs() < 1e-9 * least, "{exact} {least}");

    // Six are the most, and that is proven.
    let complaint = desk.complaint("plan wide.toml -k 7 -o wide", 1);
    assert!(complaint.contains("allow at most 6 poses together, which is proven; 7 are asked for"), "{complaint}");
}
