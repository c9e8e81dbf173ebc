//! The candidates' information matrices, and arithmetic on packed symmetric matrices.

mod information_set;
pub(crate) mod lanes;
pub(crate) mod packed;

pub use information_set::{InformationError, InformationSet};
