//! Moves of the arm: how long they take, and in which order of the poses they take least time.

pub mod timing;
pub mod tour;

pub use timing::JointLimits;
