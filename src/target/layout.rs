//! What every kind of board says of itself.

use nalgebra::{Point3, Vector2};

use super::feature::Feature;

/// Something on a board that has to be read whole, or the corners that hang on it do not count.
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// The points in T that must be in the picture, one after the other around it.
    pub outline: Vec<Point3<f64>>,
    /// Points within that must not be hidden either.
    pub inside: Vec<Point3<f64>>,
    /// Indices of the corners that hang on it.
    pub corners: Vec<usize>,
}

/// What every kind of board says of itself. In frame T, in m, with z = 0.
pub(super) trait Layout {
    /// How many corners there are: the points that are detected, of whatever kind.
    fn corner_count(&self) -> usize;

    /// How many are listed in a row.
    fn columns(&self) -> usize;

    /// Where a corner is.
    fn corner(&self, index: usize) -> Point3<f64>;

    /// What it is.
    fn feature(&self, index: usize) -> Feature;

    /// Two corners near it, in different directions.
    fn neighbours(&self, index: usize) -> [usize; 2];

    /// How far from a corner the nearest marker's pattern begins, as a share of the way to its neighbours; none without
    /// markers.
    fn clear(&self) -> Option<f64> {
        None
    }

    /// Extent of what is printed along x and y, its middle T's origin.
    fn printed_size(&self) -> (f64, f64);

    /// What must be read whole for corners to count.
    fn markers(&self) -> Vec<Marker> {
        Vec::new()
    }

    /// Modules, light or dark, along a side of its markers; 0 where there is nothing to read in them.
    fn modules(&self) -> usize {
        0
    }

    /// Fewest corners of a view that the kind's detectors hand on; none where they find all or nothing.
    fn fewest(&self) -> Option<usize> {
        None
    }
}

/// The neighbours of a corner of a grid, row by row: the one before it in its row and the one before it in its column, or after
/// it where there is none.
pub(super) fn beside_and_above(index: usize, columns: usize) -> [usize; 2] {
    [
        if index.is_multiple_of(columns) { index + 1 } else { index - 1 },
        if index < columns { index + columns } else { index - columns },
    ]
}

/// Directions that differ by less (rad) are one: rounding alone makes some 10⁻¹³, and corners of the largest boards differ by
/// 10⁻⁶.
const ON_A_LINE: f64 = 1e-9;

/// Whether corners (by index, each once), at these places on the board, fix the homography between board and image.
pub(super) fn fix_homography(corners: &[usize], at: impl Fn(usize) -> Vector2<f64>) -> bool {
    let [a, b, c, _, ..] = *corners else { return false };
    // A line through all but one passes through two of any three.
    let off_the_line = |(a, b): (usize, usize)| {
        let (a, along) = (at(a), at(b) - at(a));
        let is_off = |&&p: &&usize| {
            let to = at(p) - a;
            along.perp(&to).abs() > ON_A_LINE * along.norm() * to.norm()
        };
        corners.iter().filter(is_off).count()
    };
    [(a, b), (a, c), (b, c)].into_iter().all(|line| off_the_line(line) >= 2)
}
