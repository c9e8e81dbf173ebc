//! Verification: simulated calibrations held against what was predicted for them.
//!
//! [`simulate`] makes the noisy corners of a set of views, [`monte_carlo`] calibrates many such sets from the images
//! alone and compares the scatter of the results with a predicted covariance. MATHEMATICS.md, section 7.

mod chi_square;
mod monte_carlo;
mod simulation;

pub use chi_square::deviation_interval;
pub use monte_carlo::{
    Failure, MapError, MonteCarlo, MonteCarloError, ParameterStatistics, Prediction, TrialFailure, Trials, monte_carlo,
};
pub use simulation::simulate;
