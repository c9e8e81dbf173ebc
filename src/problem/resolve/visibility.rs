//! What makes a view.

use std::f64::consts::PI;

use super::check::{Check, NOT_NEGATIVE};
use crate::calibration::FEWEST_CORNERS;
use crate::feasibility::VisibilityLimits;
use crate::information::NoiseModel;
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, key};
use crate::target::Board;

/// Angles between the board and the camera in degrees.
const ACUTE: Allowed = Allowed::positive(90.0);

/// Corners of a board at most: a thousand by a thousand.
const MOST_CORNERS: usize = 1_000_000;

/// Pixels that a module of a marker takes to be read.
const PX_PER_MODULE: f64 = 3.0;
/// Least distance of a corner from the picture's border in px, and beyond the detector's window where that is known.
const MARGIN: f64 = 5.0;
const BESIDE_WINDOW: f64 = 3.0;

/// Least height of squares in px, and as a multiple of half the side of the detector's window where that is known: OpenCV's `cornerSubPix`
/// goes astray below 1.4 of it on rendered pictures.
const SPACING: f64 = 5.0;
const WINDOWS: f64 = 1.5;
/// Least distance in px of a marker's pattern beyond half the side of the detector's window: OpenCV's `CharucoDetector` takes
/// smaller windows where it is nearer.
const BESIDE_MARKER: f64 = 2.0;

impl Check<'_, '_> {
    pub(super) fn visibility(
        &mut self,
        visibility: &At<schema::Visibility>,
        board: Option<&Board>,
        noise: NoiseModel,
    ) -> VisibilityLimits {
        // Nearer to the border the detector's window is cut off, and in lower squares it reaches into the next ones, or into
        // the markers.
        let beside_markers = |window: f64| {
            let clear = board.and_then(Board::clear);
            clear.map_or(0.0, |clear| (window + BESIDE_MARKER) / clear)
        };
        let (margin, spacing) = match noise {
            NoiseModel::Constant => (MARGIN, SPACING),
            NoiseModel::Edges { window, .. } => {
                (window + BESIDE_WINDOW, (WINDOWS * window + 0.5).max(beside_markers(window)))
            }
        };
        // Of a board that is none as many as any has.
        let corners = board.map_or(MOST_CORNERS, Board::corner_count);
        let fewest = Allowed::between(FEWEST_CORNERS as f64, corners as f64);
        let min_corners = match key!(visibility, min_corners).given() {
            Some(least) => Some(self.count(&least, fewest)),
            None => board.and_then(Board::fewest),
        };
        let legible = PX_PER_MODULE * board.map_or(0, Board::modules) as f64;
        let min_marker = key!(visibility, min_marker_px).given();
        if let Some(least) = min_marker.as_ref().filter(|_| board.is_some_and(|board| board.modules() == 0)) {
            let instead = "only `charuco` and `aprilgrid` boards have markers";
            self.not_applicable(&least.path, "a board without markers", instead);
        }
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
            min_corners: min_corners.filter(|&least| least < corners),
            min_marker: min_marker.map_or(legible, |least| self.number(&least, NOT_NEGATIVE)),
        }
    }
}
