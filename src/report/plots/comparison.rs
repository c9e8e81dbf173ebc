//! Methods side by side.

use crate::plan::document::ComparisonDocument;
use crate::report::figure::{Content, Figure, Hue, Line, Mark, Series};

/// The map error of every method against the number of poses.
pub(super) fn map_errors(comparison: &ComparisonDocument) -> Figure {
    let mut methods: Vec<&str> = Vec::new();
    for row in &comparison.rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let hue = |method: &str| match method {
        "random" => Hue::Views,
        method if method.starts_with("kmeans") => Hue::Other,
        _ => Hue::Plan,
    };
    // Methods of one colour differ in their stroke.
    let mut used: Vec<Hue> = Vec::new();
    let mut series = Vec::new();
    for method in methods {
        let hue = hue(method);
        let line = if used.contains(&hue) { Line::Dashed } else { Line::Solid };
        used.push(hue);
        let rows = comparison.rows.iter().filter(|row| row.method == method);
        let points = rows.filter_map(|row| Some((row.count as f64, row.map_error_px?))).collect();
        series.push(Series { name: method.into(), hue, mark: Mark::Line(line), points, titles: vec![] });
    }
    Figure {
        name: "methods".into(),
        title: "Map error by method".into(),
        caption: "Predicted map error of each method's choice; methods that depend on a seed at the median of several."
            .into(),
        x: "poses".into(),
        y: "map error [px]".into(),
        content: Content::LogSeries(series),
    }
}
