//! The markers of OpenCV's predefined dictionaries.

/// A predefined dictionary of square markers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dictionary(&'static Entry);

/// A dictionary: its name, how many markers it has, and where their bits are.
#[derive(Debug, PartialEq, Eq)]
struct Entry {
    name: &'static str,
    markers: usize,
    /// Bits along a marker's side.
    side: usize,
    /// Where the bits of the first marker begin in [`BITS`].
    first: usize,
}

/// Bits of all markers, as `tests/golden/marker_dictionaries.py` wrote them: each row by row, in whole bytes.
const BITS: &[u8] = include_bytes!("dictionaries.bin");

/// All dictionaries; smaller ones of a size are the beginnings of larger ones.
static DICTIONARIES: [Entry; 22] = [
    entry("DICT_4X4_50", 50, 4, 0),
    entry("DICT_4X4_100", 100, 4, 0),
    entry("DICT_4X4_250", 250, 4, 0),
    entry("DICT_4X4_1000", 1000, 4, 0),
    entry("DICT_5X5_50", 50, 5, 2_000),
    entry("DICT_5X5_100", 100, 5, 2_000),
    entry("DICT_5X5_250", 250, 5, 2_000),
    entry("DICT_5X5_1000", 1000, 5, 2_000),
    entry("DICT_6X6_50", 50, 6, 6_000),
    entry("DICT_6X6_100", 100, 6, 6_000),
    entry("DICT_6X6_250", 250, 6, 6_000),
    entry("DICT_6X6_1000", 1000, 6, 6_000),
    entry("DICT_7X7_50", 50, 7, 11_000),
    entry("DICT_7X7_100", 100, 7, 11_000),
    entry("DICT_7X7_250", 250, 7, 11_000),
    entry("DICT_7X7_1000", 1000, 7, 11_000),
    entry("DICT_ARUCO_ORIGINAL", 1024, 5, 18_000),
    entry("DICT_ARUCO_MIP_36h12", 250, 6, 22_096),
    entry("DICT_APRILTAG_16h5", 30, 4, 23_346),
    entry("DICT_APRILTAG_25h9", 35, 5, 23_406),
    entry("DICT_APRILTAG_36h10", 2320, 6, 23_546),
    entry("DICT_APRILTAG_36h11", 587, 6, 35_146),
];

const fn entry(name: &'static str, markers: usize, side: usize, first: usize) -> Entry {
    Entry { name, markers, side, first }
}

impl Dictionary {
    /// The tags of AprilTag 36h11, which Kalibr's grids have.
    pub const APRILTAG_36H11: Self = Self(&DICTIONARIES[21]);

    /// Every dictionary.
    pub fn all() -> impl Iterator<Item = Self> {
        DICTIONARIES.iter().map(Self)
    }

    /// The dictionary that OpenCV calls so, in capitals or not, and with or without `DICT_`.
    pub fn named(name: &str) -> Option<Self> {
        let bare = |name: &str| {
            let name = name.to_ascii_uppercase();
            name.strip_prefix("DICT_").map_or(name.clone(), str::to_owned)
        };
        Self::all().find(|dictionary| bare(dictionary.name()) == bare(name))
    }

    /// OpenCV's name.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// How many markers it has.
    pub fn markers(self) -> usize {
        self.0.markers
    }

    /// Bits along a marker's side, without its border.
    pub fn side(self) -> usize {
        self.0.side
    }

    /// Whether a module of marker `id` is light, by its row from the top and its column from the left, as OpenCV draws it.
    pub fn is_light(self, id: usize, row: usize, column: usize) -> bool {
        let Entry { side, first, .. } = *self.0;
        let bit = row * side + column;
        let byte = first + id * (side * side).div_ceil(8) + bit / 8;
        BITS.get(byte).is_some_and(|byte| byte >> (7 - bit % 8) & 1 == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dictionary_has_its_bits() {
        let end = |Entry { markers, side, first, .. }: &Entry| first + markers * (side * side).div_ceil(8);
        assert_eq!(DICTIONARIES.iter().map(end).max(), Some(BITS.len()));
        // The first tag of 36h11 is 0xd5d628584; OpenCV has it upside down.
        let tag: u64 = (0..36)
            .rev()
            .fold(0, |tag, bit| tag << 1 | u64::from(Dictionary::APRILTAG_36H11.is_light(0, bit / 6, bit % 6)));
        assert_eq!(tag, 0xd_5d62_8584);
        // DICT_4X4's first marker, from OpenCV's documentation: B5 32.
        let rows = |row: usize| (0..4).map(|column| u8::from(SMALLEST.is_light(0, row, column))).collect();
        let rows: Vec<Vec<u8>> = (0..4).map(rows).collect();
        assert_eq!(rows, [[1, 0, 1, 1], [0, 1, 0, 1], [0, 0, 1, 1], [0, 0, 1, 0]]);
    }

    const SMALLEST: Dictionary = Dictionary(&DICTIONARIES[0]);

    #[test]
    fn names_are_opencvs() {
        for name in ["DICT_APRILTAG_36h11", "DICT_APRILTAG_36H11", "apriltag_36h11"] {
            assert_eq!(Dictionary::named(name), Some(Dictionary::APRILTAG_36H11), "{name}");
        }
        assert_eq!(Dictionary::named("DICT_4X4_50").map(|found| (found.markers(), found.side())), Some((50, 4)));
        assert_eq!(Dictionary::named("DICT_8X8_50"), None);
    }
}
