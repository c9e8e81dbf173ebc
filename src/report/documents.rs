//! The documents that the report of a plan is made of, and whether they agree.

use thiserror::Error;

use crate::plan::document::{ErrorGrid, Explanation, Plan, Review, Scene, SurveyedViews, Timeline, Verification};

/// The documents that the report of a plan is made of.
#[derive(Debug, Clone, Copy)]
pub struct PlanDocuments<'a> {
    pub(super) plan: &'a Plan,
    pub(super) review: &'a Review,
    pub(super) explanation: &'a Explanation,
    pub(super) verification: Option<&'a Verification>,
}

/// What in the documents of a plan does not agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Disagreement {
    /// Lists that should be of one length, or rows of a matrix.
    #[error("the lists under `{0}` are not of the lengths that they should have")]
    Lengths(&'static str),
    /// A link, joint or solid that names what is not there.
    #[error("under `{0}`, one names what is not there")]
    Names(&'static str),
    /// The review is of other poses than the plan's.
    #[error("the review is of other poses than the plan's")]
    Poses,
}

impl<'a> PlanDocuments<'a> {
    /// The plan, what can be looked at of it, why it is as it is, and its simulated calibrations, if there were any.
    ///
    /// # Errors
    /// When they do not agree with each other or within themselves.
    pub fn new(
        plan: &'a Plan,
        review: &'a Review,
        explanation: &'a Explanation,
        verification: Option<&'a Verification>,
    ) -> Result<Self, Disagreement> {
        let lengths = |key, agree: bool| if agree { Ok(()) } else { Err(Disagreement::Lengths(key)) };
        let known = &plan.intrinsics;
        let p = known.names.len();
        let joints = review.scene.joints.len();
        let correlation = &review.correlation;
        let own = review.error_map.iter().chain(&review.error_map_before);
        let mut maps = own.chain(review.others.iter().filter_map(|other| other.error_map.as_ref()));
        lengths("intrinsics", known.nominal.len() == p && known.sigma.len() == p)?;
        lengths("views", of_one_length(&review.views))?;
        let joint_values = |values: &[f64]| values.len() == joints;
        lengths(
            "poses",
            review.poses.iter().all(|pose| joint_values(&pose.joints) && joint_values(&pose.joints_display)),
        )?;
        lengths("timeline", review.timeline.as_ref().is_none_or(|timeline| timeline.is_regular(joints)))?;
        let square = correlation.len() == p && correlation.iter().all(|row| row.len() == p);
        lengths("correlation", correlation.is_empty() || square)?;
        lengths("error_map", maps.all(ErrorGrid::is_regular))?;
        if let Some(key) = dangling(&review.scene) {
            return Err(Disagreement::Names(key));
        }
        let ids: Vec<usize> = plan.in_order().iter().map(|pose| pose.id).collect();
        let has_others = |timeline: &Timeline| !timeline.pictures.iter().map(|picture| &picture.id).eq(&ids);
        if !review.poses.iter().map(|pose| &pose.id).eq(&ids) || review.timeline.as_ref().is_some_and(has_others) {
            return Err(Disagreement::Poses);
        }
        Ok(Self { plan, review, explanation, verification })
    }
}

fn of_one_length(views: &SurveyedViews) -> bool {
    let SurveyedViews { all: _, ids, positions_m, tilt_deg, azimuth_deg, distance_m, image_share } = views;
    let lists = [tilt_deg, azimuth_deg, distance_m, image_share];
    positions_m.len() == 3 * ids.len() && lists.iter().all(|list| list.len() == ids.len())
}

/// Where a number of a link or joint is not one of those that there are.
fn dangling(scene: &Scene) -> Option<&'static str> {
    let Scene { joints, links, solids, base_link, camera_link, .. } = scene;
    let is_link = |link: usize| link < links.len();
    let after_parent = |i: usize| links[i].parent.is_none_or(|parent| parent < i);
    let driven = |i: usize| links[i].motion.as_ref().is_none_or(|motion| motion.joint < joints.len());
    [
        ("links", (0..links.len()).all(|i| after_parent(i) && driven(i))),
        ("base_link", is_link(*base_link)),
        ("camera_link", is_link(*camera_link)),
        ("solids", solids.iter().all(|solid| is_link(solid.link))),
    ]
    .into_iter()
    .find_map(|(key, holds)| (!holds).then_some(key))
}
