//! The problem's constraints in terms of the survey's views.

use nalgebra::{DMatrix, Point3, Vector3};
use rayon::prelude::*;
use thiserror::Error;

use crate::feasibility::{View, told_in_image};
use crate::figures::grouped;
use crate::plan::survey::{Survey, spacings};
use crate::problem::{JointRegion, PoseConstraints, Problem};
use crate::robot::JointKind;
use crate::selection::packed::unpack;
use crate::selection::{Cap, Constraints, Separation};
use crate::spatial::Pose;
use crate::sweep::AxisRule;
use crate::target::{AxisCase, Corners};

/// Why the problem's constraints cannot be held.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ConstraintError {
    /// A pose that must be in the plan is no view.
    #[error("pose {id} is required, but it is not among the {} configurations that see the board", grouped(*views))]
    NotAView {
        /// The pose's id.
        id: usize,
        /// Number of views.
        views: usize,
    },
    /// A pose that must be in the plan is in a region without poses.
    #[error("pose {id} is required, but lies in region {region} of `constraints.keep_out`")]
    KeptOut {
        /// The pose's id.
        id: usize,
        /// The region, from 1.
        region: usize,
    },
    /// A view taken already does not see the board.
    #[error("from captured view {view} the nominal camera does not see enough of the board")]
    CapturedUnseen {
        /// The view, from 1.
        view: usize,
    },
}

/// The constraints on the views of a survey.
///
/// # Errors
/// When a required pose is no view or in a region without poses.
pub(crate) fn constraints(problem: &Problem, survey: &Survey) -> Result<Constraints, ConstraintError> {
    let PoseConstraints {
        required,
        forbidden,
        captured: _,
        keep_out,
        groups,
        joint_separation,
        view_separation,
        picture_separation: _, // by the problem
    } = &problem.constraints;
    let views = &survey.views;
    let mut indices = Vec::with_capacity(required.len());
    for &id in required {
        let i = survey.index_of(id).ok_or(ConstraintError::NotAView { id, views: views.len() })?;
        if let Some(region) = keep_out.iter().position(|region| region.contains(&views[i].q)) {
            return Err(ConstraintError::KeptOut { id, region: region + 1 });
        }
        indices.push(i);
    }
    let within =
        |region: &JointRegion| -> Vec<usize> { (0..views.len()).filter(|&i| region.contains(&views[i].q)).collect() };
    // A forbidden pose that is no view is out anyway.
    let forbidden =
        forbidden.iter().filter_map(|&id| survey.index_of(id)).chain(keep_out.iter().flat_map(within)).collect();
    let caps = groups.iter().map(|group| Cap { members: within(&group.region), most: group.most }).collect();
    let mut separations = Vec::new();
    if *joint_separation > 0.0 {
        separations.push(separation(views, |view| angles(problem, view), *joint_separation));
    }
    if *view_separation > 0.0 {
        separations.push(separation(views, direction, chord(*view_separation)));
    }
    let least = problem.picture_separation();
    if least > 0.0 {
        separations.push(separation(views, |view| picture(problem, view), least));
    }
    Ok(Constraints { required: indices, forbidden, caps, separations })
}

/// The place of that of the pictures among the separations in force, which are in the order joint, view, picture.
pub(super) fn place_of_pictures(problem: &Problem) -> Option<usize> {
    let PoseConstraints { joint_separation, view_separation, .. } = &problem.constraints;
    let before = [*joint_separation, *view_separation].iter().filter(|&&least| least > 0.0).count();
    (problem.picture_separation() > 0.0).then_some(before)
}

/// Of the views' points.
fn separation<P: AsRef<[f64]>>(views: &[View], point: impl Fn(&View) -> P + Sync, least: f64) -> Separation {
    let dimension = views.first().map_or(0, |view| point(view).as_ref().len());
    let mut points = vec![0.0; dimension * views.len()];
    if dimension > 0 {
        let rows = points.par_chunks_exact_mut(dimension).zip(views).with_min_len(256);
        rows.for_each(|(row, view)| row.copy_from_slice(point(view).as_ref()));
    }
    Separation { points: points.into(), dimension, least }
}

/// Whether a view that was not swept may stand beside `others`: by the axis test, the regions and the separations.
pub(crate) fn allows(problem: &Problem, others: &[&View], view: &View) -> bool {
    let constraints = &problem.constraints;
    let within = |region: &JointRegion| others.iter().filter(|other| region.contains(&other.q)).count();
    let apart = |point: &dyn Fn(&View) -> Vec<f64>, least: f64| {
        let own = point(view);
        let distance = |other: &View| own.iter().zip(point(other)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        least == 0.0 || others.iter().all(|other| distance(other) >= least)
    };
    (problem.axis == AxisRule::Any || view.axis_case(&problem.target) != AxisCase::Outside)
        && !constraints.keep_out.iter().any(|region| region.contains(&view.q))
        && !is_at_forbidden(problem, view)
        && constraints.groups.iter().all(|g| !g.region.contains(&view.q) || within(&g.region) < g.most)
        && apart(&|view| angles(problem, view), constraints.joint_separation)
        && apart(&direction, chord(constraints.view_separation))
        && apart(&|view| picture(problem, view).to_vec(), constraints.polished_picture_separation())
}

/// Whether a view is within half a spacing of a swept configuration that is forbidden.
fn is_at_forbidden(problem: &Problem, view: &View) -> bool {
    let swept = problem.constraints.forbidden.iter().filter(|&&id| id < problem.space.len());
    let near = |id: &usize| {
        let forbidden = problem.space.configuration(*id);
        let apart = view.q.iter().zip(&forbidden).zip(spacings(problem));
        apart.map(|((a, b), spacing)| (a - b).abs() / spacing).fold(0.0, f64::max) < 0.5
    };
    swept.into_iter().any(near)
}

fn picture(problem: &Problem, view: &View) -> [f64; 12] {
    view.picture(&problem.camera, &problem.target.board)
}

/// Values of the revolute joints.
fn angles(problem: &Problem, view: &View) -> Vec<f64> {
    let joints = view.q.iter().zip(&problem.robot.chain.joints);
    joints.filter(|(_, joint)| joint.kind == JointKind::Revolute).map(|(&q, _)| q).collect()
}

/// Unit vector from the board's centre to the camera, in the board's frame.
fn direction(view: &View) -> Vec<f64> {
    let toward: Vector3<f64> = view.X_CT.inverse().translation.vector.normalize();
    toward.iter().copied().collect()
}

/// Distance of two unit vectors at an angle.
fn chord(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin()
}

/// A view taken already, of the corners that its configuration sees.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Captured {
    pub(crate) X_CT: Pose,
    pub(crate) seen: Corners,
}

/// What is known before the first pose is chosen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    /// The views taken already.
    pub(crate) captured: Vec<Captured>,
    /// The information on what is estimated, of these views and of the standard deviations stated.
    pub(crate) information: DMatrix<f64>,
}

impl Known {
    /// In the set-up as stated.
    ///
    /// # Errors
    /// When a view taken does not see enough of the board.
    pub(crate) fn as_stated(problem: &Problem) -> Result<Self, ConstraintError> {
        let views = problem.constraints.captured.iter().enumerate();
        let unseen = |view| ConstraintError::CapturedUnseen { view: view + 1 };
        let captured: Result<Vec<_>, _> =
            views.map(|(view, q)| Captured::new(problem, q).ok_or_else(|| unseen(view))).collect();
        Ok(Self::new(problem, problem, captured?))
    }

    /// The same in a set-up that may be, in which a view taken may not see the board; it says nothing then.
    pub(crate) fn as_drawn(problem: &Problem, drawn: &Problem) -> Self {
        let views = problem.constraints.captured.iter().filter_map(|q| Captured::new(drawn, q)).collect();
        Self::new(problem, drawn, views)
    }

    fn new(problem: &Problem, set_up: &Problem, captured: Vec<Captured>) -> Self {
        let measurement = set_up.measurement_of_one_picture();
        let mut information = stated(problem);
        let p = information.nrows();
        for Captured { X_CT, seen } in &captured {
            if let Some(told) = measurement.information(X_CT, seen) {
                information += unpack(&told, p);
            }
        }
        Self { captured, information }
    }
}

impl Captured {
    /// What is seen at joint values `q`; `None` if that is not enough of the board.
    fn new(problem: &Problem, q: &[f64]) -> Option<Self> {
        let Problem { robot, camera, target, visibility, .. } = problem;
        let X_CT = robot.camera_pose(q).inverse() * target.X_BT;
        let corners: Vec<_> = target.board.corners().collect();
        let is_told = told_in_image(camera, &target.board.markers(), corners.len(), &X_CT);
        let in_image =
            |corner: &Point3<f64>| camera.project(&(X_CT * corner)).is_some_and(|pixel| camera.contains(&pixel, 0.0));
        let printed_side = (X_CT.rotation * Vector3::z()).dot(&X_CT.translation.vector) < 0.0;
        let seen: Vec<usize> = (0..corners.len()).filter(|&i| is_told[i] && in_image(&corners[i])).collect();
        let enough = printed_side && seen.len() >= visibility.min_corners.unwrap_or(corners.len());
        let enough = enough && target.board.fix_homography(&seen);
        let seen = if seen.len() == corners.len() { Corners::All } else { Corners::Some(seen) };
        enough.then_some(Self { X_CT, seen })
    }
}

/// The information of the standard deviations stated, on what is estimated: the board's heights, whose unit theirs is, and the
/// intrinsics.
pub(crate) fn stated(problem: &Problem) -> DMatrix<f64> {
    let (nuisance, p) = (problem.measurement().nuisance(), problem.estimated.len());
    let mut known = DMatrix::identity(nuisance + p, nuisance + p);
    known.view_mut((nuisance, nuisance), (p, p)).copy_from(&stated_of_intrinsics(problem));
    known
}

/// The part of it that is on the p intrinsics, p×p.
pub(crate) fn stated_of_intrinsics(problem: &Problem) -> DMatrix<f64> {
    let p = problem.estimated.len();
    let mut known = DMatrix::zeros(p, p);
    for &(j, sigma) in &problem.prior_sigma {
        known[(j, j)] += sigma.powi(-2);
    }
    known
}
