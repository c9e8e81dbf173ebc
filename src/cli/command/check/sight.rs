//! Where the camera looks and which way is up in its picture, for a mount is easily a quarter turn wrong.

use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::cli::output::fixed;
use crate::problem::Problem;
use crate::spatial::Pose;

/// The optical axis, and up in the picture.
struct Sight {
    ahead: Vector3<f64>,
    up: Vector3<f64>,
}

impl Sight {
    /// In the frame A, with the camera at `X_AC`.
    fn new(X_AC: &Pose) -> Self {
        Self { ahead: X_AC.rotation * Vector3::z(), up: X_AC.rotation * -Vector3::y() }
    }

    fn json(&self) -> Value {
        json!({ "looks_along": self.ahead.as_slice(), "up": self.up.as_slice() })
    }
}

/// On the link that carries the camera, and in the frame of the robot's base with every joint in the middle of its range.
fn sights(problem: &Problem) -> [Sight; 2] {
    let robot = &problem.robot;
    let joints = &robot.chain.joints;
    let q: Vec<f64> = joints.iter().map(|joint| f64::midpoint(joint.limits.min, joint.limits.max)).collect();
    let X_RF = robot.tree.link_poses(&q)[robot.camera_link];
    [Sight::new(&robot.X_FC), Sight::new(&(X_RF * robot.X_FC))]
}

pub(super) fn sight(problem: &Problem) -> Value {
    let [on_flange, in_base] = sights(problem);
    json!({ "on_flange": on_flange.json(), "in_base_at_mid_range": in_base.json() })
}

pub(super) fn sight_text(problem: &Problem) -> String {
    let [on_flange, in_base] = sights(problem);
    format!(
        "Camera: on the flange it looks along {}, up in the picture is {}; with every joint mid-range it looks along {} of the \
         base, up is {}.",
        direction(&on_flange.ahead),
        direction(&on_flange.up),
        direction(&in_base.ahead),
        direction(&in_base.up),
    )
}

/// A unit vector: the axis that it is, or its coordinates to hundredths.
fn direction(v: &Vector3<f64>) -> String {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if v[axis].abs() > 1.0 - 1e-9 {
            return format!("{}{name}", if v[axis] < 0.0 { "-" } else { "+" });
        }
    }
    format!("({}, {}, {})", fixed(v.x, 2), fixed(v.y, 2), fixed(v.z, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_axes_where_they_are_and_never_minus_zero() {
        assert_eq!(direction(&Vector3::new(0.0, -1.0, 1e-12)), "-y");
        assert_eq!(direction(&Vector3::new(0.6, -1e-5, 0.8)), "(0.60, 0.00, 0.80)");
    }
}
