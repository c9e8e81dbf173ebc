//! The calibration target that `calipose board --json` drew.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::print::{Artwork, Print};
use crate::problem::Problem;

/// What was drawn of the target, and the files.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BoardDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: ProblemReference,
    /// The pattern.
    pub pattern: PatternDocument,
    /// Every page.
    pub page: PageDocument,
    /// How the pages are put together; `null` where there is one.
    pub tiles: Option<TilesDocument>,
    /// Length of the bar on every page by which the print's scale is checked.
    pub scale_bar_mm: f64,
    /// The files.
    pub files: Vec<PrintedFile>,
}

/// The pattern. Seen from the front, on the page, x points to the right and y up; corner 0 is the lower left one.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PatternDocument {
    /// What kind of target it is: `checkerboard`.
    pub kind: String,
    /// Inner corners along x.
    pub columns: usize,
    /// Inner corners along y.
    pub rows: usize,
    /// Side of a square.
    pub square_mm: f64,
    /// Width and height of all squares.
    pub size_mm: [f64; 2],
    /// Least width of the white around them.
    pub white_mm: f64,
}

/// A page.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PageDocument {
    /// Name of its standard size; `null` for another.
    pub name: Option<String>,
    /// Width and height, as it lies.
    pub size_mm: [f64; 2],
}

/// How pages are put together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TilesDocument {
    /// Rows of pages.
    pub rows: usize,
    /// Columns of pages.
    pub columns: usize,
    /// Width of the strip that neighbours both have.
    pub overlap_mm: f64,
}

/// A file with a page, or with all of them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct PrintedFile {
    /// The file.
    pub file: PathBuf,
    /// Row of its page, from 1 at the top; `null` where the file has all pages.
    pub row: Option<usize>,
    /// Column of its page, from 1 at the left; `null` where the file has all pages.
    pub column: Option<usize>,
}

impl PrintedFile {
    /// The file of the page at that row and column, or of all.
    pub fn new(file: PathBuf, place: Option<(usize, usize)>) -> Self {
        let (row, column) = place.unzip();
        Self { file, row, column }
    }
}

impl Document for BoardDocument {
    const FORMAT: &'static str = "calipose.board";
    const VERSION: u32 = 1;
}

impl BoardDocument {
    /// The document of the problem's board as it was printed to `files`.
    pub fn new(problem: &Problem, artwork: &Artwork, print: &Print, files: &[PrintedFile]) -> Self {
        /// To a nanometre, as the problem file has it.
        fn rounded(mm: f64) -> f64 {
            (mm * 1e6).round() / 1e6
        }
        let board = problem.target.board;
        Self {
            header: Self::header(),
            problem: ProblemReference::new(problem),
            pattern: PatternDocument {
                kind: "checkerboard".into(),
                columns: board.columns,
                rows: board.rows,
                square_mm: rounded(board.square * 1e3),
                size_mm: artwork.size.map(rounded),
                white_mm: rounded(print.white),
            },
            page: PageDocument { name: print.paper.name.map(Into::into), size_mm: print.paper.size.map(rounded) },
            tiles: print.tiling.map(|tiling| TilesDocument {
                rows: tiling.rows,
                columns: tiling.columns,
                overlap_mm: tiling.overlap,
            }),
            scale_bar_mm: print.scale_bar,
            files: files.to_vec(),
        }
    }
}
