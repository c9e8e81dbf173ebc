//! A pattern on one page.

use super::strip::{self, Side, Words, strip};
use super::{Page, Print, ROUNDING};
use crate::print::artwork::{Artwork, Shape};
use crate::print::paper::Paper;

/// Where pattern and strip lie on a page.
pub(super) struct Sheet {
    paper: Paper,
    margin: f64,
    side: Side,
    /// The pattern's centre.
    centre: [f64; 2],
    /// Least white around the pattern, to the strip and to the page's edges.
    white: f64,
}

impl Sheet {
    /// The page with the most white around the pattern, of those that have enough: the paper may be turned, and the strip may lie at
    /// the bottom or at the left. A pattern that is wider than high lies on a page that is, if both ways are as good.
    pub(super) fn best(artwork: &Artwork, paper: Paper, margin: f64) -> Option<Self> {
        let is_wide = |[width, height]: [f64; 2]| width > height;
        let lies_as_the_pattern = paper.name.is_none() || is_wide(paper.size) == is_wide(artwork.size);
        let (first, second) = if lies_as_the_pattern { (paper, paper.turned()) } else { (paper.turned(), paper) };
        let ways = [first, second].into_iter().flat_map(|paper| Side::ALL.map(|side| (paper, side)));
        let sheets = ways.filter_map(|(paper, side)| Self::new(artwork, paper, margin, side));
        let ample = |sheet: &Self| sheet.white.min(artwork.ample);
        sheets.reduce(|best, other| if ample(&other) > ample(&best) { other } else { best })
    }

    /// Size of a page that is just large enough.
    pub(super) fn needed(artwork: &Artwork, margin: f64) -> [f64; 2] {
        let [bottom, left] = Side::ALL.map(|side| least(artwork, margin, side));
        if bottom[0] * bottom[1] < left[0] * left[1] { bottom } else { left }
    }

    fn new(artwork: &Artwork, paper: Paper, margin: f64, side: Side) -> Option<Self> {
        let needed = least(artwork, margin, side);
        if (0..2).any(|axis| paper.size[axis] < needed[axis] - ROUNDING) {
            return None;
        }
        let (across, along) = (side.across(), 1 - side.across());
        let edge = artwork.quiet.max(margin);
        // Across: the strip, white, the pattern, white. The pattern stands in the middle of what is free.
        let begin = margin + strip::HEIGHT;
        let free = paper.size[across] - begin - artwork.size[across];
        let before = (free / 2.0).min(free - edge);
        let beside = (paper.size[along] - artwork.size[along]) / 2.0;
        let mut centre = [0.0; 2];
        centre[across] = begin + before + artwork.size[across] / 2.0;
        centre[along] = paper.size[along] / 2.0;
        Some(Self { paper, margin, side, centre, white: before.min(free - before).min(beside) })
    }

    /// The page of that `title`.
    pub(super) fn print(self, artwork: &Artwork, title: &str) -> Print {
        let Self { paper, margin, side, centre, white } = self;
        let length = paper.size[1 - side.across()] - 2.0 * margin;
        let pattern: Vec<Shape> = artwork.shapes.iter().map(|shape| shape.moved(centre)).collect();
        let frame = strip(side, [margin; 2], length, &Words { title, advice: "", corner_0: true });
        let page = Page { size: paper.size, pattern, window: None, frame, tile: None };
        let title = title.to_owned();
        Print { title, pages: vec![page], paper, white, scale_bar: strip::bar(length), tiling: None }
    }
}

/// Size of the smallest page with the strip at that side.
fn least(artwork: &Artwork, margin: f64, side: Side) -> [f64; 2] {
    let edge = artwork.quiet.max(margin);
    let (across, along) = (side.across(), 1 - side.across());
    let mut size = [0.0; 2];
    size[across] = margin + strip::HEIGHT + artwork.quiet + artwork.size[across] + edge;
    size[along] = (artwork.size[along] + 2.0 * edge).max(strip::SHORTEST + 2.0 * margin);
    size.map(|side| side.max(Paper::LEAST))
}
