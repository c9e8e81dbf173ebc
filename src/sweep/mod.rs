//! The sweep: which joint configurations point the camera at the marker zone.
//!
//! A configuration's pose is a product of one transform per stage of the chain. The sweep splits the grid in two: the outer joints'
//! products are *prefixes*, each computed once, the inner joints' products are *suffixes*, tabulated once for the whole
//! sweep. What is left per configuration is one 3×3 matrix times two vectors, the camera's position and its optical
//! axis, in the target's frame, where the plane is z = 0.

mod joints;

pub use joints::{GridError, HaltonSample, JointGrid, JointSpace};

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::robot::{Motion, Robot, Stage, product};
use crate::spatial::Pose;
use crate::target::{AxisCase, Target, Zone};

/// Which configurations the sweep keeps as candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisRule {
    /// All of them, wherever the optical axis goes.
    Any,
    /// Those whose optical axis meets the zone, border included: the paper's test.
    Zone,
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sweep {
    /// Configurations swept.
    pub swept: usize,
    /// How many axes fell inside the zone.
    pub inside: usize,
    /// How many fell on its edge.
    pub edge: usize,
    /// The configurations kept, in ascending order: indices into the joint space.
    pub candidates: Vec<usize>,
}

impl Sweep {
    /// How many configurations' axes miss the zone.
    pub fn outside(&self) -> usize {
        self.swept - self.inside - self.edge
    }
}

/// Suffix tables stay within the processor's first-level cache: 512 × 6 × 8 bytes.
const MOST_SUFFIXES: usize = 512;

/// Sweeps `space` and keeps the configurations that `rule` asks for. The result does not depend on the number of
/// threads. `observe` is told, from any thread, how many configurations have been swept since it was last called.
pub fn sweep(
    robot: &Robot,
    target: &Target,
    space: &JointSpace,
    rule: AxisRule,
    observe: &(dyn Fn(usize) + Sync),
) -> Sweep {
    let X_TB = target.X_BT.inverse();
    let parts: Vec<Sweep> = match space {
        JointSpace::Grid(grid) => {
            let split = Split::of(robot, grid);
            (0..split.prefixes)
                .into_par_iter()
                .with_min_len(16)
                .fold(Sweep::empty, |mut found, prefix| {
                    let X_TP = X_TB * split.prefix_pose(robot, grid, prefix);
                    split.suffixes.meet(&X_TP, &target.zone, rule, prefix * split.suffixes.len(), &mut found);
                    observe(split.suffixes.len());
                    found
                })
                .collect()
        }
        JointSpace::Sample(_) => (0..space.len())
            .into_par_iter()
            .with_min_len(256)
            .fold(Sweep::empty, |mut found, id| {
                let mut one = Suffixes::default();
                one.push(&robot.camera_pose(&space.configuration(id)));
                one.meet(&X_TB, &target.zone, rule, id, &mut found);
                observe(1);
                found
            })
            .collect(),
    };
    parts.into_iter().fold(Sweep::empty(), Sweep::followed_by)
}

/// A grid divided into outer joints (prefix) and inner joints (suffix).
struct Split {
    /// Number of stages that the outer joints drive.
    outer: usize,
    prefixes: usize,
    suffixes: Suffixes,
}

impl Split {
    fn of(robot: &Robot, grid: &JointGrid) -> Self {
        let chain = &robot.chain;
        let counts = grid.counts();
        let mut joints = counts.len();
        let mut size = 1;
        while joints > 0 && size * counts[joints - 1] <= MOST_SUFFIXES {
            joints -= 1;
            size *= counts[joints];
        }
        // A joint that others mimic may drive stages on both sides; then more joints are outer, at worst all.
        let mut outer = stages_before(&chain.stages, joints);
        while outer.is_none() && joints < counts.len() {
            size /= counts[joints];
            joints += 1;
            outer = stages_before(&chain.stages, joints);
        }
        let outer = outer.unwrap_or(chain.stages.len());
        let X_nC = chain.X_nF * robot.X_FC;
        let mut suffixes = Suffixes::default();
        for j in 0..size {
            let q = grid.configuration(j); // prefix 0: the inner joints' digits are those of j
            suffixes.push(&(product(&chain.stages[outer..], &q) * X_nC));
        }
        Self { outer, prefixes: counts[..joints].iter().product(), suffixes }
    }

    fn prefix_pose(&self, robot: &Robot, grid: &JointGrid, prefix: usize) -> Pose {
        product(&robot.chain.stages[..self.outer], &grid.configuration(prefix * self.suffixes.len()))
    }
}

/// How many stages the first `joints` joints drive, if these stages all come before the others.
fn stages_before(stages: &[Stage], joints: usize) -> Option<usize> {
    let is_outer = |stage: &Stage| matches!(stage.motion, Motion::Driven { joint, .. } if joint < joints);
    let outer = stages.iter().take_while(|stage| is_outer(stage)).count();
    (!stages[outer..].iter().any(is_outer)).then_some(outer)
}

/// Camera positions and optical axes behind the prefix, coordinate by coordinate so that the compiler can use vector
/// instructions.
#[derive(Default)]
struct Suffixes {
    position: [Vec<f64>; 3],
    axis: [Vec<f64>; 3],
}

impl Suffixes {
    fn len(&self) -> usize {
        self.position[0].len()
    }

    fn push(&mut self, X_PC: &Pose) {
        let z_C = X_PC.rotation * Vector3::z();
        for i in 0..3 {
            self.position[i].push(X_PC.translation.vector[i]);
            self.axis[i].push(z_C[i]);
        }
    }

    /// Intersects every view ray with the target's plane and files it under its case.
    fn meet(&self, X_TP: &Pose, zone: &Zone, rule: AxisRule, first_id: usize, found: &mut Sweep) {
        let R: Matrix3<f64> = X_TP.rotation.to_rotation_matrix().into_inner();
        let t = X_TP.translation.vector;
        let n = self.len();
        let [px, py, pz] = self.position.each_ref().map(|v| &v[..n]);
        let [ax, ay, az] = self.axis.each_ref().map(|v| &v[..n]);
        let (half_width, half_height) = (zone.width / 2.0, zone.height / 2.0);
        found.swept += n;
        for j in 0..n {
            let row = |i: usize, x: f64, y: f64, z: f64| R[(i, 0)] * x + R[(i, 1)] * y + R[(i, 2)] * z;
            let z = row(2, px[j], py[j], pz[j]) + t.z;
            let fall = -row(2, ax[j], ay[j], az[j]);
            // The plane lies ahead when height and fall have one sign; |s·fall| compares without the division.
            let x = (row(0, px[j], py[j], pz[j]) + t.x) * fall + row(0, ax[j], ay[j], az[j]) * z;
            let y = (row(1, px[j], py[j], pz[j]) + t.y) * fall + row(1, ax[j], ay[j], az[j]) * z;
            let near = z * fall > 0.0
                && x.abs() <= half_width * fall.abs() * SLACK
                && y.abs() <= half_height * fall.abs() * SLACK;
            if near {
                match zone.case(x / fall, y / fall) {
                    AxisCase::Inside => found.inside += 1,
                    AxisCase::Edge => found.edge += 1,
                    AxisCase::Outside => continue,
                }
                if rule == AxisRule::Zone {
                    found.candidates.push(first_id + j);
                }
            }
        }
        if rule == AxisRule::Any {
            found.candidates.extend(first_id..first_id + n);
        }
    }
}

/// The test without division lets through a little more than the zone; [`Zone::case`] decides.
const SLACK: f64 = 1.0 + 1e-12;

impl Sweep {
    fn empty() -> Self {
        Self { swept: 0, inside: 0, edge: 0, candidates: Vec::new() }
    }

    fn followed_by(mut self, next: Self) -> Self {
        self.swept += next.swept;
        self.inside += next.inside;
        self.edge += next.edge;
        self.candidates.extend(next.candidates);
        self
    }
}
