//! Whether simulated calibrations came to what was predicted.

use std::fmt;

use super::chi_square::deviation_interval;
use super::monte_carlo::MonteCarlo;

/// Fewer successful trials tell too little for a verdict: the interval of a ratio is wider than ±35 %.
const LEAST_TRIALS: usize = 30;

/// A greater share of failed trials is said in the verdict.
const MANY_FAILURES: f64 = 0.01;

/// With fewer successful trials than a verdict takes, a greater share of failed ones is verdict enough.
const MOST_FAIL: f64 = 0.5;

/// How often the judgement as a whole errs about a plan that does as predicted.
const ERROR_RATE: f64 = 0.01;

/// What simulated calibrations say of the plan that they follow.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// None gave a camera.
    NoCalibration,
    /// More than half gave none, and the others are too few to be compared.
    MostFail {
        /// Share of the trials that failed.
        failed: f64,
    },
    /// Too few gave a camera to be compared.
    TooFew {
        /// How many did.
        good: usize,
    },
    /// The scatter of the estimates was compared with the prediction.
    Compared {
        /// Share of the trials that failed.
        failed: f64,
        /// Intrinsics that scatter more than predicted.
        worse: Vec<&'static str>,
        /// Intrinsics that scatter less.
        better: Vec<&'static str>,
    },
}

impl Judgement {
    /// Judges the plan by its trials. The judgement as a whole errs once in a hundred plans that do as predicted: each of the p
    /// intervals is taken at a confidence of 1 − 0.01/p.
    pub fn new(found: &MonteCarlo) -> Self {
        let good = found.count - found.failures.len();
        let failed = found.failures.len() as f64 / found.count as f64;
        if good < LEAST_TRIALS {
            return match good {
                0 => Self::NoCalibration,
                _ if failed > MOST_FAIL => Self::MostFail { failed },
                _ => Self::TooFew { good },
            };
        }
        let (low, high) = deviation_interval(good, 1.0 - ERROR_RATE / found.parameters.len() as f64);
        let worse = found.parameters.iter().filter(|p| p.ratio * low > 1.0).map(|p| p.name).collect();
        let better = found.parameters.iter().filter(|p| p.ratio * high < 1.0).map(|p| p.name).collect();
        Self::Compared { failed, worse, better }
    }

    /// Whether the plan does what it predicts, or better; `None` if the trials are too few to tell.
    pub fn holds(&self) -> Option<bool> {
        match self {
            Self::NoCalibration | Self::MostFail { .. } => Some(false),
            Self::TooFew { .. } => None,
            Self::Compared { failed, worse, .. } => Some(worse.is_empty() && *failed <= MANY_FAILURES),
        }
    }
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let (failed, worse, better) = match self {
            Self::NoCalibration => return f.write_str("Verdict: the plan does not lead to a calibration."),
            Self::MostFail { failed } => return write!(f, "Verdict: {} of the calibrations fail.", percent(*failed)),
            Self::TooFew { good } => {
                return write!(f, "Verdict: none; {good} calibrations, but a verdict needs {LEAST_TRIALS}.");
            }
            Self::Compared { failed, worse, better } => (*failed, worse, better),
        };
        f.write_str("Verdict: ")?;
        if failed > MANY_FAILURES {
            write!(f, "{} of the calibrations fail; of the others, ", percent(failed))?;
        }
        match (&worse[..], &better[..]) {
            ([], []) => f.write_str("the plan does as predicted; the scatter of every intrinsic agrees.")?,
            ([], better) => write!(f, "the plan does better than predicted in {}.", better.join(", "))?,
            (worse, _) => write!(f, "the plan does worse than predicted in {}.", worse.join(", "))?,
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::super::{Failure, MapError, ParameterStatistics, TrialFailure};
    use super::*;

    fn trials(good: usize, failed: usize, ratio: f64) -> Judgement {
        let parameter = |name, ratio| ParameterStatistics {
            name,
            nominal: 1.0,
            bias: 0.0,
            sampled_sigma: ratio,
            predicted_sigma: 1.0,
            ratio,
            interval: (0.9, 1.1),
        };
        let failure = |trial| Failure { trial, reason: TrialFailure::NotConverged { iterations: 9 } };
        Judgement::new(&MonteCarlo {
            parameters: vec![parameter("fx", 1.0), parameter("k1", ratio)],
            covariance: DMatrix::identity(2, 2),
            map_error: MapError { measured: 1.0, predicted: 1.0, standard_error: 0.1 },
            rms: 0.3,
            count: good + failed,
            failures: (0..failed).map(failure).collect(),
        })
    }

    #[test]
    fn a_plan_is_bad_that_does_worse_than_predicted_or_fails_often_and_open_where_trials_are_few() {
        for (judgement, holds, words) in [
            (trials(0, 5, 1.0), Some(false), "does not lead to a calibration."),
            (trials(4, 6, 1.0), Some(false), "60 % of the calibrations fail."),
            (trials(29, 0, 9.0), None, "none; 29 calibrations, but a verdict needs 30"),
            (trials(500, 0, 1.0), Some(true), "Verdict: the plan does as predicted;"),
            (trials(500, 0, 0.8), Some(true), "better than predicted in k1."),
            (trials(500, 0, 1.3), Some(false), "worse than predicted in k1."),
            (
                trials(480, 20, 1.0),
                Some(false),
                "4 % of the calibrations fail; of the others, the plan does as predicted;",
            ),
        ] {
            assert_eq!(judgement.holds(), holds, "{judgement}");
            assert!(judgement.to_string().contains(words), "{judgement}");
        }
    }
}
