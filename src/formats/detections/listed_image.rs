//! What the files list, whatever their format.

use nalgebra::Vector2;

use crate::calibration::Corner;
use crate::target::Board;

/// Largest pixel coordinate that is read, px; beyond it stands no slip of a detector but another kind of file.
pub(super) const LARGEST_PIXEL: f64 = 1e6;

/// A file as it is listed, its board and image size those that are known of it.
pub(super) struct ListedImages {
    pub(super) board: Board,
    pub(super) size: [u32; 2],
    pub(super) images: Vec<ListedImage>,
}

/// A corner as it was detected.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detected {
    pub(super) pixel: Vector2<f64>,
    pub(super) weight: f64,
}

/// An image of a file: all corners of the board, each with its line and whether it was detected.
pub(super) struct ListedImage {
    pub(super) name: String,
    pub(super) line: usize,
    pub(super) corners: Vec<(Option<Detected>, usize)>,
}

impl ListedImage {
    pub(super) fn last_line(&self) -> usize {
        self.corners.last().map_or(self.line, |(_, line)| *line)
    }

    /// Those detected.
    pub(super) fn detected(&self) -> impl Iterator<Item = Corner> + '_ {
        let corners = self.corners.iter().enumerate();
        corners.filter_map(|(index, (detected, _))| {
            detected.map(|Detected { pixel, weight }| Corner { index, pixel, weight })
        })
    }
}
