//! Kalibr's targets in YAML.

use super::{StatedBoard, refused};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Node;
use crate::target::{AprilGrid, Checkerboard};

/// Corners, circles or tags along a side: as many as in problem files.
const MOST: u32 = 1000;

/// Lengths in m.
const LENGTHS: [f64; 2] = [1e-6, 1e3];

pub(super) fn read(root: &Node) -> Result<StatedBoard, ReadError> {
    let count = |key: &str, least: u32| root.require("", key)?.count(&key, least, MOST);
    let length = |key: &str| root.require("", key)?.number(&key)?.between(&key, LENGTHS[0], LENGTHS[1]);
    let kind = root.require("", "target_type")?;
    match kind.text(&"target_type")? {
        "checkerboard" => {
            let (columns, rows) = (count("targetCols", 2)? as usize, count("targetRows", 2)? as usize);
            let (square, along_rows) = (length("colSpacingMeters")?, length("rowSpacingMeters")?);
            if (square / along_rows - 1.0).abs() > 1e-9 {
                let line = root.require("", "rowSpacingMeters")?.line;
                let [found, given] = [along_rows, square].map(|side| format!("{side} m"));
                return Err(ReadFault::NotSquare { rows: found, columns: given }.at(line));
            }
            Ok(StatedBoard::Checkerboard(Checkerboard { columns, rows, square }))
        }
        "aprilgrid" => {
            let sides = [count("tagCols", 1)? as usize, count("tagRows", 1)? as usize];
            let spacing = root.require("", "tagSpacing")?.number(&"tagSpacing")?.between(&"tagSpacing", 0.01, 1.0)?;
            let grid = AprilGrid::new(sides, length("tagSize")?, spacing);
            Ok(StatedBoard::AprilGrid(grid.map_err(|error| refused(error, kind.line))?))
        }
        "circlegrid" => {
            let is_asymmetric = match root.get("asymmetricGrid") {
                None => false,
                Some(node) => match node.text(&"asymmetricGrid")?.to_ascii_lowercase().as_str() {
                    "true" | "1" => true,
                    "false" | "0" => false,
                    other => {
                        let (key, found) = ("asymmetricGrid".to_owned(), other.to_owned());
                        return Err(ReadFault::Type { key, found, expected: "true or false" }.at(node.line));
                    }
                },
            };
            // In the asymmetric grid Kalibr's is the step from row to row, half of that along a row.
            let steps = if is_asymmetric { 2.0 } else { 1.0 };
            let (columns, rows) = (count("targetCols", 2)?, count("targetRows", 2)?);
            Ok(StatedBoard::Circles { columns, rows, spacing: steps * length("spacingMeters")?, is_asymmetric })
        }
        other => {
            let (key, found) = ("target_type".to_owned(), other.to_owned());
            let supported = "checkerboard, aprilgrid, circlegrid";
            Err(ReadFault::Unsupported { key, found, supported }.at(kind.line))
        }
    }
}
