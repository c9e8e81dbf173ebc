//! Boards of every kind, through one door.

use std::fmt;

use nalgebra::Point3;

use super::aprilgrid::AprilGrid;
use super::charuco::Charuco;
use super::checkerboard::Checkerboard;
use super::circles::Circles;
use super::feature::Feature;
use super::layout::{Layout, Marker, fix_homography};
use super::points::Points;

/// A planar board, by its kind. Its *corners* are the points that are detected, of whatever kind: each has an index, and frame
/// T has its origin in the middle of what is printed.
#[derive(Debug, Clone, PartialEq)]
pub enum Board {
    /// Light and dark squares.
    Checkerboard(Checkerboard),
    /// A chessboard with markers in its light squares.
    Charuco(Charuco),
    /// A grid of tags.
    AprilGrid(AprilGrid),
    /// A grid of circles.
    Circles(Circles),
    /// Points anywhere.
    Points(Points),
}

impl Board {
    /// A checkerboard of so many inner corners along x and y, and squares of so many metres.
    pub const fn checkerboard(columns: usize, rows: usize, square: f64) -> Self {
        Self::Checkerboard(Checkerboard { columns, rows, square })
    }

    fn layout(&self) -> &dyn Layout {
        match self {
            Self::Checkerboard(board) => board,
            Self::Charuco(board) => board,
            Self::AprilGrid(board) => board,
            Self::Circles(board) => board,
            Self::Points(board) => board,
        }
    }

    /// Its kind, as problem files name it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Checkerboard(_) => "checkerboard",
            Self::Charuco(_) => "charuco",
            Self::AprilGrid(_) => "aprilgrid",
            Self::Circles(board) if board.is_asymmetric() => "asymmetric-circles",
            Self::Circles(_) => "circles",
            Self::Points(_) => "points",
        }
    }

    /// Number of corners.
    pub fn corner_count(&self) -> usize {
        self.layout().corner_count()
    }

    /// Printed size in metres along x and y.
    pub fn printed_size(&self) -> (f64, f64) {
        self.layout().printed_size()
    }

    /// Position in T of the corner with that index.
    pub fn corner(&self, index: usize) -> Point3<f64> {
        self.layout().corner(index)
    }

    /// What the corner with that index is.
    pub fn feature(&self, index: usize) -> Feature {
        self.layout().feature(index)
    }

    /// Two corners near the one with that index, in different directions: how small it is in a picture shows by how near they
    /// come.
    pub fn neighbours(&self, index: usize) -> [usize; 2] {
        self.layout().neighbours(index)
    }

    /// How far from a corner the nearest marker's pattern begins, as a share of the way to its neighbours; none without
    /// markers.
    pub fn clear(&self) -> Option<f64> {
        self.layout().clear()
    }

    /// What must be read whole for corners to count.
    pub fn markers(&self) -> Vec<Marker> {
        self.layout().markers()
    }

    /// Modules, light or dark, along a side of its markers; 0 where there is nothing to read in them.
    pub fn modules(&self) -> usize {
        self.layout().modules()
    }

    /// Fewest corners of a view that the detectors of this kind hand on; none where they find all or nothing.
    pub fn fewest(&self) -> Option<usize> {
        self.layout().fewest()
    }

    /// Columns and rows of corners and the distance of neighbours in m, where they make a square grid.
    pub fn grid(&self) -> Option<(usize, usize, f64)> {
        match self {
            Self::Checkerboard(Checkerboard { columns, rows, square }) => Some((*columns, *rows, *square)),
            Self::Charuco(board) => Some((board.columns() - 1, board.rows() - 1, board.square())),
            Self::Circles(board) if !board.is_asymmetric() => Some((board.columns(), board.rows(), board.spacing())),
            Self::AprilGrid(_) | Self::Circles(_) | Self::Points(_) => None,
        }
    }

    /// Whether a picture may show it from two sides alike, so that its corners can be counted from either end.
    pub fn is_ambiguous(&self) -> bool {
        match self {
            Self::Checkerboard(_) => true,
            Self::Circles(board) => !board.is_asymmetric(),
            Self::Charuco(_) | Self::AprilGrid(_) | Self::Points(_) => false,
        }
    }

    /// Column and row of the corner with that index, counted row by row.
    pub fn column_and_row(&self, index: usize) -> (usize, usize) {
        let columns = self.layout().columns();
        (index % columns, index / columns)
    }

    /// How many corners are listed in a row.
    pub fn columns(&self) -> usize {
        self.layout().columns()
    }

    /// All corners in T, in their order, with z = 0.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = Point3<f64>> + '_ {
        let layout = self.layout();
        (0..layout.corner_count()).map(|i| layout.corner(i))
    }

    /// Least distance of a corner from its neighbours, in m.
    pub fn spacing(&self) -> f64 {
        let distance = |i: usize| self.neighbours(i).map(|j| (self.corner(i) - self.corner(j)).norm());
        (0..self.corner_count()).flat_map(distance).fold(f64::INFINITY, f64::min)
    }

    /// Whether corners (by index, each once) fix the homography between board and image: four of them in general position,
    /// no three on a line. That is so unless all of them but one lie on a line.
    pub fn fix_homography(&self, corners: &[usize]) -> bool {
        fix_homography(corners, |i| self.corner(i).coords.xy())
    }
}

/// In a sentence: "the 8 x 6 board".
impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Checkerboard(Checkerboard { columns, rows, .. }) => write!(f, "{columns} x {rows} board"),
            Self::Charuco(board) => write!(f, "ChArUco board of {} x {} squares", board.columns(), board.rows()),
            Self::AprilGrid(board) => write!(f, "grid of {} x {} tags", board.columns(), board.rows()),
            Self::Circles(board) => write!(f, "grid of {} x {} circles", board.columns(), board.rows()),
            Self::Points(_) => write!(f, "board of {} points", self.corner_count()),
        }
    }
}

/// Which of `count` corners can be told from each other, those whose markers all are legible.
pub fn told(markers: &[Marker], count: usize, mut is_legible: impl FnMut(&Marker) -> bool) -> Vec<bool> {
    let mut told = vec![true; count];
    for marker in markers.iter().filter(|marker| !is_legible(marker)) {
        for &corner in &marker.corners {
            told[corner] = false;
        }
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_centred_and_row_by_row() {
        let board = Board::checkerboard(3, 2, 0.1);
        let corners: Vec<_> = board.corners().collect();
        assert_eq!(corners.len(), 6);
        assert!((corners[0] - Point3::new(-0.1, -0.05, 0.0)).norm() < 1e-15);
        assert!((corners[1] - Point3::new(0.0, -0.05, 0.0)).norm() < 1e-15);
        assert!((corners[5] - Point3::new(0.1, 0.05, 0.0)).norm() < 1e-15);
        assert_eq!([0, 1, 4].map(|i| board.neighbours(i)), [[1, 3], [0, 4], [3, 1]]);
    }

    #[test]
    fn four_corners_in_general_position_fix_a_homography() {
        let board = Board::checkerboard(4, 3, 0.1);
        // Rows are 0–3, 4–7, 8–11.
        assert!(board.fix_homography(&[0, 1, 4, 5]));
        assert!(board.fix_homography(&[0, 1, 2, 3, 4, 5]));
        assert!(!board.fix_homography(&[0, 1, 2, 3, 4]));
        assert!(!board.fix_homography(&[9, 0, 1, 2, 3]));
        assert!(!board.fix_homography(&[0, 5, 10, 3]));
        assert!(!board.fix_homography(&[0, 1, 5]));
        // Of four corners three on a line, whichever comes first.
        assert!(!board.fix_homography(&[4, 0, 8, 5]) && !board.fix_homography(&[5, 0, 4, 8]));
        assert!(board.fix_homography(&[4, 0, 8, 5, 6]));
        // Of the largest board, the flattest triangle.
        let board = Board::checkerboard(1000, 1000, 0.0123);
        assert!(board.fix_homography(&[0, 998, 999, 1998, 1997]));
    }
}
