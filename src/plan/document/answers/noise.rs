//! How far corners scatter, as `calipose noise --json` tells.

use schemars::JsonSchema;
use serde::Serialize;

use crate::calibration::{FittedNoise, Scatter};
use crate::information::NoiseModel;
use crate::plan::document::header::{Document, Header};

/// Corners that move together by more than chance explains by this factor were moved.
const MOVED: f64 = 2.0;

/// The scatter of corners over repeated pictures.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct NoiseDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Scenes, one a file.
    pub scenes: usize,
    /// Pictures of all scenes.
    pub pictures: usize,
    /// Corners of a scene that were seen in two pictures at least.
    pub corners: usize,
    /// The models, that which fits best first.
    pub models: Vec<MeasuredNoise>,
    /// Root mean square of the pictures' common shift.
    pub common_shift_px: f64,
    /// What that would be if the corners scattered each for itself.
    pub expected_shift_px: f64,
    /// Whether the scene moved, by these two.
    pub moved: bool,
}

/// A model of the noise as measured.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredNoise {
    /// Its name, as in `noise.model`.
    pub model: String,
    /// Standard deviation, as `noise.sigma_px`.
    pub sigma_px: f64,
    /// Half the side of the window, as `noise.window_px`; `null` for constant noise.
    pub window_px: Option<f64>,
    /// Standard deviation of the corners' own sigma about the model's, as a share of it, beyond what chance explains.
    pub misfit: f64,
}

impl Document for NoiseDocument {
    const FORMAT: &'static str = "calipose.noise";
    const VERSION: u32 = 1;
}

impl NoiseDocument {
    /// The `scatter` over so many scenes and pictures.
    pub fn new(scatter: &Scatter, scenes: usize, pictures: usize) -> Self {
        let model = |FittedNoise { noise, misfit, .. }: &FittedNoise| MeasuredNoise {
            model: noise.model.name().name().into(),
            sigma_px: noise.sigma,
            window_px: match noise.model {
                NoiseModel::Constant => None,
                NoiseModel::Edges { window, .. } => Some(window),
            },
            misfit: *misfit,
        };
        let mut fitted = [&scatter.constant, &scatter.edges];
        fitted.sort_by(|a, b| b.log_likelihood.total_cmp(&a.log_likelihood));
        Self {
            header: Self::header(),
            scenes,
            pictures,
            corners: scatter.corners,
            models: fitted.map(model).into(),
            common_shift_px: scatter.common_shift,
            expected_shift_px: scatter.expected_shift,
            moved: scatter.common_shift > MOVED * scatter.expected_shift,
        }
    }
}
