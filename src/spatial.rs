//! Poses and their perturbations.
//!
//! `X_AB` is the pose of frame B in frame A and maps B's coordinates to A's: `p_A = X_AB * p_B`. Adjacent
//! letters cancel, so `X_CT = X_BC.inverse() * X_BT` reads as C ← B ← T.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3, Vector6};

/// A rigid transform `X_AB`; translation in metres.
pub type Pose = Isometry3<f64>;

/// A small motion, rotation first: `(ω in rad, v in m)`.
pub type Tangent = Vector6<f64>;

/// The matrix `[v]×` of the cross product: `skew(v) * u = v × u`.
pub fn skew(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// The pose `X_AB` after B moved by `ξ = (ω, v)`, both expressed in A and taken about B's origin:
/// the rotation becomes `exp([ω]×)·R_AB`, the translation `p_AB + v`.
///
/// Rotating about B's origin rather than A's keeps `ω` and `v` uncorrelated for a small, distant B.
pub fn perturb(X_AB: &Pose, ξ: &Tangent) -> Pose {
    let ω = Vector3::new(ξ[0], ξ[1], ξ[2]);
    let v = Vector3::new(ξ[3], ξ[4], ξ[5]);
    Pose::from_parts((X_AB.translation.vector + v).into(), UnitQuaternion::from_scaled_axis(ω) * X_AB.rotation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skew_is_the_cross_product() {
        let (a, b) = (Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.5, 4.0, -1.0));
        assert_eq!(skew(&a) * b, a.cross(&b));
    }

    #[test]
    fn perturbation_moves_a_point_by_its_linearisation() {
        let X_AB = Pose::new(Vector3::new(0.3, -0.2, 1.5), Vector3::new(0.4, 0.1, -0.7));
        let ξ = Tangent::new(2e-7, -1e-7, 3e-7, 1e-7, 2e-7, -3e-7);
        let p_B = Vector3::new(0.1, 0.2, -0.05);
        let arm = X_AB.rotation * p_B;
        let linear = Vector3::new(ξ[0], ξ[1], ξ[2]).cross(&arm) + Vector3::new(ξ[3], ξ[4], ξ[5]);
        let moved = perturb(&X_AB, &ξ) * nalgebra::Point3::from(p_B) - X_AB * nalgebra::Point3::from(p_B);
        assert!((moved - linear).norm() < 1e-13);
    }
}
