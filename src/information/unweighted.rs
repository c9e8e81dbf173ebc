//! What plain least squares makes of corners that scatter unequally.

use nalgebra::{DMatrix, Dyn, OMatrix, U6};

use super::view::Measurement;
use crate::selection::packed::inverse;
use crate::spatial::Pose;
use crate::target::{Corners, Warp};

/// The covariance of an estimate that minimises the plain sum of the squared residuals, as OpenCV's `calibrateCamera` does, where the
/// corners have covariances `Σ_j` all the same: the sandwich `H⁻¹ K H⁻¹` (Huber 1967; White 1980), with `A⊥ = A − Q Qᵀ A`, where
/// `B = Q R`, of residual Jacobians A (2m×p) by the intrinsics and B (2m×6) by the view's pose, both without weights,
///
/// ```text
///     H = Σ A⊥ᵀ A⊥ / σ²        K = Σ A⊥ᵀ Σ_j A⊥ / σ⁴ + G Gᵀ        G = Σ A⊥ᵀ C / σ²
/// ```
///
/// The last part is there where the board may bulge, which such an estimate knows nothing of: C (2m×2) are the residuals'
/// derivatives by its heights, in their deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Unweighted {
    H: DMatrix<f64>,
    K: DMatrix<f64>,
    G: DMatrix<f64>,
}

impl Unweighted {
    /// Of no views, with `prior` information (p×p) on the intrinsics.
    pub fn new(prior: &DMatrix<f64>) -> Self {
        Self { H: prior.clone(), K: prior.clone(), G: DMatrix::zeros(prior.nrows(), Warp::HEIGHTS) }
    }

    /// Adds the view of the corners `seen` from `X_CT`; `None` if a corner has no image.
    pub fn add(&mut self, measurement: &Measurement, X_CT: &Pose, seen: &Corners) -> Option<()> {
        let indices = seen.indices(measurement.corners.len());
        let estimated = measurement.unknowns.estimated;
        let mut A = DMatrix::zeros(2 * indices.len(), estimated.len());
        let mut B = OMatrix::<f64, Dyn, U6>::zeros(2 * indices.len());
        let mut C = DMatrix::zeros(2 * indices.len(), Warp::HEIGHTS);
        let mut covariances = Vec::with_capacity(indices.len());
        let R = X_CT.rotation.to_rotation_matrix().into_inner();
        for (at, &i) in indices.iter().enumerate() {
            let derivatives = measurement.derivatives(i, &R, &X_CT.translation.vector)?;
            for (j, &parameter) in estimated.iter().enumerate() {
                A.fixed_view_mut::<2, 1>(2 * at, j).copy_from_slice(&derivatives.by_intrinsics[parameter]);
            }
            B.fixed_view_mut::<2, 6>(2 * at, 0).copy_from_slice(derivatives.by_pose.as_flattened());
            C.fixed_view_mut::<2, { Warp::HEIGHTS }>(2 * at, 0).copy_from_slice(derivatives.by_heights.as_flattened());
            covariances.push(derivatives.whitening.covariance());
        }
        let Q = B.qr().q();
        A -= &Q * (Q.transpose() * &A);
        let mut scattered = A.clone();
        for (at, covariance) in covariances.iter().enumerate() {
            let rows = covariance * A.rows(2 * at, 2);
            scattered.rows_mut(2 * at, 2).copy_from(&rows);
        }
        let scale = measurement.scale();
        self.H += A.tr_mul(&A) * scale;
        self.K += A.tr_mul(&scattered) * scale;
        self.G += A.tr_mul(&C) * scale;
        Some(())
    }

    /// The estimate's covariance, p×p; `None` if the views leave an intrinsic undetermined.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let inverse = inverse(&self.H)?;
        Some(&inverse * (&self.K + &self.G * self.G.transpose()) * &inverse)
    }
}
