//! Where to start looking for a configuration that takes a requested camera pose.

use crate::problem::Problem;
use crate::robot::Starts;

/// Most configurations of the joint space that are looked at.
const MOST: usize = 20_000;

/// Configurations of the problem's joint space, all over it, for [`crate::robot::reach`] to start from.
pub fn reach_starts(problem: &Problem) -> Starts {
    let space = &problem.space;
    let total = space.len();
    let configurations = if total <= MOST {
        (0..total).map(|id| space.configuration(id)).collect()
    } else {
        // Golden-section steps: an even stride would be in step with a grid and see one value of the inner joints.
        let id = |i: usize| ((i as f64 * 0.618_033_988_749_895).fract() * total as f64) as usize;
        (0..MOST).map(|i| space.configuration(id(i))).collect()
    };
    Starts::new(&problem.robot, configurations)
}
