//! Verification: simulated calibrations held against what was predicted for them.
//!
//! [`simulate`] makes the noisy corners of a set of views, [`monte_carlo`] calibrates many such sets from the images
//! alone and compares the scatter of the results with a predicted covariance; [`Judgement`] says whether they agree.

mod chi_square;
mod disturbance;
mod judgement;
mod monte_carlo;
mod simulation;

pub use chi_square::deviation_interval;
pub use disturbance::{Disturbance, Nominal};
pub use judgement::Judgement;
pub use monte_carlo::{
    Failure, MapError, MonteCarlo, MonteCarloError, ParameterStatistics, Prediction, TrialFailure, Trials, Weighing,
    monte_carlo,
};
pub use simulation::{Scene, simulate};
