//! From a design file to a checked design.

use std::path::Path;
use std::sync::LazyLock;

use serde_json::Value;

use super::Codesign;
use crate::experiment::base::Base;
use crate::experiment::factor::{Factor, factor, try_levels};
use crate::experiment::file::{DesignFile, Search, Surface};
use crate::experiment::reading::{ExperimentFile, Stated, read_experiment};
use crate::problem::{Allowed, At, Check, Numbers, ProblemError, Reason, Vocabulary, key, toml_schema};

/// Coordinates in mm.
const COORDINATE: Allowed = Allowed::between(-1e6, 1e6);

/// What may be free at once: more cannot be searched by trying.
const MOST_FREE: usize = 20;

/// Sections of the problem file that say what is asked for, not what the set-up is.
const GOALS: [&str; 2] = ["selection", "estimate"];

/// The JSON Schema of design files.
pub(super) fn schema_json() -> Value {
    toml_schema::<DesignFile>()
}

impl ExperimentFile for DesignFile {
    const FOLDERS: &str = "designs";

    fn common<'f>(file: &At<'f, Self>) -> [At<'f, Option<String>>; 2] {
        [key!(file, name), key!(file, output.folder)]
    }
}

/// The design that the file at `path` states.
pub(super) fn read(path: &Path) -> Result<Codesign, ProblemError> {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_json);
    read_experiment(path, Vocabulary::new(&SCHEMA), |check, file: &At<DesignFile>, common, folder| {
        let base = Base::read(check, &key!(file, problem), folder)?;
        Ok(base.and_then(|base| codesign(check, file, common, base)))
    })
}

fn codesign(check: &mut Check, file: &At<DesignFile>, common: Stated, base: Base) -> Option<Codesign> {
    let Stated { name, sha256, output } = common;
    let stated = key!(file, free);
    if stated.value.is_empty() {
        check.fault(&stated.path, Reason::Empty);
    }
    if stated.value.len() > MOST_FREE {
        let found = format!("a list of {}", stated.value.len());
        check.fault(&stated.path, Reason::Type { found, expected: format!("a list of at most {MOST_FREE}") });
    }
    // Whatever has a distribution may be drawn from here.
    let free: Vec<Option<Factor>> = stated.elements().map(|stated| factor(check, &stated, true)).collect();
    let surface = key!(file, surface).given().map_or([None; 3], |surface| ranges(check, &surface));
    let search = searched(check, &key!(file, search));
    let free: Vec<Factor> = free.into_iter().collect::<Option<_>>()?;
    for (i, (stated, factor)) in stated.elements().zip(&free).enumerate() {
        if free[..i].iter().any(|other| other.name == factor.name) {
            check.fault(&key!(stated, name).path, Reason::Duplicate { name: factor.name.clone() });
        }
    }
    let set = key!(file, set);
    let problem = base.problem(set.value.iter());
    let problem = problem.map_err(|fault| base.refuse_set(check, &set, &fault)).ok()?;
    if problem.selection.goal.count().is_none() {
        let hint = Some("give a number of poses: set = [\"selection.count=10\"]".to_owned());
        let sentence =
            "set-ups are compared by plans of one size, and the problem asks for accuracies or a time".to_owned();
        check.fault(&key!(file, problem).path, Reason::InProblem { problem: base.path.clone(), sentence, hint });
    }
    if let Some((criterion, _)) = problem.selection.goal.criteria().iter().find(|(each, _)| !each.is_of_intrinsics()) {
        let hint = Some("set = [\"selection.criterion=v\"] compares them by the map error".to_owned());
        let sentence = format!(
            "set-ups cannot be compared by the criterion `{}`, which is relative to the views that each has",
            criterion.name()
        );
        check.fault(&key!(file, problem).path, Reason::InProblem { problem: base.path.clone(), sentence, hint });
    }
    for (stated, factor) in stated.elements().zip(&free) {
        // Values of other goals, or on other intrinsics, are not of one scale.
        let section =
            |text: &String| text.split(['.', '=']).next().map(|name| name.trim().trim_matches('"').to_owned());
        let is_of_goal = |text: &String| section(text).is_some_and(|section| GOALS.contains(&section.as_str()));
        if factor.samples().iter().flat_map(|level| &level.set).any(is_of_goal) {
            check.not_applicable(&stated.path, "the design of a set-up", "vary it in a study, `calipose study`");
        }
    }
    if !check.faults.is_empty() {
        return None;
    }
    try_levels(check, &stated, &free, &|settings| {
        let refused = base.problem(set.value.iter().chain(settings)).err();
        refused.map(|fault| base.refusal(&fault)).into_iter().collect()
    });
    let set = file.value.set.clone();
    Some(Codesign { name, sha256, free, problem, output, base, set, surface, search })
}

/// The ranges in m.
fn ranges(check: &mut Check, surface: &At<Surface>) -> [Option<[f64; 2]>; 3] {
    [key!(surface, x_mm), key!(surface, y_mm), key!(surface, z_mm)].map(|range: At<Option<Numbers<2>>>| {
        let range = range.given()?;
        Some(check.range(&range, COORDINATE).map(|mm| mm / 1e3))
    })
}

fn searched(check: &mut Check, search: &At<Search>) -> Search {
    check.count(&key!(search, screened), Allowed::between(1.0, 60_000.0));
    check.count(&key!(search, finalists), Allowed::between(1.0, 10_000.0));
    check.count(&key!(search, rounds), Allowed::between(0.0, 1000.0));
    check.count(&key!(search, map), Allowed::between(0.0, 100.0));
    search.value.clone()
}
