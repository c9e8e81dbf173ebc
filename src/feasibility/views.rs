//! From candidates to views: all tests, in turn.

use std::ops::Range;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::collision::Collision;
use super::occlusion::Occlusion;
use super::rejection::Rejection;
use super::stability::Stability;
use super::visibility::{VisibilityLimits, cos_tilt, enough, visible_corners};
use crate::camera::Camera;
use crate::robot::Robot;
use crate::spatial::Pose;
use crate::sweep::{Candidates, JointSpace};
use crate::target::{AxisCase, Board, Corners, Marker, Target, told};

/// A configuration that the robot can take and from which the camera sees the board.
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
    /// The corners that the camera sees.
    pub seen: Corners,
    /// Tip-over margin in m, where stability is tested: the distance of the projected centre of mass from the nearest edge
    /// of the support polygon.
    pub stability_margin: Option<f64>,
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

    /// The board in the picture: the directions of its four outer corners, each times half the focal length, 12 numbers in px. Of two
    /// views they are as far apart as the corners' images, in the root mean square over the corners, as long as that is little.
    pub fn picture(&self, camera: &Camera, board: &Board) -> [f64; 12] {
        picture(&self.X_CT, camera, board)
    }

    /// Where the optical axis meets the target's plane.
    pub fn axis_case(&self, target: &Target) -> AxisCase {
        let point_T = self.target_point().map(|point| target.X_BT.inverse() * point);
        point_T.map_or(AxisCase::Outside, |point| target.zone.case(point.x, point.y))
    }

    /// Where the optical axis meets the board's plane, in the base frame; `None` if it runs parallel or away from it.
    pub fn target_point(&self) -> Option<Point3<f64>> {
        let normal_C = self.X_CT.rotation * Vector3::z();
        let t = normal_C.dot(&self.X_CT.translation.vector) / normal_C.z;
        (t.is_finite() && t > 0.0).then(|| self.X_BC * Point3::new(0.0, 0.0, t))
    }
}

/// The [picture](View::picture) of a board at `X_CT`.
pub(crate) fn picture(X_CT: &Pose, camera: &Camera, board: &Board) -> [f64; 12] {
    let directions = outer_corners(board).map(|corner| (X_CT * corner).coords.normalize() * half_focal(camera));
    std::array::from_fn(|i| directions[i / 3][i % 3])
}

/// Those of the printed area, in T.
pub(crate) fn outer_corners(board: &Board) -> [Point3<f64>; 4] {
    let (width, height) = board.printed_size();
    let corner = |(x, y)| Point3::new(0.5 * x * width, 0.5 * y * height, 0.0);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner)
}

/// Half the mean focal length, px: directions times this are as far apart, all four together, as their images in the root mean square.
pub(crate) fn half_focal(camera: &Camera) -> f64 {
    0.25 * (camera.intrinsics()[0] + camera.intrinsics()[1])
}

/// The tests that make a candidate a view, prepared for one robot, camera and board.
#[derive(Debug, Clone, PartialEq)]
pub struct Checks<'a> {
    robot: &'a Robot,
    camera: &'a Camera,
    target: &'a Target,
    visibility: &'a VisibilityLimits,
    stability: Option<&'a Stability>,
    collision: Collision,
    occlusion: Occlusion,
    /// In T.
    corners: Vec<Point3<f64>>,
    markers: Vec<Marker>,
}

impl<'a> Checks<'a> {
    /// Prepares the tests; `clearance` (m) is the least distance between links.
    pub fn new(
        robot: &'a Robot,
        camera: &'a Camera,
        target: &'a Target,
        visibility: &'a VisibilityLimits,
        clearance: f64,
        stability: Option<&'a Stability>,
    ) -> Self {
        Self {
            robot,
            camera,
            target,
            visibility,
            stability,
            collision: Collision::new(robot, clearance),
            occlusion: Occlusion::new(&robot.tree, robot.camera_link),
            corners: target.board.corners().collect(),
            markers: target.board.markers(),
        }
    }

    /// The same tests of a robot, camera and board that are elsewhere or otherwise than those they were prepared for, but of the same
    /// bodies and points.
    pub(crate) fn of_moved<'b>(&self, robot: &'b Robot, camera: &'b Camera, target: &'b Target) -> Checks<'b>
    where
        'a: 'b,
    {
        Checks { robot, camera, target, ..self.clone() }
    }

    /// Whether there are bodies, that may collide or hide corners.
    pub fn has_bodies(&self) -> bool {
        !self.occlusion.is_empty()
    }

    /// The test for collision.
    pub fn collision(&self) -> &Collision {
        &self.collision
    }

    /// The view from joint values `q`, which are configuration `id`, or the first reason that there is none.
    ///
    /// # Errors
    /// The reason.
    pub fn view(&self, id: usize, q: &[f64]) -> Result<View, Rejection> {
        let joints = self.robot.chain.joints.iter();
        if joints.zip(q).any(|(joint, &q)| !joint.keeps_margin(q)) {
            return Err(Rejection::JointLimit);
        }
        let X_BC = self.robot.camera_pose(q);
        let X_CT = X_BC.inverse() * self.target.X_BT;
        let mut seen = visible_corners(self.camera, self.target, self.visibility, &self.corners, &self.markers, &X_CT)?;
        let mut stability_margin = None;
        if self.stability.is_some() || self.has_bodies() {
            // In the root's frame, which stands on the ground; B is the frame of the link that carries the board.
            let X_RL = self.robot.tree.link_poses(q);
            stability_margin = self.stable(&X_RL)?;
            if let Some(pair) = self.collision.first(&X_RL) {
                let with_obstacle = pair.iter().any(|link| self.robot.obstacles.contains(link));
                return Err(if with_obstacle { Rejection::SceneCollision } else { Rejection::SelfCollision });
            }
            let X_BL = if self.robot.board_link == 0 { X_RL } else { self.robot.link_poses(q) };
            seen = self.unhidden(&X_BL, &X_BC, seen)?;
        }
        Ok(View { id, q: q.to_vec(), X_BC, X_CT, seen, stability_margin })
    }

    /// The tip-over margin, where it is tested and wide enough.
    fn stable(&self, X_RL: &[Pose]) -> Result<Option<f64>, Rejection> {
        let Some(stability) = self.stability else { return Ok(None) };
        let margin = stability.margin_at(&self.robot.tree, X_RL);
        // Without masses nothing can be said, and nothing is promised.
        if margin.is_some_and(|margin| margin >= stability.margin) { Ok(margin) } else { Err(Rejection::Unstable) }
    }

    /// Those of the corners that no link or obstacle hides, if they are enough.
    fn unhidden(&self, X_BL: &[Pose], X_BC: &Pose, seen: Corners) -> Result<Corners, Rejection> {
        let indices = seen.indices(self.corners.len());
        let mut points: Vec<Point3<f64>> = indices.iter().map(|&i| self.corners[i]).collect();
        points.extend(self.markers.iter().flat_map(|marker| marker.outline.iter().chain(&marker.inside)));
        let mut hidden = self.occlusion.hidden(X_BL, X_BC, &self.target.X_BT, &points);
        let mut markers = hidden.split_off(indices.len()).into_iter();
        let is_told = told(&self.markers, self.corners.len(), |marker| {
            !markers.by_ref().take(marker.outline.len() + marker.inside.len()).fold(false, |any, hidden| any | hidden)
        });
        let left: Vec<usize> =
            indices.iter().zip(hidden).filter(|&(&i, hidden)| !hidden && is_told[i]).map(|(&i, _)| i).collect();
        if left.len() == indices.len() {
            return Ok(seen);
        }
        let least = self.visibility.min_corners.ok_or(Rejection::Occluded)?;
        enough(self.target, least, left).ok_or(Rejection::Occluded)
    }
}

/// Candidates that are tested in a row, at most.
const ROW: usize = 256;

/// Rows that are handed out together, and how many of these parts are tested before their views are put to the others: the views
/// of all parts are never kept twice.
const ROWS: usize = 8;
const PARTS: usize = 256;

/// The candidates that are views, in ascending order, and how many were rejected for each reason of
/// [`Rejection::ALL`]. The result does not depend on the number of threads.
pub fn feasible_views(
    checks: &Checks,
    space: &JointSpace,
    candidates: &Candidates,
) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let mut views = Vec::new();
    let mut rejected = [0; Rejection::ALL.len()];
    let mut rows = candidates.pieces(ROW);
    loop {
        let batch: Vec<Range<usize>> = rows.by_ref().take(ROWS * PARTS).collect();
        if batch.is_empty() {
            break;
        }
        let parts: Vec<_> = batch.par_chunks(ROWS).map(|rows| views_of(checks, space, rows)).collect();
        for (some_views, some_rejected) in parts {
            views.extend(some_views);
            for (sum, count) in rejected.iter_mut().zip(some_rejected) {
                *sum += count;
            }
        }
    }
    views.shrink_to_fit();
    (views, rejected)
}

fn views_of(checks: &Checks, space: &JointSpace, rows: &[Range<usize>]) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let mut views = Vec::new();
    let mut rejected = [0; Rejection::ALL.len()];
    for row in rows {
        space.visit(row.clone(), |id, q| match checks.view(id, q) {
            Ok(view) => views.push(view),
            Err(reason) => rejected[reason as usize] += 1,
        });
    }
    (views, rejected)
}
