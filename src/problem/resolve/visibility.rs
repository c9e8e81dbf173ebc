//! What makes a view.

use std::f64::consts::PI;

use super::check::{Check, NOT_NEGATIVE};
use crate::calibration::FEWEST_CORNERS;
use crate::feasibility::VisibilityLimits;
use crate::information::NoiseModel;
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, key};

/// Angles between the board and the camera in degrees.
const ACUTE: Allowed = Allowed::positive(90.0);

/// Least distance of a corner from the picture's border in px, and beyond the detector's window where that is known.
const MARGIN: f64 = 5.0;
const BESIDE_WINDOW: f64 = 3.0;

/// Least height of squares in px, and as a multiple of half the side of the detector's window where that is known: OpenCV's `cornerSubPix`
/// goes astray below 1.4 of it on rendered pictures.
const SPACING: f64 = 5.0;
const WINDOWS: f64 = 1.5;

impl Check<'_, '_> {
    pub(super) fn visibility(
        &mut self,
        visibility: &At<schema::Visibility>,
        target: &schema::Target,
        noise: NoiseModel,
    ) -> VisibilityLimits {
        // Nearer to the border the detector's window is cut off, and in lower squares it reaches into the next ones.
        let (margin, spacing) = match noise {
            NoiseModel::Constant => (MARGIN, SPACING),
            NoiseModel::Edges { window } => (window + BESIDE_WINDOW, WINDOWS * window + 0.5),
        };
        let corners = u64::from(target.columns) * u64::from(target.rows);
        let fewest = Allowed::between(FEWEST_CORNERS as f64, corners as f64);
        let min_corners = key!(visibility, min_corners).given().map(|least| self.count(&least, fewest));
        let min_distance = self.length(&key!(visibility, min_distance_mm), NOT_NEGATIVE);
        let farther = Allowed::between(visibility.value.min_distance_mm.max(0.0), 1e6);
        VisibilityLimits {
            margin: key!(visibility, margin_px).given().map_or(margin, |given| self.number(&given, NOT_NEGATIVE)),
            max_incidence: self.angle(&key!(visibility, max_incidence_deg), ACUTE).min(PI / 2.0),
            max_tilt: self.angle(&key!(visibility, max_tilt_deg), ACUTE).min(PI / 2.0),
            min_distance,
            max_distance: self.length(&key!(visibility, max_distance_mm), farther),
            min_corner_spacing: key!(visibility, min_corner_spacing_px)
                .given()
                .map_or(spacing, |given| self.number(&given, NOT_NEGATIVE)),
            min_corners: min_corners.filter(|&least| (least as u64) < corners),
        }
    }
}
