//! The report of simulated calibrations.

use maud::html;

use super::head::{Head, Tone, figure};
use super::table::{Cell, Row, table};
use super::{page, plots, script};
use crate::figures::short;
use crate::plan::document::Verification;
use crate::report::plots::verification_figures;

/// The report of simulated calibrations, a page that stands alone.
pub fn verification_page(verification: &Verification) -> String {
    let tone = match verification.holds {
        Some(true) => Tone::Good,
        Some(false) => Tone::Bad,
        None => Tone::Open,
    };
    let error = &verification.map_error_px;
    let px = |value: Option<f64>| value.map_or("undetermined".to_owned(), short);
    let head = Head {
        kind: "simulated calibrations of a plan",
        calipose: &verification.header.calipose,
        name: &verification.problem.name,
        tone,
        verdict: verification.verdict.clone(),
        details: String::new(),
        next: html! { (next(verification.holds)) },
        figures: vec![
            figure("Poses", verification.count.to_string(), ""),
            figure("Map error, predicted", px(error.predicted), "px RMS"),
            figure("Map error, simulated", px(error.measured), "px RMS"),
            figure("Calibrations", verification.trials.to_string(), &format!("{} failed", verification.failed)),
        ],
    };
    let rows = verification.parameters.iter().map(|parameter| Row {
        pose: None,
        cells: vec![
            Cell::Text(parameter.name.clone()),
            Cell::short(parameter.predicted_sigma),
            Cell::short(parameter.sampled_sigma),
            Cell::short(parameter.ratio),
            Cell::short(parameter.ratio_interval[0]),
            Cell::short(parameter.ratio_interval[1]),
            Cell::short(parameter.bias),
        ],
    });
    let header = ["Intrinsic", "Predicted sigma", "Sampled sigma", "Ratio", "Least likely ratio", "Greatest", "Bias"];
    let body = html! {
        (head.markup())
        main {
            section id="plots" { h2 { "Plots" } (plots(&verification_figures(verification))) }
            section id="intrinsics" {
                h2 { "Intrinsics" }
                (table("Intrinsics", &header.map(String::from), &rows.collect::<Vec<_>>()))
            }
            @if !verification.failures.is_empty() {
                section id="failures" {
                    h2 { "Calibrations that failed" }
                    (table("Failures", &["Trial".to_owned(), "Reason".into()], &failures(verification)))
                }
            }
        }
        (head.foot(Some(&verification.problem)))
        (script())
    };
    page(&format!("{}: simulated calibrations", verification.problem.name), &body)
}

fn next(holds: Option<bool>) -> &'static str {
    match holds {
        Some(false) => {
            "Next: see below which intrinsics scatter more than predicted; add poses, or estimate fewer intrinsics."
        }
        Some(true) => "Next: take the plan's pictures and calibrate.",
        None => "Next: simulate more calibrations, with --trials.",
    }
}

fn failures(verification: &Verification) -> Vec<Row> {
    let row = |failed: &crate::plan::document::FailedTrial| Row {
        pose: None,
        cells: vec![Cell::Text(failed.trial.to_string()), Cell::Text(failed.reason.clone())],
    };
    verification.failures.iter().take(100).map(row).collect()
}
