//! Whether the corners are listed in the board's order: in the wrong one, no homography takes the board to the image.

use nalgebra::Vector2;

use super::CalibrationError;
use super::homography::homography;
use super::observations::{Observations, View};

/// A homography that misses the corners by more than this share of their spread is none: strong distortion leaves less,
/// another order several times as much.
const MISFIT: f64 = 0.15;

/// Swapped rows and columns fit where they miss by less than this share of what the order given does.
const BETTER: f64 = 0.25;

/// A view misses as no other does beyond this multiple of their median.
const APART: f64 = 8.0;

/// How far the best homography misses a view's corners, as a share of their spread.
struct Misfit {
    as_given: f64,
    /// With the list read as that of a board of as many rows as this has columns; infinite where the board is no grid.
    swapped: f64,
}

/// Refuses views whose corners stand in another order than the board's. Mirrored and turned orders are those of the same
/// board, mirrored or turned: any lists of that kind fix the same camera.
///
/// # Errors
/// [`CalibrationError::SwappedOrder`] and [`CalibrationError::Disordered`], with the views.
pub(super) fn check(observations: &Observations) -> Result<(), CalibrationError> {
    let misfits: Vec<Misfit> = observations.views().iter().map(|view| misfit(observations, view)).collect();
    let of = misfits.len();
    let views = |is: &dyn Fn(&Misfit) -> bool| -> Vec<usize> { (0..of).filter(|&view| is(&misfits[view])).collect() };
    let swapped = views(&|m| m.as_given > MISFIT && m.swapped < BETTER * m.as_given);
    if !swapped.is_empty() {
        let (columns, rows, _) = observations.board().grid().unwrap_or_default();
        return Err(CalibrationError::SwappedOrder { views: swapped, of, columns, rows });
    }
    let mut sorted: Vec<f64> = misfits.iter().map(|m| m.as_given).collect();
    let (_, median, _) = sorted.select_nth_unstable_by(of / 2, f64::total_cmp);
    let limit = MISFIT.max(APART * *median);
    let disordered = views(&|m| m.as_given > limit);
    if disordered.is_empty() { Ok(()) } else { Err(CalibrationError::Disordered { views: disordered, of }) }
}

fn misfit(observations: &Observations, view: &View) -> Misfit {
    let image: Vec<Vector2<f64>> = view.iter().map(|corner| corner.pixel).collect();
    let given: Vec<_> = view.iter().map(|corner| observations.on_board(corner)).collect();
    let swapped = observations.board().grid().map_or(f64::INFINITY, |(_, rows, _)| {
        let in_order = |index: usize| Vector2::new((index % rows) as f64, (index / rows) as f64);
        missed(&view.iter().map(|corner| in_order(corner.index)).collect::<Vec<_>>(), &image)
    });
    Misfit { as_given: missed(&given, &image), swapped }
}

/// Root mean square distance from the image points to the homography's, over the root mean square distance from their
/// middle; infinite where there is no homography.
fn missed(board: &[Vector2<f64>], image: &[Vector2<f64>]) -> f64 {
    let Some(H) = homography(board, image) else { return f64::INFINITY };
    let middle = image.iter().sum::<Vector2<f64>>() / image.len() as f64;
    let spread: f64 = image.iter().map(|pixel| (pixel - middle).norm_squared()).sum();
    let squares = board.iter().zip(image).map(|(point, pixel)| {
        let mapped = H * point.push(1.0);
        (mapped.xy() / mapped.z - pixel).norm_squared()
    });
    let missed = (squares.sum::<f64>() / spread).sqrt();
    if missed.is_nan() { f64::INFINITY } else { missed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Corner;
    use crate::target::Board;

    const BOARD: Board = Board::checkerboard(7, 4, 0.03);

    /// A tilted board, the corner at column i and row j listed as `index(i, j)`.
    fn view(index: impl Fn(usize, usize) -> usize) -> View {
        let mut view: View = (0..28)
            .map(|n| {
                let (i, j) = (n % 7, n / 7);
                let (x, y) = (i as f64, j as f64);
                let pixel = Vector2::new(100.0 + 40.0 * x + 3.0 * y, 90.0 + 35.0 * y) / (1.0 + 0.02 * x + 0.01 * y);
                Corner { index: index(i, j), pixel, weight: 1.0 }
            })
            .collect();
        view.sort_unstable_by_key(|corner| corner.index);
        view
    }

    fn checked(views: Vec<View>) -> Result<(), CalibrationError> {
        check(&Observations::new(BOARD, 640, 480, views).unwrap())
    }

    #[test]
    fn mirrored_and_turned_lists_pass() {
        let ordered: [fn(usize, usize) -> usize; 4] =
            [|i, j| 7 * j + i, |i, j| 7 * j + 6 - i, |i, j| 7 * (3 - j) + i, |i, j| 27 - 7 * j - i];
        assert_eq!(checked(ordered.map(view).to_vec()), Ok(()));
    }

    #[test]
    fn lists_by_columns_and_shuffled_ones_are_told_apart() {
        let good = || view(|i, j| 7 * j + i);
        let by_columns = || view(|i, j| 4 * i + j);
        assert_eq!(
            checked(vec![good(), by_columns(), good()]),
            Err(CalibrationError::SwappedOrder { views: vec![1], of: 3, columns: 7, rows: 4 })
        );
        assert!(matches!(checked(vec![by_columns()]), Err(CalibrationError::SwappedOrder { of: 1, .. })));
        // Every other row backwards.
        let winding = view(|i, j| 7 * j + if j % 2 == 0 { i } else { 6 - i });
        assert_eq!(checked(vec![good(), good(), winding]), Err(CalibrationError::Disordered { views: vec![2], of: 3 }));
    }
}
