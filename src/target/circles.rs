//! Grids of circles.

use nalgebra::Point3;

use super::error::{BoardError, at_least, length};
use super::feature::Feature;
use super::layout::{Layout, beside_and_above};

/// A grid of black circles. Its corners are their centres. In the plain grid they are counted row by row from the lower left
/// one; in the asymmetric one, whose every other row is half a step to the right, from the **upper** left one, as OpenCV does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circles {
    columns: usize,
    rows: usize,
    spacing: f64,
    diameter: f64,
    is_asymmetric: bool,
}

impl Circles {
    /// A grid of `rows` rows with `columns` circles each, `spacing` m between the centres of neighbours of a row, and with
    /// circles of `diameter` m. In the asymmetric one rows are half of that apart.
    ///
    /// # Errors
    /// [`BoardError`] for what is no board.
    pub fn new(
        [columns, rows]: [usize; 2],
        spacing: f64,
        diameter: f64,
        is_asymmetric: bool,
    ) -> Result<Self, BoardError> {
        at_least(2, "circles", [columns, rows])?;
        length("distance of circles", spacing)?;
        length("diameter of circles", diameter)?;
        let board = Self { columns, rows, spacing, diameter, is_asymmetric };
        let room = board.nearest();
        if diameter >= room {
            return Err(BoardError::TooLarge { what: "circles", size: diameter * 1e3, room: room * 1e3 });
        }
        Ok(board)
    }

    /// Circles in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Distance of neighbours in a row, in m.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Diameter of a circle in m.
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Whether every other row is half a step to the right.
    pub fn is_asymmetric(&self) -> bool {
        self.is_asymmetric
    }

    /// Distance of the nearest circles, m: in the asymmetric grid along the diagonal.
    fn nearest(&self) -> f64 {
        if self.is_asymmetric { self.spacing / 2f64.sqrt() } else { self.spacing }
    }

    /// Extent of the centres, m.
    fn extent(&self) -> (f64, f64) {
        let (columns, rows) = ((self.columns - 1) as f64, (self.rows - 1) as f64);
        if self.is_asymmetric {
            ((columns + 0.5) * self.spacing, rows * self.spacing / 2.0)
        } else {
            (columns * self.spacing, rows * self.spacing)
        }
    }
}

impl Layout for Circles {
    fn corner_count(&self) -> usize {
        self.columns * self.rows
    }

    fn columns(&self) -> usize {
        self.columns
    }

    fn corner(&self, index: usize) -> Point3<f64> {
        let (column, row) = (index % self.columns, index / self.columns);
        let (width, height) = self.extent();
        if self.is_asymmetric {
            let x = (column as f64 + 0.5 * (row % 2) as f64) * self.spacing;
            Point3::new(x - width / 2.0, height / 2.0 - 0.5 * row as f64 * self.spacing, 0.0)
        } else {
            Point3::new(column as f64 * self.spacing - width / 2.0, row as f64 * self.spacing - height / 2.0, 0.0)
        }
    }

    fn feature(&self, _: usize) -> Feature {
        Feature::Circle { radius: self.diameter / 2.0 }
    }

    /// In the asymmetric grid two of the diagonal ones, or where the row has but one, that and the next of the row.
    fn neighbours(&self, index: usize) -> [usize; 2] {
        if !self.is_asymmetric {
            return beside_and_above(index, self.columns);
        }
        let (column, row) = (index % self.columns, index / self.columns);
        let other = if row == 0 { index + self.columns } else { index - self.columns };
        // In the next row the circles at the same column and the one before, or after it in rows to the right.
        let diagonal = if row % 2 == 0 {
            column.checked_sub(1).map(|_| other - 1)
        } else {
            (column + 1 < self.columns).then_some(other + 1)
        };
        [other, diagonal.unwrap_or(if column == 0 { index + 1 } else { index - 1 })]
    }

    fn printed_size(&self) -> (f64, f64) {
        let (width, height) = self.extent();
        (width + self.diameter, height + self.diameter)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn the_asymmetric_grid_is_opencvs() {
        let board = Circles::new([4, 11], 0.04, 0.02, true).unwrap();
        for i in 0..11 {
            for j in 0..4 {
                // OpenCV's, y down.
                let (x, y) = ((2 * j + i % 2) as f64 * 0.02, i as f64 * 0.02);
                let from_first = board.corner(4 * i + j) - board.corner(0);
                assert!((from_first.x - x).abs() < 1e-15 && (from_first.y + y).abs() < 1e-15, "{i} {j}");
            }
        }
        for i in 0..44 {
            let [a, b] = board.neighbours(i).map(|other| (board.corner(other) - board.corner(i)).xy());
            assert!(a.perp(&b).abs() > 1e-4, "{i}: neighbours {a} {b}");
            assert!((a.norm() - 0.02 * 2f64.sqrt()).abs() < 1e-15, "{i}");
        }
        assert_eq!(board.printed_size(), (0.16, 0.22));
    }

    #[test]
    fn circles_do_not_touch() {
        let new = |diameter, is_asymmetric| Circles::new([4, 5], 0.04, diameter, is_asymmetric).map(|_| ());
        assert_eq!(new(0.039, false), Ok(()));
        assert_eq!(new(0.04, false), Err(BoardError::TooLarge { what: "circles", size: 40.0, room: 40.0 }));
        assert!(new(0.0283, true).is_err() && new(0.0282, true).is_ok());
    }
}
