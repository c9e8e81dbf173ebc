//! What the rows of a study come to.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::Study;
use super::cell::PreparedCell;
use super::statistics::{interval, mean, median, range};
use super::store::Store;
use super::table::{StudyTable, Values};
use crate::experiment::factor::interval_name;
use crate::plan::document::{
    AxisMeans, CellDocument, ComparedLevels, Difference, Document, Mean, OutcomeSummary, ProblemReference, ReasonCount,
    StudyAxis, StudyDocument,
};

/// All cells of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    cells: Vec<(usize, CellDocument)>,
}

/// Levels that an axis of drawn numbers has at most; more are put together in intervals.
const MOST_LEVELS: usize = 12;

/// Intervals that numbers are put together in, with as many rows in each.
const INTERVALS: usize = 6;

/// What tells series apart: rows of the same series are of one line in a plot. Means over several problems would be of none of them.
const SERIES: [&str; 4] = ["problem", "criterion", "count", "method"];

impl Results {
    /// Reads all cells of `study`; the numbers of those that are not there, if any are missing.
    ///
    /// # Errors
    /// The numbers of the missing cells.
    pub fn read(study: &Study, store: &Store) -> Result<Self, Vec<usize>> {
        let cells: Vec<Result<(usize, CellDocument), usize>> = (0..study.cells())
            .into_par_iter()
            .map(|index| {
                let cell = store.cell(&PreparedCell::new(study, index).fingerprint);
                cell.map(|cell| (index, cell)).ok_or(index)
            })
            .collect();
        let missing: Vec<usize> = cells.iter().filter_map(|cell| cell.as_ref().err().copied()).collect();
        if missing.is_empty() { Ok(Self { cells: cells.into_iter().flatten().collect() }) } else { Err(missing) }
    }

    /// The rows as a table.
    pub fn table(&self, study: &Study) -> StudyTable {
        StudyTable::new(study, &self.cells)
    }

    /// Cells and how long each took, as CSV: what is not the same in every run.
    ///
    /// # Errors
    /// Never in practice: the writer writes to memory.
    pub fn times_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["cell", "survey_s", "rows_s"])?;
        for (index, cell) in &self.cells {
            writer.write_record([index.to_string(), cell.seconds.survey.to_string(), cell.seconds.rows.to_string()])?;
        }
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }

    /// What it comes to.
    pub fn summary(&self, study: &Study, table: &StudyTable) -> StudyDocument {
        let axes = axes(study, table);
        let outcomes = study.outcomes.iter().map(|outcome| summarised(table, &axes, outcome)).collect();
        let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
        let rows = self.cells.iter().flat_map(|(_, cell)| &cell.rows);
        for reason in rows.filter_map(|row| row.reason.as_deref()) {
            *reasons.entry(reason).or_default() += 1;
        }
        let mut reasons: Vec<ReasonCount> =
            reasons.into_iter().map(|(reason, rows)| ReasonCount { reason: reason.to_owned(), rows }).collect();
        reasons.sort_by_key(|reason| std::cmp::Reverse(reason.rows));
        let problem = |(base, name): (usize, &str)| ProblemReference {
            name: name.to_owned(),
            sha256: self.sha256_of(study, base),
            set: study.set.clone(),
        };
        StudyDocument {
            header: StudyDocument::header(),
            name: study.name.clone(),
            sha256: study.sha256.clone(),
            problems: study.problems().into_iter().enumerate().map(problem).collect(),
            cells: study.cells(),
            rows: table.len(),
            reasons,
            axes: axes.iter().map(|axis| StudyAxis { name: axis.name.clone(), levels: axis.levels.clone() }).collect(),
            outcomes,
        }
    }

    /// SHA-256 of a base problem's file, which its cells hold.
    fn sha256_of(&self, study: &Study, base: usize) -> String {
        let of_base = self.cells.iter().filter(|(index, _)| study.cell(*index).problem == base);
        let mut known = of_base.map(|(_, cell)| &cell.problem.sha256).filter(|sha256| !sha256.is_empty());
        known.next().cloned().unwrap_or_default()
    }
}

/// What varies over the rows.
struct Axis {
    name: String,
    levels: Vec<String>,
    /// The levels as numbers, if all are.
    numbers: Option<Vec<f64>>,
    /// The level of each row; none where the row does not say.
    of_row: Vec<Option<usize>>,
}

/// Everything with at least two levels.
fn axes(study: &Study, table: &StudyTable) -> Vec<Axis> {
    let factors = study.factors.iter().map(|factor| factor.name.as_str());
    let names = SERIES[..1].iter().copied().chain(factors).chain(SERIES[1..].iter().copied());
    let axes = names.filter_map(|name| Some(axis(name, table.column(name)?, table.len(), study.is_sampled())));
    axes.filter(|axis| axis.levels.len() > 1).collect()
}

fn axis(name: &str, values: &Values, rows: usize, drawn: bool) -> Axis {
    let mut levels: Vec<String> = Vec::new();
    let mut place: BTreeMap<String, usize> = BTreeMap::new();
    let of_row = (0..rows).map(|row| {
        let label = values.label(row)?;
        Some(*place.entry(label).or_insert_with_key(|label| {
            levels.push(label.clone());
            levels.len() - 1
        }))
    });
    let of_row: Vec<Option<usize>> = of_row.collect();
    let numbers: Option<Vec<f64>> = levels.iter().map(|level| level.parse().ok()).collect();
    match numbers {
        Some(numbers) if drawn && levels.len() > MOST_LEVELS => in_intervals(name, &numbers, &of_row),
        numbers => Axis { name: name.to_owned(), levels, numbers, of_row },
    }
}

/// The axis with its numbers put together.
fn in_intervals(name: &str, numbers: &[f64], of_row: &[Option<usize>]) -> Axis {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let starts: Vec<usize> = (0..=INTERVALS).map(|i| i * sorted.len() / INTERVALS).collect();
    let part = |i: usize| &sorted[starts[i]..starts[i + 1]];
    let interval_of = |number: f64| {
        let below = sorted.partition_point(|&other| other < number);
        starts[1..INTERVALS].iter().filter(|&&start| start <= below).count()
    };
    Axis {
        name: name.to_owned(),
        levels: (0..INTERVALS).map(|i| interval_name(part(i)[0], part(i)[part(i).len() - 1])).collect(),
        numbers: Some((0..INTERVALS).map(|i| median(part(i)).unwrap_or_default()).collect()),
        of_row: of_row.iter().map(|level| level.map(|level| interval_of(numbers[level]))).collect(),
    }
}

fn summarised(table: &StudyTable, axes: &[Axis], outcome: &str) -> OutcomeSummary {
    let column = table.column(outcome);
    let numbers: Vec<Option<f64>> = (0..table.len()).map(|row| column.and_then(|values| values.number(row))).collect();
    let means = axes.iter().map(|axis| AxisMeans { axis: axis.name.clone(), means: means(axes, axis, &numbers) });
    OutcomeSummary {
        outcome: outcome.to_owned(),
        means: means.collect(),
        compared: axes.iter().filter_map(|axis| compared(axes, axis, &numbers)).collect(),
    }
}

/// The name of a row's series: its levels on the axes that tell series apart, but for `axis`; none where the row does not say.
fn series(axes: &[Axis], axis: &Axis, row: usize) -> Option<String> {
    let others = axes.iter().filter(|other| SERIES.contains(&other.name.as_str()) && other.name != axis.name);
    let names: Option<Vec<String>> = others
        .map(|other| {
            let level = &other.levels[other.of_row[row]?];
            Some(if other.name == "count" { format!("{level} poses") } else { level.clone() })
        })
        .collect();
    Some(names?.join(", "))
}

/// The names of all series, in the order of their first rows, and that of each row.
fn all_series(axes: &[Axis], axis: &Axis, rows: usize) -> (Vec<String>, Vec<Option<usize>>) {
    let mut names: Vec<String> = Vec::new();
    let of_row = (0..rows).map(|row| {
        let name = series(axes, axis, row)?;
        let known = names.iter().position(|known| *known == name);
        Some(known.unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        }))
    });
    let of_row = of_row.collect();
    (names, of_row)
}

fn means(axes: &[Axis], axis: &Axis, numbers: &[Option<f64>]) -> Vec<Mean> {
    let (names, of_row) = all_series(axes, axis, numbers.len());
    let mut found = vec![vec![(Vec::new(), 0); axis.levels.len()]; names.len()];
    for (row, number) in numbers.iter().enumerate() {
        if let (Some(series), Some(level)) = (of_row[row], axis.of_row[row]) {
            let (there, without) = &mut found[series][level];
            match number {
                Some(number) => there.push(*number),
                None => *without += 1,
            }
        }
    }
    let named = names.into_iter().zip(found);
    named
        .flat_map(|(series, levels)| {
            let levels = levels.into_iter().enumerate().filter(|(_, (there, without))| there.len() + without > 0);
            levels.map(move |(level, (there, without))| Mean {
                series: series.clone(),
                level: axis.levels[level].clone(),
                number: axis.numbers.as_ref().map(|numbers| numbers[level]),
                rows: there.len(),
                without,
                mean: mean(&there),
                interval: interval(&there),
                range: range(&there),
                median: median(&there),
            })
        })
        .collect()
}

/// The levels of `axis` against its first, over rows that differ in nothing else; none where no rows do.
fn compared(axes: &[Axis], axis: &Axis, numbers: &[Option<f64>]) -> Option<ComparedLevels> {
    // Rows by all else but the seed, and by level.
    let mut blocks: BTreeMap<Vec<Option<usize>>, Vec<Vec<f64>>> = BTreeMap::new();
    let (names, of_row) = all_series(axes, axis, numbers.len());
    let mut series_of: BTreeMap<Vec<Option<usize>>, usize> = BTreeMap::new();
    for (row, number) in numbers.iter().enumerate() {
        let (Some(number), Some(level), Some(series)) = (number, axis.of_row[row], of_row[row]) else { continue };
        let others = axes.iter().filter(|other| other.name != axis.name);
        let block: Vec<Option<usize>> = others.map(|other| other.of_row[row]).collect();
        series_of.insert(block.clone(), series);
        blocks.entry(block).or_insert_with(|| vec![Vec::new(); axis.levels.len()])[level].push(*number);
    }
    let mut differences = Vec::new();
    for (series, name) in names.iter().enumerate() {
        for (level, level_name) in axis.levels.iter().enumerate().skip(1) {
            let of_series = blocks.iter().filter(|(block, _)| series_of[*block] == series).map(|(_, levels)| levels);
            let matched: Vec<(&[f64], &[f64])> = of_series
                .map(|levels| (&levels[0][..], &levels[level][..]))
                .filter(|(first, other)| !first.is_empty() && !other.is_empty())
                .collect();
            let pairs = pairs(&matched);
            if let Some(difference) = difference(name, level_name, &pairs) {
                differences.push(difference);
            }
        }
    }
    let against = axis.levels.first()?.clone();
    (!differences.is_empty()).then(|| ComparedLevels { axis: axis.name.clone(), against, differences })
}

/// Numbers of the first level beside those of another. Those of one block, which differ in the seed, count as their mean; of a
/// single block each of the more numerous side is paired.
fn pairs(matched: &[(&[f64], &[f64])]) -> Vec<[f64; 2]> {
    if let [(first, other)] = matched {
        let pairs = first.len().max(other.len());
        let cycled = |side: &[f64], i: usize| side[i % side.len()];
        return (0..pairs).map(|i| [cycled(first, i), cycled(other, i)]).collect();
    }
    matched.iter().filter_map(|(first, other)| Some([mean(first)?, mean(other)?])).collect()
}

fn difference(series: &str, level: &str, pairs: &[[f64; 2]]) -> Option<Difference> {
    let differences: Vec<f64> = pairs.iter().map(|[first, other]| other - first).collect();
    let logarithms: Option<Vec<f64>> =
        pairs.iter().map(|[first, other]| (*first > 0.0 && *other > 0.0).then(|| (other / first).ln())).collect();
    Some(Difference {
        series: series.to_owned(),
        level: level.to_owned(),
        pairs: pairs.len(),
        difference: mean(&differences)?,
        interval: interval(&differences),
        ratio: logarithms.as_deref().and_then(mean).map(f64::exp),
        ratio_interval: logarithms.as_deref().and_then(interval).map(|ends| ends.map(f64::exp)),
    })
}
