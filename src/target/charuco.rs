//! OpenCV's ChArUco board: a chessboard with markers in its light squares.

use std::f64::consts::SQRT_2;

use nalgebra::{Point3, Vector2};

use super::dictionary::Dictionary;
use super::error::{BoardError, at_least, length};
use super::feature::Feature;
use super::layout::{Layout, Marker, beside_and_above};

/// A ChArUco board. Its corners are the inner ones of the chessboard with the numbers that OpenCV gives them: row by row from
/// the **upper** left one, as the board is seen from the front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Charuco {
    columns: usize,
    rows: usize,
    square: f64,
    marker: f64,
    dictionary: Dictionary,
    is_legacy: bool,
}

impl Charuco {
    /// A board of `columns` × `rows` squares of `square` m, with markers of `marker` m from the dictionary. Where `is_legacy`,
    /// it is that of OpenCV before 4.6 and of calib.io: with an even number of rows it begins with a light square.
    ///
    /// # Errors
    /// [`BoardError`] for what is no board.
    pub fn new(
        [columns, rows]: [usize; 2],
        square: f64,
        marker: f64,
        dictionary: Dictionary,
        is_legacy: bool,
    ) -> Result<Self, BoardError> {
        at_least(3, "squares", [columns, rows])?;
        length("side of a square", square)?;
        length("side of a marker", marker)?;
        if marker >= square {
            return Err(BoardError::TooLarge { what: "markers", size: marker * 1e3, room: square * 1e3 });
        }
        let board = Self { columns, rows, square, marker, dictionary, is_legacy };
        let (needed, has) = (board.light_squares().count(), dictionary.markers());
        if needed > has {
            return Err(BoardError::TooFewMarkers { needed, dictionary: dictionary.name(), has });
        }
        Ok(board)
    }

    /// Squares along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Squares along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Side of a square in m.
    pub fn square(&self) -> f64 {
        self.square
    }

    /// Side of a marker in m.
    pub fn marker(&self) -> f64 {
        self.marker
    }

    /// Where the markers are from.
    pub fn dictionary(&self) -> Dictionary {
        self.dictionary
    }

    /// Whether its squares are those of OpenCV before 4.6.
    pub fn is_legacy(&self) -> bool {
        self.is_legacy
    }

    /// Whether a square is light, by its column from the left and its row from the top.
    pub fn is_light(&self, column: usize, row: usize) -> bool {
        let shifted = usize::from(self.is_legacy && self.rows.is_multiple_of(2));
        (column + row + shifted) % 2 == 1
    }

    /// Columns and rows of the light squares, in the order of their markers.
    pub fn light_squares(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let squares = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        squares.filter(|&(column, row)| self.is_light(column, row))
    }

    /// The least x and the greatest y in T of the square at that column and row, m.
    pub fn upper_left(&self, column: usize, row: usize) -> [f64; 2] {
        [(column as f64 - self.columns as f64 / 2.0) * self.square, (self.rows as f64 / 2.0 - row as f64) * self.square]
    }
}

impl Layout for Charuco {
    fn corner_count(&self) -> usize {
        (self.columns - 1) * (self.rows - 1)
    }

    fn columns(&self) -> usize {
        self.columns - 1
    }

    fn corner(&self, index: usize) -> Point3<f64> {
        let columns = self.columns - 1;
        let [x, y] = self.upper_left(index % columns + 1, index / columns + 1);
        Point3::new(x, y, 0.0)
    }

    fn feature(&self, _: usize) -> Feature {
        let edges = [Vector2::new(self.square, 0.0), Vector2::new(0.0, self.square)];
        Feature::Corner { edges, is_crossing: true }
    }

    fn neighbours(&self, index: usize) -> [usize; 2] {
        beside_and_above(index, self.columns - 1)
    }

    /// Their corners are on the squares' diagonals.
    fn clear(&self) -> Option<f64> {
        Some(SQRT_2 * (self.square - self.marker) / (2.0 * self.square))
    }

    fn printed_size(&self) -> (f64, f64) {
        (self.columns as f64 * self.square, self.rows as f64 * self.square)
    }

    /// OpenCV hands a corner on where both of the markers next to it were read.
    fn markers(&self) -> Vec<Marker> {
        let margin = (self.square - self.marker) / 2.0;
        let marker = |(column, row): (usize, usize)| {
            let [x, y] = self.upper_left(column, row);
            let at = |u: f64, v: f64| Point3::new(x + margin + u * self.marker, y - margin - v * self.marker, 0.0);
            let around = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
            let inner =
                around.into_iter().filter(|&(c, r)| (1..self.columns).contains(&c) && (1..self.rows).contains(&r));
            Marker {
                outline: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
                inside: vec![at(0.5, 0.5)],
                corners: inner.map(|(c, r)| (r - 1) * (self.columns - 1) + c - 1).collect(),
            }
        };
        self.light_squares().map(marker).collect()
    }

    /// With the border, one module wide.
    fn modules(&self) -> usize {
        self.dictionary.side() + 2
    }

    /// From how many on a view fixes the board's pose, and OpenCV's samples keep it.
    fn fewest(&self) -> Option<usize> {
        Some(4)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn board(columns: usize, rows: usize, is_legacy: bool) -> Charuco {
        Charuco::new([columns, rows], 0.04, 0.03, Dictionary::named("DICT_4X4_50").unwrap(), is_legacy).unwrap()
    }

    #[test]
    fn corners_and_markers_hang_together() {
        let board = board(5, 4, false);
        assert_eq!((board.corner_count(), board.markers().len()), (12, 10));
        assert!((board.corner(0) - Point3::new(-0.06, 0.04, 0.0)).norm() < 1e-15);
        assert!((board.corner(11) - Point3::new(0.06, -0.04, 0.0)).norm() < 1e-15);
        let markers = board.markers();
        for corner in 0..12 {
            let of: Vec<&Marker> = markers.iter().filter(|marker| marker.corners.contains(&corner)).collect();
            assert_eq!(of.len(), 2, "{corner}");
            for marker in of {
                // √2 half squares away.
                assert!(((marker.inside[0] - board.corner(corner)).norm() - 0.02 * 2f64.sqrt()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn old_boards_of_even_rows_begin_light() {
        for (columns, rows) in [(5, 4), (5, 5), (4, 4)] {
            assert!(!board(columns, rows, false).is_light(0, 0));
            assert_eq!(board(columns, rows, true).is_light(0, 0), rows % 2 == 0);
        }
    }

    #[test]
    fn impossible_boards_are_refused() {
        let small = Dictionary::named("DICT_APRILTAG_16h5").unwrap();
        let new =
            |columns, rows, square, marker| Charuco::new([columns, rows], square, marker, small, false).map(|_| ());
        assert_eq!(
            new(7, 9, 0.03, 0.02),
            Err(BoardError::TooFewMarkers { needed: 31, dictionary: "DICT_APRILTAG_16h5", has: 30 })
        );
        assert_eq!(new(6, 5, 0.03, 0.03), Err(BoardError::TooLarge { what: "markers", size: 30.0, room: 30.0 }));
        assert!(new(2, 5, 0.03, 0.02).is_err() && new(6, 5, f64::NAN, 0.02).is_err() && new(6, 5, 0.03, 0.0).is_err());
        assert_eq!(new(6, 10, 0.03, 0.029), Ok(()));
    }
}
