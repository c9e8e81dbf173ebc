//! Fields of a plan that are made anew and compared.

use nalgebra::DMatrix;

use super::compare::{alike, near, number, numbers, other, same};
use super::error::CertifyError;
use super::evidence::Accuracies;
use crate::plan::document::{
    Intrinsics, PlannedPose, Pose, ScenarioDocument, SeenView, SurveyCounts, UnweightedAccuracy,
};
use crate::problem::{Goal, Method, Problem};

/// Numbers of a pose agree to this: m, degrees, entries of a quaternion.
const SAME_POSE: f64 = 1e-9;

/// Numbers drawn agree to this share.
const SAME_DRAW: f64 = 1e-12;

/// A tilt near zero is known to no more than this, in degrees: its cosine is 1 there.
const SAME_TILT: f64 = 1e-6;

/// Checks that the method is the one asked for, and that what it leaves in a plan is there.
pub(crate) fn is_by_that_method(method: &str, searched: bool, fewest: bool, goal: &Goal) -> Result<(), CertifyError> {
    let asked = goal.method();
    if method != asked.name() {
        return Err(other("the method", method, asked.name()));
    }
    same("whether the number of poses has a proof", &fewest, &goal.proves_fewest())?;
    same("whether a search followed", &searched, &(asked == Method::Exact))
}

pub(crate) fn are_those_counts(stated: &SurveyCounts, found: &SurveyCounts) -> Result<(), CertifyError> {
    let SurveyCounts { swept, axis_inside, axis_edge, refined, views, off_grid, rejected } = stated;
    same("the number of configurations swept", swept, &found.swept)?;
    same("the number of axes inside the zone", axis_inside, &found.axis_inside)?;
    same("the number of axes on the zone's edge", axis_edge, &found.axis_edge)?;
    same("the number of configurations tried around picked poses", refined, &found.refined)?;
    same("the number of views", views, &found.views)?;
    same("the number of views off the grid", off_grid, &found.off_grid)?;
    alike("the count of rejected candidates", rejected, &found.rejected)
}

/// What the plan says of a pose, held against what its view says.
pub(crate) fn is_that_pose(stated: &PlannedPose, found: &PlannedPose) -> Result<(), CertifyError> {
    let PlannedPose {
        id,
        joints_rad,
        joints_deg,
        camera_in_base: Pose { position_m, quaternion_xyzw },
        target_point_m,
        tilt_deg,
        distance_m,
        share: _, // of the set, not of the view
        stability_margin_m,
        corners_seen,
    } = stated;
    let of_pose = |what: &str| format!("{what} of pose {id}");
    let close = |what: &str, stated: &[f64], found: &[f64]| {
        numbers(&of_pose(what), stated, found, |what, stated, found| near(what, stated, found, SAME_POSE))
    };
    same("the id of a pose", id, &found.id)?;
    close("joint value in rad", joints_rad, &found.joints_rad)?;
    close("joint value in degrees", joints_deg, &found.joints_deg)?;
    close("coordinate of the camera", position_m, &found.camera_in_base.position_m)?;
    // A quaternion without real part may have either sign.
    let turned = found.camera_in_base.quaternion_xyzw;
    let opposite = turned[3] < SAME_POSE && turned.iter().zip(quaternion_xyzw).map(|(a, b)| a * b).sum::<f64>() < 0.0;
    close("part of the camera's quaternion", quaternion_xyzw, &turned.map(|q| if opposite { -q } else { q }))?;
    let point = |point: &Option<[f64; 3]>| point.iter().flatten().copied().collect::<Vec<_>>();
    close("coordinate of the target point", &point(target_point_m), &point(&found.target_point_m))?;
    near(&of_pose("the tilt"), *tilt_deg, found.tilt_deg, SAME_TILT)?;
    near(&of_pose("the distance"), *distance_m, found.distance_m, SAME_POSE)?;
    let margin = |margin: &Option<f64>| margin.iter().copied().collect::<Vec<_>>();
    close("tip-over margin", &margin(stability_margin_m), &margin(&found.stability_margin_m))?;
    alike(&of_pose("the corners seen"), corners_seen, &found.corners_seen)
}

/// What the plan says of its poses in a scenario.
pub(crate) fn are_those_in_scenario(stated: &ScenarioDocument, found: &ScenarioDocument) -> Result<(), CertifyError> {
    // The map error is of the poses together.
    let ScenarioDocument { intrinsics, map_error_px: _, views } = stated;
    // Draws may differ in the last digit from one machine's mathematics to another's.
    let close = |what: &str, stated, found| number(what, stated, found, SAME_DRAW);
    numbers("intrinsic of a scenario", intrinsics, &found.intrinsics, close)?;
    same("the number of views of a scenario", &views.len(), &found.views.len())?;
    for (stated, found) in views.iter().zip(&found.views) {
        let close = |what: &str, stated, found| near(what, stated, found, SAME_POSE);
        let numbers_of = |view: &Option<SeenView>| -> Vec<f64> {
            let pose = view.as_ref().map(|view| &view.camera_in_base);
            pose.iter().flat_map(|pose| pose.position_m.into_iter().chain(pose.quaternion_xyzw)).collect()
        };
        numbers("coordinate of the camera in a scenario", &numbers_of(stated), &numbers_of(found), close)?;
        let corners = |view: &Option<SeenView>| view.as_ref().map(|view| view.corners_seen.clone());
        alike("the corners seen in a scenario", &corners(stated), &corners(found))?;
    }
    Ok(())
}

/// The intrinsics, their nominal values and their predicted standard deviations.
pub(crate) fn are_those_intrinsics(
    stated: &Intrinsics,
    problem: &Problem,
    found: &Accuracies,
    tolerance: f64,
) -> Result<(), CertifyError> {
    let Intrinsics { names, nominal, sigma } = stated;
    let unknowns = problem.unknowns();
    same("the list of intrinsics", &names.join(", "), &unknowns.names().join(", "))?;
    numbers("nominal value", nominal, &unknowns.values(), |what, stated, found| same(what, &stated, &found))?;
    numbers("predicted sigma", sigma, &found.sigma, |what, stated, found| number(what, stated, found, tolerance))
}

/// What a calibration that weighs nothing makes of the poses.
pub(crate) fn are_those_unweighted(
    stated: Option<&UnweightedAccuracy>,
    problem: &Problem,
    covariance: Option<DMatrix<f64>>,
    tolerance: f64,
) -> Result<(), CertifyError> {
    let (UnweightedAccuracy { sigma, map_error_px }, covariance) = match (stated, covariance) {
        (Some(stated), Some(covariance)) => (stated, covariance),
        (None, None) => return Ok(()),
        (Some(_), None) => return Err(other("the accuracy without weights", "stated", "the same as with")),
        (None, Some(_)) => return Err(other("the accuracy without weights", "not stated", "another than with")),
    };
    let map_error = (problem.unknowns().map_error_weight() * &covariance).trace().sqrt();
    let deviations: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
    let close = |what: &str, stated: f64, found: f64| number(what, stated, found, tolerance);
    numbers("predicted sigma without weights", sigma, &deviations, close)?;
    close("the map error without weights", *map_error_px, map_error)
}
