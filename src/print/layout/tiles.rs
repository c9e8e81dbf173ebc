//! A pattern spread over several pages.
//!
//! The pattern with its white border is divided into parts, one a page. A page shows a little more than its part, so that
//! neighbours overlap, and marks beside it say where the part ends. Cut there, pages join edge to edge; cut on one side only, one is laid
//! on the other, mark on mark. Nothing is printed on the pattern itself.

use super::strip::{self, Side, Words, strip};
use super::{Page, Print, Tile, Tiling};
use crate::print::artwork::{Artwork, Rectangle, Shape};
use crate::print::error::PrintError;
use crate::print::paper::Paper;

/// Width in mm of what two neighbours both have.
const OVERLAP: f64 = 10.0;

/// Width in mm of the band around the window, where the marks are.
const BAND: f64 = 5.0;

/// Smallest part in mm.
const LEAST: f64 = 20.0;

/// Pages at most: nobody puts more together.
const MOST: usize = 400;

/// The pattern on pages of that paper, turned as it takes fewer of them.
pub(super) fn tiles(artwork: &Artwork, paper: Paper, margin: f64, title: &str) -> Result<Print, PrintError> {
    let ways = [paper, paper.turned()].into_iter().filter_map(|paper| Grid::new(artwork, paper, margin));
    let grid = ways.min_by_key(Grid::count).ok_or(PrintError::NoRoom { paper, margin })?;
    if grid.count() > MOST {
        return Err(PrintError::TooManyPages { pattern: artwork.size, paper: grid.paper, most: MOST });
    }
    Ok(grid.print(artwork, title))
}

/// The parts: where they begin and end in frame T.
struct Grid {
    paper: Paper,
    margin: f64,
    /// Bounds along x and along y, ascending.
    bounds: [Vec<f64>; 2],
}

impl Grid {
    /// None where a page has no room for a part.
    fn new(artwork: &Artwork, paper: Paper, margin: f64) -> Option<Self> {
        let inside = paper.size.map(|side| side - 2.0 * margin);
        let room = [inside[0], inside[1] - strip::HEIGHT].map(|side| side - 2.0 * BAND - OVERLAP);
        if inside[0] < strip::SHORTEST || room.iter().any(|&side| side < LEAST) {
            return None;
        }
        let bounds = [0, 1].map(|axis| {
            let half = artwork.size[axis] / 2.0 + artwork.quiet;
            divided([-half, half], room[axis], &artwork.cuts[axis])
        });
        Some(Self { paper, margin, bounds })
    }

    /// Columns and rows.
    fn columns_and_rows(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.bounds[axis].len() - 1)
    }

    fn count(&self) -> usize {
        let [columns, rows] = self.columns_and_rows();
        columns.saturating_mul(rows)
    }

    fn print(&self, artwork: &Artwork, title: &str) -> Print {
        let [columns, rows] = self.columns_and_rows();
        let places = (1..=rows).flat_map(|row| (1..=columns).map(move |column| (row, column)));
        let pages = places.map(|(row, column)| self.page(artwork, title, row, column)).collect();
        let tiling = Some(Tiling { rows, columns, overlap: OVERLAP });
        let scale_bar = strip::bar(self.paper.size[0] - 2.0 * self.margin);
        Print { title: title.to_owned(), pages, paper: self.paper, white: artwork.quiet, scale_bar, tiling }
    }

    fn page(&self, artwork: &Artwork, title: &str, row: usize, column: usize) -> Page {
        let (size, margin) = (self.paper.size, self.margin);
        let [columns, rows] = self.columns_and_rows();
        // Rows count from the top, y from the bottom.
        let place = [column - 1, rows - row];
        let part = Rectangle {
            min: [0, 1].map(|axis| self.bounds[axis][place[axis]]),
            max: [0, 1].map(|axis| self.bounds[axis][place[axis] + 1]),
        };
        let middle = [size[0] / 2.0, f64::midpoint(size[1], strip::HEIGHT)];
        let origin = [0, 1].map(|axis| middle[axis] - f64::midpoint(part.min[axis], part.max[axis]));
        let last = [columns - 1, rows - 1];
        let seen = Rectangle {
            min: [0, 1].map(|axis| part.min[axis] - if place[axis] > 0 { OVERLAP / 2.0 } else { 0.0 }),
            max: [0, 1].map(|axis| part.max[axis] + if place[axis] < last[axis] { OVERLAP / 2.0 } else { 0.0 }),
        };
        let on_page = |rectangle: Rectangle| {
            let moved = |corner: [f64; 2]| [corner[0] + origin[0], corner[1] + origin[1]];
            Rectangle { min: moved(rectangle.min), max: moved(rectangle.max) }
        };
        let window = on_page(seen);
        let pattern = artwork.shapes.iter().filter(|shape| shape.bounds().overlaps(&seen));
        let title = format!("Row {row} of {rows}, column {column} of {columns}. {title}");
        let words = Words { title: &title, advice: " Join at the marks.", corner_0: place == [0, 0] };
        let mut frame = strip(Side::Bottom, [margin; 2], size[0] - 2.0 * margin, &words);
        frame.extend(marks(on_page(part), window));
        Page {
            size,
            pattern: pattern.map(|shape| shape.moved(origin)).collect(),
            window: Some(window),
            frame,
            tile: Some(Tile { row, column, part, origin }),
        }
    }
}

/// Short lines around the window where the part ends.
fn marks(part: Rectangle, window: Rectangle) -> Vec<Shape> {
    /// Half of a line's width.
    const HALF: f64 = 0.05;
    /// Where a line begins and ends, from the window.
    const FROM: f64 = 1.0;
    const TO: f64 = BAND - 0.5;
    let mut marks = Vec::new();
    for axis in [0, 1] {
        let across = 1 - axis;
        for at in [part.min[axis], part.max[axis]] {
            for [from, to] in [
                [window.min[across] - TO, window.min[across] - FROM],
                [window.max[across] + FROM, window.max[across] + TO],
            ] {
                let (mut min, mut max) = ([0.0; 2], [0.0; 2]);
                (min[axis], max[axis]) = (at - HALF, at + HALF);
                (min[across], max[across]) = (from, to);
                marks.push(Shape::Rectangle(Rectangle { min, max }));
            }
        }
    }
    marks
}

/// Bounds of as few parts of `[begin, end]` as can be with at most `room` each, at those of `cuts` that make them about equal;
/// elsewhere where `cuts` are too far apart.
fn divided([begin, end]: [f64; 2], room: f64, cuts: &[f64]) -> Vec<f64> {
    let mut full = vec![begin];
    let mut from = begin;
    while end - from > room {
        let within = cuts.iter().rev().find(|&&cut| cut > from && cut - from <= room);
        from = within.copied().unwrap_or(from + room);
        full.push(from);
        if full.len() > MOST {
            break;
        }
    }
    full.push(end);
    let count = full.len() - 1;
    let nearest = |at: f64| cuts.iter().copied().min_by(|a, b| (a - at).abs().total_cmp(&(b - at).abs()));
    let equal = |i: usize| match i {
        0 => Some(begin),
        i if i == count => Some(end),
        i => nearest(begin + (end - begin) * i as f64 / count as f64),
    };
    let even: Option<Vec<f64>> = (0..=count).map(equal).collect();
    let is_possible = |bounds: &Vec<f64>| bounds.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] <= room);
    even.filter(is_possible).unwrap_or(full)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_end_at_the_cuts_if_they_can() {
        let cuts: Vec<f64> = (0..9).map(|i| f64::from(i) * 10.0).collect();
        assert_eq!(divided([-5.0, 85.0], 90.0, &cuts), [-5.0, 85.0]);
        assert_eq!(divided([-5.0, 85.0], 60.0, &cuts), [-5.0, 40.0, 85.0]);
        // Even parts would be too large with their ends at cuts.
        assert_eq!(divided([-5.0, 85.0], 46.0, &[10.0, 20.0, 39.0, 48.0]), [-5.0, 39.0, 85.0]);
        assert_eq!(divided([-5.0, 85.0], 47.0, &[10.0, 20.0, 38.0, 49.0]), [-5.0, 38.0, 85.0]);
        // Squares that are larger than a page are cut wherever it ends.
        assert_eq!(divided([0.0, 100.0], 40.0, &[50.0]), [0.0, 40.0, 50.0, 90.0, 100.0]);
        assert_eq!(divided([0.0, 100.0], 40.0, &[]), [0.0, 40.0, 80.0, 100.0]);
        assert!(divided([0.0, 1e9], 40.0, &[]).len() > MOST, "given up");
    }
}
