//! What can be looked at of a plan.

mod curve;
mod silhouettes;
mod timeline;

use std::iter::zip;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::compare::median_choice;
use crate::feasibility::{Collision, View};
use crate::plan::choose::{Choice, Chooser, PlanError};
use crate::plan::document::{
    Document, ErrorGrid, NearestLinks, OtherChoice, Picture, Plan, PlannedPose, ProblemReference, Review, ReviewedPose,
    Scene, Silhouette, SurveyedViews, finite, image_share,
};
use crate::plan::survey::Survey;
use crate::problem::{Method, Problem};
use crate::spatial::Pose;
use silhouettes::silhouettes;
use timeline::timeline;

/// Views that are listed at most.
const MOST_VIEWS: usize = 20_000;

/// Seeds of a clustering that is set beside a plan; the one with the median map error is taken.
pub const KMEANS_RUNS: usize = 5;

/// Reviews `plan`, whose poses are the views `selected` of the chooser's survey.
///
/// # Errors
/// When poses cannot be chosen otherwise for comparison.
pub fn review(plan: &Plan, chooser: &Chooser, selected: &[usize]) -> Result<Review, PlanError> {
    let (problem, survey) = (chooser.problem(), chooser.survey());
    let chosen = chooser.assess(selected.to_vec());
    let (other, _) = median_choice(chooser, Method::KMeansJoints, plan.count, plan.seed, KMEANS_RUNS)?;
    let covariance = |choice: &Choice| chooser.covariance(&chooser.information(&choice.selected));
    let known = covariance(&chosen);
    let map = |known: &DMatrix<f64>| ErrorGrid::new(&problem.unknowns(), known);
    let scene = Scene::new(problem);
    let collision = Collision::new(&problem.robot, problem.clearance);
    Ok(Review {
        header: Review::header(),
        problem: ProblemReference::new(problem),
        views: surveyed(problem, survey, &[selected, &other.selected].concat()),
        poses: zip(plan.in_order(), 1..)
            .filter_map(|(pose, number)| {
                let (_, &i) = zip(&plan.poses, selected).find(|(other, _)| other.id == pose.id)?;
                let view = &survey.views[i];
                let X_BL = problem.robot.link_poses(&view.q);
                let bodies = silhouettes(&scene, &problem.camera, view, &X_BL);
                let nearest = nearest(&scene, &collision, &X_BL);
                Some(reviewed_pose(pose, number, problem, view, bodies, nearest, &scene.board.pattern_m))
            })
            .collect(),
        timeline: timeline(plan, problem, &collision),
        others: vec![OtherChoice {
            method: Method::KMeansJoints.name().into(),
            ids: other.selected.iter().map(|&i| survey.views[i].id).collect(),
            map_error_px: finite(other.map_error),
            error_map: covariance(&other).as_ref().map(map),
        }],
        curve: curve::curve(plan, chooser)?,
        correlation: known.as_ref().map(correlation).unwrap_or_default(),
        error_map: known.as_ref().map(map),
        error_map_before: chooser.covariance(&chooser.information(&[])).as_ref().map(map),
        scene,
    })
}

/// The tested links that come nearest to each other, with the links at `X_BL`.
fn nearest(scene: &Scene, collision: &Collision, X_BL: &[Pose]) -> Option<NearestLinks> {
    let (pair, distance) = collision.gaps(X_BL).into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(NearestLinks { links: pair.map(|link| scene.links[link].name.clone()), distance_m: distance.max(0.0) })
}

fn reviewed_pose(
    pose: &PlannedPose,
    number: usize,
    problem: &Problem,
    view: &View,
    bodies: Vec<Silhouette>,
    nearest: Option<NearestLinks>,
    pattern: &[Vec<[f64; 2]>],
) -> ReviewedPose {
    let Problem { camera, target, visibility, .. } = problem;
    ReviewedPose {
        id: pose.id,
        label: number.to_string(),
        joints: pose.joints_rad.clone(),
        joints_display: pose.joints_deg.clone(),
        camera: pose.camera_in_base,
        tilt_deg: pose.tilt_deg,
        distance_m: pose.distance_m,
        share: pose.share,
        nearest,
        picture: Picture::new(camera, &target.board, pattern, visibility.margin, view, bodies),
    }
}

/// The views of the survey, those of `chosen` among them however many there are.
fn surveyed(problem: &Problem, survey: &Survey, chosen: &[usize]) -> SurveyedViews {
    let all = survey.views.len();
    let listed: Vec<&View> = thinned(all, MOST_VIEWS, chosen).into_iter().map(|i| &survey.views[i]).collect();
    let eighths = |angle: f64| (angle.to_degrees() * 8.0).round() / 8.0;
    // A tenth of a millimetre, a hundredth of a percent.
    let fine = |x: f64| (x * 1e4).round() / 1e4;
    let azimuth = |view: &View| {
        let camera = view.X_CT.inverse().translation.vector;
        eighths(camera.y.atan2(camera.x))
    };
    let share = |view: &&View| fine(image_share(&problem.camera, &problem.target.board, view));
    SurveyedViews {
        all,
        ids: listed.iter().map(|view| view.id).collect(),
        positions_m: listed.iter().flat_map(|view| <[f64; 3]>::from(view.X_BC.translation.vector).map(fine)).collect(),
        tilt_deg: listed.iter().map(|view| eighths(view.tilt())).collect(),
        azimuth_deg: listed.iter().map(|view| azimuth(view)).collect(),
        distance_m: listed.iter().map(|view| fine(view.distance())).collect(),
        image_share: listed.par_iter().map(share).collect(),
    }
}

/// Of the numbers below `all` those of `chosen`, and evenly spaced ones, at most `most`; ascending.
fn thinned(all: usize, most: usize, chosen: &[usize]) -> Vec<usize> {
    let mut listed: Vec<usize> = (0..all).step_by(all.div_ceil(most).max(1)).chain(chosen.iter().copied()).collect();
    listed.sort_unstable();
    listed.dedup();
    listed
}

fn correlation(covariance: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let sigma: Vec<f64> = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
    let row = |i: usize| sigma.iter().enumerate().map(|(j, σ)| covariance[(i, j)] / (sigma[i] * σ)).collect();
    (0..sigma.len()).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::thinned;

    #[test]
    fn what_was_chosen_is_among_the_views_listed_however_many_there_are() {
        assert_eq!(thinned(5, 10, &[3]), [0, 1, 2, 3, 4]);
        assert_eq!(thinned(100, 4, &[50, 31, 99]), [0, 25, 31, 50, 75, 99]);
    }
}
