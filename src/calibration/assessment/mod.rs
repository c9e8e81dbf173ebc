//! What a calibration is worth: its errors over the image, what was wished for, the verdict, and what the views lack.

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

/// An accuracy wished for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wish {
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

/// An accuracy wished for, and what is reached.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyReached {
    /// What is to be accurate: `map error [px]`, `sigma of fx`.
    pub what: String,
    /// What is wished for.
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
    /// What was wished for and what is reached.
    pub wished: Vec<AccuracyReached>,
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
        wishes: &[Wish],
    ) -> Self {
        let Calibration { camera, poses, .. } = calibration;
        let W = calibration.unknowns().map_error_weight();
        let map_errors = MapErrors::new(calibration, &W);
        let reached = |wish: &Wish| match *wish {
            Wish::MapError(limit) => AccuracyReached { what: "map error [px]".into(), limit, reached: map_errors.rms },
            Wish::Sigma { intrinsic, sigma } => {
                let name = camera.lens().parameter_names().get(intrinsic).copied().unwrap_or_default();
                let reached = calibration.sigma_of(intrinsic);
                AccuracyReached { what: format!("sigma of {name}"), limit: sigma, reached }
            }
        };
        let wished: Vec<AccuracyReached> = wishes.iter().map(reached).collect();
        let judgement = Judgement::new(calibration, observations.corner_count(), other, map_errors.rms, &wished);
        let lacks = Lacks::new(observations, calibration, &W, map_errors.rms, goal(wishes));
        let verdict = judgement.sentence(calibration, loss, map_errors.rms, &lacks);
        let residuals = ResidualStatistics::new(&residuals(observations, camera, poses).concat());
        Self { map_errors, residuals, wished, judgement, lacks, verdict }
    }
}

/// The map error to reach: the one wished for, or a good one where nothing is.
fn goal(wishes: &[Wish]) -> Option<f64> {
    match wishes {
        [] => Some(GOOD_MAP_ERROR),
        _ => wishes.iter().find_map(|wish| match wish {
            Wish::MapError(limit) => Some(*limit),
            Wish::Sigma { .. } => None,
        }),
    }
}
