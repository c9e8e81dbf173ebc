//! The checkerboard.

use nalgebra::{Point3, Vector2};

use super::feature::Feature;
use super::layout::{Layout, beside_and_above};

/// A checkerboard: its corners are those where four squares meet, row by row from the one with the least x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checkerboard {
    /// Inner corners along x.
    pub columns: usize,
    /// Inner corners along y.
    pub rows: usize,
    /// Distance of neighbouring corners in metres.
    pub square: f64,
}

impl Layout for Checkerboard {
    fn corner_count(&self) -> usize {
        self.columns * self.rows
    }

    fn columns(&self) -> usize {
        self.columns
    }

    fn corner(&self, index: usize) -> Point3<f64> {
        let (column, row) = (index % self.columns, index / self.columns);
        Point3::new(
            (column as f64 - (self.columns - 1) as f64 / 2.0) * self.square,
            (row as f64 - (self.rows - 1) as f64 / 2.0) * self.square,
            0.0,
        )
    }

    fn feature(&self, _: usize) -> Feature {
        let edges = [Vector2::new(self.square, 0.0), Vector2::new(0.0, self.square)];
        Feature::Corner { edges, is_crossing: true }
    }

    fn neighbours(&self, index: usize) -> [usize; 2] {
        beside_and_above(index, self.columns)
    }

    /// One square more than inner corners in each direction.
    fn printed_size(&self) -> (f64, f64) {
        ((self.columns + 1) as f64 * self.square, (self.rows + 1) as f64 * self.square)
    }
}
