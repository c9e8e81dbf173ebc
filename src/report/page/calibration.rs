//! The report of a calibration.

use maud::{Markup, html};

use super::head::{Head, Tone, figure};
use super::table::{Cell, Row, table};
use super::{page, plots, script};
use crate::figures::short;
use crate::plan::document::{BoardWarp, CalibrationDocument};
use crate::report::plots::calibration_figures;

/// The report of a calibration, a page that stands alone.
pub fn calibration_page(calibration: &CalibrationDocument) -> String {
    let px = |value: Option<f64>| value.map_or("undetermined".to_owned(), short);
    let corners: usize = calibration.views.iter().map(|view| view.corners).sum();
    let name = calibration.problem.as_ref().map_or("Calibration", |problem| problem.name.as_str());
    let (tone, next) = match calibration.judgement.as_str() {
        "good" => (Tone::Good, "Next: use the camera file that calibrate wrote beside this page."),
        "fair" => (Tone::Open, "Next: use it where that accuracy will do, or add pictures as the verdict says."),
        _ => (Tone::Bad, "Next: do not use this camera yet; do as the verdict says and calibrate again."),
    };
    let head = Head {
        kind: "camera calibration",
        calipose: &calibration.header.calipose,
        name,
        tone,
        verdict: calibration.verdict.clone(),
        details: String::new(),
        next: html! { (next) },
        figures: vec![
            figure("Map error", px(calibration.map_error_px.rms), "px RMS over the image"),
            figure("Residuals", short(calibration.rms_px), "px RMS"),
            figure("Pictures", calibration.views.len().to_string(), &format!("{corners} corners")),
            figure("Outliers", calibration.outliers.len().to_string(), "corners that do not fit"),
        ],
    };
    let body = html! {
        (head.markup())
        main {
            section id="intrinsics" { h2 { "Intrinsics" } (intrinsics(calibration)) }
            section id="plots" { h2 { "Plots" } (plots(&calibration_figures(calibration))) }
            section id="pictures" { h2 { "Pictures" } (pictures(calibration)) }
            @if !calibration.outliers.is_empty() {
                section id="outliers" { h2 { "Corners that do not fit" } (outliers(calibration)) }
            }
        }
        (head.foot(calibration.problem.as_ref()))
        (script())
    };
    page(&format!("{name}: camera calibration"), &body)
}

fn intrinsics(calibration: &CalibrationDocument) -> Markup {
    let known = &calibration.intrinsics;
    let row = |((name, &value), &sigma): ((&String, &f64), &f64)| {
        let estimated = calibration.estimated.contains(name);
        let sigma = if estimated { Cell::Number(short(sigma), sigma) } else { Cell::Text("fixed".into()) };
        Row { pose: None, cells: vec![Cell::Text(name.clone()), Cell::Number(format!("{value:.6}"), value), sigma] }
    };
    let rows: Vec<Row> = known.names.iter().zip(&known.values).zip(&known.sigma).map(row).collect();
    let header = ["Intrinsic", "Value", "Sigma"].map(String::from);
    html! {
        p { "Lens " code { (calibration.lens) } ", pictures of " (calibration.image.width_px) " × " (calibration.image.height_px) " px." }
        (table("Intrinsics", &header, &rows))
        @for [a, b] in &calibration.tied { p { (a) " and " (b) " are held equal." } }
        @if let Some(BoardWarp { x, y, x_sigma, y_sigma }) = calibration.warp_mm {
            p {
                "The board's middle lies above its rim by " (short(x)) " ± " (short(x_sigma)) " mm along x and "
                (short(y)) " ± " (short(y_sigma)) " mm along y."
            }
        }
    }
}

fn pictures(calibration: &CalibrationDocument) -> Markup {
    let row = |view: &crate::plan::document::CalibratedView| {
        let [x, y, z] = view.pose.position_m;
        let distance = x.hypot(y).hypot(z);
        let worst = view.residuals.iter().map(|corner| corner.residual_px[0].hypot(corner.residual_px[1]));
        let worst = worst.reduce(f64::max);
        Row {
            pose: None,
            cells: vec![
                Cell::Text(view.name.clone()),
                Cell::Text(view.corners.to_string()),
                Cell::short(Some(view.rms_px)),
                Cell::short(worst),
                Cell::Number(format!("{:.0}", 1e3 * distance), distance),
            ],
        }
    };
    let rows: Vec<Row> = calibration.views.iter().map(row).collect();
    let header = ["Picture", "Corners", "RMS residual, px", "Largest, px", "Distance, mm"].map(String::from);
    html! {
        (table("Pictures", &header, &rows))
        @if !calibration.skipped.is_empty() {
            p { "Without corners, and left out: " (calibration.skipped.join(", ")) "." }
        }
    }
}

fn outliers(calibration: &CalibrationDocument) -> Markup {
    let rows: Vec<Row> = calibration
        .outliers
        .iter()
        .map(|outlier| {
            let length = outlier.residual_px[0].hypot(outlier.residual_px[1]);
            Row {
                pose: None,
                cells: vec![
                    Cell::Text(outlier.view.clone()),
                    Cell::Text(outlier.column.to_string()),
                    Cell::Text(outlier.row.to_string()),
                    Cell::short(Some(length)),
                    outlier
                        .standardised
                        .map_or(Cell::Text("–".into()), |sigma| Cell::Number(format!("{sigma:.0}"), sigma)),
                ],
            }
        })
        .collect();
    table("Outliers", &["Picture", "Column", "Row", "Residual, px", "In sigma"].map(String::from), &rows)
}
