//! What of a review is in space: all that the view of a page draws.

use serde::Serialize;

use super::{Review, ReviewedPose, Scene, Timeline};
use crate::plan::document::plan::Pose;

/// What is in space of a review, by the names that it has there.
#[derive(Debug, Serialize)]
pub(crate) struct Space<'a> {
    #[serde(flatten)]
    scene: &'a Scene,
    views: Views<'a>,
    poses: Vec<Place<'a>>,
    timeline: Option<&'a Timeline>,
}

#[derive(Debug, Serialize)]
struct Views<'a> {
    ids: &'a [usize],
    positions_m: &'a [f64],
    tilt_deg: &'a [f64],
}

#[derive(Debug, Serialize)]
struct Place<'a> {
    id: usize,
    label: &'a str,
    joints: &'a [f64],
    camera: &'a Pose,
    tilt_deg: f64,
    distance_m: f64,
}

impl<'a> Space<'a> {
    pub(crate) fn new(Review { scene, views, poses, timeline, .. }: &'a Review) -> Self {
        let views = Views { ids: &views.ids, positions_m: &views.positions_m, tilt_deg: &views.tilt_deg };
        Self { scene, views, poses: poses.iter().map(Place::new).collect(), timeline: timeline.as_ref() }
    }

    /// On one line.
    pub(crate) fn to_line(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

impl<'a> Place<'a> {
    fn new(ReviewedPose { id, label, joints, camera, tilt_deg, distance_m, .. }: &'a ReviewedPose) -> Self {
        Self { id: *id, label, joints, camera, tilt_deg: *tilt_deg, distance_m: *distance_m }
    }
}
