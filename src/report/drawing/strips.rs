//! Strips over time, as kuva's own plots cannot be: small ones, one above the other, over one axis.

use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use kuva::render::render_utils::generate_ticks;

use super::style::Style;
use crate::figures::trimmed;
use crate::report::figure::{Band, BandKind, Hue, Line, Mark, Series, Strip};

/// Width of a character of the legend, as a share of its size: more than that of most.
const CHARACTER: f64 = 0.56;

/// How far a line that is drawn may be from its points, px.
const OFF_LINE: f64 = 0.15;

/// Least height of a strip against that of text: less has no room for two numbers.
const LEAST: f64 = 2.6;

/// Where the time axis is in a drawing of strips, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::report) struct Frame {
    /// Its beginning.
    pub(in crate::report) left: f64,
    /// Its end.
    pub(in crate::report) right: f64,
}

impl Frame {
    /// Of a drawing in a style.
    pub(in crate::report) fn new(style: &Style) -> Self {
        let text = f64::from(style.text);
        Self { left: 3.6 * text, right: style.width - text }
    }
}

/// A drawing of strips that is begun.
struct Strips<'s> {
    scene: Scene,
    style: &'s Style,
    frame: Frame,
    /// Where the time ends, s.
    end: f64,
    /// Height of a line of text, px.
    line: f64,
    /// Size of small text, px.
    small: u32,
}

/// A place for text: its anchor's x and its baseline's y, px.
type Place = (f64, f64);

/// Strips with bands above and behind them, over a time axis from 0 to `end` (s). The drawing is higher than its style says where
/// strips would be too low to be read.
pub(super) fn scene(strips: &[Strip], bands: &[Band], end: f64, style: &Style) -> Scene {
    let text = f64::from(style.text);
    let background = Some(style.colours.paper).filter(|&paper| paper != "none");
    let mut scene = Scene::new(style.width, style.height).with_background(background);
    scene.text_color = Some(style.colours.ink.into());
    let frame = Frame::new(style);
    let mut drawing = Strips {
        scene,
        style,
        frame,
        end: if end > 0.0 { end } else { 1.0 },
        line: 1.4 * text,
        small: style.text.saturating_sub(1).max(1),
    };
    let lane = [drawing.line, drawing.line + 0.7 * text];
    let heads: Vec<f64> = strips.iter().map(|strip| drawing.head(strip)).collect();
    let around = lane[1] + heads.iter().sum::<f64>() + 2.0 * drawing.line;
    let height = style.height.max(around + LEAST * text * strips.len() as f64);
    drawing.scene.height = height;
    let (bottom, room) = (height - 2.0 * drawing.line, height - around);
    let shares: f64 = strips.iter().map(|strip| strip.height).sum();
    let mut tops = Vec::new();
    let mut y = lane[1];
    for (strip, head) in strips.iter().zip(&heads) {
        let top = y + head;
        y = top + room * strip.height / shares;
        tops.push([top, y]);
    }
    drawing.bands(bands, lane, &tops);
    drawing.time_axis(&tops, bottom);
    for ((strip, rows), head) in strips.iter().zip(&tops).zip(&heads) {
        drawing.strip(strip, *rows, rows[0] - head);
    }
    drawing.scene
}

impl Strips<'_> {
    fn x(&self, time: f64) -> f64 {
        self.frame.left + (self.frame.right - self.frame.left) * (time / self.end).clamp(0.0, 1.0)
    }

    fn write(&mut self, content: &str, (x, y): Place, size: u32, anchor: TextAnchor, colour: &str) {
        let color = Some(colour.into());
        self.scene.add(Primitive::Text {
            x,
            y,
            content: content.into(),
            size,
            anchor,
            rotate: None,
            bold: false,
            color,
        });
    }

    fn stroke(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], colour: &str) {
        let (stroke, stroke_width, stroke_dasharray) = (colour.into(), 1.0, None);
        self.scene.add(Primitive::Line { x1, y1, x2, y2, stroke, stroke_width, stroke_dasharray });
    }

    /// A rectangle over a time, between two heights.
    fn block(&mut self, time: (f64, f64), [top, bottom]: [f64; 2], fill: &str, stroke: Option<&str>, opacity: f64) {
        let x = self.x(time.0);
        // Pictures that take no time are seen all the same.
        let width = (self.x(time.1) - x).max(1.0);
        let (stroke, stroke_width) = (stroke.map(Into::into), stroke.map(|_| 1.0));
        let opacity = Some(opacity).filter(|&opacity| opacity < 1.0);
        let height = bottom - top;
        self.scene.add(Primitive::Rect { x, y: top, width, height, fill: fill.into(), stroke, stroke_width, opacity });
    }

    /// The lane with what takes its time, and its shade on all strips.
    fn bands(&mut self, bands: &[Band], lane: [f64; 2], strips: &[[f64; 2]]) {
        let colours = &self.style.colours;
        let (plan, other, views, grid, ink) = (colours.plan, colours.other, colours.views, colours.grid, colours.ink);
        let middle = f64::midpoint(lane[0], lane[1]);
        self.stroke([self.frame.left, middle], [self.frame.right, middle], grid);
        let mut free = f64::NEG_INFINITY;
        for Band { time, kind, label, title } in bands {
            let shade = match kind {
                BandKind::Pictures => Some((views, 0.14)),
                BandKind::NotSafe => Some((other, 0.18)),
                BandKind::RoundAbout => None,
            };
            if let Some((colour, opacity)) = shade {
                for rows in strips {
                    self.block(*time, *rows, colour, None, opacity);
                }
            }
            self.scene.elements.push(Primitive::GroupStart {
                transform: None,
                title: Some(title.clone()),
                extra_attrs: None,
            });
            match kind {
                BandKind::Pictures => self.block(*time, lane, plan, None, 1.0),
                BandKind::NotSafe => self.block(*time, lane, other, None, 1.0),
                BandKind::RoundAbout => self.block(*time, lane, "none", Some(ink), 1.0),
            }
            let middle = f64::midpoint(self.x(time.0), self.x(time.1));
            let half = 0.5 * self.width_of(label);
            if middle - half > free && !label.is_empty() {
                self.write(label, (middle, lane[0] - 0.25 * self.line), self.small, TextAnchor::Middle, ink);
                free = middle + half;
            }
            self.scene.elements.push(Primitive::GroupEnd);
        }
    }

    /// About the width of small text, with a space, px.
    fn width_of(&self, text: &str) -> f64 {
        CHARACTER * f64::from(self.small) * (text.chars().count() + 1) as f64
    }

    /// What the legend of a strip names.
    fn named<'a>(&self, strip: &'a Strip) -> Vec<(&'a Series, f64)> {
        let named =
            strip.series.iter().filter(|series| matches!(series.mark, Mark::Line(_)) && !series.name.is_empty());
        named.map(|series| (series, 1.8 * self.line + self.width_of(&series.name))).collect()
    }

    /// Whether a strip's legend stands beside its name, and not below.
    fn has_one_row(&self, strip: &Strip) -> bool {
        let legend: f64 = self.named(strip).iter().map(|(_, width)| width).sum();
        1.1 * self.width_of(&strip.name) + legend < self.frame.right - self.frame.left
    }

    /// Height of what stands above a strip, px.
    fn head(&self, strip: &Strip) -> f64 {
        self.line * if self.has_one_row(strip) { 1.6 } else { 2.5 }
    }

    /// A strip between two heights, with its name and legend below `above`.
    fn strip(&mut self, strip: &Strip, rows: [f64; 2], above: f64) {
        let (ink, grid) = (self.style.colours.ink, self.style.colours.grid);
        let Frame { left, right } = self.frame;
        let baseline = rows[0] - 0.35 * self.line;
        let name_at = if self.has_one_row(strip) { baseline } else { baseline - 0.9 * self.line };
        debug_assert!(name_at > above, "{name_at} {above}");
        self.write(&strip.name, (left, name_at), self.style.text, TextAnchor::Start, ink);
        self.legend(strip, baseline);
        let (low, high) = strip.range;
        let y = |value: f64| rows[1] - (rows[1] - rows[0]) * (value - low) / (high - low);
        let ticks = ((rows[1] - rows[0]) / self.line).clamp(2.0, 5.0) as usize;
        for tick in generate_ticks(low, high, ticks) {
            self.stroke([left, y(tick)], [right, y(tick)], grid);
            let place = (left - 0.3 * self.line, y(tick) + 0.35 * f64::from(self.small));
            self.write(&trimmed(tick, 4), place, self.small, TextAnchor::End, ink);
        }
        self.stroke([left, rows[0]], [left, rows[1]], grid);
        for series in &strip.series {
            let points: Vec<(f64, f64)> = series.points.iter().map(|&(time, value)| (self.x(time), y(value))).collect();
            self.series(series, &points, rows);
        }
    }

    fn legend(&mut self, strip: &Strip, baseline: f64) {
        let named = self.named(strip);
        let mut x = self.frame.right - named.iter().map(|(_, width)| width).sum::<f64>() + 0.4 * self.line;
        for (series, width) in named {
            let height = baseline - 0.3 * f64::from(self.small);
            self.line(series, &[(x, height), (x + 1.2 * self.line, height)]);
            let ink = self.style.colours.ink;
            self.write(&series.name, (x + 1.5 * self.line, baseline), self.small, TextAnchor::Start, ink);
            x += width;
        }
    }

    fn series(&mut self, series: &Series, points: &[(f64, f64)], rows: [f64; 2]) {
        if matches!(series.mark, Mark::Line(_)) {
            self.line(series, &thinned(points));
            return;
        }
        let colour = self.style.hue(series.hue);
        for (i, &(cx, cy)) in points.iter().enumerate() {
            let title = series.titles.get(i).cloned();
            self.scene.elements.push(Primitive::GroupStart { transform: None, title, extra_attrs: None });
            self.scene.add(Primitive::Circle {
                cx,
                cy,
                r: 0.3 * self.line,
                fill: colour.into(),
                fill_opacity: None,
                stroke: Some(self.style.colours.ink.into()),
                stroke_width: Some(1.0),
            });
            // Where there is more room.
            let on_the_left = cx < f64::midpoint(self.frame.left, self.frame.right);
            let (x, anchor) = if on_the_left {
                (cx + 0.5 * self.line, TextAnchor::Start)
            } else {
                (cx - 0.5 * self.line, TextAnchor::End)
            };
            let y = if cy > f64::midpoint(rows[0], rows[1]) { cy - 0.35 * self.line } else { cy + 0.9 * self.line };
            let ink = self.style.colours.ink;
            self.write(&series.name, (x, y), self.small, anchor, ink);
            self.scene.elements.push(Primitive::GroupEnd);
        }
    }

    fn line(&mut self, series: &Series, points: &[(f64, f64)]) {
        let (width, dashes) = match (series.mark, series.hue) {
            (Mark::Line(Line::Dashed), _) => (1.2, Some("6 4".to_owned())),
            (_, Hue::Views) => (1.3, None),
            _ => (1.8, None),
        };
        // A tenth of a px is fine enough; kuva would write all digits.
        let step = |(i, (x, y)): (usize, &(f64, f64))| format!("{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
        self.scene.add(Primitive::Path(Box::new(PathData {
            d: points.iter().enumerate().map(step).collect(),
            fill: None,
            stroke: self.style.hue(series.hue).into(),
            stroke_width: width,
            opacity: None,
            stroke_dasharray: dashes,
        })));
    }

    fn time_axis(&mut self, strips: &[[f64; 2]], bottom: f64) {
        let (ink, grid) = (self.style.colours.ink, self.style.colours.grid);
        let width = self.frame.right - self.frame.left;
        let ticks = (width / (8.0 * f64::from(self.style.text))).clamp(2.0, 10.0) as usize;
        self.stroke([self.frame.left, bottom], [self.frame.right, bottom], ink);
        for tick in generate_ticks(0.0, self.end, ticks) {
            let x = self.x(tick);
            for rows in strips {
                self.stroke([x, rows[0]], [x, rows[1]], grid);
            }
            self.stroke([x, bottom], [x, bottom + 0.3 * self.line], ink);
            let place = (x, bottom + self.line);
            self.write(&trimmed(tick, 4), place, self.small, TextAnchor::Middle, ink);
        }
        let place = (f64::midpoint(self.frame.left, self.frame.right), bottom + 1.85 * self.line);
        self.write("time [s]", place, self.small, TextAnchor::Middle, ink);
    }
}

/// Points of a line from left to right without those that do not show.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let is_off = |[from, to]: [usize; 2], i: usize| {
        let ((x1, y1), (x2, y2), (x, y)) = (points[from], points[to], points[i]);
        let share = if x2 > x1 { (x - x1) / (x2 - x1) } else { 0.0 };
        (y - (y1 + share * (y2 - y1))).abs() > OFF_LINE
    };
    let mut kept: Vec<usize> = (0..points.len().min(1)).collect();
    for to in 1..points.len() {
        let from = kept[kept.len() - 1];
        if (from + 1..to).any(|i| is_off([from, to], i)) {
            kept.push(to - 1);
        }
    }
    kept.extend((points.len() > 1).then(|| points.len() - 1));
    kept.into_iter().map(|i| points[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_corners_and_curves() {
        let corner: Vec<(f64, f64)> =
            (0..=100).map(|i| (f64::from(i), if i < 40 { 0.0 } else { f64::from(i) - 40.0 })).collect();
        assert_eq!(thinned(&corner), [(0.0, 0.0), (40.0, 0.0), (100.0, 60.0)]);
        let parabola: Vec<(f64, f64)> = (0..=100).map(|i| (f64::from(i), f64::from(i * i) / 100.0)).collect();
        let kept = thinned(&parabola);
        assert!((8..40).contains(&kept.len()), "{kept:?}");
        for pair in kept.windows(2) {
            for &(x, y) in parabola.iter().filter(|point| point.0 > pair[0].0 && point.0 < pair[1].0) {
                let on_line = pair[0].1 + (x - pair[0].0) / (pair[1].0 - pair[0].0) * (pair[1].1 - pair[0].1);
                assert!((y - on_line).abs() <= OFF_LINE);
            }
        }
        // A step, and what is no line yet.
        assert_eq!(thinned(&[(0.0, 0.0), (1.0, 0.0), (1.0, 5.0), (2.0, 5.0)]).len(), 4);
        assert_eq!((thinned(&[]), thinned(&[(1.0, 2.0)])), (vec![], vec![(1.0, 2.0)]));
    }
}
