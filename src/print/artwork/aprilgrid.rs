//! The grid of AprilTags.

use super::modules::modules;
use super::{Artwork, Rectangle, Shape};
use crate::figures::trimmed;
use crate::target::AprilGrid;

/// More white than so many mm around a pattern brings nothing.
const AMPLE: f64 = 50.0;

/// Modules along a tag's side, border and all.
const MODULES: usize = 10;

impl Artwork {
    /// Tags, and small black squares at their corners, as Kalibr draws them.
    pub(super) fn aprilgrid(board: &AprilGrid) -> Self {
        let (columns, rows) = (board.columns(), board.rows());
        let tag = board.tag() * 1e3;
        let gap = board.spacing() * tag;
        let lower_left = |column: usize, row: usize| board.lower_left(column, row).map(|x| x * 1e3);
        let tags = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).enumerate();
        let tags = tags.flat_map(|(id, (column, row))| {
            let is_light = |row: usize, column: usize| AprilGrid::is_light(id, row, column);
            modules(lower_left(column, row), tag, MODULES, is_light)
        });
        let small = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row))).map(|(column, row)| {
            let [x, y] = lower_left(column, row);
            Shape::Rectangle(Rectangle { min: [x - gap, y - gap], max: [x, y] })
        });
        let middles = |of: &dyn Fn(usize) -> f64, count: usize| (0..count).map(|i| of(i) + tag / 2.0).collect();
        let side = |count: usize| count as f64 * (tag + gap) + gap;
        Self {
            shapes: tags.chain(small).collect(),
            size: [side(columns), side(rows)],
            quiet: (gap / 2.0).min(AMPLE),
            ample: tag.min(AMPLE),
            cuts: [middles(&|i| lower_left(i, 0)[0], columns), middles(&|i| lower_left(0, i)[1], rows)],
            title: format!(
                "AprilGrid, {columns} × {rows} tags of {} mm, {} mm apart, {}",
                trimmed(tag, 4),
                trimmed(gap, 4),
                AprilGrid::DICTIONARY.name(),
            ),
        }
    }
}
