//! How far detected corners scatter.

use super::check::{Check, SIZE};
use crate::camera::Camera;
use crate::information::{Blur, Noise, NoiseModel, NoiseName};
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, Optional, key};

/// Standard deviations of a corner in px: from that of no detector to the size of a picture.
const SIGMA: Allowed = Allowed::between(1e-6, 1e3);

/// Half the side of the detector's window in px.
const WINDOW: Allowed = Allowed::between(1.0, 1e3);

/// Diameters of a lens's aperture in mm: a metre is a telescope's.
const APERTURE: Allowed = Allowed::positive(1e3);

/// Exposures in ms: a minute.
const EXPOSURE: Allowed = Allowed::positive(6e4);

/// Speeds of a camera in °/s and mm/s.
const SPEED: Allowed = Allowed::between(0.0, 1e5);

impl Check<'_, '_> {
    /// `camera` is none where something is wrong with it.
    pub(super) fn noise(&mut self, noise: &At<schema::Noise>, camera: Option<&Camera>) -> Noise {
        let sigma = self.number(&key!(noise, sigma_px), SIGMA);
        let window = key!(noise, window_px);
        let model = match noise.value.model.0 {
            NoiseName::Constant => {
                let of_edges: [&dyn Optional; 6] = [
                    &window,
                    &key!(noise, focus_mm),
                    &key!(noise, aperture_mm),
                    &key!(noise, exposure_ms),
                    &key!(noise, turning_deg_s),
                    &key!(noise, moving_mm_s),
                ];
                self.refused(&of_edges, "constant noise", "leave it out, or `noise.model`, which is \"edges\" then");
                NoiseModel::Constant
            }
            NoiseName::Edges => NoiseModel::Edges {
                window: window.given().map_or(NoiseModel::USUAL_WINDOW, |window| self.number(&window, WINDOW)),
                blur: self.blur(noise, camera),
            },
        };
        Noise { sigma, model }
    }

    fn blur(&mut self, noise: &At<schema::Noise>, camera: Option<&Camera>) -> Blur {
        let mut blur = camera.map_or(Blur::NONE, |camera| Blur::NONE.through(camera));
        let (focus, aperture) = (key!(noise, focus_mm), key!(noise, aperture_mm));
        if focus.is_given() || aperture.is_given() {
            if let Some(focus) = self.required(focus, &[]) {
                blur.focus = self.length(&focus, SIZE).recip();
            }
            if let Some(aperture) = self.required(aperture, &[]) {
                blur.aperture = self.length(&aperture, APERTURE);
            }
        }
        let exposure = key!(noise, exposure_ms);
        let (turning, moving) = (key!(noise, turning_deg_s), key!(noise, moving_mm_s));
        let is_moved = turning.is_given() || moving.is_given();
        if !(exposure.is_given() || is_moved) {
            return blur;
        }
        let Some(exposure) = self.required(exposure, &[]) else { return blur };
        if !is_moved {
            let instead = "give `turning_deg_s`, `moving_mm_s` or both, or leave it out";
            self.not_applicable(&exposure.path, "a camera at rest", instead);
        }
        let seconds = self.number(&exposure, EXPOSURE) / 1e3;
        blur.turning = seconds * turning.given().map_or(0.0, |turning| self.angle(&turning, SPEED));
        blur.moving = seconds * moving.given().map_or(0.0, |moving| self.length(&moving, SPEED));
        blur
    }
}
