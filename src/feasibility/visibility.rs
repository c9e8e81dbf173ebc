//! Visibility of the board, regardless of what may stand in the way.

use nalgebra::{Point3, Vector2, Vector3};

use super::views::Rejection;
use crate::camera::Camera;
use crate::spatial::Pose;
use crate::target::{Corners, Target};

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
    /// Least distance in px of neighbouring corners in the image.
    pub min_corner_spacing: f64,
    /// Fewest corners that make a view, of a board that can be read in part; none where every corner must be seen.
    pub min_corners: Option<usize>,
}

/// Cosine of the angle between the optical axis and the board's inward normal.
pub(super) fn cos_tilt(X_CT: &Pose) -> f64 {
    -(X_CT.rotation * Vector3::z()).z
}

/// The corners whose images satisfy the limits, or the first reason that the board is not seen; `corners` are all of the
/// board's, in T.
pub(super) fn visible_corners(
    camera: &Camera,
    target: &Target,
    limits: &VisibilityLimits,
    corners: &[Point3<f64>],
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
        let crowded = is_crowded(target.board.columns, pixels.len(), limits.min_corner_spacing, |i| Some(&pixels[i]));
        return if crowded { Err(Rejection::CornerSpacing) } else { Ok(Corners::All) };
    };
    let pixels: Vec<Result<Vector2<f64>, Rejection>> = corners.iter().map(pixel).collect();
    let seen = enough(target, least, (0..pixels.len()).filter(|&i| pixels[i].is_ok()).collect());
    let Some(seen) = seen else {
        return Err(pixels.into_iter().find_map(Result::err).unwrap_or(Rejection::OutsideImage));
    };
    let at = |i: usize| pixels[i].as_ref().ok();
    if is_crowded(target.board.columns, pixels.len(), limits.min_corner_spacing, at) {
        return Err(Rejection::CornerSpacing);
    }
    Ok(seen)
}

/// The corners, if they are `least` or more and fix a homography.
pub(super) fn enough(target: &Target, least: usize, corners: Vec<usize>) -> Option<Corners> {
    if corners.len() == target.board.corner_count() {
        return Some(Corners::All);
    }
    (corners.len() >= least && target.board.fix_homography(&corners)).then_some(Corners::Some(corners))
}

/// Whether two neighbours of a board with so many columns, of those of its `count` corners that `at` has an image of, are
/// nearer in the image than `least` (px).
fn is_crowded<'p>(columns: usize, count: usize, least: f64, at: impl Fn(usize) -> Option<&'p Vector2<f64>>) -> bool {
    let too_close = |i: usize, j: usize| match (at(i), at(j)) {
        (Some(a), Some(b)) => (a - b).norm() < least,
        _ => false,
    };
    (0..count).any(|i| (i % columns != 0 && too_close(i, i - 1)) || (i >= columns && too_close(i, i - columns)))
}
