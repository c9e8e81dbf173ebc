//! What a view teaches about the camera's intrinsics.

mod criterion;
mod diversity;
mod image_area;
mod map_error;
mod view;
mod weakest;
mod zhang;

pub use criterion::Criterion;
pub use diversity::DiversityModel;
pub use map_error::{map_error_at, map_error_weight, pixel_units};
pub use view::Measurement;
pub use weakest::{Weakest, weakest};
pub use zhang::ZHANG_DIRECTIONS;
