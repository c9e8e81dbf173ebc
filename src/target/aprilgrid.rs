//! Kalibr's grid of AprilTags.

use std::f64::consts::SQRT_2;

use nalgebra::{Point3, Vector2};

use super::dictionary::Dictionary;
use super::error::{BoardError, at_least, length};
use super::feature::Feature;
use super::layout::{Layout, Marker};

/// A grid of the tags of AprilTag 36h11, with small black squares between their corners, as Kalibr draws it. Its corners are
/// those of the tags in Kalibr's order: row by row of the grid that they make together, from the lower left one, whose tag has
/// the number 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AprilGrid {
    columns: usize,
    rows: usize,
    tag: f64,
    spacing: f64,
}

/// Modules of the black border, on each side.
const BORDER: usize = 2;

/// Fewest tags of a view that Kalibr keeps.
const FEWEST: usize = 4;

impl AprilGrid {
    /// Where the tags are from.
    pub const DICTIONARY: Dictionary = Dictionary::APRILTAG_36H11;

    /// A grid of `columns` × `rows` tags of `tag` m, the space between them `spacing` times as wide.
    ///
    /// # Errors
    /// [`BoardError`] for what is no board.
    pub fn new([columns, rows]: [usize; 2], tag: f64, spacing: f64) -> Result<Self, BoardError> {
        at_least(1, "tags", [columns, rows])?;
        length("side of a tag", tag)?;
        length("space between tags", spacing * tag)?;
        let (needed, has) = (columns.saturating_mul(rows), Self::DICTIONARY.markers());
        if needed > has {
            return Err(BoardError::TooFewMarkers { needed, dictionary: Self::DICTIONARY.name(), has });
        }
        Ok(Self { columns, rows, tag, spacing })
    }

    /// Tags along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Tags along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Side of a tag in m.
    pub fn tag(&self) -> f64 {
        self.tag
    }

    /// Space between tags as a share of their side.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Whether a module of tag `id` is light, by its row from the top and its column from the left, border and all.
    pub fn is_light(id: usize, row: usize, column: usize) -> bool {
        let side = Self::DICTIONARY.side();
        let bits = BORDER..BORDER + side;
        // OpenCV has them upside down.
        let turned = |i: usize| side - 1 - (i - BORDER);
        bits.contains(&row) && bits.contains(&column) && Self::DICTIONARY.is_light(id, turned(row), turned(column))
    }

    /// The least x and y in T of the tag at that column and row, m.
    pub fn lower_left(&self, column: usize, row: usize) -> [f64; 2] {
        let along = |i: usize, count: usize| {
            let pitch = (1.0 + self.spacing) * self.tag;
            i as f64 * pitch - (count as f64 * pitch - self.spacing * self.tag) / 2.0
        };
        [along(column, self.columns), along(row, self.rows)]
    }
}

impl Layout for AprilGrid {
    fn corner_count(&self) -> usize {
        4 * self.columns * self.rows
    }

    fn columns(&self) -> usize {
        2 * self.columns
    }

    fn corner(&self, index: usize) -> Point3<f64> {
        let (column, row) = (index % (2 * self.columns), index / (2 * self.columns));
        let [x, y] = self.lower_left(column / 2, row / 2);
        Point3::new(x + (column % 2) as f64 * self.tag, y + (row % 2) as f64 * self.tag, 0.0)
    }

    /// A tag and a small square meet in each corner, as squares of a chessboard do: the edges of the shorter one reach to both
    /// sides.
    fn feature(&self, _: usize) -> Feature {
        let reach = self.tag * self.spacing.min(1.0);
        Feature::Corner { edges: [Vector2::new(reach, 0.0), Vector2::new(0.0, reach)], is_crossing: true }
    }

    /// Those of the next tags, and at the border those of the same.
    fn neighbours(&self, index: usize) -> [usize; 2] {
        let columns = 2 * self.columns;
        let (column, row) = (index % columns, index / columns);
        let next = |i: usize, count: usize| match i {
            0 => 1,
            _ if i + 1 == count => i - 1,
            _ if i.is_multiple_of(2) => i - 1,
            _ => i + 1,
        };
        [row * columns + next(column, columns), next(row, 2 * self.rows) * columns + column]
    }

    /// The bits begin on the tags' diagonals, behind the border.
    fn clear(&self) -> Option<f64> {
        Some(SQRT_2 * BORDER as f64 / self.modules() as f64 / self.spacing)
    }

    /// With the small squares around.
    fn printed_size(&self) -> (f64, f64) {
        let side = |count: usize| (count as f64 * (1.0 + self.spacing) + self.spacing) * self.tag;
        (side(self.columns), side(self.rows))
    }

    /// Kalibr keeps the tags that are whole in the picture.
    fn markers(&self) -> Vec<Marker> {
        let tag = |(column, row): (usize, usize)| {
            let first = 2 * row * 2 * self.columns + 2 * column;
            let corners = vec![first, first + 1, first + 2 * self.columns + 1, first + 2 * self.columns];
            let [x, y] = self.lower_left(column, row);
            let middle = Point3::new(x + self.tag / 2.0, y + self.tag / 2.0, 0.0);
            Marker { outline: corners.iter().map(|&i| self.corner(i)).collect(), inside: vec![middle], corners }
        };
        (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row))).map(tag).collect()
    }

    fn modules(&self) -> usize {
        Self::DICTIONARY.side() + 2 * BORDER
    }

    fn fewest(&self) -> Option<usize> {
        Some(4 * FEWEST.min(self.columns * self.rows))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn corners_are_kalibrs() {
        let board = AprilGrid::new([2, 2], 0.1, 0.25).unwrap();
        let from_first = |i: usize| (board.corner(i) - board.corner(0)) * 1e3;
        for (corner, [x, y]) in
            [(1, [100.0, 0.0]), (2, [125.0, 0.0]), (4, [0.0, 100.0]), (6, [125.0, 100.0]), (15, [225.0, 225.0])]
        {
            assert!((from_first(corner).xy() - Vector2::new(x, y)).norm() < 1e-9, "{corner}");
        }
        assert!((board.corner(0).coords + board.corner(15).coords).norm() < 1e-15);
        assert!((board.corner(0).x + 0.1125).abs() < 1e-15 && (board.printed_size().0 - 0.275).abs() < 1e-15);
        assert_eq!(board.markers()[1].corners, [2, 3, 7, 6]);
        assert_eq!([0, 1, 6].map(|i| board.neighbours(i)), [[1, 4], [2, 5], [5, 10]]);
    }

    #[test]
    fn impossible_boards_are_refused() {
        let too_few = BoardError::TooFewMarkers { needed: 600, dictionary: "DICT_APRILTAG_36h11", has: 587 };
        assert_eq!(AprilGrid::new([30, 20], 0.1, 0.3), Err(too_few));
        assert!(AprilGrid::new([0, 2], 0.1, 0.3).is_err() && AprilGrid::new([2, 2], 0.1, 0.0).is_err());
    }
}
