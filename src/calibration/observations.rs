//! Detected board corners, checked.

use nalgebra::Vector2;
use thiserror::Error;

use crate::target::{Board, Checkerboard};

/// Fewest corners that fix a view's homography.
pub const FEWEST_CORNERS: usize = 4;

/// How far outside the image a detection may lie, as a share of the image's longer side: noise carries corners
/// across the border, and some detectors extrapolate to it.
pub const BORDER_TOLERANCE: f64 = 0.05;

/// One detected corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Index of the corner on the board, in the order of [`Board::corners`].
    pub index: usize,
    /// Where it was seen, px.
    pub pixel: Vector2<f64>,
    /// How sure that is, against other corners: its standard deviation is that of a corner of weight 1, divided by it.
    pub weight: f64,
}

/// The corners of one image; any of the board's may be missing.
pub type View = Vec<Corner>;

/// The views of one board by one camera, free of the faults that [`ObservationError`] lists.
///
/// The poses that a calibration finds follow the corner indices: z of T points at the camera when the indices
/// run as [`Board::corners`] does seen from the printed side, that is x to the right and y **up** in an upright
/// image. Detectors that count the rows downwards find the same camera, with z pointing away from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    board: Board,
    width: u32,
    height: u32,
    views: Vec<View>,
}

/// Why a set of detections cannot be calibrated from. Views count from 0, as given.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ObservationError {
    /// There is no view at all.
    #[error("there are no views")]
    NoViews,
    /// The board has no area.
    #[error("the board has {columns} x {rows} corners; it needs at least 2 x 2")]
    BoardSize {
        /// Corners along x.
        columns: usize,
        /// Corners along y.
        rows: usize,
    },
    /// The squares of the board have no size.
    #[error("the board's squares measure {square} m; the size must be positive and finite")]
    SquareSize {
        /// The size given, m.
        square: f64,
    },
    /// A view has too few corners for a homography.
    #[error("view {view} has {found} corners; at least {FEWEST_CORNERS} are needed")]
    TooFewCorners {
        /// The view.
        view: usize,
        /// Its corners.
        found: usize,
    },
    /// A corner index is not on the board: detections of another board, or its rows and columns are swapped.
    #[error("view {view}: corner {index} is not on the board, which has {corners} corners")]
    NotOnBoard {
        /// The view.
        view: usize,
        /// The index given.
        index: usize,
        /// Corners of the board.
        corners: usize,
    },
    /// A corner appears twice in a view.
    #[error("view {view}: corner {index} appears twice")]
    Duplicate {
        /// The view.
        view: usize,
        /// The corner's index.
        index: usize,
    },
    /// A pixel is NaN or infinite.
    #[error("view {view}: the pixel of corner {index} is ({u}, {v}); both must be finite")]
    NotFinite {
        /// The view.
        view: usize,
        /// The corner's index.
        index: usize,
        /// Pixel column.
        u: f64,
        /// Pixel row.
        v: f64,
    },
    /// A pixel is outside the image by more than [`BORDER_TOLERANCE`].
    #[error("view {view}: corner {index} at ({u}, {v}) is outside the {width} x {height} image")]
    OutsideImage {
        /// The view.
        view: usize,
        /// The corner's index.
        index: usize,
        /// Pixel column.
        u: f64,
        /// Pixel row.
        v: f64,
        /// Image width, px.
        width: u32,
        /// Image height, px.
        height: u32,
    },
    /// A corner's weight is not positive and finite.
    #[error("view {view}: the weight of corner {index} is {weight}; it must be positive and finite")]
    Weight {
        /// The view.
        view: usize,
        /// The corner's index.
        index: usize,
        /// The weight.
        weight: f64,
    },
    /// All corners of a view lie on one line of the board or of the image.
    #[error("view {view}: its corners lie on one line, which does not determine a homography")]
    Collinear {
        /// The view.
        view: usize,
    },
}

impl Observations {
    /// Checks the detections of `views` of `board` in images of `width` × `height` px.
    ///
    /// # Errors
    /// The first fault found, in the order of the views.
    pub fn new(board: Board, width: u32, height: u32, views: Vec<View>) -> Result<Self, ObservationError> {
        if let Board::Checkerboard(Checkerboard { columns, rows, square }) = board {
            if columns < 2 || rows < 2 {
                return Err(ObservationError::BoardSize { columns, rows });
            }
            if !(square > 0.0 && square.is_finite()) {
                return Err(ObservationError::SquareSize { square });
            }
        }
        if views.is_empty() {
            return Err(ObservationError::NoViews);
        }
        let mut seen = vec![usize::MAX; board.corner_count()];
        for (i, view) in views.iter().enumerate() {
            for corner in view {
                check_corner(&board, width, height, i, corner)?;
                if std::mem::replace(&mut seen[corner.index], i) == i {
                    return Err(ObservationError::Duplicate { view: i, index: corner.index });
                }
            }
            if view.len() < FEWEST_CORNERS {
                return Err(ObservationError::TooFewCorners { view: i, found: view.len() });
            }
            let on_board = view.iter().map(|c| board.corner(c.index).coords.xy());
            if collinear(on_board) || collinear(view.iter().map(|c| c.pixel)) {
                return Err(ObservationError::Collinear { view: i });
            }
        }
        Ok(Self { board, width, height, views })
    }

    /// The board.
    pub fn board(&self) -> &Board {
        &self.board
    }

    /// Image width, px.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Image height, px.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The views.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// Corners in all views together.
    pub fn corner_count(&self) -> usize {
        self.views.iter().map(Vec::len).sum()
    }

    /// Position in T, m, of a corner; z = 0.
    pub(super) fn on_board(&self, corner: &Corner) -> Vector2<f64> {
        self.board.corner(corner.index).coords.xy()
    }
}

fn check_corner(board: &Board, width: u32, height: u32, view: usize, corner: &Corner) -> Result<(), ObservationError> {
    let Corner { index, pixel, weight } = *corner;
    let (u, v) = (pixel.x, pixel.y);
    if index >= board.corner_count() {
        return Err(ObservationError::NotOnBoard { view, index, corners: board.corner_count() });
    }
    if !(u.is_finite() && v.is_finite()) {
        return Err(ObservationError::NotFinite { view, index, u, v });
    }
    if !(weight > 0.0 && weight.is_finite()) {
        return Err(ObservationError::Weight { view, index, weight });
    }
    let margin = 0.5 + BORDER_TOLERANCE * f64::from(width.max(height));
    let outside = |x: f64, size: u32| x < -margin || x > f64::from(size) - 1.0 + margin;
    if outside(u, width) || outside(v, height) {
        return Err(ObservationError::OutsideImage { view, index, u, v, width, height });
    }
    Ok(())
}

/// Whether the points spread in one direction only: their scatter matrix is singular.
fn collinear(points: impl ExactSizeIterator<Item = Vector2<f64>> + Clone) -> bool {
    let mean = points.clone().sum::<Vector2<f64>>() / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for d in points.map(|p| p - mean) {
        xx += d.x * d.x;
        xy += d.x * d.y;
        yy += d.y * d.y;
    }
    // det = λ₁λ₂ and trace = λ₁ + λ₂ ≥ λ₁, so this asks λ₂ ≤ 1e-9 λ₁: a width of 3e-5 lengths.
    xx * yy - xy * xy <= 1e-9 * (xx + yy) * (xx + yy)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOARD: Board = Board::checkerboard(4, 3, 0.05);

    fn view() -> View {
        (0..12)
            .map(|i| Corner {
                index: i,
                pixel: Vector2::new(100.0 + 40.0 * (i % 4) as f64, 90.0 + 35.0 * (i / 4) as f64),
                weight: 1.0,
            })
            .collect()
    }

    fn check(views: Vec<View>) -> Result<Observations, ObservationError> {
        Observations::new(BOARD, 640, 480, views)
    }

    #[test]
    fn good_views_with_missing_corners_pass() {
        let partial = view().into_iter().skip(3).step_by(2).collect();
        let observations = check(vec![view(), partial]).unwrap();
        assert_eq!(observations.corner_count(), 17);
        assert_eq!(
            observations.on_board(&Corner { index: 5, pixel: Vector2::zeros(), weight: 1.0 }),
            Vector2::new(-0.025, 0.0)
        );
    }

    #[test]
    fn faults_name_view_corner_and_value() {
        let mut bad = view();
        bad[7].pixel.x = f64::NAN;
        assert!(matches!(check(vec![view(), bad]), Err(ObservationError::NotFinite { view: 1, index: 7, .. })));
        let mut bad = view();
        bad[2].pixel.y = 1e6;
        let error = check(vec![bad]).unwrap_err();
        assert_eq!(error.to_string(), "view 0: corner 2 at (180, 1000000) is outside the 640 x 480 image");
        let mut bad = view();
        bad[3].index = 2;
        assert_eq!(check(vec![bad]), Err(ObservationError::Duplicate { view: 0, index: 2 }));
        let mut bad = view();
        bad[3].index = 12;
        assert_eq!(check(vec![bad]), Err(ObservationError::NotOnBoard { view: 0, index: 12, corners: 12 }));
        let mut bad = view();
        bad[4].weight = 0.0;
        assert_eq!(check(vec![bad]), Err(ObservationError::Weight { view: 0, index: 4, weight: 0.0 }));
        let short = view().into_iter().take(3).collect();
        assert_eq!(check(vec![view(), short]), Err(ObservationError::TooFewCorners { view: 1, found: 3 }));
        let line = view().into_iter().take(4).collect();
        assert_eq!(check(vec![line]), Err(ObservationError::Collinear { view: 0 }));
        assert_eq!(check(vec![]), Err(ObservationError::NoViews));
    }

    #[test]
    fn pixels_just_inside_and_just_outside_the_tolerance() {
        let at = |u: f64| {
            let mut view = view();
            view[0].pixel.x = u;
            check(vec![view])
        };
        assert!(at(-32.49).is_ok());
        assert!(matches!(at(-32.51), Err(ObservationError::OutsideImage { .. })));
    }

    #[test]
    fn boards_without_area_are_refused() {
        let flat = Board::checkerboard(5, 1, 0.05);
        assert_eq!(
            Observations::new(flat, 640, 480, vec![view()]),
            Err(ObservationError::BoardSize { columns: 5, rows: 1 })
        );
        let nothing = Board::checkerboard(4, 3, 0.0);
        assert_eq!(
            Observations::new(nothing, 640, 480, vec![view()]),
            Err(ObservationError::SquareSize { square: 0.0 })
        );
    }
}
