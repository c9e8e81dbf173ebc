//! How far detected corners scatter.

use super::check::Check;
use crate::information::{Noise, NoiseModel, NoiseName};
use crate::problem::fault::Allowed;
use crate::problem::schema;
use crate::problem::text::{At, key};

/// Standard deviations of a corner in px: from that of no detector to the size of a picture.
const SIGMA: Allowed = Allowed::between(1e-6, 1e3);

/// Half the side of the detector's window in px.
const WINDOW: Allowed = Allowed::between(1.0, 1e3);

impl Check<'_, '_> {
    pub(super) fn noise(&mut self, noise: &At<schema::Noise>) -> Noise {
        let sigma = self.number(&key!(noise, sigma_px), SIGMA);
        let window = key!(noise, window_px);
        let model = match noise.value.model.0 {
            NoiseName::Constant => {
                self.refused(&[&window], "constant noise", "leave it out, or `noise.model`, which is \"edges\" then");
                NoiseModel::Constant
            }
            NoiseName::Edges => NoiseModel::Edges {
                window: window.given().map_or(NoiseModel::USUAL_WINDOW, |window| self.number(&window, WINDOW)),
            },
        };
        Noise { sigma, model }
    }
}
