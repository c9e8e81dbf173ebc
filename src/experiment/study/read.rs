//! From a study file to a checked study.

use std::path::Path;
use std::sync::LazyLock;

use serde_json::Value;

use super::table::StudyTable;
use super::{Choices, Layout, Simulation, Study, is_of_simulation};
use crate::experiment::base::{Base, Refusal, SettingFault};
use crate::experiment::factor::{Factor, MOST_FACTORS, factor, try_levels};
use crate::experiment::file::{self, DesignKind, Simulate, StudyFile};
use crate::experiment::reading::{ExperimentFile, Stated, read_experiment};
use crate::problem::{Allowed, At, Check, Named, Problem, ProblemError, Reason, Vocabulary, key, toml_schema};

/// Cells of a study; each takes milliseconds at least.
const MOST_CELLS: usize = 1_000_000;

/// The JSON Schema of study files.
pub(super) fn schema_json() -> Value {
    toml_schema::<StudyFile>()
}

impl ExperimentFile for StudyFile {
    const FOLDERS: &str = "studies";

    fn common<'f>(file: &At<'f, Self>) -> [At<'f, Option<String>>; 2] {
        [key!(file, name), key!(file, output.folder)]
    }
}

/// The study that the file at `path` states.
pub(super) fn read(path: &Path) -> Result<Study, ProblemError> {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_json);
    read_experiment(path, Vocabulary::new(&SCHEMA), |check, file: &At<StudyFile>, stated, folder| {
        let bases = bases(check, file, folder)?;
        Ok(study(check, file, stated, bases))
    })
}

/// The base problems as they are without the study; what is wrong with one of them is told as of itself.
fn bases(check: &mut Check, file: &At<StudyFile>, folder: &Path) -> Result<Vec<Base>, ProblemError> {
    let problems = key!(file, problems);
    if problems.value.is_empty() {
        check.fault(&problems.path, Reason::Empty);
    }
    let mut bases: Vec<Base> = Vec::new();
    for problem in problems.elements() {
        if let Some(base) = Base::read(check, &problem, folder)? {
            if bases.iter().any(|other| other.name == base.name) {
                check.fault(&problem.path, Reason::Duplicate { name: base.name.clone() });
            }
            bases.push(base);
        }
    }
    Ok(bases)
}

fn study(check: &mut Check, file: &At<StudyFile>, stated: Stated, bases: Vec<Base>) -> Option<Study> {
    let Stated { name, sha256, output } = stated;
    let sampled = file.value.design.kind.0 == DesignKind::Sampled;
    let stated = key!(file, factors);
    let found: Vec<Option<Factor>> = stated.elements().map(|stated| factor(check, &stated, sampled)).collect();
    let layout = layout(check, &key!(file, design));
    let choices = choices(check, &key!(file, choose));
    let simulation = simulation(check, &key!(file, simulate));
    // Without all factors nothing more can be said.
    let factors: Vec<Factor> = found.into_iter().collect::<Option<_>>()?;
    names(check, &stated, &factors);
    if layout? == Layout::Paired {
        paired(check, &stated, &factors);
    }
    let set = file.value.set.clone();
    let study =
        Study { name, sha256, factors, outcomes: Vec::new(), output, bases, set, layout: layout?, choices, simulation };
    size(check, &stated, &study);
    if !check.faults.is_empty() {
        return None;
    }
    let problems = tried(check, file, &study);
    let outcomes = outcomes(check, &key!(file, outcomes), &problems, &study);
    Some(Study { outcomes, ..study })
}

fn layout(check: &mut Check, design: &At<file::Design>) -> Option<Layout> {
    let draws = key!(design, draws);
    let kind = design.value.kind.0;
    if kind != DesignKind::Sampled {
        check.refused(&[&draws], "a design that is not sampled", "give `kind = \"sampled\"`");
        return Some(if kind == DesignKind::Full { Layout::Full } else { Layout::Paired });
    }
    let draws = check.required(draws, &[])?;
    check.count(&draws, Allowed::between(1.0, MOST_CELLS as f64));
    Some(Layout::Sampled { draws: *draws.value, sequence: design.value.sequence.0, seed: design.value.seed })
}

fn choices(check: &mut Check, choose: &At<file::Choose>) -> Choices {
    let seeds = key!(choose, seeds).given();
    let counts = key!(choose, counts);
    let mut poses = Vec::with_capacity(counts.value.len());
    for count in counts.elements() {
        poses.push(check.count(&count, Allowed::between(1.0, 1e6)));
    }
    once(check, &counts, ToString::to_string);
    once(check, &key!(choose, methods), |Named(method)| method.name().to_owned());
    once(check, &key!(choose, criteria), |Named(criterion)| criterion.name().to_owned());
    let names = choose.value;
    Choices {
        methods: names.methods.iter().map(|method| method.0).collect(),
        criteria: names.criteria.iter().map(|criterion| criterion.0).collect(),
        counts: poses,
        seeds: seeds.map_or(1, |seeds| check.count(&seeds, Allowed::between(1.0, 1000.0)) as u64),
    }
}

/// Refuses what a list has twice.
fn once<T>(check: &mut Check, list: &At<Vec<T>>, name: impl Fn(&T) -> String) {
    let names: Vec<String> = list.value.iter().map(name).collect();
    for (i, element) in list.elements().enumerate() {
        if names[..i].contains(&names[i]) {
            check.fault(&element.path, Reason::Duplicate { name: names[i].clone() });
        }
    }
}

fn names(check: &mut Check, stated: &At<Vec<file::Factor>>, factors: &[Factor]) {
    if factors.len() > MOST_FACTORS {
        let expected = format!("at most {MOST_FACTORS} factors");
        check.fault(&stated.path, Reason::Type { found: format!("a list of {}", factors.len()), expected });
    }
    for (i, (stated, factor)) in stated.elements().zip(factors).enumerate() {
        let taken = factors[..i].iter().any(|other| other.name == factor.name);
        if taken || StudyTable::has_own(&factor.name) {
            check.fault(&key!(stated, name).path, Reason::Duplicate { name: factor.name.clone() });
        }
    }
}

fn paired(check: &mut Check, stated: &At<Vec<file::Factor>>, factors: &[Factor]) {
    let levels = |factor: &Factor| factor.levels().map_or(0, <[_]>::len);
    let Some(expected) = factors.first().map(levels) else { return };
    for (stated, factor) in stated.elements().zip(factors) {
        if levels(factor) != expected {
            let found = levels(factor);
            check.fault(&stated.path, Reason::Length { found, expected, per: "level of the first factor" });
        }
    }
}

fn size(check: &mut Check, stated: &At<Vec<file::Factor>>, study: &Study) {
    // In floating point, where nothing overflows.
    let cells = match study.layout {
        Layout::Full => study.factors.iter().filter_map(Factor::levels).map(|levels| levels.len() as f64).product(),
        Layout::Paired | Layout::Sampled { .. } => study.settings() as f64,
    } * study.bases.len() as f64;
    if cells > MOST_CELLS as f64 {
        check.fault(&stated.path, Reason::TooManyCells { cells, most: MOST_CELLS });
    }
}

/// Tries every level by itself on every base, and gives the bases with what the study sets in all cells.
fn tried(check: &mut Check, file: &At<StudyFile>, study: &Study) -> Vec<Problem> {
    let mut problems = Vec::new();
    for base in &study.bases {
        match study.with(base, std::iter::empty()) {
            Ok(problem) => problems.push(problem),
            Err(fault) => base.refuse_set(check, &key!(file, set), &fault),
        }
    }
    if check.faults.is_empty() {
        try_levels(check, &key!(file, factors), &study.factors, &|set| {
            study.bases.iter().filter_map(|base| refused(study, base, set)).collect()
        });
    }
    problems
}

/// Why a base refuses a level.
fn refused(study: &Study, base: &Base, set: &[String]) -> Option<Refusal> {
    let mut simulation = study.simulation;
    for text in set.iter().filter(|text| is_of_simulation(text)) {
        if let Err(sentence) = simulation.set(text) {
            return Some(base.refusal(&SettingFault::Simulation(sentence)));
        }
    }
    study.with(base, set.iter()).err().map(|fault| base.refusal(&fault))
}

fn simulation(check: &mut Check, simulate: &At<Simulate>) -> Simulation {
    let trials = key!(simulate, trials);
    if *trials.value == 1 {
        let (found, expected) = ("1".to_owned(), "0 or at least 2: one trial has no scatter".to_owned());
        check.fault(&trials.path, Reason::Type { found, expected });
    }
    let mut deviations = simulate.value.stated();
    for (name, number, most) in deviations.numbers() {
        check.within(&simulate.path.key(name), *number, Allowed::between(0.0, most));
    }
    Simulation { trials: check.count(&trials, Simulation::TRIALS), deviations }
}

/// The columns to summarise.
fn outcomes(check: &mut Check, stated: &At<Vec<String>>, problems: &[Problem], study: &Study) -> Vec<String> {
    const NUMBERS: [&str; 8] =
        ["map_error_px", "simulated_map_error_px", "value", "bound", "efficiency", "poses", "views", "candidates"];
    if stated.value.is_empty() {
        let simulated = study.simulation.trials > 0
            || study.factors.iter().any(|factor| factor.key().is_some_and(is_of_simulation));
        return if simulated { NUMBERS[..2].to_vec() } else { NUMBERS[..1].to_vec() }
            .into_iter()
            .map(Into::into)
            .collect();
    }
    let mut allowed: Vec<String> = NUMBERS.map(String::from).into();
    for name in problems.iter().flat_map(|problem| problem.unknowns().names()) {
        let column = format!("sigma_{name}");
        if !allowed.contains(&column) {
            allowed.push(column);
        }
    }
    once(check, stated, Clone::clone);
    for outcome in stated.elements() {
        if !allowed.contains(outcome.value) {
            check.fault(&outcome.path, Reason::UnknownName { name: outcome.value.clone(), allowed: allowed.clone() });
        }
    }
    stated.value.clone()
}
