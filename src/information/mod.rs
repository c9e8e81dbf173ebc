//! What a view teaches about the camera's intrinsics.

mod criterion;
mod map;
pub mod packed;
mod set;
mod view;

pub use criterion::Criterion;
pub use map::{map_error_at, map_error_weight};
pub use set::{InformationError, InformationSet};
pub use view::Measurement;
