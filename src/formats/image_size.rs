//! The size of a camera's images, as files state it.

use super::error::{ReadError, ReadFault};
use super::tree::Node;

/// Longest image side, px.
const LONGEST_SIDE: u32 = 100_000;

/// A side of an image, px.
pub(super) fn side(node: &Node, key: &str) -> Result<u32, ReadError> {
    node.count(&key, 1, LONGEST_SIDE)
}

/// The image size that the file has on `line`, if it has one, or that is `known` beside it; both, where they agree.
pub(super) fn agreed(found: Option<[u32; 2]>, known: Option<[u32; 2]>, line: usize) -> Result<[u32; 2], ReadError> {
    match (found, known) {
        (Some(found), Some(given)) if found != given => {
            let [found, given] = [found, given].map(|[width, height]| format!("{width} x {height}"));
            Err(ReadFault::Mismatch { what: "image size", found, given }.at(line))
        }
        (Some(size), _) | (None, Some(size)) => Ok(size),
        (None, None) => Err(ReadFault::NotStated { what: "image size" }.at(line)),
    }
}
