//! Why a target cannot be printed as requested.

use thiserror::Error;

use super::paper::Paper;
use crate::figures::trimmed;

/// Why a target cannot be printed as requested. Lengths are mm.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PrintError {
    /// The board is none.
    #[error(
        "a checkerboard of {columns} × {rows} inner corners with squares of {square_mm} mm cannot be drawn: there must be 2 to 1000 \
             inner corners along each side, and a positive size"
    )]
    Board {
        /// Inner corners along x.
        columns: usize,
        /// Inner corners along y.
        rows: usize,
        /// Side of a square.
        square_mm: f64,
    },
    /// Of the board nothing but its points is known.
    #[error("a board of points cannot be drawn: the problem says where its points are, not what they look like")]
    NoPattern,
    /// The margin is none.
    #[error("the margin of {margin} mm must be a number from 0 on")]
    Margin {
        /// The margin.
        margin: f64,
    },
    /// The page is too small for the pattern.
    #[error("{paper} is too small: the pattern has {}, and with {} mm of white around it, title and scale bar it takes {}",
        area(*pattern), trimmed(*quiet, 2), area(*needed))]
    TooSmall {
        /// The page.
        paper: Paper,
        /// Size of the pattern.
        pattern: [f64; 2],
        /// The least white around it.
        quiet: f64,
        /// Size of a page that would do.
        needed: [f64; 2],
        /// The next standard size that does.
        next: Option<Paper>,
    },
    /// Nothing is left of a page for a part of the pattern.
    #[error("{paper} with a margin of {} mm has no room for a part of the pattern beside title, scale bar and marks", trimmed(*margin, 2))]
    NoRoom {
        /// The page.
        paper: Paper,
        /// The margin.
        margin: f64,
    },
    /// No page can be that large.
    #[error("the pattern takes a page of {}; a page has at most {} mm", area(*needed), Paper::MOST)]
    TooLarge {
        /// Size of a page that would do.
        needed: [f64; 2],
    },
    /// The pattern would be spread over too many pages.
    #[error("the pattern of {} takes more than {most} pages of {paper}", area(*pattern))]
    TooManyPages {
        /// Size of the pattern.
        pattern: [f64; 2],
        /// The page.
        paper: Paper,
        /// How many pages there may be.
        most: usize,
    },
}

/// Width and height as people read them.
fn area([width, height]: [f64; 2]) -> String {
    format!("{} × {} mm", trimmed(width, 2), trimmed(height, 2))
}
