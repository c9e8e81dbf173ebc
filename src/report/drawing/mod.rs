//! Plots as SVG and PNG, by kuva.

mod strips;
mod style;

use std::sync::Arc;

use kuva::backend::png::PngBackend;
use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{ColorMap, ForestPlot, Heatmap, LinePlot, QuiverPlot, SankeyPlot, ScatterPlot};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, render_multiple};
use thiserror::Error;

use super::figure::{Content, Figure, Hue, Interval, Line, Mark, Series};
pub(super) use strips::Frame;
use style::PX_PER_INCH;
pub use style::Style;

/// `figure` as an SVG document. The marks of a series with titles are groups with a `<title>` each.
pub fn svg(figure: &Figure, style: &Style) -> String {
    SvgBackend::new().render_scene(&scene(figure, style))
}

/// `figure` as a PNG picture of `dpi` dots per inch, at 96 px of the style to the inch.
///
/// # Errors
/// When the picture cannot be encoded.
pub fn png(figure: &Figure, style: &Style, dpi: f64) -> Result<Vec<u8>, DrawingError> {
    let scale = dpi / PX_PER_INCH;
    let mut scene = scene(figure, style);
    scale_dashes(&mut scene, scale);
    PngBackend::new().with_scale(scale as f32).render_scene(&scene).map_err(DrawingError)
}

/// Makes dashes longer: kuva takes their lengths as dots of the picture, all other lengths as px of the style.
fn scale_dashes(scene: &mut Scene, scale: f64) {
    for element in &mut scene.elements {
        let dashes = match element {
            Primitive::Line { stroke_dasharray, .. } | Primitive::PolyLine { stroke_dasharray, .. } => stroke_dasharray,
            Primitive::Path(path) => &mut path.stroke_dasharray,
            _ => continue,
        };
        if let Some(dashes) = dashes {
            let lengths = dashes.split([' ', ',']).filter_map(|length| length.parse::<f64>().ok());
            *dashes = lengths.map(|length| (scale * length).to_string()).collect::<Vec<_>>().join(" ");
        }
    }
}

/// Why a figure has no picture.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("the picture cannot be encoded: {0}")]
pub struct DrawingError(String);

fn scene(figure: &Figure, style: &Style) -> Scene {
    if let Content::Strips { strips, bands, end } = &figure.content {
        return strips::scene(strips, bands, *end, style);
    }
    let plots = plots(&figure.content, style);
    let layout = Layout::auto_from_plots(&plots)
        .with_width(style.width)
        .with_height(style.height)
        .with_x_label(figure.x.as_str())
        .with_y_label(figure.y.as_str())
        .with_tick_size(style.text)
        .with_label_size(style.text)
        .with_body_size(style.text)
        .with_theme(style.theme());
    render_multiple(plots, fitted(&figure.content, layout))
}

fn plots(content: &Content, style: &Style) -> Vec<Plot> {
    match content {
        Content::Series(series)
        | Content::LogSeries(series)
        | Content::Drawing(series)
        | Content::Rows { series, .. } => series.iter().map(|series| drawn(series, style)).collect(),
        Content::Map { rows, size: [width, height], most, unit } => {
            let numbers = || rows.iter().rev().map(|row| row.iter().map(|number| number.unwrap_or(f64::NAN)));
            let colours = on_fixed_scale(numbers().flatten(), (0.0, *most), ColorMap::Viridis);
            let map = Heatmap::new().with_data(numbers()).with_cell_size(1.0).with_color_map(colours);
            vec![Plot::Heatmap(map.with_x_range(0.0, *width).with_y_range(-height, 0.0).with_legend(*unit))]
        }
        Content::Field { rows, x, y, unit } => {
            let numbers = || rows.iter().rev().map(|row| row.iter().map(|number| number.unwrap_or(f64::NAN)));
            let there = || rows.iter().flatten().filter_map(|number| *number);
            let ends = (there().fold(f64::INFINITY, f64::min), there().fold(f64::NEG_INFINITY, f64::max));
            let colours = on_fixed_scale(numbers().flatten(), ends, ColorMap::Viridis);
            let field = Heatmap::new().with_data(numbers()).with_cell_size(1.0).with_color_map(colours);
            vec![Plot::Heatmap(field.with_x_range(x[0], x[1]).with_y_range(y[0], y[1]).with_legend(*unit))]
        }
        Content::Matrix { names, rows } => {
            let numbers = || rows.iter().rev().map(|row| row.iter().copied());
            let colours = on_fixed_scale(numbers().flatten(), (-1.0, 1.0), ColorMap::RedBlue);
            let matrix = Heatmap::new().with_data(numbers()).with_color_map(colours);
            let labels = (names.iter().rev().cloned().collect(), names.clone());
            vec![Plot::Heatmap(matrix.with_labels(labels.0, labels.1))]
        }
        Content::Arrows { arrows, scale, .. } => {
            let drawn = arrows.iter().map(|&([u, v], [du, dv])| (u, -v, du, -dv));
            let plot = QuiverPlot::new().with_arrows(drawn).with_scale(*scale).with_color(style.hue(Hue::Plan));
            vec![Plot::Quiver(plot.with_head_max_px(4.0).with_shaft_width(1.0))]
        }
        // Drawn without kuva's axes.
        Content::Strips { .. } => vec![],
        Content::Flow(links) => {
            let flow = links.iter().fold(SankeyPlot::new(), |flow, (from, to, count)| flow.with_link(from, to, *count));
            vec![Plot::Sankey(flow)]
        }
        Content::Intervals { rows, expected } => {
            let colour = style.hue(Hue::Plan);
            let add = |forest: ForestPlot, Interval { name, value, range }: &Interval| {
                forest.with_colored_row(name, *value, range.0, range.1, colour)
            };
            vec![Plot::Forest(rows.iter().fold(ForestPlot::new().with_null_value(*expected), add))]
        }
    }
}

fn drawn(series: &Series, style: &Style) -> Plot {
    let Series { name, hue, mark, points, titles } = series;
    let colour = style.hue(*hue);
    let (shape, size) = match mark {
        Mark::Line(line) => {
            let plot = LinePlot::new().with_data(points.iter().copied()).with_color(colour);
            let plot = if name.is_empty() { plot } else { plot.with_legend(name) };
            return Plot::Line(match line {
                Line::Solid => plot.with_stroke_width(2.0),
                Line::Dashed => plot.with_dashed(),
            });
        }
        Mark::Dots => (MarkerShape::Circle, 1.2),
        Mark::Discs => (MarkerShape::Circle, 5.0),
        Mark::Diamonds => (MarkerShape::Diamond, 5.0),
    };
    let plot = ScatterPlot::new().with_data(points.iter().copied()).with_color(colour).with_marker(shape);
    let plot = plot.with_size(size).with_legend(name);
    Plot::Scatter(if titles.is_empty() { plot } else { plot.with_tooltips().with_tooltip_labels(titles) })
}

/// kuva colours from the least number to the greatest; this undoes it for the scale from `least` to `most`. What is no number is
/// left out.
fn on_fixed_scale(numbers: impl Iterator<Item = f64>, (least, most): (f64, f64), colours: ColorMap) -> ColorMap {
    let (low, high) = numbers
        .filter(|number| number.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| (low.min(number), high.max(number)));
    ColorMap::Custom(Arc::new(move |share: f64| {
        if share.is_nan() {
            return "none".into();
        }
        let number = low + share * (high - low);
        colours.map(((number - least) / (most - least)).clamp(0.0, 1.0))
    }))
}

/// Rows of a picture count from its top.
fn from_top() -> TickFormat {
    TickFormat::Custom(Arc::new(|v: f64| format!("{:.0}", v.abs())))
}

/// The axes that the content asks for.
fn fitted(content: &Content, layout: Layout) -> Layout {
    match content {
        Content::Series(_)
        | Content::Strips { .. }
        | Content::Flow(_)
        | Content::Field { .. }
        | Content::Intervals { .. } => layout,
        Content::LogSeries(_) => layout.with_log_y(),
        Content::Drawing(_) => layout.with_equal_aspect(),
        Content::Rows { names, .. } => layout
            .with_y_categories(names.iter().rev().cloned().collect())
            .with_y_axis_min(0.5)
            .with_y_axis_max(names.len() as f64 + 0.5),
        Content::Map { .. } => layout.with_y_tick_format(from_top()),
        Content::Arrows { size: [width, height], .. } => {
            let framed =
                layout.with_x_axis_min(0.0).with_x_axis_max(*width).with_y_axis_min(-height).with_y_axis_max(0.0);
            framed.with_y_tick_format(from_top())
        }
        Content::Matrix { names, .. } => {
            layout.with_x_categories(names.clone()).with_y_categories(names.iter().rev().cloned().collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_are_as_long_in_a_picture_as_in_a_drawing() {
        let line = Series {
            name: "bound".into(),
            hue: Hue::Bound,
            mark: Mark::Line(Line::Dashed),
            points: vec![(0.0, 0.0), (1.0, 1.0)],
            titles: vec![],
        };
        let figure = Figure {
            name: "line".into(),
            title: String::new(),
            caption: String::new(),
            x: String::new(),
            y: String::new(),
            content: Content::Series(vec![line]),
        };
        let style = Style::paper(50.0, 40.0, 8.0);
        assert!(svg(&figure, &style).contains("stroke-dasharray=\"8 4\""));
        let mut scene = scene(&figure, &style);
        scale_dashes(&mut scene, 3.0);
        let scaled = SvgBackend::new().render_scene(&scene);
        assert!(scaled.contains("\"24 12\"") && !scaled.contains("\"8 4\""), "{scaled}");
    }
}
