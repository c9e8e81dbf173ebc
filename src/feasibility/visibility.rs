//! Visibility of the board, regardless of what may stand in the way.

use nalgebra::{Point3, Vector2, Vector3};

use super::rejection::Rejection;
use crate::camera::Camera;
use crate::spatial::Pose;
use crate::target::{Board, Corners, Marker, Target, told};

/// What a view must satisfy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibilityLimits {
    /// Least distance in px of every corner from the outermost pixel centres.
    pub margin: f64,
    /// Greatest angle in rad between the board's normal and the direction from the board to the camera.
    pub max_incidence: f64,
    /// Greatest angle in rad between the board's normal and the optical axis.
    pub max_tilt: f64,
    /// Least distance in m from the camera to the board's centre.
    pub min_distance: f64,
    /// Greatest distance in m from the camera to the board's centre.
    pub max_distance: f64,
    /// Least distance in px of neighbouring rows and columns of corners in the image: the height of the squares' parallelograms.
    pub min_corner_spacing: f64,
    /// Fewest corners that make a view, of a board that can be read in part; none where every corner must be seen.
    pub min_corners: Option<usize>,
    /// Least side in px of a marker that can be read.
    pub min_marker: f64,
}

/// Cosine of the angle between the optical axis and the board's inward normal.
pub(super) fn cos_tilt(X_CT: &Pose) -> f64 {
    -(X_CT.rotation * Vector3::z()).z
}

/// The corners whose images satisfy the limits, or the first reason that the board is not seen; `corners` and `markers` are all
/// of the board's, in T.
pub(super) fn visible_corners(
    camera: &Camera,
    target: &Target,
    limits: &VisibilityLimits,
    corners: &[Point3<f64>],
    markers: &[Marker],
    X_CT: &Pose,
) -> Result<Corners, Rejection> {
    let to_board = X_CT.translation.vector;
    let distance = to_board.norm();
    let cos_incidence = -(X_CT.rotation * Vector3::z()).dot(&to_board) / distance;
    // At the board's very centre the cosine is NaN.
    if cos_incidence.is_nan() || cos_incidence <= 0.0 {
        return Err(Rejection::BackSide);
    }
    if !(limits.min_distance..=limits.max_distance).contains(&distance) {
        return Err(Rejection::Distance);
    }
    if cos_incidence < limits.max_incidence.cos() {
        return Err(Rejection::Incidence);
    }
    if cos_tilt(X_CT) < limits.max_tilt.cos() {
        return Err(Rejection::Tilt);
    }
    let pixel = |corner: &Point3<f64>| {
        let pixel = camera.project(&(X_CT * corner)).ok_or(Rejection::BeyondLens)?;
        if camera.contains(&pixel, limits.margin) { Ok(pixel) } else { Err(Rejection::OutsideImage) }
    };
    let Some(least) = limits.min_corners else {
        let pixels = corners.iter().map(pixel).collect::<Result<Vec<_>, Rejection>>()?;
        if let Some(reason) = markers.iter().find_map(|marker| illegible(camera, limits, marker, X_CT)) {
            return Err(reason);
        }
        let crowded = is_crowded(&target.board, limits.min_corner_spacing, |i| pixels.get(i));
        return if crowded { Err(Rejection::CornerSpacing) } else { Ok(Corners::All) };
    };
    let mut pixels: Vec<Result<Vector2<f64>, Rejection>> = corners.iter().map(pixel).collect();
    for marker in markers {
        let Some(reason) = illegible(camera, limits, marker, X_CT) else { continue };
        for &corner in &marker.corners {
            pixels[corner] = Err(reason);
        }
    }
    let seen = enough(target, least, (0..pixels.len()).filter(|&i| pixels[i].is_ok()).collect());
    let Some(seen) = seen else {
        return Err(pixels.into_iter().find_map(Result::err).unwrap_or(Rejection::OutsideImage));
    };
    let at = |i: usize| pixels.get(i).and_then(|pixel| pixel.as_ref().ok());
    if is_crowded(&target.board, limits.min_corner_spacing, at) {
        return Err(Rejection::CornerSpacing);
    }
    Ok(seen)
}

/// Least distance in px of a marker's outline from the picture's border, for it to be read: OpenCV's `minDistanceToBorder`.
pub const MARKER_MARGIN: f64 = 3.0;

/// Why a marker cannot be read, however it is lit and whatever stands before it.
fn illegible(camera: &Camera, limits: &VisibilityLimits, marker: &Marker, X_CT: &Pose) -> Option<Rejection> {
    let pixels: Option<Vec<_>> = marker.outline.iter().map(|point| camera.project(&(X_CT * point))).collect();
    let Some(pixels) = pixels else { return Some(Rejection::BeyondLens) };
    if !pixels.iter().all(|pixel| camera.contains(pixel, MARKER_MARGIN)) {
        return Some(Rejection::OutsideImage);
    }
    let next = pixels.iter().cycle().skip(1);
    let is_small = limits.min_marker > 0.0 && pixels.iter().zip(next).any(|(a, b)| (a - b).norm() < limits.min_marker);
    is_small.then_some(Rejection::CornerSpacing)
}

/// The corners of a board with `count` that are told from each other in a picture that `camera` takes from `X_CT`, as far as
/// its `markers` are in it whole.
pub fn told_in_image(camera: &Camera, markers: &[Marker], count: usize, X_CT: &Pose) -> Vec<bool> {
    let is_in = |point: &Point3<f64>| {
        camera.project(&(X_CT * point)).is_some_and(|pixel| camera.contains(&pixel, MARKER_MARGIN))
    };
    told(markers, count, |marker| marker.outline.iter().all(is_in))
}

/// The corners, if they are `least` or more and fix a homography.
pub(super) fn enough(target: &Target, least: usize, corners: Vec<usize>) -> Option<Corners> {
    if corners.len() == target.board.corner_count() {
        return Some(Corners::All);
    }
    (corners.len() >= least && target.board.fix_homography(&corners)).then_some(Corners::Some(corners))
}

/// Whether the surroundings of a corner, of those that `at` has an image of, are lower in the image than `least` (px).
fn is_crowded<'p>(board: &Board, least: f64, at: impl Fn(usize) -> Option<&'p Vector2<f64>>) -> bool {
    least > 0.0
        && (0..board.corner_count()).any(|i| {
            let Some(corner) = at(i) else { return false };
            let [beside, above] = board.neighbours(i).map(|j| at(j).map(|neighbour| neighbour - corner));
            square_height(beside, above).is_some_and(|height| height < least)
        })
}

/// The least height in px of the parallelogram that two edges of a square are in the image: how near to the next row or column its
/// corners are. Of a single edge its length.
pub(super) fn square_height(a: Option<Vector2<f64>>, b: Option<Vector2<f64>>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => {
            let longer = a.norm().max(b.norm());
            Some(if longer > 0.0 { a.perp(&b).abs() / longer } else { 0.0 })
        }
        (edge, other) => edge.or(other).map(|edge| edge.norm()),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::camera::Lens;
    use crate::target::{AprilGrid, Charuco, Dictionary, Zone};

    const BOARD: Board = Board::checkerboard(4, 3, 0.03);

    /// No limits but those of geometry.
    const NONE: VisibilityLimits = VisibilityLimits {
        margin: 0.0,
        max_incidence: PI / 2.0,
        max_tilt: PI / 2.0,
        min_distance: 0.0,
        max_distance: 100.0,
        min_corner_spacing: 0.0,
        min_corners: None,
        min_marker: 0.0,
    };

    /// What a pinhole camera of 640 × 480 px with a focal length of 500 px sees.
    fn seen(limits: &VisibilityLimits, X_CT: &Pose) -> Result<Corners, Rejection> {
        seen_of(BOARD, limits, X_CT)
    }

    fn seen_of(board: Board, limits: &VisibilityLimits, X_CT: &Pose) -> Result<Corners, Rejection> {
        let camera = Camera::new(Lens::Pinhole, 640, 480, &[500.0, 500.0, 319.5, 239.5]).unwrap();
        let zone = Zone { width: 1.0, height: 1.0, edge_margin: 0.0 };
        let (corners, markers): (Vec<_>, _) = (board.corners().collect(), board.markers());
        let target = Target { board, X_BT: Pose::identity(), zone, warp: None, thickness: 5e-3 };
        visible_corners(&camera, &target, limits, &corners, &markers, X_CT)
    }

    /// The board's centre at `p` in C, its printed side towards −z but turned by `r`.
    fn board(p: [f64; 3], r: [f64; 3]) -> Pose {
        Pose::new(Vector3::from(p), Vector3::from(r)) * Pose::rotation(Vector3::x() * PI)
    }

    fn ahead(distance: f64) -> Pose {
        board([0.0, 0.0, distance], [0.0; 3])
    }

    #[test]
    fn distances_may_be_the_limits_and_no_more() {
        let limits = VisibilityLimits { min_distance: 0.5, max_distance: 0.8, ..NONE };
        for (distance, verdict) in [(0.5, true), (0.499_999, false), (0.8, true), (0.800_001, false)] {
            assert_eq!(seen(&limits, &ahead(distance)) == Ok(Corners::All), verdict, "{distance}");
        }
        // To the board's centre, not along the optical axis.
        assert_eq!(seen(&limits, &board([0.1, 0.0, 0.495], [0.0; 3])), Ok(Corners::All));
        assert_eq!(seen(&limits, &ahead(0.3)), Err(Rejection::Distance));
    }

    #[test]
    fn incidence_is_to_the_camera_and_tilt_to_its_axis() {
        let degrees = |angle: f64| angle.to_radians();
        let flat = VisibilityLimits { max_incidence: degrees(20.0), ..NONE };
        let tilted = VisibilityLimits { max_tilt: degrees(20.0), ..NONE };
        for (angle, verdict) in [(19.99, Ok(Corners::All)), (20.01, Err(()))] {
            let on = |limits, X_CT: &Pose, reason| {
                assert_eq!(seen(limits, X_CT), verdict.clone().map_err(|()| reason), "{angle}");
            };
            for sign in [-1.0, 1.0] {
                let angle = sign * degrees(angle);
                let aside = [0.8 * angle.sin(), 0.0, 0.8 * angle.cos()];
                // Parallel to the image, aside: the incidence alone grows. Turned towards the camera: the tilt alone.
                on(&flat, &board(aside, [0.0; 3]), Rejection::Incidence);
                assert_eq!(seen(&tilted, &board(aside, [0.0; 3])), Ok(Corners::All));
                on(&tilted, &board(aside, [0.0, angle, 0.0]), Rejection::Tilt);
                assert_eq!(seen(&flat, &board(aside, [0.0, angle, 0.0])), Ok(Corners::All));
                on(&flat, &board([0.0, 0.0, 0.8], [angle, 0.0, 0.0]), Rejection::Incidence);
                on(&tilted, &board([0.0, 0.0, 0.8], [0.0, angle, 0.0]), Rejection::Tilt);
            }
        }
        let turned = |angle: f64| seen(&NONE, &board([0.0, 0.0, 0.8], [degrees(angle), 0.0, 0.0]));
        assert_eq!((turned(89.99), turned(90.01)), (Ok(Corners::All), Err(Rejection::BackSide)));
        assert_eq!(turned(180.0), Err(Rejection::BackSide));
        assert_eq!(seen(&NONE, &ahead(0.0)), Err(Rejection::BackSide));
    }

    #[test]
    fn every_corner_keeps_the_margin_of_every_border() {
        let limits = VisibilityLimits { margin: 20.0, ..NONE };
        // At 0.5 m a pixel is 1 mm; the outermost corners are 45 and 30 mm from the centre, the borders 319.5 and 239.5 px.
        let (x, y) = (0.2995 - 0.045, 0.2195 - 0.03);
        for (x, y, moved) in
            [(x, 0.0, [1.0, 0.0]), (-x, 0.0, [-1.0, 0.0]), (0.0, y, [0.0, 1.0]), (0.0, -y, [0.0, -1.0])]
        {
            let at = |by: f64| seen(&limits, &board([x + by * moved[0], y + by * moved[1], 0.5], [0.0; 3]));
            assert_eq!((at(-1e-6), at(1e-6)), (Ok(Corners::All), Err(Rejection::OutsideImage)), "{moved:?}");
        }
        // The left columns are behind the camera.
        let beside = board([-0.01, 0.0, 0.01], [0.0, -1.4, 0.0]);
        assert_eq!(seen(&NONE, &beside), Err(Rejection::BeyondLens));
    }

    #[test]
    fn neighbours_are_apart_along_rows_and_along_columns() {
        // Fronto-parallel at 0.5 m all neighbours are 30 px apart.
        for (least, verdict) in [(29.999, true), (30.001, false)] {
            let limits = VisibilityLimits { min_corner_spacing: least, ..NONE };
            assert_eq!(seen(&limits, &ahead(0.5)) == Ok(Corners::All), verdict);
        }
        // Turned by 60° about x the columns' neighbours are about 15 px apart, the rows' 30; about y the other way round.
        let limits = VisibilityLimits { min_corner_spacing: 22.0, ..NONE };
        let part = VisibilityLimits { min_corners: Some(6), ..limits };
        for r in [[PI / 3.0, 0.0, 0.0], [0.0, PI / 3.0, 0.0]] {
            let X_CT = board([0.0, 0.0, 0.5], r);
            assert_eq!(seen(&NONE, &X_CT), Ok(Corners::All));
            assert_eq!(seen(&limits, &X_CT), Err(Rejection::CornerSpacing), "{r:?}");
            assert_eq!(seen(&part, &X_CT), Err(Rejection::CornerSpacing), "{r:?}");
        }
    }

    #[test]
    fn slanted_squares_are_as_high_as_their_rows_are_apart() {
        // Edges of 20 px that meet at 30°.
        let (along, slanted) = (Vector2::new(20.0, 0.0), Vector2::new(-20.0 * 0.75f64.sqrt(), 10.0));
        assert!((square_height(Some(along), Some(slanted)).unwrap() - 10.0).abs() < 1e-12);
        assert_eq!(square_height(None, Some(along)), Some(20.0));
        assert_eq!(square_height(Some(Vector2::zeros()), Some(Vector2::zeros())), Some(0.0));
    }

    #[test]
    fn boards_read_in_part_need_enough_corners_and_not_on_a_line() {
        let part = |least| VisibilityLimits { margin: 20.0, min_corners: Some(least), ..NONE };
        // One column of three beyond the right margin; x grows with the column, for the turn about x keeps it.
        let aside = board([0.2995 - 0.03, 0.0, 0.5], [0.0; 3]);
        let left: Vec<usize> = (0..12).filter(|i| i % 4 != 3).collect();
        assert_eq!(seen(&part(9), &aside), Ok(Corners::Some(left)));
        assert_eq!(seen(&part(10), &aside), Err(Rejection::OutsideImage));
        assert_eq!(seen(&part(12), &ahead(0.5)), Ok(Corners::All));
        // One column left: three corners on a line.
        let edge = board([0.2995 + 0.03, 0.0, 0.5], [0.0; 3]);
        assert_eq!(seen(&part(3), &edge), Err(Rejection::OutsideImage));
        // Corners that are not seen have no neighbours: those in sight are 30 px apart whatever the lens does to the others.
        let limits = VisibilityLimits { min_corner_spacing: 29.0, ..part(9) };
        assert_eq!(seen(&limits, &aside).map(|seen| seen.indices(12).len()), Ok(9));
    }

    /// At 0.5 m a pixel is 1 mm, and the right border is 319.5 mm from the optical axis.
    #[test]
    fn corners_count_where_their_markers_are_read() {
        let dictionary = Dictionary::named("DICT_4X4_50").unwrap();
        let charuco = Charuco::new([5, 4], 0.04, 0.03, dictionary, false).unwrap();
        let grid = AprilGrid::new([3, 2], 0.04, 0.25).unwrap();
        let part = VisibilityLimits { min_corners: Some(4), ..NONE };
        let corners = |of: Board, limits: &VisibilityLimits, x: f64| {
            let count = of.corner_count();
            seen_of(of, limits, &board([x, 0.0, 0.5], [0.0; 3])).map(|seen| seen.indices(count))
        };
        let columns = |kept: &dyn Fn(usize) -> bool, of: usize, count: usize| -> Vec<usize> {
            (0..count).filter(|i| kept(i % of)).collect()
        };
        // The last column of squares has markers that end 95 mm from the middle, the last but one such that end at 55 mm; they must be
        // 3 px inside, which are 3 mm.
        let of = |x: f64| corners(Board::Charuco(charuco), &part, x);
        assert_eq!(of(0.2214), Ok(columns(&|_| true, 4, 12)));
        assert_eq!(
            of(0.2216),
            Ok(columns(&|column| column < 3, 4, 12)),
            "the corners at 60 mm lost one of their markers"
        );
        assert_eq!(of(0.2614), Ok(columns(&|column| column < 3, 4, 12)));
        assert_eq!(
            of(0.2616),
            Ok(columns(&|column| column < 2, 4, 12)),
            "the corners at 20 mm are in sight all the same"
        );
        // Tags end at 70, 20 and −30 mm.
        let of = |x: f64| corners(Board::AprilGrid(grid), &part, x);
        assert_eq!(of(0.2464), Ok(columns(&|_| true, 6, 24)));
        assert_eq!(of(0.2466), Ok(columns(&|column| column < 4, 6, 24)));
        assert_eq!(of(0.2996), Ok(columns(&|column| column < 2, 6, 24)));
        assert_eq!(of(0.3496), Err(Rejection::OutsideImage));
        // Markers are 30 px wide, tags 40 px.
        let small = |min_marker| VisibilityLimits { min_marker, ..part };
        assert!(corners(Board::Charuco(charuco), &small(29.9), 0.0).is_ok());
        assert_eq!(corners(Board::Charuco(charuco), &small(30.1), 0.0), Err(Rejection::CornerSpacing));
        assert_eq!(corners(Board::AprilGrid(grid), &small(40.1), 0.0), Err(Rejection::CornerSpacing));
        // Where all are asked for, all markers must be read.
        let whole = VisibilityLimits { min_corners: None, ..part };
        assert!(corners(Board::Charuco(charuco), &whole, 0.2214).is_ok());
        assert_eq!(corners(Board::Charuco(charuco), &whole, 0.2216), Err(Rejection::OutsideImage));
    }
}
