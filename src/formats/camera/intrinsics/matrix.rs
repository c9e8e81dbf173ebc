//! The matrices that ROS and OpenCV share: `{rows, cols, data}`, or the bare numbers.

use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::{Located, Node};

/// A matrix is never larger here.
const MOST: u32 = 64;

/// Skew, px per unit of y/z, of no account: over a field of view of 90° it moves the image by less than a thousandth of a pixel.
const NO_SKEW: f64 = 1e-3;

/// Rounding of the camera matrix's zeros and its one below.
const ROUNDING: f64 = 1e-9;

/// A matrix of a file.
pub(in crate::formats::camera) struct Matrix {
    /// The key of its numbers.
    pub(in crate::formats::camera) key: String,
    pub(in crate::formats::camera) line: usize,
    /// Row by row.
    pub(in crate::formats::camera) entries: Vec<Located>,
}

impl Matrix {
    /// The matrix at the first of `keys` that `root` has.
    pub(in crate::formats::camera) fn read(root: &Node, keys: &[&str]) -> Result<Self, ReadError> {
        let Some((key, matrix)) = root.first_of(keys) else {
            return Err(ReadFault::Missing { key: keys[0].to_owned() }.at(root.line));
        };
        if matrix.entries().is_empty() {
            return Ok(Self { key: key.to_owned(), line: matrix.line, entries: matrix.numbers(&key)? });
        }
        let within = format!("{key}.");
        let side = |name: &str| matrix.require(&within, name)?.count(&format_args!("{within}{name}"), 0, MOST);
        let (rows, columns) = (side("rows")?, side("cols")?);
        let data = matrix.require(&within, "data")?;
        let (key, line) = (format!("{within}data"), data.line);
        let entries = data.numbers(&key)?;
        if entries.len() as u32 != rows * columns {
            let expected = format!("{} ({rows} x {columns})", rows * columns);
            return Err(ReadFault::Length { key, found: entries.len(), expected }.at(line));
        }
        Ok(Self { key, line, entries })
    }

    /// fx, fy, cx and cy of a camera matrix, which must have no skew.
    pub(in crate::formats::camera) fn pinhole(&self) -> Result<[Located; 4], ReadError> {
        let Self { key, line, entries } = self;
        let [fx, skew, cx, zero, fy, cy, left, below, one] = entries[..] else {
            let expected = "9 (3 x 3)".to_owned();
            return Err(ReadFault::Length { key: key.clone(), found: entries.len(), expected }.at(*line));
        };
        if skew.value.abs() > NO_SKEW {
            return Err(ReadFault::Skew { key: format!("{key}[1]"), value: skew.value }.at(skew.line));
        }
        for (i, entry, must) in [(3, zero, 0.0), (6, left, 0.0), (7, below, 0.0), (8, one, 1.0)] {
            if (entry.value - must).abs() > ROUNDING {
                entry.between(&format_args!("{key}[{i}]"), must, must)?;
            }
        }
        Ok([fx, fy, cx, cy])
    }
}

/// Entries of the camera matrix of θ.
pub(in crate::formats::camera) fn camera_matrix(θ: &[f64]) -> [f64; 9] {
    [θ[0], 0.0, θ[2], 0.0, θ[1], θ[3], 0.0, 0.0, 1.0]
}
