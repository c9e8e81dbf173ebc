//! Wavefront OBJ.

use nalgebra::Point3;

use super::{MeshError, point, text};

/// The vertices that faces use, once for each use.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<Point3<f64>>, MeshError> {
    let mut all = Vec::new();
    let mut used = Vec::new();
    for (i, line) in text(bytes).lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => all.push(point(words, i + 1)?),
            Some("f") => {
                for corner in words {
                    let unknown = || MeshError::at(i + 1, format!("there is no vertex \"{corner}\" yet"));
                    used.push(all[index(corner, all.len()).ok_or_else(unknown)?]);
                }
            }
            _ => {}
        }
    }
    Ok(used)
}

/// The index in a face's corner, `7`, `7/1`, `7//3` or `7/1/3`: from 1, or from the latest of `count` backwards.
fn index(corner: &str, count: usize) -> Option<usize> {
    let number: isize = corner.split('/').next()?.parse().ok()?;
    let back = number.unsigned_abs();
    let index = if number < 0 { count.checked_sub(back) } else { back.checked_sub(1) };
    index.filter(|&index| index < count)
}
