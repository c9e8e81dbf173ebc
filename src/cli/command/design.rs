//! `calipose design`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::study::{drawn, has_key};
use crate::cli::interrupt::writing;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, duration, grouped, short, table, wrapped};
use crate::experiment::{Codesign, Designed};
use crate::plan::document::{DesignDocument, Document, SetUp};
use crate::plan::results::{probe, write_together};
use crate::report::{design_figures, design_page, family, gain};

#[derive(Debug, Args)]
pub(crate) struct DesignArguments {
    /// Design file (TOML)
    file: PathBuf,
    /// Folder for the results [default: the file's]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Replace the results of another design
    #[arg(long)]
    force: bool,
}

/// Name of the file with the results.
const DESIGN_FILE: &str = "design.json";

/// Set-ups that are listed.
const LISTED: usize = 5;

pub(crate) fn run(arguments: &DesignArguments, screen: &mut Screen) -> Result<(), Failure> {
    let design = Codesign::read(&arguments.file)?;
    let folder = arguments.output.clone().unwrap_or_else(|| design.output.clone());
    arguments.may_write(&folder, &design)?;
    let (screened, examined) = design.evaluations();
    if design.problem.visibility.min_distance == 0.0 {
        screen.warn(
            "`visibility.min_distance_mm` is 0, so that the best set-up may bring the board nearer than the camera can focus; give the \
             distance in the problem file, or in the design file's `set`",
        );
    }
    let bar = screen.progress("trying", screened + examined);
    let found = design.search(&folder, &|| bar.inc(1));
    bar.finish_and_clear();
    let Designed { document, problem_file } = found?;
    let figures = design_figures(&document);
    let drawn = drawn(&figures)?;
    let files = [
        ("best.toml", problem_file.into_bytes()),
        ("ranking.csv", ranking_csv(&document).map_err(|error| Failure::Table(error.to_string()))?),
        ("report.html", design_page(&document).into_bytes()),
        (DESIGN_FILE, document.to_json().into_bytes()),
    ];
    writing(|| {
        write_together(&folder.join("figures"), &drawn, &[])?;
        write_together(&folder, &files, &[])
    })?;
    screen.document(&document)?;
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    screen.text(&format!(
        "{}\n\n{}\n\n{}\n{}",
        wrapped(&format!("{}: {} {}", document.name, gain(&document), family(&document))),
        ranking(&document),
        wrapped(&tried(&document)),
        wrapped(&format!("Written to {}: {}, and {} figures.", folder.display(), names.join(", "), figures.len())),
    ))
}

/// Whether the file at `path` states a design.
pub(crate) fn is_design(path: &Path) -> bool {
    has_key(path, "free")
}

/// Says what a search would take.
pub(crate) fn check(path: &Path, screen: &mut Screen) -> Result<(), Failure> {
    let forecast = Codesign::read(path)?.forecast();
    screen.document(&forecast)?;
    let things = if forecast.free.len() == 1 { "thing is" } else { "things are" };
    screen.text(&format!(
        "{}: valid.\n{} {things} free on {}: {}.\n{} set-ups would be screened on a coarser sweep, and at most {} examined.\nIt would take \
         up to about {} on this machine, and write to {}.",
        forecast.name,
        forecast.free.len(),
        forecast.problem.name,
        forecast.free.join(", "),
        grouped(forecast.screened),
        grouped(forecast.examined_at_most),
        duration(forecast.seconds),
        forecast.output.display(),
    ))
}

impl DesignArguments {
    /// That results can be written, and replace none of another design.
    fn may_write(&self, folder: &Path, design: &Codesign) -> Result<(), Failure> {
        let path = folder.join(DESIGN_FILE);
        let theirs = std::fs::read(&path).ok().and_then(|bytes| serde_json::from_slice::<DesignDocument>(&bytes).ok());
        match theirs.filter(|theirs| theirs.name != design.name && !self.force) {
            Some(theirs) => Err(Failure::OtherDesign { path, theirs: theirs.name }),
            None => Ok(probe(folder)?),
        }
    }
}

fn tried(document: &DesignDocument) -> String {
    let proof = &document.proof;
    let undecided = match proof.undecided {
        0 => String::new(),
        some => format!(" For {} more no plan was found, and nothing is proven.", grouped(some)),
    };
    format!(
        "{} set-ups screened on a coarser sweep; {} examined on the problem's own: {} proven worse than the best, {} without a \
         plan.{undecided}",
        grouped(proof.screened),
        grouped(proof.examined),
        grouped(proof.proven_worse),
        grouped(proof.without_plan),
    )
}

fn ranking(document: &DesignDocument) -> String {
    let names: Vec<&str> = document.best.values.iter().map(|value| short_name(&value.name)).collect();
    let row = |(rank, set_up): (String, &SetUp)| {
        let values = set_up.values.iter().map(|value| value.number.map_or_else(|| value.value.clone(), short));
        let rest = [set_up.map_error_px.map_or_else(|| "-".into(), short), grouped(set_up.views)];
        std::iter::once(rank).chain(values).chain(rest).collect::<Vec<String>>()
    };
    let ranked = document.ranking.iter().take(LISTED).enumerate().map(|(i, set_up)| ((i + 1).to_string(), set_up));
    let rows: Vec<Vec<String>> = ranked.map(row).collect();
    let header: Vec<&str> = [&["set-up"], &names[..], &["map error [px]", "views"]].concat();
    table(&header, &rows)
}

/// The last part of a key.
fn short_name(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

fn ranking_csv(document: &DesignDocument) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = document.best.values.iter().map(|value| value.name.as_str());
    writer.write_record(names.chain(["map_error_px", "value", "bound", "efficiency", "views", "nearest_mm"]))?;
    for set_up in &document.ranking {
        let number = |number: Option<f64>| number.map_or_else(String::new, |number| number.to_string());
        let rest = [
            number(set_up.map_error_px),
            number(set_up.value),
            number(set_up.bound),
            number(set_up.efficiency),
            set_up.views.to_string(),
            set_up.nearest_mm.to_string(),
        ];
        writer.write_record(set_up.values.iter().map(|value| value.value.clone()).chain(rest))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}
