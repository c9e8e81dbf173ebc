//! What is found in a cell.

use std::ops::ControlFlow;
use std::time::Instant;

use rayon::prelude::*;

use super::{Choices, Simulation, Study};
use crate::experiment::stages::{Fingerprint, StageKeys, Stages};
use crate::information::Criterion;
use crate::plan::assess::verify;
use crate::plan::choose::{Choice, Chooser, PICKS, decide, refined_survey};
use crate::plan::document::{
    CellDocument, CellOutcome, CellRow, CellSeconds, Document, ProblemReference, SimulatedOutcome, finite,
};
use crate::plan::survey::Survey;
use crate::problem::{Goal, Method, Problem};
use crate::verification::Weighing;

/// A cell, ready to be computed.
pub(super) struct PreparedCell {
    pub(super) index: usize,
    /// Of all that its rows follow from.
    pub(super) fingerprint: String,
    /// The problem and what to simulate, or why there is none.
    pub(super) problem: Result<(Problem, Simulation), String>,
    /// What its survey follows from; none of a survey that no other cell can have.
    pub(super) stages: Option<StageKeys>,
}

impl PreparedCell {
    /// Cell number `index` of `study`.
    pub(super) fn new(study: &Study, index: usize) -> Self {
        let cell = study.cell(index);
        let problem = study.problem(&cell).and_then(|problem| Ok((problem, study.simulation(&cell)?)));
        let problem = problem.map_err(|fault| fault.reason());
        // What a survey is refined with depends on the selection, and so belongs to its cell alone.
        let shared = problem.as_ref().ok().filter(|(problem, _)| problem.refinement.rounds == 0);
        let stages = shared.map(|(problem, _)| StageKeys::of(problem));
        let version = (env!("CARGO_PKG_VERSION"), CellDocument::VERSION);
        let fingerprint = Fingerprint::of(&(version, &problem, &study.choices)).hex();
        Self { index, fingerprint, problem, stages }
    }

    /// Computes the cell's rows.
    pub(super) fn compute(&self, study: &Study, stages: &Stages) -> CellDocument {
        let start = Instant::now();
        let choices = &study.choices;
        let base = || ProblemReference {
            name: study.bases[study.cell(self.index).problem].name.clone(),
            sha256: String::new(),
            set: study.cell(self.index).levels.into_iter().flat_map(|level| level.set).collect(),
        };
        let mut seconds = CellSeconds::default();
        let (problem, rows) = match (&self.problem, &self.stages) {
            (Ok((problem, simulation)), Some(keys)) => {
                let survey = stages.survey(problem, keys);
                seconds.survey = start.elapsed().as_secs_f64();
                let survey = (*survey).as_ref().map_err(ToString::to_string);
                (ProblemReference::new(problem), rows(problem, survey, choices, simulation))
            }
            (Ok((problem, simulation)), None) => {
                let survey = refined_survey(problem, &|_| {});
                seconds.survey = start.elapsed().as_secs_f64();
                let survey = survey.as_ref().map_err(ToString::to_string);
                (ProblemReference::new(problem), rows(problem, survey, choices, simulation))
            }
            (Err(reason), _) => (base(), refused(reason, choices)),
        };
        seconds.rows = start.elapsed().as_secs_f64() - seconds.survey;
        CellDocument { header: CellDocument::header(), fingerprint: self.fingerprint.clone(), problem, rows, seconds }
    }
}

/// The rows of a cell that has no problem. What the problem would have said stands empty.
fn refused(reason: &str, choices: &Choices) -> Vec<CellRow> {
    fn or_none<T>(all: Vec<T>) -> Vec<Option<T>> {
        if all.is_empty() { vec![None] } else { all.into_iter().map(Some).collect() }
    }
    let criteria = or_none(choices.criteria.iter().map(|criterion| criterion.name()).collect());
    let methods = or_none(choices.methods.iter().map(|method| method.name()).collect());
    let mut rows = Vec::new();
    for criterion in criteria {
        for count in or_none(choices.counts.clone()) {
            for method in &methods {
                let criterion = criterion.unwrap_or_default().to_owned();
                rows.push(row(criterion, method.unwrap_or_default(), count, None, Err(reason.to_owned())));
            }
        }
    }
    rows
}

/// What each row is to choose.
struct Wanted {
    criteria: Vec<Vec<(Criterion, f64)>>,
    counts: Vec<usize>,
    methods: Vec<Method>,
}

impl Wanted {
    /// What the study asks for, and the problem where it does not; none of a problem that asks for no number of poses while the study
    /// asks for nothing else.
    fn of(choices: &Choices, goal: &Goal) -> Option<Self> {
        let own = choices.criteria.is_empty() && choices.counts.is_empty() && choices.methods.is_empty();
        if own && goal.count().is_none() {
            return None;
        }
        let criteria = match &choices.criteria[..] {
            [] => vec![goal.criteria().into_owned()],
            some => some.iter().map(|&criterion| vec![(criterion, 1.0)]).collect(),
        };
        let counts = match &choices.counts[..] {
            [] => vec![goal.count().unwrap_or(PICKS)],
            some => some.to_vec(),
        };
        let methods = if choices.methods.is_empty() { vec![goal.method()] } else { choices.methods.clone() };
        Some(Self { criteria, counts, methods })
    }
}

fn rows(
    problem: &Problem,
    survey: Result<&Survey, String>,
    choices: &Choices,
    simulation: &Simulation,
) -> Vec<CellRow> {
    let Some(wanted) = Wanted::of(choices, &problem.selection.goal) else {
        return vec![as_many_as_serve(problem, survey, simulation)];
    };
    let mut rows = Vec::new();
    for criteria in &wanted.criteria {
        let criterion = Criterion::describe(criteria);
        let chooser = survey.clone().and_then(|survey| {
            let chooser = Chooser::new(problem, survey).and_then(|chooser| chooser.by(criteria));
            chooser.map_err(|error| error.to_string())
        });
        for &count in &wanted.counts {
            let mut certified = Certified::default();
            for &method in &wanted.methods {
                let seeds = if method.is_seeded() { choices.seeds } else { 1 };
                let bounded = chooser.as_ref().map_err(Clone::clone).and_then(|chooser| {
                    certified.prepare(chooser, method, count)?;
                    Ok(chooser)
                });
                let of_seed = |run: u64| {
                    let seed = problem.selection.seed.wrapping_add(run);
                    let outcome = bounded.clone().and_then(|chooser| {
                        let (choice, log_bound) = certified.choose(chooser, method, count, seed)?;
                        Ok(outcome(chooser, &choice, log_bound, simulation, seed))
                    });
                    row(criterion.clone(), method.name(), Some(count), method.is_seeded().then_some(seed), outcome)
                };
                rows.par_extend((0..seeds).into_par_iter().map(of_seed));
            }
        }
    }
    rows
}

fn row(
    criterion: String,
    method: &str,
    count: Option<usize>,
    seed: Option<u64>,
    outcome: Result<CellOutcome, String>,
) -> CellRow {
    let (outcome, reason) = match outcome {
        Ok(outcome) => (Some(outcome), None),
        Err(reason) => (None, Some(reason)),
    };
    CellRow { criterion, method: method.to_owned(), count, seed, outcome, reason }
}

/// The bound on log Φ of sets of one size, which the methods share, and the sets found on the way to it. Errors are in words already:
/// several rows may tell them.
#[derive(Default)]
struct Certified {
    best: Option<(Choice, f64)>,
    exact: Option<(Choice, f64)>,
    bound: Option<f64>,
}

impl Certified {
    /// Finds what choices by `method` need.
    fn prepare(&mut self, chooser: &Chooser, method: Method, count: usize) -> Result<(), String> {
        let seed = chooser.problem().selection.seed;
        match method {
            Method::Best if self.best.is_none() => {
                let (choice, certificate) = chooser.best(count, seed).map_err(|error| error.to_string())?;
                self.bound.get_or_insert(certificate.log_bound);
                self.best = Some((choice, certificate.log_bound));
            }
            Method::Exact if self.exact.is_none() => {
                // A limit on time would make results depend on the machine; that on nodes holds.
                let found = chooser.exact(count, seed, &mut |_| ControlFlow::Continue(()));
                let (choice, _, search) = found.map_err(|error| error.to_string())?;
                self.exact = Some((choice, search.log_bound));
            }
            _ if self.bound.is_none() => {
                let certificate = chooser.certificate(count).map_err(|error| error.to_string())?;
                self.bound = Some(certificate.log_bound);
            }
            _ => {}
        }
        Ok(())
    }

    /// A choice and the bound, which was prepared for.
    fn choose(&self, chooser: &Chooser, method: Method, count: usize, seed: u64) -> Result<(Choice, f64), String> {
        let known = match method {
            Method::Best => &self.best,
            Method::Exact => &self.exact,
            _ => &None,
        };
        if let Some(known) = known {
            return Ok(known.clone());
        }
        let choice = chooser.choose(method, count, seed).map_err(|error| error.to_string())?;
        Ok((choice, self.bound.unwrap_or(f64::INFINITY)))
    }
}

/// The poses that the problem asks for by accuracies or a time.
fn as_many_as_serve(problem: &Problem, survey: Result<&Survey, String>, simulation: &Simulation) -> CellRow {
    let found = survey.and_then(|survey| {
        let chooser = Chooser::new(problem, survey).map_err(|error| error.to_string())?;
        // Ended by its nodes alone, as the exact search.
        let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).map_err(|error| error.to_string())?;
        Ok(outcome(&chooser, &decision.choice, decision.log_bound, simulation, problem.selection.seed))
    });
    let method = if problem.selection.goal.proves_fewest() { "fewest" } else { "timed" };
    row(problem.selection.goal.to_string(), method, None, None, found)
}

fn outcome(chooser: &Chooser, choice: &Choice, log_bound: f64, simulation: &Simulation, seed: u64) -> CellOutcome {
    let (problem, survey) = (chooser.problem(), chooser.survey());
    let names = problem.unknowns().names();
    CellOutcome {
        configurations: survey.sweep.swept + survey.refined,
        candidates: survey.sweep.candidates.len(),
        views: survey.views.len(),
        poses: choice.selected.len(),
        value: finite(chooser.natural(choice.log_value)),
        bound: finite(chooser.natural(log_bound)),
        efficiency: finite((choice.log_value - log_bound).exp()),
        map_error_px: finite(choice.map_error),
        sigma: names.into_iter().map(String::from).zip(choice.sigma.iter().copied()).collect(),
        simulated: simulated(problem, survey, choice, simulation, seed),
    }
}

fn simulated(
    problem: &Problem,
    survey: &Survey,
    choice: &Choice,
    simulation: &Simulation,
    seed: u64,
) -> Option<SimulatedOutcome> {
    let Simulation { trials, deviations } = simulation;
    if *trials == 0 {
        return None;
    }
    let configurations: Vec<Vec<f64>> = choice.selected.iter().map(|&i| survey.views[i].q.clone()).collect();
    // Nothing is predicted for a choice that leaves an intrinsic undetermined, and nothing simulated.
    let found =
        verify(problem, &configurations, &deviations.disturbance(), Weighing::default(), *trials, seed, &|_| {})
            .ok()?;
    Some(SimulatedOutcome {
        trials: found.count,
        failed: found.failures.len(),
        map_error_px: finite(found.map_error.measured),
        standard_error_px: finite(found.map_error.standard_error),
    })
}
