//! What is to be learnt: some of a camera's intrinsics.

use crate::camera::Camera;

/// A camera and those of its intrinsics that are estimated; p of them, in the order of all rows and columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknowns<'a> {
    /// The camera whose intrinsics they are: the nominal one, or a calibrated one.
    pub camera: &'a Camera,
    /// Indices into its intrinsics, ascending.
    pub estimated: &'a [usize],
}

impl Unknowns<'_> {
    /// Number p of them.
    pub fn len(&self) -> usize {
        self.estimated.len()
    }

    /// Whether nothing is estimated.
    pub fn is_empty(&self) -> bool {
        self.estimated.is_empty()
    }

    /// Their names.
    pub fn names(&self) -> Vec<&'static str> {
        let names = self.camera.lens().parameter_names();
        self.estimated.iter().map(|&i| names[i]).collect()
    }

    /// Their values in the camera.
    pub fn values(&self) -> Vec<f64> {
        self.estimated.iter().map(|&i| self.camera.intrinsics()[i]).collect()
    }
}
