//! Every method side by side.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::plan::choose::{Choice, Chooser, PlanError};
use crate::plan::document::{
    ComparisonDocument, ComparisonEquivalent, ComparisonRow, Document, MeasuredRow, ProblemReference, finite,
};
use crate::problem::{Method, Problem};
use crate::verification::MonteCarlo;

/// One method at one number of poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The method.
    pub method: Method,
    /// The choice; of a method that depends on a seed, the one with the median map error.
    pub choice: Choice,
    /// Share of the best possible information that the choice has at least.
    pub efficiency: f64,
    /// Time to choose, the median over the seeds.
    pub time: Duration,
}

/// What [`compare`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// For each number of poses, one row per method, in the order given.
    pub rows: Vec<Row>,
    /// Seeds tried by methods that depend on one.
    pub seeds: usize,
}

/// How many k-means poses do what a plan does.
#[derive(Debug, Clone, PartialEq)]
pub struct Equivalent {
    /// The clustering.
    pub method: Method,
    /// Least number found, to a twentieth, whose median map error is no larger than the plan's; `None` if none was within
    /// the limit.
    pub poses: Option<usize>,
    /// The greatest number tried.
    pub tried: usize,
}

impl Comparison {
    /// What is written of the rows, what simulated calibrations of each came to if there were any, and the numbers of poses
    /// whose plans k-means was to equal.
    pub fn document(
        &self,
        problem: &Problem,
        chooser: &Chooser,
        measured: &[Option<MonteCarlo>],
        equivalents: &[(usize, Equivalent)],
    ) -> ComparisonDocument {
        let names = problem.unknowns().names();
        let row = |(row, measured): (&Row, &Option<MonteCarlo>)| ComparisonRow {
            method: row.method.name().into(),
            count: row.choice.selected.len(),
            value: finite(chooser.natural(row.choice.log_value)),
            map_error_px: finite(row.choice.map_error),
            sigma: names.iter().map(ToString::to_string).zip(row.choice.sigma.iter().copied()).collect(),
            measured: measured.as_ref().map(|found| MeasuredRow {
                trials: found.count,
                failed: found.failures.len(),
                map_error_px: finite(found.map_error.measured),
                sigma: found.parameters.iter().map(|p| (p.name.into(), finite(p.sampled_sigma))).collect(),
            }),
            efficiency: finite(row.efficiency),
            seconds: row.time.as_secs_f64(),
        };
        let equivalent = |(count, equivalent): &(usize, Equivalent)| ComparisonEquivalent {
            count: *count,
            method: equivalent.method.name().into(),
            equivalent_count: equivalent.poses,
            tried: equivalent.tried,
        };
        ComparisonDocument {
            header: ComparisonDocument::header(),
            problem: ProblemReference::new(problem),
            criterion: chooser.criterion(),
            rows: self.rows.iter().zip(measured).map(row).collect(),
            equivalents: equivalents.iter().map(equivalent).collect(),
        }
    }
}

/// Chooses by every method at every number of poses; methods that depend on a seed run `seeds` times from `seed` on.
/// `observe` is called after each row.
///
/// # Errors
/// When a choice fails.
pub fn compare(
    chooser: &Chooser,
    methods: &[Method],
    counts: &[usize],
    seed: u64,
    seeds: usize,
    observe: &mut dyn FnMut(),
) -> Result<Comparison, PlanError> {
    let mut rows = Vec::new();
    for &count in counts {
        let certificate = chooser.certificate(count)?;
        for &method in methods {
            let runs = if method.is_seeded() { seeds } else { 1 };
            let (choice, time) = median_choice(chooser, method, count, seed, runs)?;
            let efficiency = certificate.efficiency(choice.log_value);
            rows.push(Row { method, choice, efficiency, time });
            observe();
        }
    }
    Ok(Comparison { rows, seeds })
}

/// How many poses clustered by `method` have a median map error of at most `map_error`: grows the number from `start` by
/// half at a time, up to `limit`, then halves the interval down to a twentieth.
///
/// # Errors
/// When a clustering fails.
pub fn equivalent_kmeans(
    chooser: &Chooser,
    method: Method,
    map_error: f64,
    start: usize,
    limit: usize,
    seed: u64,
    seeds: usize,
) -> Result<Equivalent, PlanError> {
    let suffices = |count: usize| -> Result<bool, PlanError> {
        Ok(median_choice(chooser, method, count, seed, seeds)?.0.map_error <= map_error)
    };
    let (mut short, mut enough) = (0, start.min(limit));
    while !suffices(enough)? {
        if enough == limit {
            return Ok(Equivalent { method, poses: None, tried: limit });
        }
        short = enough;
        enough = (enough + enough.div_ceil(2)).min(limit);
    }
    while enough - short > (enough / 20).max(1) {
        let middle = usize::midpoint(short, enough);
        if suffices(middle)? { enough = middle } else { short = middle }
    }
    Ok(Equivalent { method, poses: Some(enough), tried: enough })
}

pub(super) fn median_choice(
    chooser: &Chooser,
    method: Method,
    count: usize,
    seed: u64,
    runs: usize,
) -> Result<(Choice, Duration), PlanError> {
    let mut choices = (0..runs as u64)
        .into_par_iter()
        .map(|run| {
            let start = Instant::now();
            Ok((chooser.choose(method, count, seed.wrapping_add(run))?, start.elapsed()))
        })
        .collect::<Result<Vec<_>, PlanError>>()?;
    let mut times: Vec<Duration> = choices.iter().map(|(_, time)| *time).collect();
    times.sort_unstable();
    choices.sort_by(|a, b| a.0.map_error.total_cmp(&b.0.map_error));
    let middle = (choices.len() - 1) / 2;
    Ok((choices.swap_remove(middle).0, times[middle]))
}
