//! Numbers and poses as attributes.

use nalgebra::Vector3;

use crate::export::text::decimal;
use crate::spatial::Pose;

/// Least size in m of a solid where a format takes no flat ones.
const THIN: f64 = 1e-6;

/// Numbers with spaces between.
pub(super) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(decimal).collect::<Vec<_>>().join(" ")
}

/// Coordinates.
pub(super) fn vector(v: &Vector3<f64>) -> String {
    numbers([v.x, v.y, v.z])
}

/// `w x y z` of a pose's rotation.
pub(super) fn quaternion(X: &Pose) -> String {
    let q = X.rotation.quaternion();
    numbers([q.w, q.i, q.j, q.k])
}

/// Roll, pitch and yaw in rad: the rotation is `Rz(yaw)·Ry(pitch)·Rx(roll)`.
///
/// Exact to rounding also where the pitch is a right angle: the roll is that of what is left once the yaw is taken off, whatever yaw the
/// noise of its sine and cosine gives.
pub(super) fn roll_pitch_yaw(X: &Pose) -> [f64; 3] {
    let R = X.rotation.to_rotation_matrix();
    let yaw = R[(1, 0)].atan2(R[(0, 0)]);
    let (sin, cos) = yaw.sin_cos();
    let pitch = (-R[(2, 0)]).atan2(cos * R[(0, 0)] + sin * R[(1, 0)]);
    let across = |column: usize| cos * R[(1, column)] - sin * R[(0, column)];
    [(-across(2)).atan2(across(1)), pitch, yaw]
}

/// A size that is not 0.
pub(super) fn thick(size: f64) -> f64 {
    size.max(THIN)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    use super::*;

    fn turned(roll: f64, pitch: f64, yaw: f64) -> Pose {
        Pose::from_parts([0.0; 3].into(), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
    }

    proptest! {
        #[test]
        fn angles_give_the_rotation_back(
            roll in -3.2..3.2f64, near in -1.0..1.0f64, size in 0..18i32, yaw in -3.2..3.2f64, up in any::<bool>(),
        ) {
            // Pitches about a right angle, nearer and nearer to it.
            let pitch = (if up { 1.0 } else { -1.0 }) * FRAC_PI_2 + near * 10f64.powi(-size);
            let X = turned(roll, pitch, yaw);
            let [roll, pitch, yaw] = roll_pitch_yaw(&X);
            let again = turned(roll, pitch, yaw);
            prop_assert!((again.to_homogeneous() - X.to_homogeneous()).norm() < 2e-15);
        }
    }

    #[test]
    fn numbers_have_no_exponents() {
        assert_eq!(numbers([1.0, -0.0, 1e-7]), "1.0 0.0 0.0000001");
    }
}
