//! Points and directions that the joints move, as Taylor models.
//!
//! With the joints at the centre of a box, each stage turns what hangs on it about a fixed axis, or slides it. In a frame at one
//! end of the chain a point p at the other end is, at joint values `d_a` from the centre,
//!
//! ```text
//!     p(d) = E_1 E_2 … E_m p        E_a = exp(d_a ξ_a)
//! ```
//!
//! outermost stage first, so that `∂⁴p = ξ_a ξ_b ξ_c ξ_d (E_{d+1} … E_m p)` up to turns, for a, b, c, d in this order: no longer than
//! `|ω_a| |ω_b| |ω_c|` times how fast d moves the point. Summed over all fourths it is the remainder, no interval arithmetic needed.

use nalgebra::{Point3, Vector3};

use super::taylor::{place, place_of_three};
use crate::robot::{JointKind, Motion, Robot};
use crate::spatial::Pose;

/// How a stage moves what hangs on it, per half width of its joint's range in the box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twist {
    pub(super) joint: usize,
    ω: Vector3<f64>,
    v: Vector3<f64>,
}

/// A vector as a Taylor model: its remainder is a ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moved<const N: usize, const Q: usize, const C: usize> {
    pub(super) c: Vector3<f64>,
    pub(super) l: [Vector3<f64>; N],
    pub(super) q: [Vector3<f64>; Q],
    pub(super) t: [Vector3<f64>; C],
    pub(super) r: f64,
}

/// Stages that a chain may have; it has as many as joints and those that mimic them.
type Twists = Vec<Twist>;

/// The camera's frame and the board's, at the centre of a box, and how the joints move the one in the other.
#[derive(Debug, Clone)]
pub(super) struct Kinematics {
    /// At the centre.
    pub(super) X_CT: Pose,
    /// Of the board in C.
    pub(super) of_board: Twists,
    /// Of the camera in T.
    pub(super) of_camera: Twists,
}

/// Bounds the rounding of a pose, as a share of its numbers and of 1 m.
const ROUNDING: f64 = 1e-13;

impl Kinematics {
    /// At the joint values `centre` of a box with these half widths.
    pub(super) fn new(robot: &Robot, X_BT: &Pose, centre: &[f64], half: &[f64]) -> Self {
        let X_BC = robot.camera_pose(centre);
        let (X_CB, X_TB) = (X_BC.inverse(), X_BT.inverse());
        let mut of_board = Twists::new();
        let mut of_camera = Twists::new();
        let mut X_BP = Pose::identity();
        for stage in &robot.chain.stages {
            let X_BJ = X_BP * stage.X_PJ;
            if let Motion::Driven { joint, kind, axis, multiplier, .. } = stage.motion {
                let scale = half[joint] * multiplier;
                of_camera.push(Twist::new(joint, kind, &(X_TB * X_BJ), &axis, scale));
                of_board.push(Twist::new(joint, kind, &(X_CB * X_BJ), &axis, -scale));
            }
            X_BP = X_BJ * stage.motion.pose(centre);
        }
        // From C the last stage is the outermost.
        of_board.reverse();
        Self { X_CT: X_CB * X_BT, of_board, of_camera }
    }
}

impl Twist {
    fn new(joint: usize, kind: JointKind, X_AJ: &Pose, axis: &Vector3<f64>, scale: f64) -> Self {
        let axis = X_AJ.rotation * axis * scale;
        match kind {
            JointKind::Revolute => Self { joint, ω: axis, v: X_AJ.translation.vector.cross(&axis) },
            JointKind::Prismatic => Self { joint, ω: Vector3::zeros(), v: axis },
        }
    }

    fn of_point(&self, p: &Vector3<f64>) -> Vector3<f64> {
        self.ω.cross(p) + self.v
    }
}

/// The point p as the stages move it.
pub(super) fn point<const N: usize, const Q: usize, const C: usize>(
    twists: &[Twist],
    p: &Point3<f64>,
) -> Moved<N, Q, C> {
    moved(twists, p.coords, Twist::of_point)
}

/// The direction of any length as the stages turn it.
pub(super) fn direction<const N: usize, const Q: usize, const C: usize>(
    twists: &[Twist],
    p: &Vector3<f64>,
) -> Moved<N, Q, C> {
    moved(twists, *p, |twist, p| twist.ω.cross(p))
}

fn moved<const N: usize, const Q: usize, const C: usize>(
    twists: &[Twist],
    p: Vector3<f64>,
    motion: impl Fn(&Twist, &Vector3<f64>) -> Vector3<f64>,
) -> Moved<N, Q, C> {
    let mut l = [Vector3::zeros(); N];
    let mut q = [Vector3::zeros(); Q];
    let mut t = [Vector3::zeros(); C];
    let mut r = 0.0;
    // How far those further in move the point.
    let mut inner = 0.0;
    let mut outer: f64 = twists.iter().map(|twist| twist.ω.norm()).sum();
    let mut size = 1.0 + p.norm();
    for (c, twist) in twists.iter().enumerate().rev() {
        let slope = motion(twist, &p);
        l[twist.joint] += slope;
        let turn = twist.ω.norm();
        outer = (outer - turn).max(0.0);
        // From c outward, each stage as often as it may be: 1/m! for one that is there m times.
        for b in (0..=c).rev() {
            let second = twists[b].ω.cross(&slope);
            let share = if b == c { 0.5 } else { 1.0 };
            q[place(N, twists[b].joint, twist.joint)] += share * second;
            for a in (0..=b).rev() {
                let third = twists[a].ω.cross(&second);
                let share = if a == b { if b == c { 1.0 / 6.0 } else { 0.5 } } else { share };
                t[place_of_three(N, twists[a].joint, twists[b].joint, twist.joint)] += share * third;
            }
        }
        let speed = slope.norm() + turn * inner;
        let fourths = turn.powi(3) + outer * (4.0 * turn * turn + outer * (6.0 * turn + 4.0 * outer));
        r += fourths * speed / 24.0;
        inner += speed;
        size += speed + twist.v.norm();
    }
    // The lever arms' rounding is that of the twists' own numbers.
    Moved { c: p, l, q, t, r: r * (1.0 + ROUNDING) + ROUNDING * size }
}
