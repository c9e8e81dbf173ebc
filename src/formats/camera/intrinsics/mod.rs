//! A camera's lens model and intrinsics, as the formats list them: a name, a matrix, coefficients.

mod coefficients;
mod lens_names;
mod matrix;

pub(super) use coefficients::coefficients_of;
pub(super) use lens_names::LensNames;
pub(super) use matrix::{Matrix, camera_matrix};

use crate::camera::{Camera, Lens};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Located;

/// The camera of intrinsics θ, each in its range.
pub(super) fn camera(lens: Lens, [width, height]: [u32; 2], θ: &[Located]) -> Result<Camera, ReadError> {
    for (i, (name, value)) in lens.parameter_names().iter().zip(θ).enumerate() {
        let (min, max) = match i {
            0 | 1 => (1e-3, 1e6),
            2 => (-0.5, f64::from(width) - 0.5),
            3 => (-0.5, f64::from(height) - 0.5),
            _ => (-1e6, 1e6),
        };
        value.between(name, min, max)?;
    }
    let values: Vec<f64> = θ.iter().map(|x| x.value).collect();
    Camera::new(lens, width, height, &values)
        .map_err(|error| ReadFault::Syntax { message: error.to_string() }.at(θ.first().map_or(1, |x| x.line)))
}
