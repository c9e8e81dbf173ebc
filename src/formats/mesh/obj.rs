//! Wavefront OBJ.

use nalgebra::Point3;

use super::{MeshError, point, text};

/// The vertices, whether or not faces use them.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<Point3<f64>>, MeshError> {
    let mut points = Vec::new();
    for (i, line) in text(bytes).lines().enumerate() {
        let mut words = line.split_whitespace();
        if words.next() == Some("v") {
            points.push(point(words, i + 1)?);
        }
    }
    Ok(points)
}
