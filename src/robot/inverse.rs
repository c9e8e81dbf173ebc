//! Inverse kinematics: joint values that bring the camera to a requested pose.
//!
//! Damped least squares (Levenberg–Marquardt; Nakamura & Hanafusa 1986, Wampler 1986) within the joint limits, from several
//! starts. What is made small is `‖log(R_requested · Rᵀ)‖² + ‖p_requested − p‖² / ℓ²`: an error of one radian weighs as much as one of
//! the length ℓ.

use nalgebra::{Cholesky, DVector, Matrix6xX, Vector6};
use rayon::prelude::*;

use super::{Joint, JointKind, Limits, Robot};
use crate::spatial::Pose;

/// How to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachSettings {
    /// The length ℓ in m.
    pub length: f64,
    /// Greatest distance in m from the requested position that counts as reached.
    pub position_tolerance: f64,
    /// Greatest angle in rad from the requested orientation that counts as reached.
    pub angle_tolerance: f64,
    /// Starts tried at once; where none reaches the pose, as many more are tried, up to `most_starts`.
    pub starts: usize,
    /// Most starts tried.
    pub most_starts: usize,
    /// Most steps from each start.
    pub most_steps: usize,
}

impl Default for ReachSettings {
    fn default() -> Self {
        Self {
            length: 0.5,
            position_tolerance: 1e-6,
            angle_tolerance: 1e-6,
            starts: 64,
            most_starts: 512,
            most_steps: 200,
        }
    }
}

/// A configuration at, or nearest to, a requested pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// Joint values, rad or m, within their limits; of those that are one place, the nearest to 0.
    pub q: Vec<f64>,
    /// Distance in m from the requested position.
    pub position_error: f64,
    /// Angle in rad from the requested orientation.
    pub angle_error: f64,
    /// Whether both are within the tolerances.
    pub reached: bool,
    /// Least distance of a joint from its limits, as a share of half its range: 1 in the middle, 0 at a limit.
    pub limit_margin: f64,
}

/// Configurations to start from, and where they bring the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    configurations: Vec<(Vec<f64>, Pose)>,
}

impl Starts {
    /// These configurations of `robot` (rad or m).
    pub fn new(robot: &Robot, configurations: Vec<Vec<f64>>) -> Self {
        let with_pose = |q: Vec<f64>| {
            let X_BC = robot.camera_pose(&q);
            (q, X_BC)
        };
        Self { configurations: configurations.into_par_iter().map(with_pose).collect() }
    }

    /// At most `count` of them, the nearest to `requested` first, that differ from each other.
    fn nearest(&self, requested: &Pose, length: f64, joints: &[Joint], count: usize) -> Vec<&[f64]> {
        /// Least difference of two starts, as a share of a joint's range.
        const APART: f64 = 0.1;
        let cost = |X: &Pose| error(requested, X, length).norm_squared();
        let mut order: Vec<(f64, usize)> =
            self.configurations.iter().enumerate().map(|(i, (_, X))| (cost(X), i)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let apart = |a: &[f64], b: &[f64]| {
            joints.iter().zip(a.iter().zip(b)).any(|(joint, (a, b))| {
                let Limits { min, max } = joint.limits;
                (a - b).abs() > APART * (max - min)
            })
        };
        let mut chosen: Vec<&[f64]> = Vec::new();
        for (_, i) in order {
            let q = &self.configurations[i].0;
            if chosen.len() == count {
                break;
            }
            if chosen.iter().all(|other| apart(q, other)) {
                chosen.push(q);
            }
        }
        chosen
    }
}

/// The configurations that bring the camera of `robot` to `requested`, its pose in the base frame, those farthest from joint limits
/// first; or, where none does, the configuration that comes nearest. Configurations differ by more than 5° or 5 mm in a joint.
///
/// The result does not depend on the number of threads. It is empty only without starts.
pub fn reach(robot: &Robot, requested: &Pose, starts: &Starts, settings: &ReachSettings) -> Vec<Reached> {
    const APART: f64 = 0.087;
    const APART_MM: f64 = 5e-3;
    let joints = &robot.chain.joints;
    let starts = starts.nearest(requested, settings.length, joints, settings.most_starts);
    let mut nearest: Option<(f64, Reached)> = None;
    for batch in starts.chunks(settings.starts.max(1)) {
        let ends: Vec<(f64, Reached)> =
            batch.par_iter().map(|start| descend(robot, requested, start, settings)).collect();
        let mut found: Vec<Reached> = Vec::new();
        let same = |a: &Reached, b: &Reached| {
            joints.iter().zip(a.q.iter().zip(&b.q)).all(|(joint, (a, b))| {
                let apart = if joint.kind == JointKind::Revolute { APART } else { APART_MM };
                (a - b).abs() <= apart
            })
        };
        for (cost, end) in ends {
            if end.reached {
                if !found.iter().any(|other| same(other, &end)) {
                    found.push(end);
                }
            } else if nearest.as_ref().is_none_or(|(least, _)| cost < *least) {
                nearest = Some((cost, end));
            }
        }
        if !found.is_empty() {
            found.sort_by(|a, b| b.limit_margin.total_cmp(&a.limit_margin));
            return found;
        }
    }
    nearest.into_iter().map(|(_, end)| end).collect()
}

/// Error of `X` against `requested`: rotation in rad, translation in units of ℓ, both in the base frame.
fn error(requested: &Pose, X: &Pose, length: f64) -> Vector6<f64> {
    let ω = (requested.rotation * X.rotation.inverse()).scaled_axis();
    let v = (requested.translation.vector - X.translation.vector) / length;
    Vector6::new(ω.x, ω.y, ω.z, v.x, v.y, v.z)
}

/// Where damped steps from `start` end, and the cost there.
fn descend(robot: &Robot, requested: &Pose, start: &[f64], settings: &ReachSettings) -> (f64, Reached) {
    let length = settings.length;
    let joints = &robot.chain.joints;
    let mut q = start.to_vec();
    let (mut X, mut J) = robot.camera_jacobian(&q);
    let mut e = error(requested, &X, length);
    let mut λ = 1e-2;
    for _ in 0..settings.most_steps {
        J.fixed_rows_mut::<3>(3).scale_mut(1.0 / length);
        // The gradient of the cost is exactly −2Jᵀe, because the derivative of the logarithm maps e to itself.
        let descent = J.tr_mul(&e);
        for (i, joint) in joints.iter().enumerate() {
            let Limits { min, max } = joint.limits;
            if (q[i] <= min && descent[i] < 0.0) || (q[i] >= max && descent[i] > 0.0) {
                J.column_mut(i).fill(0.0);
            }
        }
        let mut stepped = None;
        while λ < 1e9 {
            let step = damped_step(&J, &e, λ);
            let next: Vec<f64> = joints
                .iter()
                .zip(q.iter().zip(step.iter()))
                .map(|(joint, (q, step))| (q + step).max(joint.limits.min).min(joint.limits.max))
                .collect();
            let X_next = robot.camera_pose(&next);
            let e_next = error(requested, &X_next, length);
            if e_next.norm_squared() < e.norm_squared() {
                λ = (λ * 0.1).max(1e-14);
                stepped = Some((next, e_next));
                break;
            }
            λ *= 8.0;
        }
        let Some((next, e_next)) = stepped else { break };
        let gain = 1.0 - e_next.norm_squared() / e.norm_squared();
        (q, e) = (next, e_next);
        (X, J) = robot.camera_jacobian(&q);
        if e.norm() < 1e-14 || gain < 1e-12 {
            break;
        }
    }
    robot.unwind(&mut q);
    let position_error = (requested.translation.vector - X.translation.vector).norm();
    let angle_error = e.fixed_rows::<3>(0).norm();
    let reached = position_error <= settings.position_tolerance && angle_error <= settings.angle_tolerance;
    let margin = |(joint, q): (&Joint, &f64)| {
        let Limits { min, max } = joint.limits;
        // A joint without a range is where it always is.
        if max > min { (q - min).min(max - q) / (max - min) * 2.0 } else { 1.0 }
    };
    let limit_margin = joints.iter().zip(&q).map(margin).fold(1.0, f64::min);
    (e.norm_squared(), Reached { q, position_error, angle_error, reached, limit_margin })
}

/// `Jᵀ(JJᵀ + λI)⁻¹e`.
fn damped_step(J: &Matrix6xX<f64>, e: &Vector6<f64>, λ: f64) -> DVector<f64> {
    let mut A = J * J.transpose();
    for i in 0..6 {
        A[(i, i)] += λ;
    }
    match Cholesky::new(A) {
        Some(factor) => J.tr_mul(&factor.solve(e)),
        None => DVector::zeros(J.ncols()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::dh::{self, Convention, Row};
    use crate::robot::{Motion, Stage};

    /// A revolute, a prismatic and a revolute joint; the first also drives a stage at the end.
    fn robot() -> Robot {
        let row = |name: &str, kind, alpha| Row {
            name: name.into(),
            kind,
            a: 0.3,
            alpha,
            d: 0.1,
            theta: 0.4,
            limits: Limits { min: -1.0, max: 1.5 },
            max_speed: None,
        };
        let rows = [
            row("a", JointKind::Revolute, 1.2),
            row("b", JointKind::Prismatic, -0.5),
            row("c", JointKind::Revolute, 0.3),
        ];
        let mut chain = dh::chain(&rows, Convention::Standard, Pose::translation(0.0, 0.1, 0.2));
        let axis = nalgebra::Vector3::y_axis();
        let motion = Motion::Driven { joint: 0, kind: JointKind::Revolute, axis, multiplier: -0.7, offset: 0.2 };
        chain.stages.push(Stage { X_PJ: Pose::translation(0.2, 0.0, 0.1), motion });
        let tree = dh::tree(&rows, Convention::Standard, Pose::identity());
        Robot {
            chain,
            tree,
            X_FC: Pose::rotation(nalgebra::Vector3::new(0.3, 0.2, 0.1)),
            board_link: 0,
            camera_link: 0,
            obstacles: vec![],
        }
    }

    #[test]
    fn the_jacobian_equals_finite_differences() {
        let robot = robot();
        let q = [0.4, 0.7, -0.3];
        let (X, J) = robot.camera_jacobian(&q);
        assert_eq!(X, robot.camera_pose(&q));
        let h = 1e-6;
        for i in 0..3 {
            let at = |h: f64| {
                let mut q = q;
                q[i] += h;
                robot.camera_pose(&q)
            };
            let difference = error(&at(h), &at(-h), 1.0) / (2.0 * h);
            assert!((J.column(i) - difference).norm() < 1e-9, "{i}");
        }
    }

    #[test]
    fn limits_hold_and_the_nearest_is_told_from_the_reached() {
        let robot = robot();
        let starts = Starts::new(&robot, vec![vec![0.0; 3], vec![1.0; 3]]);
        let settings = ReachSettings::default();
        let within = reach(&robot, &robot.camera_pose(&[0.9, -0.8, 1.4]), &starts, &settings);
        assert!(within[0].reached);
        assert!(within[0].q.iter().zip([0.9, -0.8, 1.4]).all(|(q, expected)| (q - expected).abs() < 1e-6));
        assert!((within[0].limit_margin - 0.08).abs() < 1e-5);
        let beyond = reach(&robot, &robot.camera_pose(&[0.9, 2.5, 1.4]), &starts, &settings);
        assert_eq!(beyond.len(), 1);
        assert!(!beyond[0].reached && beyond[0].position_error > 0.1);
        assert!(beyond[0].q.iter().all(|q| (-1.0..=1.5).contains(q)));
    }
}
