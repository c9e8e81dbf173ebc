//! What can be wrong with a camera's numbers.

use thiserror::Error;

/// Why a set of numbers is not a camera.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CameraError {
    /// The image has no pixels.
    #[error("the image is {width} x {height} px; both sides must be at least 1 px")]
    EmptyImage {
        /// Image width given.
        width: u32,
        /// Image height given.
        height: u32,
    },
    /// The number of parameters is not the model's.
    #[error("the {lens} model has {expected} intrinsic parameters, {found} are given")]
    ParameterCount {
        /// Name of the lens model.
        lens: &'static str,
        /// Parameters of the model, fx fy cx cy included.
        expected: usize,
        /// Parameters given.
        found: usize,
    },
    /// A parameter is NaN or infinite.
    #[error("{name} is {value}; it must be a finite number")]
    NotFinite {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A focal length is not positive.
    #[error("{name} is {value} px; a focal length must be positive")]
    FocalLength {
        /// `fx` or `fy`.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}
