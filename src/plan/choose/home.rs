//! Whether the robot can be at its home.

use super::error::PlanError;
use crate::feasibility::Collision;
use crate::motion::{Danger, Safety, way};
use crate::problem::Problem;

/// That at the home of the tour, if there is one, tested links keep what they keep on the way, and the robot too.
///
/// # Errors
/// When it is not so.
pub fn home_is_safe(problem: &Problem) -> Result<(), PlanError> {
    let Some(home) = &problem.motion.home else { return Ok(()) };
    let collision = Collision::new(&problem.robot, problem.clearance);
    let safety = Safety::new(&problem.robot, &collision, problem.stability.as_ref());
    let at_rest = way::prove(&safety, &home.q, &home.q, way::Precision::VERDICT);
    at_rest.map(|_| ()).map_err(|failure| PlanError::UnsafeHome {
        links: match safety.danger(failure.place.margin) {
            Danger::Contact(links) => Some(links.map(|link| problem.robot.tree.links[link].name.clone())),
            Danger::TippingOver => None,
        },
    })
}
