//! What a prediction leaves out: the robot and the camera are not quite as stated.

use nalgebra::{UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::simulation::{Scene, trial_seed};
use crate::camera::Camera;
use crate::information::Noise;
use crate::robot::{JointKind, Robot};
use crate::spatial::Pose;
use crate::target::{Corners, Surface, Target};

/// Deviations from the plan, drawn anew for every trial; all zero by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disturbance {
    /// Standard deviation of the relative error of the nominal fx and fy (one factor for both), and of the nominal cx and cy
    /// as a share of the focal length.
    pub intrinsics: f64,
    /// Standard deviation of every revolute joint, rad.
    pub joints: f64,
    /// Standard deviation of the camera mount's rotation about each axis, rad; one error for all views.
    pub mount_rotation: f64,
    /// Standard deviation of the camera mount's position along each axis, m; one error for all views.
    pub mount_translation: f64,
    /// Growth of the noise with tilt: σ is multiplied by `1 + tilt·(1/cos(tilt) − 1)`.
    pub noise_with_tilt: f64,
    /// Growth of the noise with distance: σ is multiplied by `1 + distance·max(0, d/d₀ − 1)`, d₀ the nearest view's.
    pub noise_with_distance: f64,
    /// Chance of each corner to go undetected.
    pub missing: f64,
}

/// What the plan supposes.
#[derive(Debug, Clone, Copy)]
pub struct Nominal<'a> {
    /// The arm and the camera's mount.
    pub robot: &'a Robot,
    /// The camera.
    pub camera: &'a Camera,
    /// The board.
    pub target: &'a Target,
    /// How far corners scatter.
    pub noise: Noise,
}

/// Separates these draws from those of the pixel noise.
const STREAM: u64 = 0x6469_7374_7572_6265;

impl Disturbance {
    /// The scene of one trial: what the camera meets when the robot is told the joint values `planned`, and which corners the
    /// plan expects to see there.
    pub fn scene(&self, nominal: &Nominal<'_>, planned: &[(&Vec<f64>, &Corners)], seed: u64, trial: usize) -> Scene {
        let Nominal { robot, camera, target, noise } = *nominal;
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(trial_seed(seed ^ STREAM, trial));
        let mut normal = |deviation: f64| deviation * rng.sample::<f64, _>(StandardNormal);
        let mut θ = camera.intrinsics().to_vec();
        let factor = normal(self.intrinsics).exp();
        let focal = θ[0];
        (θ[0], θ[1]) = (θ[0] * factor, θ[1] * factor);
        (θ[2], θ[3]) = (θ[2] + focal * normal(self.intrinsics), θ[3] + focal * normal(self.intrinsics));
        let mut triple = |deviation: f64| Vector3::new(normal(deviation), normal(deviation), normal(deviation));
        let mount = Pose::from_parts(
            triple(self.mount_translation).into(),
            UnitQuaternion::from_scaled_axis(triple(self.mount_rotation)),
        );
        let X_FC = robot.X_FC * mount;
        let mut pose = |q: &Vec<f64>| {
            let joints = robot.chain.joints.iter().zip(q);
            let q: Vec<f64> = joints
                .map(|(joint, q)| match joint.kind {
                    JointKind::Revolute => q + normal(self.joints),
                    JointKind::Prismatic => *q,
                })
                .collect();
            (robot.chain.flange_pose(&q) * X_FC).inverse() * target.X_BT
        };
        let poses: Vec<Pose> = planned.iter().map(|(q, _)| pose(q)).collect();
        let distance = |X_CT: &Pose| X_CT.translation.vector.norm();
        let nearest = poses.iter().map(distance).fold(f64::INFINITY, f64::min);
        let growth = |X_CT: &Pose| {
            // A board seen edge-on has no corners to detect; the limit only keeps the number finite.
            let cosine = (X_CT.rotation * Vector3::z()).z.abs().max(0.01);
            let with_tilt = self.noise_with_tilt * (cosine.recip() - 1.0);
            let with_distance = self.noise_with_distance * (distance(X_CT) / nearest - 1.0);
            1.0 + with_tilt + with_distance
        };
        Scene {
            sigma: poses.iter().map(|X_CT| noise.sigma * growth(X_CT)).collect(),
            noise: noise.model,
            poses,
            seen: planned.iter().map(|&(_, seen)| seen.clone()).collect(),
            camera: camera.with_intrinsics(&θ).unwrap_or_else(|_| camera.clone()),
            missing: self.missing,
            surface: target.warp.map_or(Surface::FLAT, |warp| Surface::new(warp, [normal(1.0), normal(1.0)])),
        }
    }
}
