//! Values given in place of the problem file's are merged before anything is checked: every key can be given, and the same
//! mistake is told in the same words wherever it was made.

use std::path::Path;

use crate::desk::Desk;
use calipose::problem::{Overrides, Problem, ProblemError};

const FILE: &str = "problems/servosila-engineer-bodies.toml";

fn overrides(texts: &[&str]) -> Overrides {
    texts.iter().fold(Overrides::new(), |overrides, text| overrides.set(text).unwrap())
}

fn with(texts: &[&str]) -> Result<Problem, ProblemError> {
    Problem::read_with(Path::new(FILE), &overrides(texts))
}

/// What is wrong, each fault by its sentence.
fn sentences(result: Result<Problem, ProblemError>) -> Vec<String> {
    result.unwrap_err().faults().iter().map(ToString::to_string).collect()
}

/// The paths of all values below `value`, lists of numbers taken whole and by element.
fn leaves(path: &str, value: &toml::Value, found: &mut Vec<(String, toml::Value)>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(key, value)| leaves(&below(key), value, found)),
        toml::Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, value)| leaves(&format!("{path}[{i}]"), value, found));
        }
        _ => {}
    }
    if !path.is_empty() {
        found.push((path.to_owned(), value.clone()));
    }
}

#[test]
fn every_key_of_the_file_can_be_given_by_its_path() {
    let text = std::fs::read_to_string(FILE).unwrap();
    let root: toml::Value = toml::from_str(&text).unwrap();
    let mut found = Vec::new();
    leaves("", &root, &mut found);
    assert!(found.len() > 150, "{}", found.len());
    let plain = Problem::read(Path::new(FILE)).unwrap();
    for (path, value) in &found {
        let line = format!("{path} = {}", value.to_string().replace('\n', " "));
        let given = Overrides::new().set(&line).unwrap();
        let problem = Problem::read_with(Path::new(FILE), &given).unwrap_or_else(|error| panic!("{line}: {error}"));
        // What says the same as the file is no other value.
        assert_eq!(problem, plain, "{line}");
    }
    // The same at once.
    let lines: Vec<String> = found.iter().map(|(path, value)| format!("{path} = {value}")).collect();
    let all = overrides(&lines.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(Problem::read_with(Path::new(FILE), &all).unwrap(), plain);
}

#[test]
fn the_same_mistake_is_told_in_the_same_words_wherever_it_was_made() {
    let text = std::fs::read_to_string(FILE).unwrap();
    for (from, to, given) in [
        ("fx_px = 1000", "fx_px = 0", "camera.fx_px=0"),
        ("criterion = \"v\"", "criterion = \"w\"", "selection.criterion=w"),
        ("count = 10", "count = 0", "selection.count=0"),
        ("count = 10", "count = 1.5", "selection.count=1.5"),
        ("count = 10", "counts = 10", "selection.counts=10"),
        ("model = \"brown-conrady\"", "model = \"fisheye\"", "camera.distortion.model=fisheye"),
    ] {
        assert!(text.contains(from), "{from}");
        let in_file = sentences(Problem::parse(&text.replace(from, to), Path::new(FILE)));
        let refused = with(&[given]);
        let fault = refused.as_ref().unwrap_err().faults()[0].clone();
        assert_eq!(sentences(refused), in_file, "{given}");
        let line = fault.given.unwrap();
        assert!(line.starts_with(given.split('=').next().unwrap()), "{line}");
        assert!(line.get(fault.span).is_some_and(|at| !at.is_empty()) && fault.line == 1);
    }
}

#[test]
fn paths_that_lead_nowhere_are_refused_with_the_place() {
    for (given, expected) in [
        ("camra.fx_px=900", "there is no key `camra`"),
        ("camera.fx=900", "there is no key `camera.fx`"),
        ("camera.fx_px.x=900", "neither a section nor a list"),
        ("robot.joints[9].a_mm=1", "element 9 of a list that has 4"),
        ("robot.joints.a_mm=1", "name an element first"),
        ("camera[0]=1", "asks for an element of a value that is not a list"),
    ] {
        let told = sentences(with(&[given]));
        assert!(told.len() == 1 && told[0].contains(expected), "{given}: {told:?}");
    }
    let hint = miette::Diagnostic::help(&with(&["camra.fx_px=900"]).unwrap_err().faults()[0]).unwrap().to_string();
    assert!(hint.contains("did you mean `camera`"), "{hint}");
}

#[test]
fn what_is_given_takes_the_place_of_what_it_excludes() {
    let plain = Problem::read(Path::new(FILE)).unwrap();
    assert_eq!(with(&["sweep.sample=5000"]).unwrap().space.len(), 5000);
    let fewest = with(&["selection.accuracy={ map_error_px = 2 }"]).unwrap();
    assert_eq!(fewest.selection.goal.accuracies().len(), 1);
    // Both given is one too many.
    let told = sentences(with(&["selection.accuracy={ map_error_px = 2 }", "selection.count=12"]));
    assert_eq!(told, ["`selection.count` and `selection.accuracy` exclude each other"]);
    let back =
        with(&["selection.accuracy={ map_error_px = 2 }", "selection.criterion=v", "selection.count=10"]).unwrap();
    assert_eq!(back.selection.goal, plain.selection.goal);
}

#[test]
fn plans_remember_what_was_given() {
    let desk = Desk::new();
    desk.stdout("plan coarse.toml --trials 0 -o out --set camera.fx_px=900 --set camera.fy_px=900 -k 8 --criterion d");
    let plan: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(desk.path("out/plan.json")).unwrap()).unwrap();
    assert_eq!(plan["problem"]["set"][0], "camera.fx_px = 900");
    assert_eq!(plan["intrinsics"]["nominal"][0], 900.0);
    assert_eq!((plan["criterion"].as_str(), plan["count"].as_u64()), (Some("d"), Some(8)));
    assert!(desk.stdout("certify out/plan.json").contains("the certificate holds"));
    // Another value is another problem.
    let text = std::fs::read_to_string(desk.path("out/plan.json")).unwrap();
    std::fs::write(desk.path("out/plan.json"), text.replace("fx_px = 900", "fx_px = 901")).unwrap();
    assert!(!desk.complaint("certify out/plan.json", 1).is_empty());
    let refused = desk.complaint("check coarse.toml --set camera.fx_px", 2);
    assert!(refused.contains("is not KEY=VALUE"), "{refused}");
    let refused = desk.complaint("check coarse.toml --set camera.fx_px=-1", 3);
    assert!(refused.contains("`camera.fx_px` is -1"), "{refused}");
}
