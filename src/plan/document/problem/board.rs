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
    /// What kind of target it is, as problem files name it.
    pub kind: String,
    /// What it is made of, in the keys that problem files have for the kind; those of other kinds are left out.
    #[serde(flatten)]
    pub board: BoardDescription,
    /// Width and height of what is printed.
    pub size_mm: [f64; 2],
    /// Least width of the white around it.
    pub white_mm: f64,
    /// Where each corner is from the middle of what is printed, x to the right and y up, in the order of their numbers.
    pub corners_mm: Vec<[f64; 2]>,
}

/// What a board is made of, in the keys of problem files.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct BoardDescription {
    /// Inner corners along x; squares, tags or circles, by the kind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<usize>,
    /// The same along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<usize>,
    /// Side of a square.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub square_mm: Option<f64>,
    /// Side of a marker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub marker_mm: Option<f64>,
    /// `OpenCV`'s name of the markers' dictionary.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dictionary: Option<String>,
    /// Whether it is a `ChArUco` board of `OpenCV` before 4.6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legacy_pattern: Option<bool>,
    /// Side of a tag.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tag_mm: Option<f64>,
    /// Space between tags as a share of that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tag_spacing: Option<f64>,
    /// Distance of neighbours in a row of circles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing_mm: Option<f64>,
    /// Diameter of a circle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diameter_mm: Option<f64>,
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
                kind: problem.target.board.kind().into(),
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
                Self { square_mm: Some(mm(square)), ..Self::sides(columns, rows) }
            }
            Board::Charuco(board) => Self {
                square_mm: Some(mm(board.square())),
                marker_mm: Some(mm(board.marker())),
                dictionary: Some(board.dictionary().name().into()),
                legacy_pattern: Some(board.is_legacy()),
                ..Self::sides(board.columns(), board.rows())
            },
            Board::AprilGrid(board) => Self {
                tag_mm: Some(mm(board.tag())),
                tag_spacing: Some(board.spacing()),
                ..Self::sides(board.columns(), board.rows())
            },
            Board::Circles(board) => Self {
                spacing_mm: Some(mm(board.spacing())),
                diameter_mm: Some(mm(board.diameter())),
                ..Self::sides(board.columns(), board.rows())
            },
            Board::Points(_) => Self::default(),
        }
    }

    fn sides(columns: usize, rows: usize) -> Self {
        Self { columns: Some(columns), rows: Some(rows), ..Self::default() }
    }
}

/// A length in m to a nanometre, in mm, as the problem file has it.
fn mm(length: f64) -> f64 {
    rounded(length * 1e3)
}

fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6 + 0.0
}
