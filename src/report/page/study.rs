//! The report of a study.

use maud::{Markup, html};

use super::head::{Head, Tone, figure};
use super::table::{Cell, Row, table};
use super::{page, plots, script};
use crate::figures::{grouped, short};
use crate::plan::document::{Mean, OutcomeSummary, StudyDocument};
use crate::report::outcome::strongest;
use crate::report::plots::study_figures;

/// The report of a study, a page that stands alone.
pub fn study_page(study: &StudyDocument) -> String {
    let failed: usize = study.reasons.iter().map(|reason| reason.rows).sum();
    let head = Head {
        kind: "study",
        calipose: &study.header.calipose,
        name: &study.name,
        tone: if failed == 0 { Tone::Good } else { Tone::Open },
        verdict: strongest(study),
        details: String::new(),
        next: html! { "Next: results.csv and results.parquet hold every row, for questions that this page does not answer." },
        figures: vec![
            figure("Cells", grouped(study.cells), ""),
            figure("Rows", grouped(study.rows), &format!("{} without a choice", grouped(failed))),
        ],
    };
    let body = html! {
        (head.markup())
        main {
            section id="plots" { h2 { "Plots" } (plots(&study_figures(study))) }
            @for outcome in &study.outcomes { (of_outcome(outcome)) }
            @if !study.reasons.is_empty() {
                section id="reasons" {
                    h2 { "Rows without a choice" }
                    (table("Reasons", &["Reason", "Rows"].map(String::from), &study.reasons.iter().map(|reason| Row {
                        pose: None,
                        cells: vec![Cell::Text(reason.reason.clone()), Cell::Number(grouped(reason.rows), reason.rows as f64)],
                    }).collect::<Vec<_>>()))
                }
            }
            section id="problems" {
                h2 { "Problems" }
                (table("Problems", &["Problem", "SHA-256 of its file", "Set in all cells"].map(String::from),
                    &study.problems.iter().map(|problem| Row {
                        pose: None,
                        cells: [problem.name.clone(), problem.sha256.clone(), problem.set.join(", ")].map(Cell::Text).into(),
                    }).collect::<Vec<_>>()))
            }
        }
        (head.foot(None))
        (script())
    };
    page(&format!("{}: a study", study.name), &body)
}

fn interval(interval: Option<[f64; 2]>) -> Cell {
    interval.map_or_else(
        || Cell::Text("–".into()),
        |[low, high]| Cell::Number(format!("{} to {}", short(low), short(high)), low),
    )
}

fn of_outcome(summary: &OutcomeSummary) -> Markup {
    let outcome = &summary.outcome;
    html! {
        section id=(outcome) {
            h2 { code { (outcome) } }
            @for means in &summary.means {
                (table(&format!("Means of {outcome} by {}", means.axis),
                    &[&means.axis, "Series", "Rows", "Without", "Mean", "95 % interval", "Median", "Range"].map(String::from),
                    &means.means.iter().map(mean).collect::<Vec<_>>()))
            }
            @for compared in &summary.compared {
                (table(&format!("{outcome} against {} {}, all else being equal", compared.axis, compared.against),
                    &[&compared.axis, "Series", "Pairs", "Difference", "95 % interval", "Ratio", "95 % interval of the ratio"]
                        .map(String::from),
                    &compared.differences.iter().map(|difference| Row {
                        pose: None,
                        cells: vec![
                            Cell::Text(difference.level.clone()),
                            Cell::Text(difference.series.clone()),
                            Cell::Number(grouped(difference.pairs), difference.pairs as f64),
                            Cell::short(Some(difference.difference)),
                            interval(difference.interval),
                            Cell::short(difference.ratio),
                            interval(difference.ratio_interval),
                        ],
                    }).collect::<Vec<_>>()))
            }
        }
    }
}

fn mean(mean: &Mean) -> Row {
    let level = match mean.number {
        Some(number) => Cell::Number(mean.level.clone(), number),
        None => Cell::Text(mean.level.clone()),
    };
    Row {
        pose: None,
        cells: vec![
            level,
            Cell::Text(mean.series.clone()),
            Cell::Number(grouped(mean.rows), mean.rows as f64),
            Cell::Number(grouped(mean.without), mean.without as f64),
            Cell::short(mean.mean),
            interval(mean.interval),
            Cell::short(mean.median),
            interval(mean.range),
        ],
    }
}
