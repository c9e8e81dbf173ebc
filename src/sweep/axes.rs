//! Optical axes, and where they meet the target's plane.

use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};

use super::{AxisRule, Sweep};
use crate::spatial::Pose;
use crate::target::{AxisCase, Zone};

/// Axes that are looked at together: as many as a register of AVX2 has numbers.
const LANES: usize = 4;

/// Camera positions and optical axes in a frame P, coordinate by coordinate and [`LANES`] at a time, so that the compiler uses
/// vector instructions.
#[derive(Default)]
pub(super) struct Axes {
    len: usize,
    blocks: Vec<Block>,
}

/// Axes that are missing in the last block have no direction, and so meet no plane.
#[derive(Clone, Copy, Default)]
struct Block {
    position: [[f64; LANES]; 3],
    axis: [[f64; LANES]; 3],
}

/// The test without division lets through a little more than the zone; [`Zone::case`] decides.
const SLACK: f64 = 1.0 + 1e-12;

impl Axes {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn push(&mut self, X_PC: &Pose) {
        let lane = self.len % LANES;
        if lane == 0 {
            self.blocks.push(Block::default());
        }
        if let Some(block) = self.blocks.last_mut() {
            let z_C = X_PC.rotation * Vector3::z();
            for i in 0..3 {
                block.position[i][lane] = X_PC.translation.vector[i];
                block.axis[i][lane] = z_C[i];
            }
        }
        self.len += 1;
    }

    /// Intersects every axis with the target's plane, where P is at `X_TP`, and files it under its case. They are numbered from
    /// `first_id` on.
    pub(super) fn meet(
        &self,
        arch: Arch,
        X_TP: &Pose,
        zone: &Zone,
        rule: AxisRule,
        first_id: usize,
        found: &mut Sweep,
    ) {
        let R = X_TP.rotation.to_rotation_matrix().into_inner();
        let t = X_TP.translation.vector;
        arch.dispatch(Meeting { axes: self, R, t, zone, rule, first_id, found: &mut *found });
        found.swept += self.len;
        if rule == AxisRule::Any {
            found.candidates.push(first_id..first_id + self.len);
        }
    }
}

/// The inner loop of the sweep, compiled for every set of instructions that [`Arch`] tells apart. No product is fused with a sum:
/// every processor rounds alike and finds the same.
struct Meeting<'a> {
    axes: &'a Axes,
    R: Matrix3<f64>,
    t: Vector3<f64>,
    zone: &'a Zone,
    rule: AxisRule,
    first_id: usize,
    found: &'a mut Sweep,
}

impl WithSimd for Meeting<'_> {
    type Output = ();

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "only so is it compiled for each set of instructions")]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { axes, R, t, zone, rule, first_id, found } = self;
        let (half_width, half_height) = (zone.width / 2.0, zone.height / 2.0);
        let row =
            |i: usize, v: &[[f64; LANES]; 3], l: usize| R[(i, 0)] * v[0][l] + R[(i, 1)] * v[1][l] + R[(i, 2)] * v[2][l];
        for (b, Block { position, axis }) in axes.blocks.iter().enumerate() {
            let (mut z, mut fall, mut ahead) = ([0.0; LANES], [0.0; LANES], [false; LANES]);
            for l in 0..LANES {
                z[l] = row(2, position, l) + t.z;
                fall[l] = -row(2, axis, l);
                // The plane lies ahead when height and fall have one sign.
                ahead[l] = z[l] * fall[l] > 0.0;
            }
            if ahead == [false; LANES] {
                continue;
            }
            let (mut x, mut y, mut near) = ([0.0; LANES], [0.0; LANES], [false; LANES]);
            for l in 0..LANES {
                x[l] = (row(0, position, l) + t.x) * fall[l] + row(0, axis, l) * z[l];
                y[l] = (row(1, position, l) + t.y) * fall[l] + row(1, axis, l) * z[l];
                // |s·fall| compares without the division.
                near[l] = ahead[l]
                    & (x[l].abs() <= half_width * fall[l].abs() * SLACK)
                    & (y[l].abs() <= half_height * fall[l].abs() * SLACK);
            }
            if near == [false; LANES] {
                continue;
            }
            for l in (0..LANES).filter(|&l| near[l]) {
                match zone.case(x[l] / fall[l], y[l] / fall[l]) {
                    AxisCase::Inside => found.inside += 1,
                    AxisCase::Edge => found.edge += 1,
                    AxisCase::Outside => continue,
                }
                if rule == AxisRule::Zone {
                    let id = first_id + b * LANES + l;
                    found.candidates.push(id..id + 1);
                }
            }
        }
    }
}
