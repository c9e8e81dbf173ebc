//! Every method side by side.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::plan::choose::{Choice, Chooser, KMeans, PlanError, leave_grid};
use crate::plan::document::{
    ComparisonDocument, ComparisonEquivalent, ComparisonRow, Document, MeasuredRow, ProblemReference, finite,
};
use crate::plan::survey::Survey;
use crate::problem::{Goal, Method, Problem};
use crate::verification::MonteCarlo;

/// One method at one number of poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The method.
    pub method: Method,
    /// Whether the poses could leave the grid.
    pub off_grid: bool,
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

impl Row {
    /// What it is called: the method, and whether it could leave the grid.
    pub fn name(&self) -> String {
        if self.off_grid { format!("{}-off-grid", self.method.name()) } else { self.method.name().into() }
    }
}

/// The best poses that may leave the grid, with the views that they are among.
#[derive(Debug, Clone, PartialEq)]
pub struct BestOffGrid {
    /// The swept views, and those found off the grid.
    pub survey: Survey,
    /// The choice.
    pub row: Row,
}

/// The best `count` poses that may leave the grid of `swept`, the views of `problem`. By criteria: accuracies would set the count.
///
/// # Errors
/// As [`Chooser::best`].
pub fn best_off_grid(problem: &Problem, swept: &Survey, count: usize) -> Result<BestOffGrid, PlanError> {
    let start = Instant::now();
    let criteria = problem.selection.goal.criteria().into_owned();
    let mut problem = problem.clone();
    problem.selection.goal = Goal::Best { criteria, count, method: Method::Best };
    let survey = leave_grid(&problem, swept.clone(), count)?;
    let (choice, certificate) = Chooser::new(&problem, &survey)?.best(count, problem.selection.seed)?;
    let efficiency = certificate.efficiency(choice.log_value);
    let row = Row { method: Method::Best, off_grid: true, choice, efficiency, time: start.elapsed() };
    Ok(BestOffGrid { survey, row })
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
            method: row.name(),
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
            rows.push(Row { method, off_grid: false, choice, efficiency, time });
            observe();
        }
    }
    Ok(Comparison { rows, seeds })
}

/// How many poses clustered by `method` do what plans do, of which `plans` has the numbers of poses and the map errors: the least
/// number found whose median map error is at most the plan's. The search grows the number from the plan's by half at a time, up to
/// `limit`, then halves the interval down to a twentieth. `observe` is called after each plan. A method that does not cluster
/// equals none.
///
/// # Errors
/// When a clustering fails.
pub fn equivalent_kmeans(
    chooser: &Chooser,
    method: Method,
    plans: &[(usize, f64)],
    limit: usize,
    seed: u64,
    seeds: usize,
    observe: &mut dyn FnMut(),
) -> Result<Vec<Equivalent>, PlanError> {
    let features = chooser.features(method)?.unwrap_or_default();
    let limit = limit.min(features.len());
    let runs = (0..seeds.max(1) as u64).map(|run| KMeans::new(&features, seed.wrapping_add(run))).collect();
    let mut medians = Medians { chooser, runs, map_errors: BTreeMap::new() };
    let mut equivalent = |&(start, map_error): &(usize, f64)| -> Result<Equivalent, PlanError> {
        let (mut short, mut enough) = (0, start.min(limit));
        while limit == 0 || !medians.suffices(enough, map_error)? {
            if enough == limit {
                return Ok(Equivalent { method, poses: None, tried: limit });
            }
            short = enough;
            enough = (enough + enough.div_ceil(2)).min(limit);
        }
        while enough - short > (enough / 20).max(1) {
            let middle = usize::midpoint(short, enough);
            if medians.suffices(middle, map_error)? { enough = middle } else { short = middle }
        }
        Ok(Equivalent { method, poses: Some(enough), tried: enough })
    };
    let one = |plan| {
        let found = equivalent(plan);
        observe();
        found
    };
    plans.iter().map(one).collect()
}

/// Median map errors of clusterings, as far as comparisons ask for them.
struct Medians<'a> {
    chooser: &'a Chooser<'a>,
    /// One for each seed.
    runs: Vec<KMeans<'a>>,
    /// Of so many clusters the map errors of the first runs, px.
    map_errors: BTreeMap<usize, Vec<f64>>,
}

impl Medians<'_> {
    /// Whether the median over the runs, the lower of two, is at most `map_error` (px) with `count` clusters: some run only where
    /// those before leave it open.
    fn suffices(&mut self, count: usize, map_error: f64) -> Result<bool, PlanError> {
        let Self { chooser, runs, map_errors } = self;
        let found = map_errors.entry(count).or_default();
        let middle = (runs.len() - 1) / 2;
        loop {
            let within = found.iter().filter(|&&found| found <= map_error).count();
            let to_confirm = (middle + 1).saturating_sub(within);
            let to_refuse = (runs.len() - middle).saturating_sub(found.len() - within);
            if to_confirm.min(to_refuse) == 0 {
                return Ok(to_confirm == 0);
            }
            let next = &mut runs[found.len()..][..to_confirm.min(to_refuse)];
            let more: Vec<f64> = next
                .par_iter_mut()
                .map(|run| Ok(chooser.accuracy(&chooser.information(&run.members(count)?)).1))
                .collect::<Result<_, PlanError>>()?;
            found.extend(more);
        }
    }
}

/// The choice of `count` poses by `method` with the median map error over `runs` seeds from `seed` on, and the median time.
///
/// # Errors
/// When a choice fails.
pub fn median_choice(
    chooser: &Chooser,
    method: Method,
    count: usize,
    seed: u64,
    runs: usize,
) -> Result<(Choice, Duration), PlanError> {
    let features = chooser.features(method)?;
    let choose = |seed| match &features {
        Some(features) => Ok(chooser.assess(KMeans::new(features, seed).members(count)?)),
        None => chooser.choose(method, count, seed),
    };
    let mut choices = (0..runs as u64)
        .into_par_iter()
        .map(|run| {
            let start = Instant::now();
            Ok((choose(seed.wrapping_add(run))?, start.elapsed()))
        })
        .collect::<Result<Vec<_>, PlanError>>()?;
    let mut times: Vec<Duration> = choices.iter().map(|(_, time)| *time).collect();
    times.sort_unstable();
    choices.sort_by(|a, b| a.0.map_error.total_cmp(&b.0.map_error));
    let middle = (choices.len() - 1) / 2;
    Ok((choices.swap_remove(middle).0, times[middle]))
}
