//! Visibility of the whole board.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::camera::Camera;
use crate::robot::Robot;
use crate::spatial::Pose;
use crate::sweep::JointSpace;
use crate::target::{AxisCase, Target};

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
}

/// A configuration from which the camera sees every corner of the board.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The configuration's number in the joint space.
    pub id: usize,
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// Pose of the camera in the base frame.
    pub X_BC: Pose,
    /// Pose of the board in the camera frame.
    pub X_CT: Pose,
}

impl View {
    /// Angle in rad between the optical axis and the board's normal; 0 when they are parallel.
    pub fn tilt(&self) -> f64 {
        cos_tilt(&self.X_CT).clamp(-1.0, 1.0).acos()
    }

    /// Distance in m from the camera to the board's centre.
    pub fn distance(&self) -> f64 {
        self.X_CT.translation.vector.norm()
    }

    /// Where the optical axis meets the board's plane, in the base frame; `None` if it runs parallel or away from it.
    pub fn target_point(&self) -> Option<Point3<f64>> {
        let normal_C = self.X_CT.rotation * Vector3::z();
        let t = normal_C.dot(&self.X_CT.translation.vector) / normal_C.z;
        (t.is_finite() && t > 0.0).then(|| self.X_BC * Point3::new(0.0, 0.0, t))
    }

    /// Where the optical axis meets the target's plane.
    pub fn axis_case(&self, target: &Target) -> AxisCase {
        let point_T = self.target_point().map(|point| target.X_BT.inverse() * point);
        point_T.map_or(AxisCase::Outside, |point| target.zone.case(point.x, point.y))
    }
}

/// Why a candidate is not a view; the checks run in this order and the first that fails is the reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rejection {
    /// The camera is on the unprinted side of the board, or in its plane.
    BackSide,
    /// The board is nearer or farther than allowed.
    Distance,
    /// The board is seen at too flat an angle.
    Incidence,
    /// The board is tilted too far against the optical axis.
    Tilt,
    /// A corner is behind the camera or where the lens model is not one-to-one.
    BeyondLens,
    /// A corner is outside the image or in its margin.
    OutsideImage,
    /// Neighbouring corners are too close together in the image.
    CornerSpacing,
}

impl Rejection {
    /// Every reason, in the order of the checks.
    pub const ALL: [Rejection; 7] = [
        Rejection::BackSide,
        Rejection::Distance,
        Rejection::Incidence,
        Rejection::Tilt,
        Rejection::BeyondLens,
        Rejection::OutsideImage,
        Rejection::CornerSpacing,
    ];

    /// Name as written in plans.
    pub fn name(self) -> &'static str {
        match self {
            Rejection::BackSide => "back_side",
            Rejection::Distance => "distance",
            Rejection::Incidence => "incidence",
            Rejection::Tilt => "tilt",
            Rejection::BeyondLens => "beyond_lens",
            Rejection::OutsideImage => "outside_image",
            Rejection::CornerSpacing => "corner_spacing",
        }
    }
}

/// The candidates that are views, in ascending order, and how many were rejected for each reason of
/// [`Rejection::ALL`]. The result does not depend on the number of threads.
pub fn visible_views(
    robot: &Robot,
    camera: &Camera,
    target: &Target,
    limits: &VisibilityLimits,
    space: &JointSpace,
    candidates: &[usize],
) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let corners: Vec<Point3<f64>> = target.board.corners().collect();
    let test = |&id: &usize| view_from(robot, camera, target, limits, &corners, id, space.configuration(id));
    // Chunk by chunk, so that the rejected take no memory.
    let chunks: Vec<_> = candidates
        .par_chunks(1024)
        .map(|chunk| {
            let mut rejected = [0; Rejection::ALL.len()];
            let view = |verdict: Result<View, Rejection>| verdict.map_err(|reason| rejected[reason as usize] += 1).ok();
            let views: Vec<View> = chunk.iter().map(test).filter_map(view).collect();
            (views, rejected)
        })
        .collect();
    let mut rejected = [0; Rejection::ALL.len()];
    let mut views = Vec::new();
    for (some_views, some_rejected) in chunks {
        views.extend(some_views);
        for (sum, count) in rejected.iter_mut().zip(some_rejected) {
            *sum += count;
        }
    }
    (views, rejected)
}

/// The view from joint values `q` (rad or m), under the number `id`; `corners` are the board's.
///
/// # Errors
/// When it is not a view, with the first reason.
pub fn view_from(
    robot: &Robot,
    camera: &Camera,
    target: &Target,
    limits: &VisibilityLimits,
    corners: &[Point3<f64>],
    id: usize,
    q: Vec<f64>,
) -> Result<View, Rejection> {
    let X_BC = robot.camera_pose(&q);
    let X_CT = X_BC.inverse() * target.X_BT;
    match rejection(camera, target, limits, corners, &X_CT) {
        Some(reason) => Err(reason),
        None => Ok(View { id, q, X_BC, X_CT }),
    }
}

/// Cosine of the angle between the optical axis and the board's inward normal.
fn cos_tilt(X_CT: &Pose) -> f64 {
    -(X_CT.rotation * Vector3::z()).z
}

fn rejection(
    camera: &Camera,
    target: &Target,
    limits: &VisibilityLimits,
    corners: &[Point3<f64>],
    X_CT: &Pose,
) -> Option<Rejection> {
    let to_board = X_CT.translation.vector;
    let distance = to_board.norm();
    let cos_incidence = -(X_CT.rotation * Vector3::z()).dot(&to_board) / distance;
    // At the board's very centre the cosine is NaN.
    if cos_incidence.is_nan() || cos_incidence <= 0.0 {
        return Some(Rejection::BackSide);
    }
    if !(limits.min_distance..=limits.max_distance).contains(&distance) {
        return Some(Rejection::Distance);
    }
    if cos_incidence < limits.max_incidence.cos() {
        return Some(Rejection::Incidence);
    }
    if cos_tilt(X_CT) < limits.max_tilt.cos() {
        return Some(Rejection::Tilt);
    }
    let columns = target.board.columns;
    let mut pixels = Vec::with_capacity(corners.len());
    for corner in corners {
        let Some(pixel) = camera.project(&(X_CT * corner)) else {
            return Some(Rejection::BeyondLens);
        };
        if !camera.contains(&pixel, limits.margin) {
            return Some(Rejection::OutsideImage);
        }
        pixels.push(pixel);
    }
    let too_close = |i: usize, j: usize| (pixels[i] - pixels[j]).norm() < limits.min_corner_spacing;
    let crowded = (0..pixels.len())
        .any(|i| (i % columns != 0 && too_close(i, i - 1)) || (i >= columns && too_close(i, i - columns)));
    crowded.then_some(Rejection::CornerSpacing)
}
