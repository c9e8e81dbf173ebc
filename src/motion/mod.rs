//! Moves of the arm: how long they take, whether they are safe, and in which order of the poses they take least time.

pub mod course;
pub mod journey;
mod limits;
mod safety;
pub mod timing;
pub mod tour;
pub mod way;

pub use limits::JointLimits;
pub use safety::{Danger, MarginKind, Safety};
pub use timing::duration;
