//! What a view teaches about the camera's intrinsics.

mod blur;
mod criterion;
mod diversity;
mod elimination;
mod image_area;
mod map_error;
mod noise;
mod unknowns;
mod unweighted;
mod view;
mod weakest;
mod zhang;

pub use blur::Blur;
pub use criterion::{Criterion, UnknownCriterion};
pub use diversity::DiversityModel;
pub(crate) use noise::{EDGE_POINTS, LEAST_SHARE};
pub use noise::{Noise, NoiseModel, NoiseName, Whitening};
pub use unknowns::Unknowns;
pub use unweighted::Unweighted;
pub use view::Measurement;
pub use weakest::{Weakest, weakest};
pub use zhang::ZHANG_DIRECTIONS;
