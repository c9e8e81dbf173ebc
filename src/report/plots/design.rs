//! The design of a set-up: what changes cost, and the map over the board's position.

use crate::plan::document::{DesignDocument, DesignMap, Sensitivity};
use crate::report::figure::{Content, Figure, Hue, Line, Mark, Series};

/// The figures of a design.
pub(super) fn figures(design: &DesignDocument) -> Vec<Figure> {
    let best = design.best.map_error_px.unwrap_or(f64::NAN);
    let sensitivity = design.sensitivity.iter().enumerate().filter_map(|(i, sensitivity)| of(i, sensitivity, best));
    sensitivity.chain(design.map.as_ref().map(map)).collect()
}

fn of(i: usize, Sensitivity { name, points }: &Sensitivity, best: f64) -> Option<Figure> {
    let numbers = points.iter().filter_map(|point| Some((point.number?, point.map_error_px?)));
    let points: Vec<(f64, f64)> = numbers.collect();
    let titles = points.iter().map(|(number, map_error)| format!("{number}: {map_error:.3} px")).collect();
    let least = points.iter().copied().filter(|(_, map_error)| *map_error <= best).collect();
    (points.len() > 1).then(|| Figure {
        name: format!("sensitivity-{}", i + 1).into(),
        title: format!("Map error by {name}"),
        caption: "The best set-up with this changed alone; the diamond is the best.".into(),
        x: name.clone(),
        y: "map error [px]".into(),
        content: Content::Series(vec![
            Series {
                name: String::new(),
                hue: Hue::Plan,
                mark: Mark::Line(Line::Solid),
                points: points.clone(),
                titles: vec![],
            },
            Series { name: "changed".into(), hue: Hue::Plan, mark: Mark::Discs, points, titles },
            Series { name: "best".into(), hue: Hue::Other, mark: Mark::Diamonds, points: least, titles: vec![] },
        ]),
    })
}

fn map(map: &DesignMap) -> Figure {
    let ends = |values: &[f64]| {
        let (first, last) = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(1.0));
        let half = (last - first) / (2.0 * (values.len().max(2) - 1) as f64);
        [first - half, last + half]
    };
    Figure {
        name: "map".into(),
        title: "Map error over the board's position".into(),
        caption: "The best set-up with the board elsewhere: predicted map error of the best plan found. Empty where the board is off \
                  the surface, or no plan is possible."
            .into(),
        x: map.x.clone(),
        y: map.y.clone(),
        content: Content::Field {
            rows: map.map_error_px.clone(),
            x: ends(&map.x_values),
            y: ends(&map.y_values),
            unit: "px",
        },
    }
}
