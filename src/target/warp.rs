//! Boards that are not flat.

use nalgebra::{Point3, Vector2};

use super::Board;
use crate::lanes::Number;

/// How far a board may bulge: the model of mrcal, `z(x, y) = w_x (1 − x²/h_x²) + w_y (1 − y²/h_y²)` with the outermost corners
/// at ±h, whose two heights have a mean of zero and the same standard deviation. It is one board in all views, so that the
/// heights are two unknowns of all of them together.
///
/// Everywhere the heights are in units of that deviation: what is known of them before the first view is the identity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Warp {
    /// Standard deviation of either height, m.
    pub deviation: f64,
    /// Where the outermost corners are, `h_x` and `h_y`, m.
    half: [f64; 2],
}

/// The face of one board.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Surface {
    warp: Option<Warp>,
    heights: [f64; Warp::HEIGHTS],
}

impl Warp {
    /// Number of heights.
    pub const HEIGHTS: usize = 2;

    /// Their names.
    pub const NAMES: [&'static str; Self::HEIGHTS] = ["warp_x", "warp_y"];

    /// Of a board whose corners do not all lie on one line.
    pub fn new(deviation: f64, board: &Board) -> Self {
        let most = |of: fn(&Point3<f64>) -> f64| board.corners().map(|corner| of(&corner).abs()).fold(0.0, f64::max);
        Self { deviation, half: [most(|corner| corner.x), most(|corner| corner.y)] }
    }

    /// By how much the point at a place on the board (m) rises with each of the heights, m per deviation.
    pub fn rises(&self, place: &Vector2<f64>) -> [f64; Self::HEIGHTS] {
        self.rises_of((*place).into())
    }

    /// The same at one place or at several.
    #[inline]
    pub(crate) fn rises_of<N: Number>(&self, place: [N; Self::HEIGHTS]) -> [N; Self::HEIGHTS] {
        std::array::from_fn(|i| {
            let share = place[i] / N::all(self.half[i]);
            (N::all(1.0) - share * share) * self.deviation
        })
    }
}

impl Surface {
    /// A flat board's.
    pub const FLAT: Self = Self { warp: None, heights: [0.0; Warp::HEIGHTS] };

    /// Of a board that may bulge, by its heights in deviations.
    pub fn new(warp: Warp, heights: [f64; Warp::HEIGHTS]) -> Self {
        Self { warp: Some(warp), heights }
    }

    /// How it may bulge, if it may.
    pub fn warp(&self) -> Option<&Warp> {
        self.warp.as_ref()
    }

    /// The same with its heights moved, in deviations; those of a board that is flat are none.
    #[must_use]
    pub fn moved(mut self, by: &[f64]) -> Self {
        for (height, by) in self.heights.iter_mut().zip(by) {
            *height += by;
        }
        self
    }

    /// Its heights, in deviations.
    pub fn heights(&self) -> [f64; Warp::HEIGHTS] {
        self.heights
    }

    /// The point at a place on the board, in T, m.
    #[inline]
    pub fn point(&self, place: &Vector2<f64>) -> Point3<f64> {
        let rise = |warp: &Warp| warp.rises(place).iter().zip(&self.heights).map(|(rise, height)| rise * height).sum();
        place.push(self.warp.as_ref().map_or(0.0, rise)).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warped_board_rises_in_the_middle_and_keeps_its_rim() {
        let warp = Warp::new(2e-3, &Board::checkerboard(9, 7, 0.03));
        let surface = Surface::new(warp, [1.5, -0.5]);
        let height = |x: f64, y: f64| surface.point(&Vector2::new(x, y)).z;
        assert!((height(0.0, 0.0) - 2e-3).abs() < 1e-15);
        // At the rim in x only the height along y is left, half-way out three quarters of that along x.
        assert!((height(0.12, 0.0) + 1e-3).abs() < 1e-15);
        assert!(height(0.12, 0.09).abs() < 1e-15);
        assert!((height(0.06, 0.09) - 0.75 * 3e-3).abs() < 1e-15);
        assert_eq!(Surface::FLAT.point(&Vector2::new(0.1, 0.2)), Point3::new(0.1, 0.2, 0.0));
    }
}
