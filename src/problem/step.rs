//! The same problem on another grid.

use thiserror::Error;

use super::{Problem, most_configurations};
use crate::robot::JointKind;
use crate::sweep::{JointGrid, JointSpace};

/// Why a step makes no grid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StepError {
    /// The step is not a number large enough to count with.
    #[error("a step of {:.6}° makes no grid; it must be greater than 10⁻⁷ degrees", step.to_degrees())]
    NotPositive {
        /// The step in rad.
        step: f64,
    },
    /// A prismatic joint has no step to keep, because the problem sweeps a sample.
    #[error("joint {joint} is prismatic and the problem file gives no `step_mm` for it")]
    Prismatic {
        /// Name of the joint.
        joint: String,
    },
    /// The grid is too large.
    #[error("a step of {:.6}° makes {configurations} configurations, more than the {most} allowed", step.to_degrees())]
    TooManyConfigurations {
        /// The step in rad.
        step: f64,
        /// How many; saturating.
        configurations: usize,
        /// How many are allowed.
        most: usize,
    },
}

impl Problem {
    /// The same problem on the grid with `step` (rad) for every revolute joint; prismatic joints keep their steps.
    ///
    /// # Errors
    /// When the step is not positive, the grid too large, or a prismatic joint has no step.
    pub fn with_step(&self, step: f64) -> Result<Self, StepError> {
        // Below this the counts themselves might overflow.
        if !(step.is_finite() && step > 1e-9) {
            return Err(StepError::NotPositive { step });
        }
        let joints = &self.robot.chain.joints;
        let mut steps = vec![step; joints.len()];
        for (i, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.kind == JointKind::Prismatic) {
            steps[i] = match &self.space {
                JointSpace::Grid(grid) => grid.steps()[i],
                JointSpace::Sample(_) => return Err(StepError::Prismatic { joint: joint.name.clone() }),
            };
        }
        let grid = JointGrid::new(&self.robot.spans(), &steps);
        let (configurations, most) = (grid.len(), most_configurations(self.axis));
        if configurations > most {
            return Err(StepError::TooManyConfigurations { step, configurations, most });
        }
        Ok(Self { space: JointSpace::Grid(grid), ..self.clone() })
    }
}
