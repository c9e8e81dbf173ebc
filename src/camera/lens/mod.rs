//! Lens models: from a direction in C to the normalised image point, and back.
//!
//! What is particular to a model stands in its own file; this one has the list of them.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

mod brown_conrady;
mod first_zero;
mod kannala_brandt;
mod model;
mod pinhole;
mod polynomial;
mod rational;

pub(super) use model::Distorted;

use std::ops::Range;

use nalgebra::{Unit, Vector2, Vector3};

use crate::lanes::Number;
use model::Model;

/// How a lens bends the rays; coefficients in OpenCV's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lens {
    /// No distortion.
    Pinhole,
    /// Brown 1966, five coefficients: `k1 k2 p1 p2 k3` (OpenCV's default, ROS `plumb_bob`).
    BrownConrady,
    /// OpenCV's rational model, eight coefficients: `k1 k2 p1 p2 k3 k4 k5 k6`.
    Rational,
    /// Kannala & Brandt 2006, four coefficients `k1 k2 k3 k4` of the angle to the axis (OpenCV's `fisheye`).
    KannalaBrandt,
}

impl Lens {
    /// Every model.
    pub const ALL: [Lens; 4] = [Lens::Pinhole, Lens::BrownConrady, Lens::Rational, Lens::KannalaBrandt];

    fn model(self) -> &'static dyn Model {
        match self {
            Lens::Pinhole => &pinhole::Pinhole,
            Lens::BrownConrady => &brown_conrady::BrownConrady,
            Lens::Rational => &rational::Rational,
            Lens::KannalaBrandt => &kannala_brandt::KannalaBrandt,
        }
    }

    /// Name as written in problem files.
    pub fn name(self) -> &'static str {
        self.model().name()
    }

    /// Names of all intrinsic parameters of a camera with this lens, in the order of θ.
    ///
    /// ```
    /// use calipose::camera::Lens;
    ///
    /// assert_eq!(Lens::BrownConrady.parameter_names().join(" "), "fx fy cx cy k1 k2 p1 p2 k3");
    /// ```
    pub fn parameter_names(self) -> &'static [&'static str] {
        self.model().parameter_names()
    }

    /// Names that other tools have for the model.
    pub fn known_as(self) -> &'static [&'static str] {
        self.model().known_as()
    }

    /// Coefficients as real lenses have them.
    #[cfg(test)]
    pub(crate) fn typical(self) -> &'static [f64] {
        self.model().typical()
    }

    /// Whether the model bends the angle to the optical axis, not its tangent. Such a lens may see beyond 90° from the axis, its image
    /// of a plane is far from a homography, and its image circle may end within the picture.
    pub fn is_fisheye(self) -> bool {
        self.model().is_fisheye()
    }

    /// Where k1 and k2 stand in θ, if the model scales the image point by `1 + k1 r² + k2 r⁴ + …`; none where it does not.
    pub(crate) fn radial_polynomial(self) -> Option<[usize; 2]> {
        self.model().radial_polynomial()
    }

    /// Where the coefficients of a denominator stand in θ that nearly cancels a numerator's; empty where the model has none.
    pub(crate) fn denominator(self) -> Range<usize> {
        self.model().denominator()
    }

    /// How far from the optical axis the model is one-to-one; see [`Model::reach`].
    pub(super) fn reach(self, k: &[f64]) -> f64 {
        self.model().reach(k)
    }

    /// The angle to the optical axis of [`Lens::reach`]; none where the model does not fold back.
    pub(super) fn fold(self, reach: f64) -> Option<f64> {
        self.model().fold(reach)
    }

    /// The normalised image point of direction `p` (any length).
    pub(super) fn distort(self, p: &Vector3<f64>, k: &[f64], reach: f64) -> Option<Vector2<f64>> {
        self.model().distort(p, k, reach)
    }

    /// As [`Lens::distort`], with derivatives by `p` and by the coefficients; of several directions none unless all have an image.
    #[inline(always)]
    pub(super) fn distort_with_derivatives<N: Number>(self, p: [N; 3], k: &[f64], reach: f64) -> Option<Distorted<N>> {
        match self {
            Lens::Pinhole => pinhole::Pinhole.distort_with_derivatives(p, k, reach),
            Lens::BrownConrady => brown_conrady::BrownConrady.distort_with_derivatives(p, k, reach),
            Lens::Rational => rational::Rational.distort_with_derivatives(p, k, reach),
            Lens::KannalaBrandt => kannala_brandt::KannalaBrandt.distort_with_derivatives(p, k, reach),
        }
    }

    /// The direction whose normalised image point is `m`.
    pub(super) fn undistort(self, m: &Vector2<f64>, k: &[f64], reach: f64) -> Option<Unit<Vector3<f64>>> {
        let direction = self.model().direction(m, k, reach)?;
        let again = self.distort(&direction, k, reach)?;
        ((again - m).norm() <= 1e-9 * (1.0 + m.norm())).then(|| Unit::new_normalize(direction))
    }
}
