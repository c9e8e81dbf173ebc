//! Calibration targets at true scale, as PDF and SVG.
//!
//! ```text
//! Board → Artwork (black shapes in frame T) → Print (pages, each with title and scale bar) → PDF, SVG
//! ```
//!
//! Lengths are mm here, as those of paper and printers are. On every page **x points to the right and y up**, as frame T of
//! [`target`](crate::target) is seen by whoever faces the printed side: z points at them, and corner 0 is the lower left one.
//!
//! ```
//! use calipose::print::{Artwork, Print, PrintSettings};
//! use calipose::target::Board;
//!
//! let board = Board::checkerboard(8, 6, 0.035);
//! let print = Print::new(&Artwork::new(&board)?, "my robot", &PrintSettings::default())?;
//! assert_eq!(print.paper.to_string(), "A3 (420 × 297 mm)");
//! let (pdf, svg) = (print.pdf(), print.svg());
//! assert!(pdf.starts_with(b"%PDF") && svg[0].contains(r#"width="420mm" height="297mm""#));
//! # Ok::<(), calipose::print::PrintError>(())
//! ```

mod artwork;
mod error;
mod layout;
mod paper;
mod pattern;
mod pdf;
mod svg;

pub use artwork::{Anchor, Artwork, Rectangle, Shape, Text};
pub use error::PrintError;
pub use layout::{Page, Print, PrintSettings, Tile, Tiling};
pub use paper::{Paper, PaperError};
pub use pattern::Pattern;

/// What every file of this room has in it, by which it is known.
pub const MARK: &str = "Made by calipose board";

impl Print {
    /// All pages as one PDF file. Viewers that heed what it asks for print it at 100 %.
    pub fn pdf(&self) -> Vec<u8> {
        pdf::pdf(self)
    }

    /// Each page as an SVG file, in the pages' order.
    pub fn svg(&self) -> Vec<String> {
        self.pages.iter().map(|page| svg::svg(page, &self.title)).collect()
    }
}
