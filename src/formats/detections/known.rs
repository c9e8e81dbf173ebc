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
        match (found, self.board) {
            (Some(found), Some(given)) if !same(&found, &given) => {
                let [found, given] = [found, given].map(|board| text(&board));
                Err(ReadFault::Mismatch { what: "board", found, given }.at(line))
            }
            (Some(board), _) | (None, Some(board)) => Ok(board),
            (None, None) => Err(ReadFault::NotStated { what: "board" }.at(line)),
        }
    }

    /// The image size that is known and `found`, on `line` of the file.
    pub(super) fn image_size(&self, found: Option<[u32; 2]>, line: usize) -> Result<[u32; 2], ReadError> {
        agreed(found, self.image, line)
    }
}

fn same(a: &Board, b: &Board) -> bool {
    // mm to m and back rounds.
    (a.columns, a.rows) == (b.columns, b.rows) && (a.square / b.square - 1.0).abs() < 1e-9
}

fn text(board: &Board) -> String {
    format!("{} x {} of {} mm", board.columns, board.rows, (board.square * 1e9).round() / 1e6)
}
