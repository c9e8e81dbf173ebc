//! Chains and trees from Denavit–Hartenberg tables.

use nalgebra::{Translation3, UnitQuaternion, Vector3};

use super::{Chain, Joint, JointKind, Limits, Link, Motion, Stage, Tree};
use crate::spatial::Pose;

/// One row of a Denavit–Hartenberg table; lengths in m, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the joint.
    pub name: String,
    /// Which of θ and d the joint value is added to.
    pub kind: JointKind,
    /// Link length, along x (r or a).
    pub a: f64,
    /// Link twist, about x.
    pub alpha: f64,
    /// Link offset, along z.
    pub d: f64,
    /// Joint angle, about z.
    pub theta: f64,
    /// Range of joint values.
    pub limits: Limits,
    /// Largest speed in rad/s or m/s, where known.
    pub max_speed: Option<f64>,
}

/// The order of a row's factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Denavit & Hartenberg 1955: `Rz(θ)·Tz(d)·Tx(a)·Rx(α)`.
    Standard,
    /// Craig 1986: `Rx(α)·Tx(a)·Rz(θ)·Tz(d)`.
    Modified,
}

/// The chain of a table, base first; `X_nF` is the pose of the flange in the last row's frame.
pub fn chain(rows: &[Row], convention: Convention, X_nF: Pose) -> Chain {
    let mut X_before = Pose::identity();
    let mut stages = Vec::with_capacity(rows.len());
    for (joint, row) in rows.iter().enumerate() {
        let (ahead, behind) = row.split(convention);
        let axis = Vector3::z_axis();
        let motion = Motion::Driven { joint, kind: row.kind, axis, multiplier: 1.0, offset: 0.0 };
        stages.push(Stage { X_PJ: X_before * ahead, motion });
        X_before = behind;
    }
    let joint = |row: &Row| Joint::free(row.name.clone(), row.kind, row.limits, row.max_speed);
    Chain { joints: rows.iter().map(joint).collect(), stages, X_nF: X_before * X_nF }
}

/// The links of a table: link 0 is the base, link [`frame_link`]`(i)` is DH frame i (the frame after row i, named after its
/// joint), and the last link is the flange, `X_nF` from the last DH frame. In front of every DH frame stands a link without
/// body or mass that the joint moves, because the row's fixed factors may follow the motion.
pub fn tree(rows: &[Row], convention: Convention, X_nF: Pose) -> Tree {
    let link = |name: String, parent: usize, X_PJ: Pose, motion: Motion| Link {
        name,
        parent: Some(parent),
        X_PJ,
        motion,
        bodies: Vec::new(),
        mass: None,
    };
    let mut links = vec![Link { parent: None, ..link("base".into(), 0, Pose::identity(), Motion::Fixed) }];
    for (joint, row) in rows.iter().enumerate() {
        let (ahead, behind) = row.split(convention);
        let axis = Vector3::z_axis();
        let motion = Motion::Driven { joint, kind: row.kind, axis, multiplier: 1.0, offset: 0.0 };
        links.push(link(format!("{} axis", row.name), links.len() - 1, ahead, motion));
        links.push(link(row.name.clone(), links.len() - 1, behind, Motion::Fixed));
    }
    links.push(link("flange".into(), links.len() - 1, X_nF, Motion::Fixed));
    Tree { links, disabled: Vec::new() }
}

/// Number of the link of [`tree`] that is DH frame `i`: the frame after row i, from 1; 0 is the base.
pub fn frame_link(i: usize) -> usize {
    2 * i
}

impl Row {
    /// The row's fixed factors ahead of and behind the joint's motion about or along z.
    fn split(&self, convention: Convention) -> (Pose, Pose) {
        let about_z = turn(Vector3::z_axis(), self.theta) * Translation3::new(0.0, 0.0, self.d);
        let along_x = Translation3::new(self.a, 0.0, 0.0) * turn(Vector3::x_axis(), self.alpha);
        // Both motions are about or along the same z, so the joint may move ahead of the row's own θ and d.
        match convention {
            Convention::Standard => (Pose::identity(), about_z * along_x),
            Convention::Modified => (along_x, about_z),
        }
    }
}

fn turn(axis: nalgebra::Unit<Vector3<f64>>, angle: f64) -> Pose {
    Pose::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, angle))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{Matrix4, Rotation3, Translation3};

    use super::*;

    fn row(a: f64, alpha: f64, d: f64, theta: f64, kind: JointKind) -> Row {
        Row { name: String::new(), kind, a, alpha, d, theta, limits: Limits { min: -1.0, max: 1.0 }, max_speed: None }
    }

    /// The product of the table's factors as printed in textbooks, with homogeneous matrices.
    fn by_matrices(rows: &[Row], convention: Convention, q: &[f64]) -> Matrix4<f64> {
        rows.iter().zip(q).fold(Matrix4::identity(), |product, (row, &q)| {
            let (dθ, dd) = if row.kind == JointKind::Revolute { (q, 0.0) } else { (0.0, q) };
            let Rz = Rotation3::from_axis_angle(&Vector3::z_axis(), row.theta + dθ).to_homogeneous();
            let Tz = Translation3::new(0.0, 0.0, row.d + dd).to_homogeneous();
            let Tx = Translation3::new(row.a, 0.0, 0.0).to_homogeneous();
            let Rx = Rotation3::from_axis_angle(&Vector3::x_axis(), row.alpha).to_homogeneous();
            product
                * match convention {
                    Convention::Standard => Rz * Tz * Tx * Rx,
                    Convention::Modified => Rx * Tx * Rz * Tz,
                }
        })
    }

    #[test]
    fn both_conventions_equal_their_matrix_products() {
        let rows = [
            row(0.07, PI / 2.0, 0.1, 0.3, JointKind::Revolute),
            row(0.3, -0.4, -0.06, 0.0, JointKind::Prismatic),
            row(0.0, 1.1, 0.06, -PI, JointKind::Revolute),
        ];
        let q = [0.7, 0.25, -1.9];
        for convention in [Convention::Standard, Convention::Modified] {
            let X_BF = chain(&rows, convention, Pose::identity()).flange_pose(&q);
            assert!((X_BF.to_homogeneous() - by_matrices(&rows, convention, &q)).norm() < 1e-14);
            let X_nF = Pose::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, 0.5, 0.6));
            let links = tree(&rows, convention, X_nF).link_poses(&q);
            for i in 0..=rows.len() {
                let frame = by_matrices(&rows[..i], convention, &q);
                assert!((links[frame_link(i)].to_homogeneous() - frame).norm() < 1e-14);
            }
            let X_BF = chain(&rows, convention, X_nF).flange_pose(&q);
            assert!((links.last().unwrap().to_homogeneous() - X_BF.to_homogeneous()).norm() < 1e-14);
        }
    }

    /// The pose of the paper's figure 9; position and view ray computed independently.
    #[test]
    fn servosila_engineer_reaches_figure_9() {
        let mm = 1e-3;
        let rows = [
            row(70.0 * mm, PI / 2.0, 0.0, 0.0, JointKind::Revolute),
            row(300.0 * mm, 0.0, 0.0, 0.0, JointKind::Revolute),
            row(425.0 * mm, 0.0, -60.0 * mm, PI, JointKind::Revolute),
            row(0.0, 0.0, 60.0 * mm, -PI, JointKind::Revolute),
        ];
        // The figure prints the DH angles, offsets added; the joint values are without them.
        let q = [-0.2478, 1.4591, -0.644 - PI, -2.618 + PI];
        let X_BF = chain(&rows, Convention::Standard, Pose::identity()).flange_pose(&q);
        let p = X_BF.translation.vector;
        assert!((p - Vector3::new(0.38284, -0.09686, 0.60744)).norm() < 1e-5, "{p}");
        let axis = X_BF.rotation * Vector3::x();
        let t = (-0.098 - p.z) / axis.z;
        assert!((t - 0.72488).abs() < 1e-5);
        assert!((p + axis * t - Vector3::new(0.22119, -0.05596, -0.098)).norm() < 1e-5);
    }
}
