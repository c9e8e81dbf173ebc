//! Boards that other tools describe.

mod kalibr;
mod opencv;
mod points;

pub use points::read_points;

use super::error::{ReadError, ReadFault};
use super::tree;
use crate::target::{AprilGrid, BoardError, Checkerboard, Dictionary, Points};

/// A board as a file states it, as far as it does. Lengths are in m.
#[derive(Debug, Clone, PartialEq)]
pub enum StatedBoard {
    /// Kalibr's checkerboard.
    Checkerboard(Checkerboard),
    /// Kalibr's grid of tags.
    AprilGrid(AprilGrid),
    /// Kalibr's grid of circles, whose diameter it does not tell.
    Circles {
        /// Circles in a row.
        columns: u32,
        /// Rows.
        rows: u32,
        /// Distance of neighbours in a row.
        spacing: f64,
        /// Whether every other row is half a step aside.
        is_asymmetric: bool,
    },
    /// `OpenCV`'s `ChArUco` board, whose squares it does not count.
    Charuco {
        /// Where the markers are from.
        dictionary: Dictionary,
        /// Side of a square.
        square: f64,
        /// Side of a marker.
        marker: f64,
    },
    /// A table of points.
    Points(Points),
}

/// The board of a file: Kalibr's target in YAML, `OpenCV`'s `ChArUco` board in JSON, or a CSV table of points.
///
/// ```
/// use calipose::formats::{StatedBoard, read_board};
///
/// let text = "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n";
/// let StatedBoard::AprilGrid(grid) = read_board(text)? else { panic!() };
/// assert_eq!((grid.columns(), grid.tag()), (6, 0.088));
/// # Ok::<(), calipose::formats::ReadError>(())
/// ```
///
/// # Errors
/// The first fault, with its line.
pub fn read_board(text: &str) -> Result<StatedBoard, ReadError> {
    let text = text.trim_start_matches('\u{feff}');
    if text.trim().is_empty() {
        return Err(ReadFault::Empty.at(text.lines().count().max(1)));
    }
    if points::is_table(text) {
        return read_points(text).map(StatedBoard::Points);
    }
    let root = tree::parse(text)?;
    if root.get("target_type").is_some() {
        kalibr::read(&root)
    } else if root.get("dictionary").is_some() || root.get("square_size").is_some() {
        opencv::read(&root)
    } else {
        Err(ReadFault::NoBoard.at(root.line))
    }
}

fn refused(error: BoardError, line: usize) -> ReadError {
    ReadFault::Board(error).at(line)
}
