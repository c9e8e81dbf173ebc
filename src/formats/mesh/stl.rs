//! STL, binary or ASCII.

use nalgebra::Point3;

use super::{MeshError, point, text};

/// Header and count of a binary file, and what a triangle takes.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Bytes of a binary file.
pub(super) fn size(triangles: u32) -> usize {
    HEADER + triangles as usize * TRIANGLE
}

/// The corners of all triangles.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<Point3<f64>>, MeshError> {
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    match count {
        // Binary files may begin with "solid" too; their length tells them apart.
        Some(triangles) if bytes.len() == size(triangles) => Ok(binary(&bytes[HEADER..])),
        Some(triangles) if !begins_with_solid(bytes) => Err(MeshError::Size { triangles, bytes: bytes.len() }),
        _ => ascii(&text(bytes)),
    }
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    bytes.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn binary(triangles: &[u8]) -> Vec<Point3<f64>> {
    let number = |bytes: &[u8]| bytes.try_into().map_or(f64::NAN, |bytes| f64::from(f32::from_le_bytes(bytes)));
    let corner = |bytes: &[u8]| Point3::new(number(&bytes[..4]), number(&bytes[4..8]), number(&bytes[8..]));
    // The normal comes before the corners, two bytes of attributes after them.
    triangles.chunks_exact(TRIANGLE).flat_map(|triangle| triangle[12..48].chunks_exact(12).map(corner)).collect()
}

fn ascii(text: &str) -> Result<Vec<Point3<f64>>, MeshError> {
    let mut points = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        // Some exporters write all words in capitals.
        if words.next().is_some_and(|word| word.eq_ignore_ascii_case("vertex")) {
            points.push(point(words, i + 1)?);
        }
    }
    Ok(points)
}
