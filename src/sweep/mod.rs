//! The sweep: which joint configurations point the camera at the marker zone.
//!
//! A configuration's pose is a product of one transform per stage of the chain. The sweep splits the grid in two: the outer joints'
//! products are *prefixes*, each computed once, the inner joints' products are *suffixes*, tabulated once for the whole
//! sweep. What is left per configuration is one 3×3 matrix times two vectors, the camera's position and its optical
//! axis, in the target's frame, where the plane is z = 0.

mod axes;
mod candidates;
mod joints;

pub use candidates::Candidates;
pub use joints::{GridError, HaltonSample, JointGrid, JointSpace};

use pulp::Arch;
use rayon::prelude::*;

use crate::robot::{Motion, Robot, Stage, product};
use crate::spatial::Pose;
use crate::target::Target;
use axes::Axes;

/// Which configurations the sweep keeps as candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisRule {
    /// All of them, wherever the optical axis goes.
    Any,
    /// Those whose optical axis meets the zone, border included: the paper's test.
    Zone,
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sweep {
    /// Configurations swept.
    pub swept: usize,
    /// How many axes fell inside the zone.
    pub inside: usize,
    /// How many fell on its edge.
    pub edge: usize,
    /// The configurations kept.
    pub candidates: Candidates,
}

impl Sweep {
    /// How many configurations' axes miss the zone.
    pub fn outside(&self) -> usize {
        self.swept - self.inside - self.edge
    }
}

/// Axes that are looked at in a row stay within the processor's first-level cache: 512 × 6 × 8 bytes.
const MOST_AXES: usize = 512;

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
    let arch = Arch::new();
    let parts: Vec<Sweep> = match space {
        JointSpace::Grid(grid) => {
            let split = Split::of(robot, grid);
            (0..split.prefixes)
                .into_par_iter()
                .with_min_len(16)
                .fold(Sweep::default, |mut found, prefix| {
                    let X_TP = X_TB * split.prefix_pose(robot, grid, prefix);
                    let first_id = prefix * split.suffixes.len();
                    split.suffixes.meet(arch, &X_TP, &target.zone, rule, first_id, &mut found);
                    observe(split.suffixes.len());
                    found
                })
                .collect()
        }
        JointSpace::Sample(sample) => (0..space.len().div_ceil(MOST_AXES))
            .into_par_iter()
            .fold(Sweep::default, |mut found, part| {
                let ids = part * MOST_AXES..space.len().min((part + 1) * MOST_AXES);
                let first_id = ids.start;
                let mut axes = Axes::default();
                sample.visit(ids, |_, q| axes.push(&robot.camera_pose(q)));
                axes.meet(arch, &X_TB, &target.zone, rule, first_id, &mut found);
                observe(axes.len());
                found
            })
            .collect(),
    };
    parts.into_iter().fold(Sweep::default(), Sweep::followed_by)
}

/// A grid divided into outer joints (prefix) and inner joints (suffix).
struct Split {
    /// Number of stages that the outer joints drive.
    outer: usize,
    prefixes: usize,
    suffixes: Axes,
}

impl Split {
    fn of(robot: &Robot, grid: &JointGrid) -> Self {
        let chain = &robot.chain;
        let counts = grid.counts();
        let mut joints = counts.len();
        let mut size = 1;
        while joints > 0 && size * counts[joints - 1] <= MOST_AXES {
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
        let mut suffixes = Axes::default();
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

impl Sweep {
    fn followed_by(mut self, next: Self) -> Self {
        self.swept += next.swept;
        self.inside += next.inside;
        self.edge += next.edge;
        self.candidates.append(next.candidates);
        self
    }
}
