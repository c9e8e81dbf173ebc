//! What a view teaches about the camera's intrinsics.

mod criterion;

pub use criterion::Criterion;
