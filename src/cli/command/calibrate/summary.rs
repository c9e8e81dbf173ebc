//! What is said of a calibration.

use crate::calibration::{Assessment, Calibration};
use crate::cli::output::{fixed, short, table};
use crate::formats::Detections;

/// Outliers and images without corners listed in the text; the document has all.
const LISTED: usize = 10;

/// Views listed in the text.
const LISTED_VIEWS: usize = 100;

/// The calibration of what was detected, in tables and sentences; the last one is the verdict.
pub(super) fn text(detections: &Detections, calibration: &Calibration, assessment: &Assessment) -> String {
    let Detections { observations, names, skipped } = detections;
    let Calibration { camera, rms, sigma, view_rms, outliers, .. } = calibration;
    let Assessment { map_errors: map, residuals, verdict, .. } = assessment;
    let intrinsics = camera.lens().parameter_names().iter().zip(camera.intrinsics()).enumerate();
    let all = camera.lens().parameter_names();
    let deviation = |i| match calibration.ties.leader(i) {
        _ if !calibration.estimated.contains(&i) => "fixed".into(),
        leader if leader != i => format!("{} = {}", short(calibration.sigma_of(i)), all[leader]),
        _ => short(calibration.sigma_of(i)),
    };
    let intrinsics: Vec<Vec<String>> =
        intrinsics.map(|(i, (name, value))| vec![(*name).into(), format!("{value:.6}"), deviation(i)]).collect();
    let views = names.iter().zip(view_rms).zip(observations.views()).take(LISTED_VIEWS);
    let mut views: Vec<Vec<String>> =
        views.map(|((name, rms), view)| vec![name.clone(), view.len().to_string(), short(*rms)]).collect();
    if names.len() > LISTED_VIEWS {
        views.push(vec![format!("and {} more", names.len() - LISTED_VIEWS), "-".into(), "-".into()]);
    }
    let optional = |error: Option<f64>| error.map_or("-".into(), short);
    let mut text = format!(
        "{} views, {} corners; lens {}, {} x {} px.",
        names.len(),
        observations.corner_count(),
        camera.lens().name(),
        camera.width(),
        camera.height(),
    );
    if !skipped.is_empty() {
        let more = if skipped.len() > LISTED { ", ..." } else { "" };
        let listed = skipped[..skipped.len().min(LISTED)].join(", ");
        text += &format!(" {} images without corners are left out: {listed}{more}.", skipped.len());
    }
    text += &format!(
        "\n\n{}\n\n{}\n\nResiduals [px]: RMS {}, sigma of a coordinate {}; lengths: median {}, 95 % below {}, largest {}; mean \
         ({}, {}).\nPredicted map error [px]: centre {}, edge {}, corner {}; RMS over the image {}.\n",
        table(&["intrinsic", "value", "sigma"], &intrinsics),
        table(&["view", "corners", "RMS [px]"], &views),
        short(*rms),
        short(*sigma),
        short(residuals.median),
        short(residuals.percentile_95),
        short(residuals.largest),
        fixed(residuals.mean.x, 4),
        fixed(residuals.mean.y, 4),
        optional(map.centre),
        optional(map.edge),
        optional(map.corner),
        short(map.rms),
    );
    if let Some([x, y]) = calibration.warp() {
        let mm = |[height, sigma]: [f64; 2]| format!("{} ± {}", fixed(height * 1e3, 3), short(sigma * 1e3));
        text += &format!("Board's middle above its rim [mm]: along x {}, along y {}.\n", mm(x), mm(y));
    }
    for outlier in outliers.iter().take(LISTED) {
        let (column, row) = observations.board().column_and_row(outlier.index);
        text += &format!(
            "Outlier: {}, column {column}, row {row}: {} px, {:.0} sigma.\n",
            names[outlier.view],
            short(outlier.residual.norm()),
            outlier.standardised,
        );
    }
    if outliers.len() > LISTED {
        text += &format!("... and {} more outliers; --json lists them all.\n", outliers.len() - LISTED);
    }
    text + &format!("\n{verdict}")
}
