//! `calipose study`.

mod merge;
mod processes;
mod submit;

use std::num::NonZero;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, duration, grouped};
use crate::experiment::{Forecast, RunError, Shard, Store, Study, run as run_cells};
use crate::plan::document::{CellsDocument, Document};
use crate::problem::read_text;
pub(super) use merge::drawn;
use merge::merge;
use submit::{SubmitArguments, submit};

#[derive(Debug, Subcommand)]
pub(crate) enum StudyCommand {
    /// Validate a study file and say what a run would take
    Check(StudyFile),
    /// Compute all cells, or those that are missing, and merge them
    Run(StudyArguments),
    /// Compute one cell, or a shard of the cells: the unit of work on several machines
    Cell(CellArguments),
    /// Make tables, figures and the page of cells that are all there
    Merge(StudyArguments),
    /// Write a job that computes the cells on several machines and merges them, and start it
    Submit(SubmitArguments),
}

#[derive(Debug, Args)]
pub(crate) struct StudyFile {
    /// Study file (TOML)
    file: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct StudyArguments {
    #[command(flatten)]
    study: StudyFile,
    /// Folder for the results [default: the file's]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Work in a folder that holds another study
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CellArguments {
    #[command(flatten)]
    arguments: StudyArguments,
    /// Number of the cell, from 0
    #[arg(required_unless_present = "shard", conflicts_with = "shard")]
    cell: Option<usize>,
    /// Every n-th cell from the i-th on, as i/n with i from 0: 0/4, 1/4, 2/4 and 3/4 are all
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
}

/// Parser of `--shard`.
fn shard(text: &str) -> Result<Shard, String> {
    let parsed = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
    match parsed {
        Some((part, of)) if part < of => Ok(Shard { part, of }),
        _ => Err("must be I/N with I from 0 to N - 1, as in 0/4".into()),
    }
}

pub(crate) fn run(command: &StudyCommand, screen: &mut Screen) -> Result<(), Failure> {
    match command {
        StudyCommand::Check(arguments) => check(&arguments.file, screen),
        StudyCommand::Run(arguments) => {
            let (study, folder) = arguments.study()?;
            let store = Store::alone(&folder, &study, arguments.force)?;
            compute(&study, Shard::ALL, &store, screen)?;
            merge(&study, &store, screen)
        }
        StudyCommand::Cell(arguments) => cells(arguments, screen),
        StudyCommand::Merge(arguments) => {
            let (study, folder) = arguments.study()?;
            merge(&study, &Store::alone(&folder, &study, arguments.force)?, screen)
        }
        StudyCommand::Submit(arguments) => submit(arguments, screen),
    }
}

impl StudyArguments {
    /// The study, and the folder for its results.
    fn study(&self) -> Result<(Study, PathBuf), Failure> {
        let study = Study::read(&self.study.file)?;
        let folder = self.output.clone().unwrap_or_else(|| study.output.clone());
        Ok((study, folder))
    }
}

/// Threads to work on.
fn threads() -> NonZero<usize> {
    NonZero::new(rayon::current_num_threads()).unwrap_or(NonZero::<usize>::MIN)
}

/// Computes the cells of a shard that are not there.
fn compute(study: &Study, shard: Shard, store: &Store, screen: &Screen) -> Result<usize, RunError> {
    let bar = screen.progress("computing", shard.cells(study.cells()).count());
    let computed = run_cells(study, shard, store, threads(), &|cells| bar.inc(cells as u64));
    bar.finish_and_clear();
    computed
}

fn cells(arguments: &CellArguments, screen: &mut Screen) -> Result<(), Failure> {
    let (study, folder) = arguments.arguments.study()?;
    let cells = study.cells();
    let shard = match (arguments.cell, arguments.shard) {
        (Some(cell), _) if cell >= cells => {
            return Err(Failure::Usage(format!(
                "there is no cell {cell}: the study has {} cells, from 0 to {}",
                grouped(cells),
                cells - 1
            )));
        }
        // No other leaves the same when divided by the number of cells.
        (Some(cell), _) => Shard { part: cell, of: cells },
        (None, shard) => shard.unwrap_or(Shard::ALL),
    };
    let store = Store::shared(&folder, &study, arguments.arguments.force)?;
    let computed = compute(&study, shard, &store, screen)?;
    let there = shard.cells(cells).count();
    screen.document(&CellsDocument {
        header: CellsDocument::header(),
        name: study.name.clone(),
        cells: there,
        computed,
    })?;
    screen.text(&format!(
        "{} of {} cells computed, {} were there, in {}.",
        grouped(computed),
        grouped(there),
        grouped(there - computed),
        store.folder().display()
    ))
}

/// Whether the file at `path` states a study.
pub(crate) fn is_study(path: &Path) -> bool {
    has_key(path, "problems")
}

/// Whether the file at `path` is TOML with that key. What can be read only once is not looked into.
pub(crate) fn has_key(path: &Path, key: &str) -> bool {
    let text = if path.is_file() { read_text(path).unwrap_or_default() } else { String::new() };
    text.parse::<toml::Table>().is_ok_and(|table| table.contains_key(key))
}

pub(crate) fn check(path: &Path, screen: &mut Screen) -> Result<(), Failure> {
    let study = Study::read(path)?;
    let forecast = Forecast::new(&study, threads()).ok_or_else(|| Failure::Usage("no threads to work on".into()))?;
    screen.document(&forecast.document(&study))?;
    let Forecast { cells, surveys, rows, seconds, bytes } = forecast;
    screen.text(&format!(
        "{}: valid.\n{} of {} on {}, {}.\nSurveys to make: about {}.\nA run would take about {} and {} MB on this \
         machine, and write to {}.",
        study.name,
        counted(cells, "cell"),
        factors(&study),
        problems(&study),
        counted(rows, "row"),
        grouped(surveys),
        duration(seconds),
        grouped((bytes / 1e6).ceil() as usize),
        study.output.display(),
    ))
}

fn factors(study: &Study) -> String {
    match study.factors.len() {
        0 => "no factors".into(),
        n => counted(n, "factor"),
    }
}

/// `1 cell`, `2 cells`.
fn counted(number: usize, noun: &str) -> String {
    format!("{} {noun}{}", grouped(number), if number == 1 { "" } else { "s" })
}

fn problems(study: &Study) -> String {
    match study.problems()[..] {
        [problem] => problem.to_owned(),
        ref problems => format!("{} problems", problems.len()),
    }
}
