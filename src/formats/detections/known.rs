//! What is known of detections beside their file.

use crate::formats::error::{ReadError, ReadFault};
use crate::formats::image_size::agreed;
use crate::target::Board;

/// What is known of the detections beside their file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Known {
    /// The board.
    pub board: Option<Board>,
    /// Width and height of the images, px.
    pub image: Option<[u32; 2]>,
    /// The names of the images that are meant, `*` for any text and `?` for one character; all where there is none.
    pub images: Option<String>,
}

impl Known {
    /// The board that is known and `found`, on `line` of the file.
    pub(super) fn board(&self, found: Option<Board>, line: usize) -> Result<Board, ReadError> {
        match (found, &self.board) {
            (Some(found), Some(given)) if !same(&found, given) => {
                let [found, given] = [&found, given].map(text);
                Err(ReadFault::Mismatch { what: "board", found, given }.at(line))
            }
            (Some(found), None | Some(Board::Checkerboard(_))) => Ok(found),
            (_, Some(given)) => Ok(given.clone()),
            (None, None) => Err(ReadFault::NotStated { what: "board" }.at(line)),
        }
    }

    /// The image size that is known and `found`, on `line` of the file.
    pub(super) fn image_size(&self, found: Option<[u32; 2]>, line: usize) -> Result<[u32; 2], ReadError> {
        agreed(found, self.image, line)
    }
}

/// Whether two boards have the same grid of corners.
fn same(a: &Board, b: &Board) -> bool {
    let (Some((columns, rows, square)), Some(other)) = (a.grid(), b.grid()) else { return a == b };
    // mm to m and back rounds.
    (columns, rows) == (other.0, other.1) && (square / other.2 - 1.0).abs() < 1e-9
}

fn text(board: &Board) -> String {
    let Some((columns, rows, square)) = board.grid() else { return board.to_string() };
    format!("{columns} x {rows} of {} mm", (square * 1e9).round() / 1e6)
}
