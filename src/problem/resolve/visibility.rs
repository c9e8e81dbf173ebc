//! What makes a view.

use std::f64::consts::PI;

use super::check::{Check, NOT_NEGATIVE};
use crate::calibration::FEWEST_CORNERS;
use crate::feasibility::VisibilityLimits;
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, key};

/// Angles between the board and the camera in degrees.
const ACUTE: Allowed = Allowed::positive(90.0);

impl Check<'_, '_> {
    pub(super) fn visibility(
        &mut self,
        visibility: &At<schema::Visibility>,
        target: &schema::Target,
    ) -> VisibilityLimits {
        let corners = u64::from(target.columns) * u64::from(target.rows);
        let fewest = Allowed::between(FEWEST_CORNERS as f64, corners as f64);
        let min_corners = key!(visibility, min_corners).given().map(|least| self.count(&least, fewest));
        let min_distance = self.length(&key!(visibility, min_distance_mm), NOT_NEGATIVE);
        let farther = Allowed::between(visibility.value.min_distance_mm.max(0.0), 1e6);
        VisibilityLimits {
            margin: self.number(&key!(visibility, margin_px), NOT_NEGATIVE),
            max_incidence: self.angle(&key!(visibility, max_incidence_deg), ACUTE).min(PI / 2.0),
            max_tilt: self.angle(&key!(visibility, max_tilt_deg), ACUTE).min(PI / 2.0),
            min_distance,
            max_distance: self.length(&key!(visibility, max_distance_mm), farther),
            min_corner_spacing: self.number(&key!(visibility, min_corner_spacing_px), NOT_NEGATIVE),
            min_corners: min_corners.filter(|&least| (least as u64) < corners),
        }
    }
}
