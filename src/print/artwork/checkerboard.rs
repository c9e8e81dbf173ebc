//! The checkerboard.

use super::{Artwork, Rectangle, Shape};
use crate::figures::trimmed;
use crate::print::PrintError;
use crate::target::Checkerboard;

/// Squares along a side at most: those of the problem file's largest board.
const MOST: usize = 1001;

/// More white than so many mm around a pattern brings nothing.
const AMPLE: f64 = 50.0;

impl Artwork {
    /// The square at the least x and y is black.
    pub(super) fn checkerboard(board: &Checkerboard) -> Result<Self, PrintError> {
        let Checkerboard { columns, rows, square } = *board;
        let inner = 2..MOST;
        if !(inner.contains(&columns) && inner.contains(&rows) && square > 0.0 && square.is_finite()) {
            return Err(PrintError::Board { columns, rows, square_mm: square * 1e3 });
        }
        // From the first inner corner, at −(count − 1)/2 squares.
        let edges = |count: usize| -> Vec<f64> {
            let first = (0.0 - (count - 1) as f64 / 2.0) * square;
            (0..=count + 1).map(|i| (first + (i as f64 - 1.0) * square) * 1e3).collect()
        };
        let (x, y) = (edges(columns), edges(rows));
        let is_black = |&(column, row): &(usize, usize)| (column + row) % 2 == 0;
        let shape =
            |(i, j): (usize, usize)| Shape::Rectangle(Rectangle { min: [x[i], y[j]], max: [x[i + 1], y[j + 1]] });
        let squares = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
        let middles = |edges: &[f64]| edges.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
        Ok(Self {
            shapes: squares.filter(is_black).map(shape).collect(),
            size: [columns, rows].map(|count| (count + 1) as f64 * square * 1e3),
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
    use crate::target::Board;

    /// Whether the point is black.
    fn is_black(artwork: &Artwork, point: [f64; 2]) -> bool {
        let point = Rectangle { min: point, max: point };
        artwork.shapes.iter().any(|shape| shape.bounds().overlaps(&point))
    }

    #[test]
    fn every_corner_is_where_the_board_has_it() {
        for (columns, rows) in [(8, 6), (9, 6), (2, 5)] {
            let board = Board::checkerboard(columns, rows, 0.0357);
            let artwork = Artwork::new(&board).unwrap();
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
            Artwork::new(&Board::checkerboard(columns, rows, square)).unwrap_err();
        }
        Artwork::new(&Board::checkerboard(2, 1000, 1e-9)).unwrap();
    }
}
