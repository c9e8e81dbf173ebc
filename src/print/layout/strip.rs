//! The strip beside the pattern: which way x and y point, what is printed, and the bar by which the print's scale is checked.

use crate::print::artwork::{Rectangle, Shape, Text};

/// How high the strip is in mm.
pub(super) const HEIGHT: f64 = 16.0;

/// Length in mm that the mark of the axes takes at its beginning.
const AXES: f64 = 18.0;

/// Length in mm that the bar's end takes for its label.
const LABEL: f64 = 5.0;

/// Lengths in mm that the bar may have, the best first.
const BARS: [f64; 2] = [100.0, 50.0];

/// Shortest strip in mm.
pub(super) const SHORTEST: f64 = AXES + BARS[1] + LABEL;

/// Distance of the bar's ticks in mm.
const TICKS: f64 = 10.0;

/// Where the strip lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// Along the page's bottom.
    Bottom,
    /// Along its left, reading upwards.
    Left,
}

impl Side {
    pub(super) const ALL: [Self; 2] = [Self::Bottom, Self::Left];

    /// The axis of the page that the strip is stacked along.
    pub(super) fn across(self) -> usize {
        match self {
            Self::Bottom => 1,
            Self::Left => 0,
        }
    }
}

/// Length of the bar on a strip of `length`.
pub(super) fn bar(length: f64) -> f64 {
    BARS.into_iter().find(|bar| AXES + bar + LABEL <= length).unwrap_or(BARS[1])
}

/// What a strip says.
pub(super) struct Words<'a> {
    /// Its first line.
    pub(super) title: &'a str,
    /// What follows on the second, after how to print.
    pub(super) advice: &'a str,
    /// Whether corner 0 is on the page.
    pub(super) corner_0: bool,
}

/// The strip of that length, with its lower left corner at `corner` of the page.
pub(super) fn strip(side: Side, corner: [f64; 2], length: f64, words: &Words) -> Vec<Shape> {
    let Words { title, advice, corner_0 } = *words;
    let mut shapes: Vec<Shape> = axes(corner_0).iter().map(|shape| shape.moved(corner)).collect();
    let room = length - AXES;
    let bar = bar(length);
    let advice = format!("Print at 100 %, not fitted to the page, and measure this bar: {bar} mm.{advice}");
    let mut lines = scale_bar(bar);
    lines.push(Shape::Text(Text::new([0.0, 12.8], 3.2, title).fitted(room)));
    lines.push(Shape::Text(Text::new([0.0, 8.8], 2.8, &advice).fitted(room)));
    let [x, y] = corner;
    let place = |[u, v]: [f64; 2]| match side {
        Side::Bottom => [x + AXES + u, y + v],
        Side::Left => [x + HEIGHT - v, y + AXES + u],
    };
    shapes.extend(lines.iter().map(|line| match line.mapped(place) {
        Shape::Text(text) => Shape::Text(Text { upwards: side == Side::Left, ..text }),
        shape => shape,
    }));
    shapes
}

/// The bar: ticks whose middles are 10 mm apart, from 0 to `length`.
fn scale_bar(length: f64) -> Vec<Shape> {
    /// Width of the lines.
    const LINE: f64 = 0.2;
    /// Where the bar starts and its line lies: far enough for the label of 0.
    const START: [f64; 2] = [1.0, 3.4];
    let [x, y] = START;
    let block = |min: [f64; 2], max: [f64; 2]| Shape::Rectangle(Rectangle { min, max });
    let mut shapes = vec![block([x - LINE / 2.0, y], [x + length + LINE / 2.0, y + LINE])];
    let count = (length / TICKS) as usize;
    for i in 0..=count {
        let at = x + i as f64 * TICKS;
        let tall = if i % 5 == 0 { 3.6 } else { 2.4 };
        shapes.push(block([at - LINE / 2.0, y], [at + LINE / 2.0, y + tall]));
        let unit = if i == count { " mm" } else { "" };
        let label = format!("{}{unit}", i * TICKS as usize);
        shapes.push(Shape::Text(Text::new([at, 0.8], 2.2, &label).centred()));
    }
    shapes
}

/// Which way x and y point, from corner 0 where that is on the page, the one next to this mark. It is not turned with the strip.
fn axes(corner_0: bool) -> Vec<Shape> {
    /// Where the arrows begin, how long they are, and half of their width.
    const FROM: f64 = 3.0;
    const LENGTH: f64 = 9.5;
    const HALF: f64 = 0.15;
    /// Length and half of the width of an arrow's head.
    const HEAD: [f64; 2] = [2.4, 0.9];
    let tip = FROM + LENGTH;
    let line = Rectangle { min: [FROM, FROM - HALF], max: [tip - HEAD[0], FROM + HALF] };
    let head = vec![[tip, FROM], [tip - HEAD[0], FROM + HEAD[1]], [tip - HEAD[0], FROM - HEAD[1]]];
    let x = [Shape::Rectangle(line), Shape::Polygon(head)];
    let y = x.clone().map(|shape| shape.mapped(|[x, y]| [y, x]));
    let mut shapes = vec![Shape::Circle { centre: [FROM; 2], radius: 0.8 }];
    shapes.extend(x.into_iter().chain(y));
    let mut texts =
        vec![Text::new([tip + 0.6, FROM - 0.8], 3.0, "x"), Text::new([FROM, tip + 0.8], 3.0, "y").centred()];
    if corner_0 {
        texts.push(Text::new([FROM + 1.4, FROM + 1.6], 2.2, "corner 0"));
    }
    shapes.extend(texts.into_iter().map(Shape::Text));
    shapes
}
