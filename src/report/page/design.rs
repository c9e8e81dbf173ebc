//! The report of a design.

use maud::html;

use super::head::{Head, Tone, figure};
use super::table::{Cell, Row, table};
use super::{page, plots, script};
use crate::figures::{grouped, short};
use crate::plan::document::{DesignDocument, SetUp};
use crate::report::outcome::{family, gain};
use crate::report::plots::design_figures;

/// The report of a design, a page that stands alone.
pub fn design_page(design: &DesignDocument) -> String {
    let head = Head {
        kind: "design of a set-up",
        calipose: &design.header.calipose,
        name: &design.name,
        tone: Tone::Good,
        verdict: gain(design),
        details: family(design),
        next: html! { "Next: make the plan of the best set-up; its problem file stands beside this page." },
        figures: design.best.values.iter().map(|value| figure(&value.name, value.value.clone(), "")).collect(),
    };
    let names = design.best.values.iter().map(|value| value.name.clone());
    let header: Vec<String> =
        names.chain(["Map error, px", "Certified efficiency", "Views", "Nearest pose, mm"].map(String::from)).collect();
    let ranking: Vec<Row> = design.ranking.iter().map(row).collect();
    let body = html! {
        (head.markup())
        main {
            section id="plots" { h2 { "Plots" } (plots(&design_figures(design))) }
            section id="ranking" {
                h2 { "Best set-ups" }
                p { "Criterion " code { (design.criterion) } ", " (design.count) " poses." }
                (table("Best set-ups", &header, &ranking))
            }
            section id="sensitivity" {
                h2 { "What a change costs" }
                @for sensitivity in &design.sensitivity {
                    (table(&sensitivity.name, &["Value", "Map error, px", "Cost"].map(String::from),
                        &sensitivity.points.iter().map(|point| Row {
                            pose: None,
                            cells: vec![
                                point.number.map_or_else(|| Cell::Text(point.value.clone()), |n| Cell::Number(point.value.clone(), n)),
                                Cell::short(point.map_error_px),
                                cost(point.map_error_px, design.best.map_error_px),
                            ],
                        }).collect::<Vec<_>>()))
                }
            }
            section id="proof" {
                h2 { "What is proven" }
                p { (family(design)) }
                p {
                    (grouped(design.proof.examined)) " set-ups were examined on the problem's own sweep: "
                    (grouped(design.proof.proven_worse)) " are proven worse than the best plan, "
                    (grouped(design.proof.without_plan)) " have no plan of so many poses. For "
                    (grouped(design.proof.undecided)) " others no plan was found, and whether there is one is not known. Of the "
                    (grouped(design.proof.screened)) " that were screened on a coarser sweep alone nothing is proven."
                }
            }
        }
        (head.foot(Some(&design.problem)))
        (script())
    };
    page(&format!("{}: the design of a set-up", design.name), &body)
}

fn row(set_up: &SetUp) -> Row {
    let values = set_up.values.iter().map(|value| match value.number {
        Some(number) => Cell::Number(short(number), number),
        None => Cell::Text(value.value.clone()),
    });
    let rest = [
        Cell::short(set_up.map_error_px),
        Cell::short(set_up.efficiency),
        Cell::Number(grouped(set_up.views), set_up.views as f64),
        Cell::Number(format!("{:.0}", set_up.nearest_mm), set_up.nearest_mm),
    ];
    Row { pose: None, cells: values.chain(rest).collect() }
}

fn cost(map_error: Option<f64>, best: Option<f64>) -> Cell {
    match map_error.zip(best) {
        Some((map_error, best)) => {
            let percent = 100.0 * (map_error / best - 1.0);
            Cell::Number(format!("{percent:+.1} %"), percent)
        }
        None => Cell::Text("not possible".into()),
    }
}
