//! The ChArUco board.

use super::modules::modules;
use super::{Artwork, Rectangle, Shape};
use crate::figures::trimmed;
use crate::target::Charuco;

/// More white than so many mm around a pattern brings nothing.
const AMPLE: f64 = 50.0;

impl Artwork {
    /// Black squares, and in the light ones the markers, as OpenCV draws them.
    pub(super) fn charuco(board: &Charuco) -> Self {
        let (columns, rows) = (board.columns(), board.rows());
        let [square, marker] = [board.square(), board.marker()].map(|side| side * 1e3);
        let upper_left = |column: usize, row: usize| board.upper_left(column, row).map(|x| x * 1e3);
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let dark = all.filter(|&(column, row)| !board.is_light(column, row)).map(|(column, row)| {
            Shape::Rectangle(Rectangle::between(upper_left(column, row), upper_left(column + 1, row + 1)))
        });
        let margin = (square - marker) / 2.0;
        let dictionary = board.dictionary();
        let side = dictionary.side();
        let drawn = |(id, (column, row)): (usize, (usize, usize))| {
            let [x, y] = upper_left(column, row + 1);
            let bits = 1..=side;
            modules([x + margin, y + margin], marker, side + 2, |row, column| {
                bits.contains(&row) && bits.contains(&column) && dictionary.is_light(id, row - 1, column - 1)
            })
        };
        let middles =
            |count: usize| (0..count).map(|i| (i as f64 + 0.5 - count as f64 / 2.0) * square).collect::<Vec<f64>>();
        Self {
            shapes: dark.chain(board.light_squares().enumerate().flat_map(drawn)).collect(),
            size: [columns, rows].map(|count| count as f64 * square),
            quiet: (square / 2.0).min(AMPLE),
            ample: square.min(AMPLE),
            cuts: [middles(columns), middles(rows)],
            title: format!(
                "ChArUco, {columns} × {rows} squares of {} mm, markers of {} mm, {}{}",
                trimmed(square, 4),
                trimmed(marker, 4),
                dictionary.name(),
                if board.is_legacy() { ", legacy pattern" } else { "" },
            ),
        }
    }
}
