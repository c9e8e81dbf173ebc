//! Poses of a list as views, or why they are none.

use rayon::prelude::*;

use super::why::why;
use crate::calibration::pose_of_view;
use crate::feasibility::{Checks, Rejection, View};
use crate::figures::short;
use crate::formats::{Detections, ListedPose, PoseList, StatedPlace};
use crate::plan::assess::reach::reach_starts;
use crate::plan::survey::up_to_limits;
use crate::problem::Problem;
use crate::robot::{Limits, ReachSettings, Starts, reach};
use crate::spatial::Pose;
use crate::target::Corners;

/// Joint values this much beyond a range, rad or m, are rounded ones within it.
const ROUNDING: f64 = 1e-6;

/// How near joint values must bring the flange to where a list has it, m and rad: robots report where they are no better.
const NEAR: f64 = 1e-3;

/// Starts from which joint values near a picture's pose are looked for.
const STARTS: usize = 16;

/// Poses to be scored.
#[derive(Debug, Clone, PartialEq)]
pub struct PosesToScore {
    /// The poses, as they are listed.
    pub poses: Vec<PoseToScore>,
    /// Whether pictures were taken there already, of which the joint values are not known.
    pub are_taken: bool,
}

/// A pose to be scored.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseToScore {
    /// What the list calls it.
    pub name: String,
    /// Joint values, rad or m; none where only the picture or where the flange is to be is known.
    pub q: Option<Vec<f64>>,
    /// The view, or why there is none.
    pub view: Result<View, Unusable>,
}

/// Why a pose cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unusable {
    /// A name, as in documents.
    pub reason: &'static str,
    /// The same in words, with what was measured.
    pub why: String,
}

impl PosesToScore {
    /// The poses of a list, by the tests that swept configurations must pass; joints may go up to their limits.
    pub fn listed(problem: &Problem, list: &PoseList) -> Self {
        let problem = &up_to_limits(problem);
        let checks = problem.checks();
        let starts = list.poses.iter().any(|pose| matches!(pose.place, StatedPlace::Flange(_)));
        let starts = starts.then(|| reach_starts(problem));
        let pose = |listed: &ListedPose| {
            let (q, view) = match (&listed.place, &starts) {
                (StatedPlace::Joints(q), _) => (Some(q.clone()), of_joints(problem, &checks, q)),
                (StatedPlace::Flange(X_BF), Some(starts)) => of_flange(problem, &checks, starts, X_BF),
                (StatedPlace::Flange(_), None) => (None, Err(unreached(None))),
            };
            PoseToScore { name: listed.name.clone(), q, view }
        };
        Self { poses: list.poses.par_iter().map(pose).collect(), are_taken: false }
    }

    /// The pictures of detections, each located by its corners with the problem's nominal camera. Whatever they see counts; that the robot
    /// could be there they show themselves.
    pub fn detected(problem: &Problem, detections: &Detections) -> Self {
        let starts = reach_starts(problem);
        let pose = |(i, name): (usize, &String)| {
            let view = of_corners(problem, detections, i, &starts);
            PoseToScore { name: name.clone(), q: None, view }
        };
        Self { poses: detections.names.par_iter().enumerate().map(pose).collect(), are_taken: true }
    }
}

fn of_joints(problem: &Problem, checks: &Checks, q: &[f64]) -> Result<View, Unusable> {
    let mut q = q.to_vec();
    problem.robot.take_turns(&mut q);
    for (q, joint) in q.iter_mut().zip(&problem.robot.chain.joints) {
        let Limits { min, max } = joint.limits;
        let within = q.max(min).min(max);
        if (*q - within).abs() <= ROUNDING {
            *q = within;
        }
    }
    let rejected = |reason: Rejection| Unusable { reason: reason.name(), why: why(problem, checks, reason, &q) };
    // Configurations that are swept are within the limits, which the checks take for granted.
    if problem.robot.chain.joints.iter().zip(&q).any(|(joint, &q)| !joint.limits.holds(q)) {
        return Err(rejected(Rejection::JointLimit));
    }
    checks.view(0, &q).map_err(rejected)
}

/// The joint values that bring the flange to `X_BF`, those first that are farthest from limits, and the view from there.
fn of_flange(
    problem: &Problem,
    checks: &Checks,
    starts: &Starts,
    X_BF: &Pose,
) -> (Option<Vec<f64>>, Result<View, Unusable>) {
    let settings = ReachSettings { position_tolerance: NEAR, angle_tolerance: NEAR, ..ReachSettings::default() };
    let found = reach(&problem.robot, &(X_BF * problem.robot.X_FC), starts, &settings);
    if let Some(nearest) = found.first().filter(|nearest| !nearest.reached) {
        return (None, Err(unreached(Some((nearest.position_error, nearest.angle_error)))));
    }
    let mut first = None;
    for configuration in found {
        match of_joints(problem, checks, &configuration.q) {
            Ok(view) => return (Some(view.q.clone()), Ok(view)),
            Err(unusable) => first = first.or(Some((configuration.q, unusable))),
        }
    }
    match first {
        Some((q, unusable)) => (Some(q), Err(unusable)),
        None => (None, Err(unreached(None))),
    }
}

/// No joint values take the pose; the nearest are so many m and rad off.
fn unreached(nearest: Option<(f64, f64)>) -> Unusable {
    let off = nearest.map_or_else(String::new, |(position, angle)| {
        format!("; the nearest are {} mm and {}° off", short(1e3 * position), short(angle.to_degrees()))
    });
    Unusable { reason: "unreached", why: format!("no joint values within the limits bring the flange there{off}") }
}

fn of_corners(problem: &Problem, detections: &Detections, i: usize, starts: &Starts) -> Result<View, Unusable> {
    let undetermined =
        || Unusable { reason: "pose_undetermined", why: "its corners do not tell where the board is".into() };
    let X_CT = pose_of_view(&detections.observations, i, &problem.camera).ok_or_else(undetermined)?;
    let mut indices: Vec<usize> = detections.observations.views()[i].iter().map(|corner| corner.index).collect();
    indices.sort_unstable();
    let all = indices.len() == problem.target.board.corner_count();
    let seen = if all { Corners::All } else { Corners::Some(indices) };
    problem.measurement().information(&X_CT, &seen).ok_or_else(undetermined)?;
    let X_BC = problem.target.X_BT * X_CT.inverse();
    // The camera is not exactly where the corners say, so no joint values take it there exactly: the nearest keep others apart from it.
    let settings = ReachSettings { starts: STARTS, most_starts: STARTS, ..ReachSettings::default() };
    let nearest = reach(&problem.robot, &X_BC, starts, &settings).into_iter().next();
    let q = nearest.map_or_else(|| vec![0.0; problem.robot.chain.dof()], |nearest| nearest.q);
    Ok(View { id: 0, q, X_BC, X_CT, seen, stability_margin: None })
}
