//! Messages of ROS 2 as bytes.

use super::cdr::Cdr;
use crate::camera::{Camera, Lens};
use crate::spatial::Pose;

/// Nanoseconds since the recording's start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Time(pub(super) u64);

impl Time {
    const SECOND: u64 = 1_000_000_000;

    /// Of seconds, to the nearest nanosecond.
    pub(super) fn of(seconds: f64) -> Self {
        Self((seconds * Self::SECOND as f64).round() as u64)
    }
}

/// A frame in another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Transform<'a> {
    /// The frame that it is in.
    pub(super) parent: &'a str,
    /// The frame.
    pub(super) child: &'a str,
    /// Its pose there.
    pub(super) X_PC: Pose,
}

fn header(cdr: &mut Cdr, time: Time, frame: &str) {
    cdr.i32((time.0 / Time::SECOND) as i32);
    cdr.u32((time.0 % Time::SECOND) as u32);
    cdr.text(frame);
}

/// `sensor_msgs/msg/JointState`, of positions alone.
pub(super) fn joint_state<'a>(time: Time, names: impl ExactSizeIterator<Item = &'a str>, q: &[f64]) -> Vec<u8> {
    let mut cdr = Cdr::new();
    header(&mut cdr, time, "");
    cdr.count(names.len());
    names.for_each(|name| cdr.text(name));
    cdr.list(q);
    cdr.list(&[]);
    cdr.list(&[]);
    cdr.into_bytes()
}

/// `tf2_msgs/msg/TFMessage`.
pub(super) fn transforms(time: Time, transforms: &[Transform]) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.count(transforms.len());
    for Transform { parent, child, X_PC } in transforms {
        header(&mut cdr, time, parent);
        cdr.text(child);
        cdr.array(X_PC.translation.vector.as_slice());
        // i, j, k, w.
        cdr.array(X_PC.rotation.coords.as_slice());
    }
    cdr.into_bytes()
}

/// `sensor_msgs/msg/CameraInfo` of pictures that are neither rectified nor cut.
pub(super) fn camera_info(time: Time, frame: &str, camera: &Camera) -> Vec<u8> {
    let θ = camera.intrinsics();
    let [fx, fy, cx, cy] = [θ[0], θ[1], θ[2], θ[3]];
    let model = match camera.lens() {
        // Without coefficients it is ROS's way to say that there is no distortion, but image_geometry wants five.
        Lens::Pinhole | Lens::BrownConrady => "plumb_bob",
        Lens::Rational => "rational_polynomial",
        Lens::KannalaBrandt => "equidistant",
    };
    let none = [0.0; 5];
    let mut cdr = Cdr::new();
    header(&mut cdr, time, frame);
    cdr.u32(camera.height());
    cdr.u32(camera.width());
    cdr.text(model);
    cdr.list(if camera.lens() == Lens::Pinhole { &none } else { &θ[4..] });
    cdr.array(&[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]);
    cdr.array(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    cdr.array(&[fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]);
    // Binning, and the region: zeros stand for the whole picture.
    for _ in 0..6 {
        cdr.u32(0);
    }
    cdr.bool(false);
    cdr.into_bytes()
}

/// `std_msgs/msg/String`.
pub(super) fn text(text: &str) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.text(text);
    cdr.into_bytes()
}
