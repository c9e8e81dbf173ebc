//! By how much a configuration misses being a view, test by test.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector3};

use super::visibility::{VisibilityLimits, cos_tilt, square_height};
use crate::camera::Camera;
use crate::spatial::Pose;
use crate::target::{Board, Marker};

/// Most corners looked at along each side of the board.
const MOST_ALONG: usize = 8;

/// What a configuration measures in every test of visibility, whatever the others say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Distance in m from the camera to the board's centre.
    pub distance: f64,
    /// Angle in rad between the board's normal and the direction to the camera; beyond a right angle the camera is on the
    /// unprinted side.
    pub incidence: f64,
    /// Angle in rad between the board's normal and the optical axis.
    pub tilt: f64,
    /// Angle in rad between the optical axis and the direction to the board's centre.
    pub off_axis: f64,
    /// How far in px the outermost corner that must be seen is beyond the allowed part of the image; not positive inside, infinite
    /// where the lens model does not reach.
    pub overhang: f64,
    /// Least height in px of a square in the image; infinite where none are projected.
    pub spacing: f64,
    /// Greatest of the markers' least sides in px; infinite where there are none.
    pub marker: f64,
}

/// A test of visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VisibilityTest {
    /// The camera is on the printed side.
    Side,
    /// The board is neither too near nor too far.
    Distance,
    /// It is not seen too flatly.
    Incidence,
    /// It is not tilted too far against the optical axis.
    Tilt,
    /// Its corners are in the image.
    Image,
    /// Neighbouring corners are far enough apart, and markers large enough to be read.
    Spacing,
}

impl VisibilityTest {
    /// Every test, in the order of the checks.
    pub const ALL: [VisibilityTest; 6] = [
        VisibilityTest::Side,
        VisibilityTest::Distance,
        VisibilityTest::Incidence,
        VisibilityTest::Tilt,
        VisibilityTest::Image,
        VisibilityTest::Spacing,
    ];
}

/// A camera looking at a board whose inner corners are thinned out, so that large ones take no longer.
#[derive(Debug, Clone, PartialEq)]
pub struct Sighting<'a> {
    camera: &'a Camera,
    limits: &'a VisibilityLimits,
    corners: Vec<Point3<f64>>,
    /// How many of them must be in the image.
    least: usize,
    /// Corners with two neighbours, at the board's corners and in its middle.
    squares: Vec<[Point3<f64>; 3]>,
    markers: Vec<Marker>,
}

impl<'a> Sighting<'a> {
    /// Of `board` by `camera` within `limits`.
    pub fn new(camera: &'a Camera, board: &Board, limits: &'a VisibilityLimits) -> Self {
        let (columns, rows) = sides(board);
        let index = |column: usize, row: usize| row * columns + column;
        let corners: Vec<_> = thinned(rows)
            .iter()
            .flat_map(|&row| thinned(columns).into_iter().map(move |column| index(column, row)))
            .map(|i| board.corner(i))
            .collect();
        let share = limits.min_corners.map_or(1.0, |least| least as f64 / board.corner_count() as f64);
        let least = ((share * corners.len() as f64).round() as usize).clamp(1, corners.len());
        let mut squares = Vec::new();
        for row in [0, rows / 2, rows - 1] {
            for column in [0, columns / 2, columns - 1] {
                let corner = index(column, row);
                let [beside, above] = board.neighbours(corner);
                squares.push([corner, beside, above].map(|i| board.corner(i)));
            }
        }
        Self { camera, limits, corners, least, squares, markers: board.markers() }
    }

    /// What the camera measures of the board at `X_CT`.
    pub fn measures(&self, X_CT: &Pose) -> Measures {
        let to_board = X_CT.translation.vector;
        let distance = to_board.norm();
        let normal = X_CT.rotation * Vector3::z();
        let mut overhangs: Vec<f64> = self.corners.iter().map(|corner| self.overhang(&(X_CT * corner))).collect();
        overhangs.sort_by(f64::total_cmp);
        let pixel = |corner: &Point3<f64>| self.camera.project(&(X_CT * corner));
        let height = |[corner, beside, above]: &[Point3<f64>; 3]| {
            let corner = pixel(corner)?;
            let edge = |neighbour| pixel(neighbour).map(|neighbour| neighbour - corner);
            square_height(edge(beside), edge(above))
        };
        let side = |marker: &Marker| {
            let sides = marker.outline.iter().zip(marker.outline.iter().cycle().skip(1));
            sides
                .map(|(a, b)| Some((pixel(a)? - pixel(b)?).norm()))
                .try_fold(f64::INFINITY, |least, side| Some(least.min(side?)))
        };
        Measures {
            distance,
            incidence: arc_cosine(-normal.dot(&to_board) / distance),
            tilt: arc_cosine(cos_tilt(X_CT)),
            off_axis: arc_cosine(to_board.z / distance),
            overhang: overhangs[self.least - 1],
            spacing: self.squares.iter().filter_map(height).fold(f64::INFINITY, f64::min),
            marker: self.markers.iter().filter_map(side).reduce(f64::max).unwrap_or(f64::INFINITY),
        }
    }

    /// By how much each test of [`VisibilityTest::ALL`] is missed: m, rad or px, not positive where it is passed.
    pub fn shortfalls(&self, measures: &Measures) -> [f64; VisibilityTest::ALL.len()] {
        let Measures { distance, incidence, tilt, off_axis: _, overhang, spacing, marker } = *measures;
        let limits = self.limits;
        [
            // In the board's plane nothing is seen either.
            if incidence < FRAC_PI_2 { 0.0 } else { (incidence - FRAC_PI_2).max(f64::MIN_POSITIVE) },
            (distance - limits.max_distance).max(limits.min_distance - distance),
            // From the other side it is no question of flatness.
            if incidence < FRAC_PI_2 { incidence - limits.max_incidence } else { 0.0 },
            tilt - limits.max_tilt,
            overhang,
            if spacing.is_finite() {
                (limits.min_corner_spacing - spacing).max(limits.min_marker - marker)
            } else {
                0.0
            },
        ]
    }

    fn overhang(&self, corner_C: &Point3<f64>) -> f64 {
        let Some(pixel) = self.camera.project(corner_C) else { return f64::INFINITY };
        let margin = self.limits.margin;
        let beyond = |x: f64, size: u32| (margin - x).max(x - (f64::from(size) - 1.0 - margin));
        beyond(pixel.x, self.camera.width()).max(beyond(pixel.y, self.camera.height()))
    }
}

/// Columns and rows of a board's corners; those of one that has no rows are taken for a square.
fn sides(board: &Board) -> (usize, usize) {
    let (count, columns) = (board.corner_count(), board.columns());
    if columns < count {
        return (columns, count / columns);
    }
    let side = count.isqrt();
    (side, count / side)
}

/// At most [`MOST_ALONG`] of `count` indices, evenly and with both ends.
fn thinned(count: usize) -> Vec<usize> {
    let kept = count.min(MOST_ALONG);
    (0..kept).map(|i| i * (count - 1) / (kept - 1)).collect()
}

/// In [0, π]; half a turn where the cosine is undefined.
fn arc_cosine(cosine: f64) -> f64 {
    if cosine.is_nan() { std::f64::consts::PI } else { cosine.clamp(-1.0, 1.0).acos() }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::camera::Lens;
    use crate::target::viewpoint;

    const LIMITS: VisibilityLimits = VisibilityLimits {
        margin: 5.0,
        max_incidence: 1.2,
        max_tilt: 1.2,
        min_distance: 0.3,
        max_distance: 1.0,
        min_corner_spacing: 10.0,
        min_corners: None,
        min_marker: 0.0,
    };

    fn camera() -> Camera {
        Camera::new(Lens::Pinhole, 641, 481, &[500.0, 500.0, 320.0, 240.0]).unwrap()
    }

    #[test]
    fn every_shortfall_is_in_its_own_unit() {
        let (camera, board) = (camera(), Board::checkerboard(11, 9, 0.02));
        let sighting = Sighting::new(&camera, &board, &LIMITS);
        let seen = |X_TC: Pose| sighting.measures(&X_TC.inverse());
        // Straight from 0.5 m: 0.1 m to the side is 100 px off the centre, 215 px within the margin; neighbours are 20 px apart.
        let straight = seen(viewpoint(0.5, 0.0, 0.0, 0.0));
        assert!((straight.overhang + 155.0).abs() < 1e-9 && (straight.spacing - 20.0).abs() < 1e-9, "{straight:?}");
        assert!(straight.incidence < 1e-7 && straight.tilt < 1e-7 && straight.off_axis < 1e-7);
        assert!(sighting.shortfalls(&straight).iter().all(|&miss| miss <= 0.0));
        let far = sighting.shortfalls(&seen(viewpoint(4.9, 0.0, 0.0, 0.0)));
        assert!((far[1] - 3.9).abs() < 1e-12 && (far[5] - (10.0 - 0.02 / 4.9 * 500.0)).abs() < 1e-9, "{far:?}");
        let near = sighting.shortfalls(&seen(viewpoint(0.2, 0.0, 0.0, 0.0)));
        assert!((near[1] - 0.1).abs() < 1e-12 && (near[4] - (0.08 / 0.2 * 500.0 - 235.0)).abs() < 1e-9, "{near:?}");
        let flat = seen(viewpoint(0.6, 1.3, 0.4, 0.0));
        assert!(
            (sighting.shortfalls(&flat)[2] - 0.1).abs() < 1e-9 && (sighting.shortfalls(&flat)[3] - 0.1).abs() < 1e-9
        );
        // Turned about, the camera sees nothing of the board.
        let about = viewpoint(0.5, 0.0, 0.0, 0.0) * Pose::rotation(Vector3::y() * PI);
        let about = seen(about);
        assert!((about.off_axis - PI).abs() < 1e-7 && about.overhang == f64::INFINITY, "{about:?}");
        let behind = sighting.measures(&Pose::translation(0.0, 0.0, 0.5));
        assert!(sighting.shortfalls(&behind)[0] > 1.5, "{behind:?}");
    }

    #[test]
    fn of_a_board_that_may_be_read_in_part_the_nearest_corners_count() {
        let (camera, board) = (camera(), Board::checkerboard(8, 8, 0.02));
        let half = VisibilityLimits { min_corners: Some(32), ..LIMITS };
        let X_CT = Pose::translation(0.3, 0.0, 0.4);
        let whole = Sighting::new(&camera, &board, &LIMITS).measures(&X_CT).overhang;
        let part = Sighting::new(&camera, &board, &half).measures(&X_CT).overhang;
        assert!(part < whole - 20.0, "{part} {whole}");
    }
}
