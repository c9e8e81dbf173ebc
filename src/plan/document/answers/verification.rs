//! Simulated calibrations of a plan, held against its prediction: `verification.json`.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header, ProblemReference, finite};
use crate::plan::document::plan::Plan;
use crate::verification::{Judgement, MonteCarlo, Weighing};

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.99;

/// Failed trials that are listed; more are only counted.
const LISTED_FAILURES: usize = 1000;

/// What simulated calibrations of a plan came to, beside what the plan predicts. Numbers that are infinite or undefined are
/// `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verification {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// Number of poses of the plan.
    pub count: usize,
    /// Calibrations simulated.
    pub trials: usize,
    /// Seed of the simulation.
    pub seed: u64,
    /// Whether the corners were all given one weight though they scatter unequally.
    #[serde(default)]
    pub unweighted: bool,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// The intrinsics.
    pub parameters: Vec<ParameterCheck>,
    /// The map error, px.
    pub map_error_px: MapErrorCheck,
    /// RMS length of all residuals, px.
    pub rms_px: Option<f64>,
    /// Number of trials that gave no camera.
    pub failed: usize,
    /// The first 1000 of these.
    pub failures: Vec<FailedTrial>,
    /// Whether the plan does what it predicts; `null` if the trials are too few to tell.
    pub holds: Option<bool>,
    /// The same in words.
    pub verdict: String,
}

/// An intrinsic, predicted and simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterCheck {
    /// Its name.
    pub name: String,
    /// Standard deviation by the plan.
    pub predicted_sigma: Option<f64>,
    /// Standard deviation over the trials.
    pub sampled_sigma: Option<f64>,
    /// Sampled over predicted.
    pub ratio: Option<f64>,
    /// Least and greatest ratio that scatter explains, at the confidence.
    pub ratio_interval: [Option<f64>; 2],
    /// Mean deviation from the true value.
    pub bias: Option<f64>,
}

/// The RMS map error, predicted and simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapErrorCheck {
    /// By the plan.
    pub predicted: Option<f64>,
    /// Over the trials.
    pub measured: Option<f64>,
    /// Standard error of the measured.
    pub standard_error: Option<f64>,
}

/// A trial that gave no camera.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FailedTrial {
    /// The trial, from 0.
    pub trial: usize,
    /// Why.
    pub reason: String,
}

impl Document for Verification {
    const FORMAT: &'static str = "calipose.verification";
    const VERSION: u32 = 2;
}

impl Verification {
    /// That of `plan` in `folder`; `None` if there is none that can be read and is of the plan's problem and poses.
    pub fn read(folder: &Path, plan: &Plan) -> Option<Self> {
        let found: Self = serde_json::from_slice(&std::fs::read(folder.join("verification.json")).ok()?).ok()?;
        let header = Self::header();
        let fits = (&found.header.format, found.header.version) == (&header.format, header.version)
            && found.problem == plan.problem
            && found.count == plan.count;
        fits.then_some(found)
    }

    /// What was `found` for `plan` in trials of the `seed` weighed like that, and how it is judged.
    pub fn new(plan: &Plan, found: &MonteCarlo, judgement: &Judgement, weighing: Weighing, seed: u64) -> Self {
        let parameters = found.parameters.iter().map(|p| ParameterCheck {
            name: p.name.into(),
            predicted_sigma: finite(p.predicted_sigma),
            sampled_sigma: finite(p.sampled_sigma),
            ratio: finite(p.ratio),
            ratio_interval: [finite(p.interval.0), finite(p.interval.1)],
            bias: finite(p.bias),
        });
        let failures = found.failures.iter().take(LISTED_FAILURES);
        Self {
            header: Self::header(),
            problem: plan.problem.clone(),
            count: plan.count,
            trials: found.count,
            seed,
            unweighted: weighing == Weighing::Unweighted,
            confidence: CONFIDENCE,
            parameters: parameters.collect(),
            map_error_px: MapErrorCheck {
                predicted: finite(found.map_error.predicted),
                measured: finite(found.map_error.measured),
                standard_error: finite(found.map_error.standard_error),
            },
            rms_px: finite(found.rms),
            failed: found.failures.len(),
            failures: failures
                .map(|failure| FailedTrial { trial: failure.trial, reason: failure.reason.to_string() })
                .collect(),
            holds: judgement.holds(),
            verdict: judgement.to_string(),
        }
    }
}
