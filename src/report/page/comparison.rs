//! The report of a comparison.

use maud::html;

use super::head::{Head, Tone, figure};
use super::table::{Cell, Row, table};
use super::{page, plots, script};
use crate::figures::short;
use crate::plan::document::{ComparisonDocument, ComparisonRow};
use crate::report::plots::comparison_figures;

/// The report of a comparison, a page that stands alone.
pub fn comparison_page(comparison: &ComparisonDocument) -> String {
    let best = comparison.rows.iter().filter(|row| row.map_error_px.is_some()).min_by(|a, b| {
        let key = |row: &ComparisonRow| row.map_error_px.unwrap_or(f64::INFINITY);
        key(a).total_cmp(&key(b))
    });
    let equal = |count: usize| {
        let of = comparison.equivalents.iter().filter(move |equivalent| equivalent.count == count);
        of.map(|equivalent| match equivalent.equivalent_count {
            Some(poses) => format!("{poses} by {}", equivalent.method),
            None => format!("more than {} by {}", equivalent.tried, equivalent.method),
        })
    };
    let mut counts: Vec<usize> = comparison.equivalents.iter().map(|equivalent| equivalent.count).collect();
    counts.dedup();
    let head = Head {
        kind: "comparison of methods",
        calipose: &comparison.header.calipose,
        name: &comparison.problem.name,
        tone: Tone::Good,
        verdict: match best {
            Some(row) => format!(
                "{} poses by {} have the smallest map error of those compared: {} px.",
                row.count,
                row.method,
                row.map_error_px.map_or_else(String::new, short)
            ),
            None => "No method determines all intrinsics at these numbers of poses.".into(),
        },
        details: String::new(),
        next: html! { "Next: make the plan with the number of poses that reaches the accuracy you need." },
        figures: counts
            .iter()
            .map(|&count| {
                figure(
                    "K-means poses worth a plan",
                    equal(count).collect::<Vec<_>>().join(", "),
                    &format!("for {count}"),
                )
            })
            .collect(),
    };
    let rows = comparison.rows.iter().map(|row| Row {
        pose: None,
        cells: vec![
            Cell::Text(row.method.clone()),
            Cell::Text(row.count.to_string()),
            Cell::short(row.value),
            Cell::short(row.efficiency),
            Cell::short(row.map_error_px),
            Cell::short(row.measured.as_ref().and_then(|measured| measured.map_error_px)),
            Cell::short(Some(row.seconds)),
        ],
    });
    let header =
        ["Method", "Poses", "Value", "Certified efficiency", "Map error, px", "Simulated map error, px", "Time, s"];
    let body = html! {
        (head.markup())
        main {
            section id="plots" { h2 { "Plots" } (plots(&comparison_figures(comparison))) }
            section id="methods-table" {
                h2 { "Methods" }
                p { "Criterion " code { (comparison.criterion) } "." }
                (table("Methods", &header.map(String::from), &rows.collect::<Vec<_>>()))
            }
        }
        (head.foot(Some(&comparison.problem)))
        (script())
    };
    page(&format!("{}: methods side by side", comparison.problem.name), &body)
}
