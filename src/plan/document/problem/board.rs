//! The calibration target that `calipose board --json` drew.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::print::{Artwork, Print};
use crate::problem::Problem;
use crate::target::{Board, Checkerboard};

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
    /// What kind of target it is, and what it is made of.
    #[serde(flatten)]
    pub board: BoardDescription,
    /// Width and height of what is printed.
    pub size_mm: [f64; 2],
    /// Least width of the white around it.
    pub white_mm: f64,
    /// Where each corner is from the middle of what is printed, x to the right and y up, in the order of their numbers.
    pub corners_mm: Vec<[f64; 2]>,
}

/// A board by its kind, in the keys of problem files.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum BoardDescription {
    /// A checkerboard.
    Checkerboard {
        /// Inner corners along x.
        columns: usize,
        /// Inner corners along y.
        rows: usize,
        /// Side of a square.
        square_mm: f64,
    },
    /// `OpenCV`'s `ChArUco` board.
    Charuco {
        /// Squares along x.
        columns: usize,
        /// Squares along y.
        rows: usize,
        /// Side of a square.
        square_mm: f64,
        /// Side of a marker.
        marker_mm: f64,
        /// `OpenCV`'s name of the markers' dictionary.
        dictionary: String,
        /// Whether it is that of `OpenCV` before 4.6.
        legacy_pattern: bool,
    },
    /// Kalibr's grid of tags.
    #[serde(rename = "aprilgrid")]
    AprilGrid {
        /// Tags along x.
        columns: usize,
        /// Tags along y.
        rows: usize,
        /// Side of a tag.
        tag_mm: f64,
        /// Space between tags as a share of that.
        tag_spacing: f64,
    },
    /// A grid of circles.
    Circles {
        /// Circles in a row.
        columns: usize,
        /// Rows.
        rows: usize,
        /// Distance of neighbours in a row.
        spacing_mm: f64,
        /// Diameter of a circle.
        diameter_mm: f64,
    },
    /// A grid of circles whose every other row is half a step to the right.
    AsymmetricCircles {
        /// Circles in a row.
        columns: usize,
        /// Rows.
        rows: usize,
        /// Distance of neighbours in a row.
        spacing_mm: f64,
        /// Diameter of a circle.
        diameter_mm: f64,
    },
    /// Points anywhere.
    Points,
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
        Self {
            header: Self::header(),
            problem: ProblemReference::new(problem),
            pattern: PatternDocument {
                board: BoardDescription::new(&problem.target.board),
                size_mm: artwork.size.map(rounded),
                white_mm: rounded(print.white),
                corners_mm: problem.target.board.corners().map(|corner| [corner.x, corner.y].map(mm)).collect(),
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

impl BoardDescription {
    fn new(board: &Board) -> Self {
        match board {
            &Board::Checkerboard(Checkerboard { columns, rows, square }) => {
                Self::Checkerboard { columns, rows, square_mm: mm(square) }
            }
            Board::Charuco(board) => Self::Charuco {
                columns: board.columns(),
                rows: board.rows(),
                square_mm: mm(board.square()),
                marker_mm: mm(board.marker()),
                dictionary: board.dictionary().name().into(),
                legacy_pattern: board.is_legacy(),
            },
            Board::AprilGrid(board) => Self::AprilGrid {
                columns: board.columns(),
                rows: board.rows(),
                tag_mm: mm(board.tag()),
                tag_spacing: board.spacing(),
            },
            Board::Circles(board) => {
                let (columns, rows) = (board.columns(), board.rows());
                let (spacing_mm, diameter_mm) = (mm(board.spacing()), mm(board.diameter()));
                if board.is_asymmetric() {
                    Self::AsymmetricCircles { columns, rows, spacing_mm, diameter_mm }
                } else {
                    Self::Circles { columns, rows, spacing_mm, diameter_mm }
                }
            }
            Board::Points(_) => Self::Points,
        }
    }
}

/// A length in m to a nanometre, in mm, as the problem file has it.
fn mm(length: f64) -> f64 {
    rounded(length * 1e3)
}

fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6 + 0.0
}
