//! What a lens model has to say of itself.

use std::ops::Range;

use nalgebra::{Vector2, Vector3};

use crate::lanes::Number;

/// Coefficients of the largest lens model.
pub(super) const MAX_COEFFICIENTS: usize = 8;

/// A normalised image point with its derivatives, or several.
pub(in crate::camera) struct Distorted<N> {
    pub(in crate::camera) point: [N; 2],
    /// Two rows.
    pub(in crate::camera) by_point: [[N; 3]; 2],
    /// Columns; zero beyond the model's coefficients.
    pub(in crate::camera) by_coefficients: [[N; 2]; MAX_COEFFICIENTS],
}

/// A lens model: all that is particular to it. Nothing has a default, so that a new one has to answer every question.
///
/// `k` are the coefficients, padded with zeros; `reach` is [`Model::reach`] of them, or infinite where the model is continued past
/// its fold.
pub(super) trait Model {
    /// See [`Lens::name`](super::Lens::name).
    fn name(&self) -> &'static str;

    /// See [`Lens::parameter_names`](super::Lens::parameter_names).
    fn parameter_names(&self) -> &'static [&'static str];

    /// See [`Lens::known_as`](super::Lens::known_as).
    fn known_as(&self) -> &'static [&'static str];

    /// Coefficients as real lenses have them, for tests.
    #[cfg(test)]
    fn typical(&self) -> &'static [f64];

    /// See [`Lens::is_fisheye`](super::Lens::is_fisheye).
    fn is_fisheye(&self) -> bool;

    /// See [`Lens::radial_polynomial`](super::Lens::radial_polynomial).
    fn radial_polynomial(&self) -> Option<[usize; 2]>;

    /// See [`Lens::denominator`](super::Lens::denominator).
    fn denominator(&self) -> Range<usize>;

    /// How far from the optical axis the model is one-to-one, in the measure that the model itself bends: the greatest angle of a
    /// fisheye, the greatest `tan²` of the angle otherwise. Beyond it the model turns back and would put far points into the image.
    fn reach(&self, k: &[f64]) -> f64;

    /// The angle to the optical axis of `reach`; none where the model does not fold back.
    fn fold(&self, reach: f64) -> Option<f64>;

    /// The normalised image point of direction `p` (any length); none behind the lens and beyond its `reach`.
    fn distort(&self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Vector2<f64>>;

    /// As [`Model::distort`], with derivatives by `p` and by the coefficients; of several directions none unless all have an image.
    fn distort_with_derivatives<N: Number>(&self, p: [N; 3], k: &[f64], reach: f64) -> Option<Distorted<N>>
    where
        Self: Sized;

    /// The direction (any length) whose normalised image point is `m`, if it has one; whether it has is checked by the caller.
    fn direction(&self, m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Vector3<f64>>;
}
