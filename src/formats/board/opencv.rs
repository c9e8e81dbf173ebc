//! `OpenCV`'s `ChArUco` board in JSON: `dictionary`, `square_size` and `marker_size`, as its programs for several cameras read it.

use super::StatedBoard;
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Node;
use crate::target::Dictionary;

/// Lengths in m. `OpenCV` leaves the unit to the user; calipose reads m, as from its camera files, and a square of more than
/// two metres stands for one in mm.
const LENGTHS: [f64; 2] = [1e-4, 2.0];

pub(super) fn read(root: &Node) -> Result<StatedBoard, ReadError> {
    let node = root.require("", "dictionary")?;
    // OpenCV's own number of it, or its name.
    let name = node.text(&"dictionary")?;
    let numbered = name.parse().ok().and_then(|number: usize| Dictionary::all().nth(number_of(number)?));
    let dictionary = numbered.or_else(|| Dictionary::named(name)).ok_or_else(|| {
        let (key, found) = ("dictionary".to_owned(), name.to_owned());
        let supported = "OpenCV's predefined ones, by their numbers from 0 to 21 or names such as DICT_5X5_100";
        ReadFault::Unsupported { key, found, supported }.at(node.line)
    })?;
    let length = |key: &str| root.require("", key)?.number(&key)?.between(&key, LENGTHS[0], LENGTHS[1]);
    Ok(StatedBoard::Charuco { dictionary, square: length("square_size")?, marker: length("marker_size")? })
}

/// The place in [`Dictionary::all`] of the dictionary that `OpenCV` numbers so: it counts `ArUco`'s MIP last.
fn number_of(number: usize) -> Option<usize> {
    match number {
        0..=16 => Some(number),
        17..=20 => Some(number + 1),
        21 => Some(17),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_opencvs() {
        let name = |number| Dictionary::all().nth(number_of(number)?).map(Dictionary::name);
        for (number, expected) in [
            (0, "DICT_4X4_50"),
            (15, "DICT_7X7_1000"),
            (16, "DICT_ARUCO_ORIGINAL"),
            (17, "DICT_APRILTAG_16h5"),
            (20, "DICT_APRILTAG_36h11"),
            (21, "DICT_ARUCO_MIP_36h12"),
        ] {
            assert_eq!(name(number), Some(expected));
        }
        assert_eq!(name(22), None);
    }
}
