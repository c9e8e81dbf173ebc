//! Tables, figures and the page of a study.

use std::path::Path;

use crate::cli::interrupt::writing;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, grouped, wrapped};
use crate::experiment::{Results, Store, Study};
use crate::plan::document::{Document, StudyDocument};
use crate::plan::results::write_together;
use crate::report::{Figure, Style, png, strongest, study_figures, study_page, svg};

/// Missing cells that are named at most.
const MOST_NAMED: usize = 8;

/// Figures as papers take them: width and height in mm, text in pt, dots per inch.
const FIGURE: (f64, f64, f64, f64) = (120.0, 78.0, 8.0, 300.0);

/// Writes all that follows from the cells, which must all be there; the summary last.
pub(super) fn merge(study: &Study, store: &Store, screen: &mut Screen) -> Result<(), Failure> {
    let bar = screen.spinner("merging");
    let results = Results::read(study, store).map_err(|missing| incomplete(study, store, &missing))?;
    let table = results.table(study);
    let summary = results.summary(study, &table);
    let figures = study_figures(&summary);
    let drawn = drawn(&figures)?;
    let in_memory = |error: &dyn std::fmt::Display| Failure::Table(error.to_string());
    let mut files: Vec<(&str, Vec<u8>)> = vec![
        ("results.csv", table.to_csv().map_err(|error| in_memory(&error))?),
        #[cfg(feature = "parquet")]
        ("results.parquet", table.to_parquet().map_err(|error| in_memory(&error))?),
        ("times.csv", results.times_csv().map_err(|error| in_memory(&error))?),
        ("report.html", study_page(&summary).into_bytes()),
    ];
    files.push(("study.json", summary.to_json().into_bytes()));
    let folder = store.folder();
    writing(|| {
        // Those of an earlier form of the study would tell of what is not there.
        let stale = figures_in(&folder.join("figures"));
        let stale: Vec<&str> = stale.iter().map(String::as_str).collect();
        write_together(&folder.join("figures"), &drawn, &stale)?;
        write_together(folder, &files, &[])
    })?;
    bar.finish_and_clear();
    screen.document(&summary)?;
    screen.text(&told(&summary, store, &files, &figures))
}

fn incomplete(study: &Study, store: &Store, missing: &[usize]) -> Failure {
    let named: Vec<String> = missing.iter().take(MOST_NAMED).map(ToString::to_string).collect();
    Failure::Incomplete {
        folder: store.folder().to_owned(),
        cells: study.cells(),
        missing: missing.len(),
        named: named.join(", ") + if missing.len() > MOST_NAMED { ", …" } else { "" },
        others: store.kept() + missing.len() > study.cells(),
    }
}

pub(crate) fn drawn(figures: &[Figure]) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let (width, height, text, dpi) = FIGURE;
    let style = Style::paper(width, height, text);
    let mut files = Vec::with_capacity(2 * figures.len());
    for figure in figures {
        let picture = png(figure, &style, dpi).map_err(|error| Failure::Table(error.to_string()))?;
        files.push((format!("{}.svg", figure.name), svg(figure, &style).into_bytes()));
        files.push((format!("{}.png", figure.name), picture));
    }
    Ok(files)
}

/// Names of the figures that are there.
fn figures_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let is_figure = |name: &String| Path::new(name).extension().is_some_and(|end| end == "svg" || end == "png");
    names.filter(is_figure).collect()
}

fn told(summary: &StudyDocument, store: &Store, files: &[(&str, Vec<u8>)], figures: &[Figure]) -> String {
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    let mut text = format!("{}: {}", summary.name, strongest(summary));
    for reason in &summary.reasons {
        let rows =
            if reason.rows == 1 { "1 row has".to_owned() } else { format!("{} rows have", grouped(reason.rows)) };
        text += &format!("\n{rows} no choice: {}.", reason.reason);
    }
    text += &format!(
        "\n{} rows of {} cells. Written to {}: {}, and {} figures.",
        grouped(summary.rows),
        grouped(summary.cells),
        store.folder().display(),
        names.join(", "),
        figures.len()
    );
    let left = store.kept().saturating_sub(summary.cells);
    if left > 0 {
        text += &format!(
            "\n{} more cells are there, of the study as it was or of another version; they are not among the results.",
            grouped(left)
        );
    }
    text.lines().map(wrapped).collect::<Vec<_>>().join("\n")
}
