//! The checkerboard.

use super::{Artwork, Rectangle, Shape};
use crate::figures::trimmed;
use crate::print::PrintError;
use crate::target::Board;

/// Squares along a side at most: those of the problem file's largest board.
const MOST: usize = 1001;

/// More white than so many mm around a pattern brings nothing.
const AMPLE: f64 = 50.0;

impl Artwork {
    /// A checkerboard with its inner corners where [`Board::corner`] has them. The square at the least x and y is black.
    ///
    /// # Errors
    /// When the board has fewer than two or more than a thousand inner corners along a side, or squares of no positive size.
    pub fn checkerboard(board: &Board) -> Result<Self, PrintError> {
        let Board { columns, rows, square } = *board;
        let inner = 2..MOST;
        if !(inner.contains(&columns) && inner.contains(&rows) && square > 0.0 && square.is_finite()) {
            return Err(PrintError::Board { columns, rows, square_mm: square * 1e3 });
        }
        let first = board.corner(0, 0);
        let edges = |first: f64, count: usize| -> Vec<f64> {
            (0..=count + 1).map(|i| (first + (i as f64 - 1.0) * square) * 1e3).collect()
        };
        let (x, y) = (edges(first.x, columns), edges(first.y, rows));
        let is_black = |&(column, row): &(usize, usize)| (column + row) % 2 == 0;
        let shape =
            |(i, j): (usize, usize)| Shape::Rectangle(Rectangle { min: [x[i], y[j]], max: [x[i + 1], y[j + 1]] });
        let squares = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
        let middles = |edges: &[f64]| edges.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
        let (width, height) = board.printed_size();
        Ok(Self {
            shapes: squares.filter(is_black).map(shape).collect(),
            size: [width * 1e3, height * 1e3],
            quiet: (square * 1e3 / 2.0).min(AMPLE),
            ample: (square * 1e3).min(AMPLE),
            cuts: [middles(&x), middles(&y)],
            title: format!("{columns} × {rows} inner corners, squares of {} mm", trimmed(square * 1e3, 4)),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Whether the point is black.
    fn is_black(artwork: &Artwork, point: [f64; 2]) -> bool {
        let point = Rectangle { min: point, max: point };
        artwork.shapes.iter().any(|shape| shape.bounds().overlaps(&point))
    }

    #[test]
    fn every_corner_is_where_the_board_has_it() {
        for (columns, rows) in [(8, 6), (9, 6), (2, 5)] {
            let board = Board { columns, rows, square: 0.0357 };
            let artwork = Artwork::checkerboard(&board).unwrap();
            assert_eq!(artwork.shapes.len(), ((columns + 1) * (rows + 1)).div_ceil(2));
            for (index, corner) in board.corners().enumerate() {
                let (column, row) = board.column_and_row(index);
                let near = |x: f64, y: f64| is_black(&artwork, [corner.x * 1e3 + x, corner.y * 1e3 + y]);
                // Black to the lower left and the upper right of corner 0, and of every other one after it.
                let lower_left = (column + row) % 2 == 0;
                assert_eq!([near(-1e-9, -1e-9), near(1e-9, 1e-9)], [lower_left; 2], "{column}, {row}");
                assert_eq!([near(1e-9, -1e-9), near(-1e-9, 1e-9)], [!lower_left; 2], "{column}, {row}");
            }
            let [width, height] = artwork.size;
            let inside = |shape: &Shape| {
                let Rectangle { min, max } = shape.bounds();
                let reach = |axis: usize| min[axis].abs().max(max[axis].abs());
                reach(0) < width / 2.0 + 1e-9 && reach(1) < height / 2.0 + 1e-9
            };
            assert!(artwork.shapes.iter().all(inside));
        }
    }

    #[test]
    fn impossible_boards_are_refused() {
        for (columns, rows, square) in [(1, 6, 0.03), (8, 0, 0.03), (8, 1001, 0.03), (8, 6, 0.0), (8, 6, f64::NAN)] {
            Artwork::checkerboard(&Board { columns, rows, square }).unwrap_err();
        }
        Artwork::checkerboard(&Board { columns: 2, rows: 1000, square: 1e-9 }).unwrap();
    }
}
