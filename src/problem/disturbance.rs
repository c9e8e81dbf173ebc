//! What simulated calibrations are disturbed by, as people state it.

use crate::verification::Disturbance;

/// A [`Disturbance`] in the units of files and options, which the names say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StatedDisturbance {
    /// Standard deviation of the error of the nominal focal lengths and principal point.
    pub intrinsics_off_percent: f64,
    /// Standard deviation of the error of every revolute joint.
    pub joint_noise_deg: f64,
    /// Error of the camera mount's orientation, about each axis.
    pub mount_rotation_deg: f64,
    /// Error of the camera mount's position, along each axis.
    pub mount_translation_mm: f64,
    /// Growth of the noise with tilt.
    pub noise_with_tilt: f64,
    /// Growth of the noise with distance.
    pub noise_with_distance: f64,
    /// Share of the corners that are not detected.
    pub missing_percent: f64,
}

impl StatedDisturbance {
    /// Each number with its name and the greatest that it may be; the least is 0.
    pub fn numbers(&mut self) -> [(&'static str, &mut f64, f64); 7] {
        [
            ("intrinsics_off_percent", &mut self.intrinsics_off_percent, 50.0),
            ("joint_noise_deg", &mut self.joint_noise_deg, 180.0),
            ("mount_rotation_deg", &mut self.mount_rotation_deg, 180.0),
            ("mount_translation_mm", &mut self.mount_translation_mm, 1e6),
            ("noise_with_tilt", &mut self.noise_with_tilt, 1e6),
            ("noise_with_distance", &mut self.noise_with_distance, 1e6),
            ("missing_percent", &mut self.missing_percent, 99.0),
        ]
    }

    /// In rad, m and shares.
    pub fn disturbance(&self) -> Disturbance {
        Disturbance {
            intrinsics: self.intrinsics_off_percent / 100.0,
            joints: self.joint_noise_deg.to_radians(),
            mount_rotation: self.mount_rotation_deg.to_radians(),
            mount_translation: self.mount_translation_mm / 1e3,
            noise_with_tilt: self.noise_with_tilt,
            noise_with_distance: self.noise_with_distance,
            missing: self.missing_percent / 100.0,
        }
    }
}
