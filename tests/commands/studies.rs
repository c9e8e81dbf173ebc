//! Studies: every cell once, whatever happens, and the same bytes in the end.

use std::collections::BTreeMap;
use std::path::Path;

use calipose::plan::choose::Chooser;
use calipose::plan::survey::survey;
use calipose::problem::{Method, Overrides, Problem};
use serde_json::Value;

use crate::desk::Desk;

/// A study of four cells and three methods.
const STUDY: &str = r#"
name = "Small"
problems = ["coarse.toml"]
set = ["sweep.step_deg=20", "estimate.intrinsics=[\"fx\", \"fy\", \"cx\", \"cy\", \"k1\"]"]

[[factors]]
key = "noise.sigma_px"
values = [0.3, 0.6]

[[factors]]
name = "tilt"
levels = [
    { name = "to 60", set = ["visibility.max_tilt_deg=60"] },
    { name = "to 70", set = ["visibility.max_tilt_deg=70"] },
]

[choose]
methods = ["best", "greedy", "kmeans-joints"]
counts = [6, 9]
seeds = 3
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    write(&desk, "small.toml", STUDY);
    desk
}

fn write(desk: &Desk, name: &str, text: &str) {
    std::fs::write(desk.path(name), text).unwrap();
}

/// The rows of a table, by column.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// All results that are the same in every run.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in [folder.to_owned(), folder.join("figures")] {
        for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let name = entry.file_name().into_string().unwrap();
            if entry.path().is_file() && !["times.csv", ".lock"].contains(&name.as_str()) {
                found.insert(name, std::fs::read(entry.path()).unwrap());
            }
        }
    }
    found
}

/// The files of cells.
fn cells(folder: &Path) -> Vec<std::path::PathBuf> {
    let below = |folder: &Path| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = below(&folder.join("cells")).flat_map(|sub| below(&sub).collect::<Vec<_>>()).collect();
    files.sort();
    files
}

#[test]
fn a_row_is_what_a_plan_with_the_same_settings_comes_to() {
    let desk = desk();
    desk.stdout("study run small.toml -o out --quiet");
    let rows = rows(&desk.path("out/results.csv"));
    // Two numbers of poses, by best, by greedy and by k-means with three seeds.
    assert_eq!(rows.len(), 4 * 2 * (1 + 1 + 3));
    let set = "--set selection.tour_tolerance=0 --set sweep.step_deg=20 --set estimate.intrinsics=[\"fx\",\"fy\",\"cx\",\"cy\",\"k1\"]";
    for (sigma, tilt, method, seed) in [("0.3", "60", "best", ""), ("0.6", "70", "kmeans-joints", "2")] {
        let is_it = |row: &&BTreeMap<String, String>| {
            row["noise.sigma_px"] == sigma
                && row["tilt"] == format!("to {tilt}")
                && row["method"] == method
                && row["seed"] == seed
                && row["count"] == "9"
        };
        let row = rows.iter().find(is_it).unwrap();
        let seed = if seed.is_empty() { "0" } else { seed };
        let plan = desk.json(&format!(
            "plan coarse.toml {set} --set noise.sigma_px={sigma} --set visibility.max_tilt_deg={tilt} -k 9 --method {method} \
             --seed {seed} --trials 0 -o plan --json --force"
        ));
        for (column, key) in [("map_error_px", "map_error_px"), ("value", "value"), ("bound", "bound")] {
            let (ours, theirs): (f64, f64) = (row[column].parse().unwrap(), plan[key].as_f64().unwrap());
            // The bound depends on where the search for it began.
            let tolerance = if column == "bound" { 1e-3 } else { 0.0 };
            assert!((ours - theirs).abs() <= tolerance * theirs.abs(), "{column}: {ours} {theirs}");
        }
        assert_eq!(row["views"], plan["survey"]["views"].to_string());
    }
}

/// What one cell found of the views may serve another only if both take as many pictures.
#[test]
fn cells_of_several_pictures_are_their_own() {
    let desk = desk();
    let several = STUDY.replace("noise.sigma_px", "selection.pictures").replace("[0.3, 0.6]", "[1, 4]");
    write(&desk, "several.toml", &several);
    desk.stdout("study run several.toml -o out --quiet");
    let rows = rows(&desk.path("out/results.csv"));
    let map_errors = |pictures: &str| -> Vec<f64> {
        let of_those = rows.iter().filter(|row| row["selection.pictures"] == pictures && row["method"] == "greedy");
        of_those.map(|row| row["map_error_px"].parse().unwrap()).collect()
    };
    let (one, four) = (map_errors("1"), map_errors("4"));
    assert_eq!((one.len(), four.len()), (4, 4));
    assert!(one.iter().zip(&four).all(|(one, four)| (four / one - 0.5).abs() < 1e-9), "{one:?} {four:?}");
}

#[test]
fn what_was_ended_or_damaged_goes_on_to_the_same_bytes() {
    let desk = desk();
    desk.stdout("study run small.toml -o whole --quiet");
    let whole = results(&desk.path("whole"));
    assert!(whole.contains_key("results.csv") && whole.contains_key("report.html") && whole.len() > 8);
    desk.stdout("study cell small.toml 2 -o parts --quiet");
    assert_eq!(cells(&desk.path("parts")).len(), 1);
    let missing = desk.complaint("study merge small.toml -o parts", 1);
    assert!(missing.contains("3 of the study's 4 cells are not in parts: 0, 1, 3"), "{missing}");
    desk.stdout("study cell small.toml --shard 1/2 -o parts --threads 1 --quiet");
    // A file that was cut off, and one of another cell's name, do not count.
    let files = cells(&desk.path("parts"));
    let text = std::fs::read(&files[0]).unwrap();
    std::fs::write(&files[0], &text[..text.len() / 2]).unwrap();
    std::fs::copy(&files[2], &files[1]).unwrap();
    let told = desk.prose("study cell small.toml --shard 0/1 -o parts");
    assert!(told.contains("3 of 4 cells computed, 1 were there"), "{told}");
    desk.stdout("study merge small.toml -o parts --quiet");
    assert!(results(&desk.path("parts")) == whole);
    // Again, on other threads: nothing is computed, and nothing changes.
    let before = cells(&desk.path("parts")).iter().map(|path| std::fs::read(path).unwrap()).collect::<Vec<_>>();
    desk.stdout("study run small.toml -o parts --threads 3 --quiet");
    assert!(results(&desk.path("parts")) == whole);
    assert!(cells(&desk.path("parts")).iter().map(|path| std::fs::read(path).unwrap()).eq(before));
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn cells_of_a_changed_study_are_taken_and_those_of_another_version_are_not() {
    let desk = desk();
    desk.stdout("study run small.toml -o out --quiet");
    write(&desk, "more.toml", &STUDY.replace("[0.3, 0.6]", "[0.6, 0.3, 0.9]"));
    let told = desk.prose("study cell more.toml --shard 0/1 -o out");
    assert!(told.contains("2 of 6 cells computed, 4 were there"), "{told}");
    desk.stdout("study run more.toml -o fresh --quiet");
    desk.stdout("study merge more.toml -o out --quiet");
    assert!(results(&desk.path("out")) == results(&desk.path("fresh")));
    let told = desk.prose("study run small.toml -o out");
    assert!(told.contains("2 more cells are there"), "{told}");
    // What another version computed has another fingerprint.
    for path in cells(&desk.path("out")) {
        let mut cell: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        cell["fingerprint"] = "0".repeat(64).into();
        std::fs::write(&path, cell.to_string()).unwrap();
    }
    let refused = desk.complaint("study merge small.toml -o out", 1);
    assert!(refused.contains("4 of the study's 4 cells are not in out"), "{refused}");
    assert!(refused.contains("of another version of calipose"), "{refused}");
}

#[test]
fn a_folder_belongs_to_one_study_and_one_run() {
    let desk = desk();
    desk.stdout("study run small.toml -o out --quiet");
    write(&desk, "other.toml", &STUDY.replace("Small", "Other"));
    let refused = desk.complaint("study run other.toml -o out", 1);
    assert!(refused.contains("out holds the study \"Small\"") && refused.contains("--force"), "{refused}");
    desk.stdout("study run other.toml -o out --force --quiet");
    let lock = std::fs::File::open(desk.path("out/.lock")).unwrap();
    lock.lock().unwrap();
    for line in ["study run other.toml -o out", "study cell other.toml 1 -o out", "study merge other.toml -o out"] {
        let refused = desk.complaint(line, 1);
        assert!(refused.contains("another run is at work in out"), "{refused}");
    }
    lock.unlock().unwrap();
    lock.lock_shared().unwrap();
    desk.stdout("study cell other.toml 1 -o out --quiet");
    desk.complaint("study run other.toml -o out", 1);
}

#[test]
fn a_cell_that_fails_is_a_row_with_its_reason() {
    let desk = desk();
    let study = STUDY.replace("[0.3, 0.6]", "[0.3]").replace("max_tilt_deg=60", "max_tilt_deg=0.001");
    write(&desk, "failing.toml", &study);
    let told = desk.prose("study run failing.toml -o out");
    assert!(told.contains("rows have no choice: none of the"), "{told}");
    let rows = rows(&desk.path("out/results.csv"));
    let (failed, good): (Vec<_>, Vec<_>) = rows.iter().partition(|row| !row["reason"].is_empty());
    assert_eq!((failed.len(), good.len()), (10, 10));
    assert!(failed.iter().all(|row| row["map_error_px"].is_empty() && row["tilt"] == "to 60"));
    let summary: Value = serde_json::from_slice(&std::fs::read(desk.path("out/study.json")).unwrap()).unwrap();
    assert_eq!(summary["reasons"][0]["rows"], 10);
    // Levels that cannot stand together: a corner of the grid that the problem refuses.
    let refused = STUDY.replace("levels = [", "levels = [{ name = \"odd\", set = [\"camera.width_px=300\"] },");
    let refused = refused.replace("noise.sigma_px", "camera.cx_px").replace("[0.3, 0.6]", "[100, 400]");
    write(&desk, "refused.toml", &refused);
    let told = desk.prose("study run refused.toml -o refused");
    assert!(told.contains("rows have no choice"), "{told}");
}

#[test]
fn means_and_differences_are_those_of_the_rows() {
    let desk = desk();
    desk.stdout("study run small.toml -o out --quiet");
    let rows = rows(&desk.path("out/results.csv"));
    let summary: Value = serde_json::from_slice(&std::fs::read(desk.path("out/study.json")).unwrap()).unwrap();
    let outcome = &summary["outcomes"][0];
    assert_eq!(outcome["outcome"], "map_error_px");
    let numbers = |is_of: &dyn Fn(&BTreeMap<String, String>) -> bool| -> Vec<f64> {
        rows.iter().filter(|row| is_of(row)).map(|row| row["map_error_px"].parse().unwrap()).collect()
    };
    let list = |value: &Value| value.as_array().unwrap().clone();
    let by = |axis: &str| list(&outcome["means"]).into_iter().find(|means| means["axis"] == axis).unwrap();
    let best = list(&by("tilt")["means"])
        .into_iter()
        .find(|mean| mean["series"] == "9 poses, best" && mean["level"] == "to 70")
        .unwrap();
    let there = numbers(&|row| row["count"] == "9" && row["method"] == "best" && row["tilt"] == "to 70");
    assert_eq!(best["rows"], there.len());
    assert!((best["mean"].as_f64().unwrap() - there.iter().sum::<f64>() / 2.0).abs() < 1e-12);
    // Noise twice as large: everything twice as large, in every pair.
    let compared =
        list(&outcome["compared"]).into_iter().find(|compared| compared["axis"] == "noise.sigma_px").unwrap();
    assert_eq!(compared["against"], "0.3");
    for difference in list(&compared["differences"]) {
        // Which set is chosen does not depend on the noise.
        assert!((difference["ratio"].as_f64().unwrap() - 2.0).abs() < 1e-6, "{difference}");
        assert_eq!(difference["pairs"], 2);
    }
    let compared = list(&outcome["compared"]).into_iter().find(|compared| compared["axis"] == "method").unwrap();
    for difference in list(&compared["differences"]) {
        assert!(difference["ratio"].as_f64().unwrap() >= 1.0, "nothing beats `best`: {difference}");
        assert_eq!(difference["pairs"], 4, "one for each cell, its seeds together");
    }
}

#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn settings_are_drawn_evenly_and_always_the_same() {
    let desk = Desk::new();
    write(
        &desk,
        "drawn.toml",
        r#"
problems = ["coarse.toml"]
set = ["sweep.step_deg=20", "selection.criterion=d"]
[[factors]]
key = "noise.sigma_px"
log_uniform = [0.1, 1.0]
[[factors]]
key = "camera.fx_px"
normal = { mean = 1000, sigma = 10 }
round_to = 1
[[factors]]
key = "simulate.joint_noise_deg"
values = [0, 0.5]
[design]
kind = "sampled"
draws = 32
[simulate]
trials = 2
[output]
folder = "drawn"
"#,
    );
    desk.stdout("study run drawn.toml --quiet");
    let rows = rows(&desk.path("drawn/results.csv"));
    assert_eq!(rows.len(), 32);
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    // Of a Sobol sequence every half holds half of the points.
    let low = rows.iter().filter(|row| number(row, "noise.sigma_px") < 0.1f64.sqrt()).count();
    assert_eq!(low, 16);
    assert!(rows.iter().all(|row| number(row, "camera.fx_px").fract() == 0.0));
    let mean = rows.iter().map(|row| number(row, "camera.fx_px")).sum::<f64>() / 32.0;
    assert!((mean - 1000.0).abs() < 2.0, "{mean}");
    assert!(rows.iter().all(|row| row["trials"] == "2"));
    assert_eq!(rows.iter().filter(|row| row["simulate.joint_noise_deg"] == "0").count(), 16);
    let first = std::fs::read(desk.path("drawn/results.csv")).unwrap();
    desk.stdout("study run drawn.toml -o again --threads 1 --quiet");
    assert!(std::fs::read(desk.path("again/results.csv")).unwrap() == first);
    // A factor cannot be called as any other column is.
    let factors = ["noise.sigma_px", "camera.fx_px", "simulate.joint_noise_deg"];
    let own: Vec<&String> = rows[0].keys().filter(|column| !factors.contains(&column.as_str())).collect();
    assert!(own.len() > 23, "{own:?}");
    for name in own {
        write(&desk, "named.toml", &STUDY.replace("name = \"tilt\"", &format!("name = \"{name}\"")));
        let told = desk.complaint("study check named.toml", 3);
        assert!(told.contains("which is used already"), "{told}");
    }
}

/// Keys are added to the file's target, or stand in the place of all of them.
#[test]
fn the_kind_of_the_target_is_a_factor() {
    let desk = Desk::new();
    let pose = "pose = { position_mm = [232.875, 72.75, -98] }";
    let charuco = ["kind=charuco", "columns=9", "rows=7", "marker_mm=26", "dictionary=DICT_5X5_50"];
    let charuco = charuco.map(|key| format!("target.{key}"));
    let tags =
        format!("target={{ kind = 'aprilgrid', columns = 5, rows = 4, tag_mm = 44, tag_spacing = 0.3, {pose} }}");
    let circles =
        format!("target={{ kind = 'circles', columns = 8, rows = 6, spacing_mm = 35, diameter_mm = 20, {pose} }}");
    let levels =
        [("checkerboard", vec![]), ("ChArUco", charuco.to_vec()), ("tags", vec![tags]), ("circles", vec![circles])];
    let listed: Vec<String> =
        levels.iter().map(|(name, set)| format!("{{ name = \"{name}\", set = {set:?} }}")).collect();
    let study = format!(
        "problems = [\"coarse.toml\"]\nset = [\"target.zone={{}}\"]\n[[factors]]\nname = \"board\"\nlevels = [{}]\n\
         [choose]\nmethods = [\"greedy\"]\ncounts = [8]\n",
        listed.join(", ")
    );
    write(&desk, "kinds.toml", &study);
    desk.stdout("study run kinds.toml -o kinds --quiet");
    let rows = rows(&desk.path("kinds/results.csv"));
    assert_eq!(rows.len(), levels.len());
    for (row, (name, set)) in rows.iter().zip(&levels) {
        assert_eq!(row["board"], *name);
        let overrides = set.iter().fold(Overrides::new(), |overrides, key| overrides.set(key).unwrap());
        let overrides = overrides.set("target.zone={}").unwrap();
        let problem = Problem::read_with(&desk.path("coarse.toml"), &overrides).unwrap();
        let survey = survey(&problem, &|_| {}).unwrap();
        assert_eq!(row["views"], survey.views.len().to_string(), "{name}");
        let chosen = Chooser::new(&problem, &survey).unwrap().choose(Method::Greedy, 8, 0).unwrap();
        assert_eq!(row["map_error_px"].parse::<f64>().unwrap(), chosen.map_error, "{name}");
    }
}

#[test]
fn paired_levels_go_together_and_a_request_for_the_fewest_is_a_row() {
    let desk = Desk::new();
    write(
        &desk,
        "paired.toml",
        r#"
problems = ["coarse.toml"]
set = ["sweep.step_deg=20", "estimate.intrinsics=[\"fx\", \"fy\", \"cx\", \"cy\"]"]
outcomes = ["poses", "map_error_px"]
[design]
kind = "paired"
[[factors]]
key = "noise.sigma_px"
values = [0.1, 0.3]
[[factors]]
key = "selection.accuracy.map_error_px"
range = { from = 0.5, to = 1.5, count = 2 }
"#,
    );
    desk.stdout("study run paired.toml -o out --quiet");
    let rows = rows(&desk.path("out/results.csv"));
    assert_eq!(rows.len(), 2);
    for (row, (sigma, accuracy)) in rows.iter().zip([("0.1", 0.5), ("0.3", 1.5)]) {
        assert_eq!(row["noise.sigma_px"], sigma);
        assert_eq!(row["method"], "fewest");
        assert!(row["map_error_px"].parse::<f64>().unwrap() <= accuracy);
    }
}

#[test]
fn a_study_is_checked_before_it_runs() {
    let desk = desk();
    let told = desk.prose("check small.toml");
    assert!(told.contains("Small: valid. 4 cells of 2 factors on Servosila Engineer, 40 rows."), "{told}");
    assert!(told.contains("A run would take about"), "{told}");
    assert_eq!(desk.json("study check small.toml --json")["surveys"], 4);
    assert!(!desk.path("studies").exists(), "a check writes nothing");
    desk.complaint("study cell small.toml 4", 2);
    desk.complaint("study cell small.toml --shard 2/2", 2);
    desk.complaint("study cell small.toml", 2);
}

#[test]
fn what_is_wrong_with_a_study_is_told_under_its_line() {
    let desk = desk();
    let wrong = |from: &str, to: &str| {
        assert!(STUDY.contains(from), "{from}");
        write(&desk, "wrong.toml", &STUDY.replace(from, to));
        let told = desk.complaint("study run wrong.toml -o out", 3);
        assert!(!desk.path("out").exists());
        told
    };
    let cases = [
        ("noise.sigma_px", "noise.sigma", "there is no key `noise.sigma`", "did you mean `sigma_px`"),
        ("values = [0.3, 0.6]", "values = []", "`factors[0].values` is empty", "must not be empty"),
        ("values = [0.3, 0.6]", "values = [0.3, 0.3]", "`factors[0].values` is \"0.3\", which is used already", "once"),
        ("values = [0.3, 0.6]", "values = [0.3, -1]", "`factors[0].values[1]`: `noise.sigma_px` is -1", "refused by"),
        ("values = [0.3, 0.6]", "range = { from = 1, to = 0, step = 0.1 }", "runs from 1 down to 0", "[min, max]"),
        ("values = [0.3, 0.6]", "range = { from = 0, to = 1 }", "`factors[0].range.step` is missing", "`count`"),
        ("values = [0.3, 0.6]", "uniform = [0.1, 1]", "does not apply to a design that is not sampled", "draws"),
        ("values = [0.3, 0.6]", "", "`factors[0].values` is missing", "`log_uniform`"),
        ("values = [0.3, 0.6]", "range = { from = 0, to = 1, count = 2000000 }", "is 2000000", "from 1 to 100000"),
        ("max_tilt_deg=60", "max_tilt=60", "there is no key `visibility.max_tilt`", "did you mean"),
        ("max_tilt_deg=60", "max_tilt_deg", "is not KEY=VALUE", "refused by"),
        ("coarse.toml", "none.toml", "No such file", "relative to the folder of this file"),
        ("sweep.step_deg=20", "sweep.step_deg=-20", "`set[0]`: `sweep.step_deg` is -20", "refused by"),
        ("sweep.step_deg=20", "selection.off_grid=true", "`selection.off_grid` is true", "leave it out"),
        ("\"greedy\"", "\"gredy\"", "`choose.methods[1]` is \"gredy\"", "did you mean `greedy`"),
        ("\"greedy\"", "\"best\"", "`choose.methods[1]` is \"best\", which is used already", "once"),
        ("counts = [6, 9]", "counts = [0]", "`choose.counts[0]` is 0", "from 1 to"),
        ("name = \"tilt\"", "name = \"method\"", "`factors[1].name` is \"method\"", "only once"),
        ("name = \"Small\"", "outcome = [\"sigma_fx\"]", "there is no key `outcome`", "did you mean `outcomes`"),
        ("[choose]", "[design]\nkind = \"sampled\"\n[choose]", "`design.draws` is missing", "Settings of a sampled"),
        ("problems = [\"coarse.toml\"]", "", "`problems` is missing", "add it here"),
    ];
    for (from, to, what, hint) in cases {
        let told = wrong(from, to);
        assert!(told.contains(what) && told.contains(hint), "{to}: {told}");
        assert!(told.contains("wrong.toml:"), "with its line: {told}");
    }
    let name = STUDY.replace("name = \"Small\"", "name = \"Small\"\noutcomes = [\"sigma_gx\"]");
    write(&desk, "wrong.toml", &name);
    let told = desk.complaint("study run wrong.toml", 3);
    assert!(told.contains("did you mean `sigma_") && told.contains("`simulated_map_error_px`"), "{told}");
    // A thousand millions.
    let range = "range = { from = 0.1, to = 1, count = 1000 }";
    let factor = |key: &str| format!("[[factors]]\nkey = \"{key}\"\n{range}\n");
    let many = ["noise.sigma_px", "camera.distortion.k1", "camera.distortion.k2"].map(factor).concat();
    write(&desk, "wrong.toml", &format!("problems = [\"coarse.toml\"]\n{many}"));
    let told = desk.complaint("check wrong.toml", 3);
    assert!(told.contains("`factors` makes 1.0e9 cells") && told.contains("at most 1000000"), "{told}");
    // What is wrong with a base problem is told of it.
    desk.change("typo.toml", &[("width_px", "widht_px")]);
    write(&desk, "wrong.toml", &STUDY.replace("coarse.toml", "typo.toml"));
    let told = desk.complaint("study run wrong.toml", 3);
    assert!(told.contains("widht_px") && told.contains("typo.toml:"), "{told}");
}
