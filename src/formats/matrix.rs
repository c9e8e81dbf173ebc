//! The matrices that ROS and OpenCV share: `{rows, cols, data}`.

use super::error::{ReadError, ReadFault};
use super::tree::{Located, Node};

/// A matrix is never larger here.
const MOST: u32 = 64;

/// The entries of the matrix `key` of `root`, row by row.
pub(super) fn entries(root: &Node, key: &str) -> Result<Vec<Located>, ReadError> {
    let matrix = root.require("", key)?;
    let within = format!("{key}.");
    let side = |name: &str| matrix.require(&within, name)?.count(&format_args!("{within}{name}"), 0, MOST);
    let (rows, columns) = (side("rows")?, side("cols")?);
    let data = matrix.require(&within, "data")?;
    let name = format!("{within}data");
    let list = data.list(&name)?;
    if list.len() as u32 != rows * columns {
        let expected = format!("{} ({rows} x {columns})", rows * columns);
        return Err(ReadFault::Length { key: name, found: list.len(), expected }.at(data.line));
    }
    list.iter().enumerate().map(|(i, node)| node.number(&format_args!("{name}[{i}]"))).collect()
}

/// fx, fy, cx and cy of `camera_matrix`, which must have no skew.
pub(super) fn pinhole(root: &Node) -> Result<[Located; 4], ReadError> {
    let key = "camera_matrix";
    let entries = entries(root, key)?;
    let [fx, skew, cx, zero, fy, cy, left, below, one] = entries[..] else {
        let line = root.require("", key)?.line;
        let expected = "9 (3 x 3)".to_owned();
        return Err(ReadFault::Length { key: format!("{key}.data"), found: entries.len(), expected }.at(line));
    };
    for (i, entry, must) in [(1, skew, 0.0), (3, zero, 0.0), (6, left, 0.0), (7, below, 0.0), (8, one, 1.0)] {
        entry.between(&format_args!("{key}.data[{i}]"), must, must)?;
    }
    Ok([fx, fy, cx, cy])
}

/// Entries of the camera matrix of θ.
pub(super) fn camera_matrix(θ: &[f64]) -> [f64; 9] {
    [θ[0], 0.0, θ[2], 0.0, θ[1], θ[3], 0.0, 0.0, 1.0]
}
