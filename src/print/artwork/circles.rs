//! Grids of circles.

use super::{Artwork, Shape};
use crate::figures::trimmed;
use crate::target::{Board, Circles};

/// More white than so many mm around a pattern brings nothing.
const AMPLE: f64 = 50.0;

impl Artwork {
    /// Black circles.
    pub(super) fn circles(board: &Circles) -> Self {
        let [spacing, diameter] = [board.spacing(), board.diameter()].map(|length| length * 1e3);
        let of = Board::Circles(*board);
        let circle = |centre: nalgebra::Point3<f64>| Shape::Circle {
            centre: [centre.x * 1e3, centre.y * 1e3],
            radius: diameter / 2.0,
        };
        let step = if board.is_asymmetric() { spacing / 2.0 } else { spacing };
        let (columns, rows) = (board.columns(), board.rows());
        // Between the circles; in the asymmetric grid wherever it is cut some are.
        let between =
            |count: usize, step: f64| (1..count).map(|i| (i as f64 - count as f64 / 2.0) * step).collect::<Vec<f64>>();
        let along = if board.is_asymmetric() { 2 * columns } else { columns };
        let (width, height) = of.printed_size();
        let kind = if board.is_asymmetric() { "asymmetric circles, " } else { "circles, " };
        Self {
            shapes: of.corners().map(circle).collect(),
            size: [width * 1e3, height * 1e3],
            quiet: ((spacing - diameter) / 2.0).min(AMPLE),
            ample: spacing.min(AMPLE),
            cuts: [between(along, step), between(rows, step)],
            title: format!(
                "{kind}{columns} × {rows}, {} mm apart, {} mm in diameter",
                trimmed(spacing, 4),
                trimmed(diameter, 4)
            ),
        }
    }
}
