//! What a calibration is worth: its errors over the image, what was requested, the verdict, and what the views lack.

mod errors;
mod judgement;
mod lacks;
mod other_lens;

pub use errors::{MapErrors, ResidualStatistics};
pub use judgement::Judgement;
pub use lacks::{Lacks, MoreViews, TiltLack, WeakCombination};
pub use other_lens::{OtherLens, other_lens, unknown_camera};

use super::{Calibration, LossKind, Observations, residuals};
use judgement::GOOD_MAP_ERROR;

/// An accuracy requested.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// A map error, px.
    MapError(f64),
    /// The standard deviation of an intrinsic.
    Sigma {
        /// Its index into [`Camera::intrinsics`](crate::camera::Camera::intrinsics).
        intrinsic: usize,
        /// The standard deviation, in the intrinsic's unit.
        sigma: f64,
    },
}

/// An accuracy requested, and what is reached.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyReached {
    /// What is to be accurate: `map error [px]`, `sigma of fx`.
    pub what: String,
    /// What is requested.
    pub limit: f64,
    /// What is reached.
    pub reached: f64,
}

/// What there is to say of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Assessment {
    /// Predicted map errors.
    pub map_errors: MapErrors,
    /// The residuals.
    pub residuals: ResidualStatistics,
    /// What was requested and what is reached.
    pub requested: Vec<AccuracyReached>,
    /// What it is worth.
    pub judgement: Judgement,
    /// What the views lack.
    pub lacks: Lacks,
    /// The judgement in a sentence or two, and what the views lack where that matters.
    pub verdict: String,
}

impl Assessment {
    /// Assesses the `calibration` of `observations` by `loss`, beside the `other` lens that fits best.
    pub fn new(
        observations: &Observations,
        calibration: &Calibration,
        loss: LossKind,
        other: Option<OtherLens>,
        requests: &[Request],
    ) -> Self {
        let Calibration { camera, poses, .. } = calibration;
        let W = calibration.unknowns().map_error_weight();
        let map_errors = MapErrors::new(calibration, &W);
        let reached = |request: &Request| match *request {
            Request::MapError(limit) => {
                AccuracyReached { what: "map error [px]".into(), limit, reached: map_errors.rms }
            }
            Request::Sigma { intrinsic, sigma } => {
                let name = camera.lens().parameter_names().get(intrinsic).copied().unwrap_or_default();
                let reached = calibration.sigma_of(intrinsic);
                AccuracyReached { what: format!("sigma of {name}"), limit: sigma, reached }
            }
        };
        let requested: Vec<AccuracyReached> = requests.iter().map(reached).collect();
        let judgement = Judgement::new(calibration, observations.corner_count(), other, map_errors.rms, &requested);
        let lacks = Lacks::new(observations, calibration, &W, map_errors.rms, goal(requests));
        let verdict = judgement.sentence(calibration, loss, map_errors.rms, &lacks);
        let residuals = ResidualStatistics::new(&residuals(observations, camera, poses, &calibration.surface).concat());
        Self { map_errors, residuals, requested, judgement, lacks, verdict }
    }
}

/// The map error to reach: the one requested, or a good one where nothing is.
fn goal(requests: &[Request]) -> Option<f64> {
    match requests {
        [] => Some(GOOD_MAP_ERROR),
        _ => requests.iter().find_map(|request| match request {
            Request::MapError(limit) => Some(*limit),
            Request::Sigma { .. } => None,
        }),
    }
}
