//! Plans that hold where the set-up is not quite as stated.

use nalgebra::{UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Problem;
use crate::robot::JointKind;
use crate::spatial::Pose;
use crate::verification::trial_seed;

/// What a plan must withstand.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// How far the set-up may be from what is stated.
    pub uncertainty: Uncertainty,
    /// What is made great over the scenarios.
    pub goal: RobustGoal,
    /// Scenarios that the poses are chosen for; the first is the set-up as stated.
    pub scenarios: usize,
    /// Set-ups drawn, the scenarios among them, in which views are tried.
    pub draws: usize,
    /// Least share of them in which a configuration must be a view.
    pub seen_share: f64,
}

/// What is made great over the scenarios.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RobustGoal {
    /// The geometric mean of the criterion.
    #[default]
    Mean,
    /// The least.
    Worst,
}

/// Standard deviations of what is stated of a set-up, each normal and one for all views.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Uncertainty {
    /// Of the logarithm of the focal length: one factor for fx and fy.
    pub focal_length: f64,
    /// Of cx and cy, px.
    pub principal_point: f64,
    /// Of further intrinsics by index, in their own units.
    pub intrinsics: Vec<(usize, f64)>,
    /// Of the camera mount's position along each axis, m.
    pub mount_translation: f64,
    /// Of the camera mount's rotation about each axis, rad.
    pub mount_rotation: f64,
    /// Of the board's position along each axis, m.
    pub board_translation: f64,
    /// Of the board's rotation about each axis, rad.
    pub board_rotation: f64,
    /// Of the zero of every revolute joint, rad.
    pub revolute_zero: f64,
    /// Of the zero of every prismatic joint, m.
    pub prismatic_zero: f64,
}

impl Uncertainty {
    /// Whether all is as stated.
    pub fn is_none(&self) -> bool {
        let Self {
            focal_length,
            principal_point,
            intrinsics,
            mount_translation,
            mount_rotation,
            board_translation,
            board_rotation,
            revolute_zero,
            prismatic_zero,
        } = self;
        let of_camera =
            [focal_length, principal_point].into_iter().chain(intrinsics.iter().map(|(_, deviation)| deviation));
        let of_poses =
            [mount_translation, mount_rotation, board_translation, board_rotation, revolute_zero, prismatic_zero];
        of_camera.chain(of_poses).all(|&deviation| deviation == 0.0)
    }
}

impl RobustGoal {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Mean, Self::Worst];

    /// Name as written in problem files and plans.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Worst => "worst",
        }
    }
}

/// Separates these draws from others of the same seed.
const STREAM: u64 = 0x7363_656e_6172_696f;

impl Problem {
    /// The scenarios beside the set-up as stated, which poses are chosen for; none where no robustness is asked for.
    pub fn scenarios(&self) -> Vec<Problem> {
        let count = self.robust.as_ref().map_or(0, |robust| robust.scenarios);
        (1..count).map(|draw| self.drawn(self.selection.seed, draw)).collect()
    }

    /// The set-up as it may be by draw `draw`, counted from 1, from the uncertainty stated, and itself without one: intrinsics,
    /// mount, the board's place and the joints' zeros are others. The same seed and draw give the same.
    #[must_use]
    pub fn drawn(&self, seed: u64, draw: usize) -> Problem {
        let mut drawn = self.clone();
        let Some(Robustness { uncertainty, .. }) = drawn.robust.take() else { return drawn };
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(trial_seed(seed ^ STREAM, draw));
        // Every number is drawn whether it is uncertain or not, so that one uncertainty more leaves the others' draws alone.
        let mut normal = |deviation: f64| deviation * rng.sample::<f64, _>(StandardNormal);
        let mut θ = self.camera.intrinsics().to_vec();
        let factor = normal(uncertainty.focal_length).exp();
        θ[0] *= factor;
        θ[1] *= factor;
        θ[2] += normal(uncertainty.principal_point);
        θ[3] += normal(uncertainty.principal_point);
        let mut small_motion = |translation: f64, rotation: f64| {
            let mut triple = |deviation: f64| Vector3::new(normal(deviation), normal(deviation), normal(deviation));
            Pose::from_parts(triple(translation).into(), UnitQuaternion::from_scaled_axis(triple(rotation)))
        };
        let mount = small_motion(uncertainty.mount_translation, uncertainty.mount_rotation);
        let board = small_motion(uncertainty.board_translation, uncertainty.board_rotation);
        let joints = self.robot.chain.joints.iter().map(|joint| match joint.kind {
            JointKind::Revolute => uncertainty.revolute_zero,
            JointKind::Prismatic => uncertainty.prismatic_zero,
        });
        let zeros: Vec<f64> = joints.map(&mut normal).collect();
        for (i, θ) in θ.iter_mut().enumerate() {
            let stated = uncertainty.intrinsics.iter().find(|&&(index, _)| index == i);
            *θ += normal(stated.map_or(0.0, |&(_, deviation)| deviation));
        }
        // A camera that cannot be, at deviations of the size of the values, is left as it is.
        if let Ok(camera) = self.camera.with_intrinsics(&θ) {
            drawn.noise.model = drawn.noise.model.through(&camera);
            drawn.camera = camera;
        }
        drawn.robot.X_FC *= mount;
        drawn.robot.move_zeros(&zeros);
        // The arm moves against the board, so that what the board lies on stays under it.
        let X_BT = self.target.X_BT;
        drawn.robot.move_arm(&(X_BT * board.inverse() * X_BT.inverse()));
        drawn
    }
}
