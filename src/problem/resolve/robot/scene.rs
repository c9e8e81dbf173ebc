//! What stands around the robot.

use crate::problem::fault::Reason;
use crate::problem::resolve::check::Check;
use crate::problem::schema;
use crate::problem::text::{At, key};
use crate::robot::Robot;
use crate::spatial::Pose;

/// Names of the links that are attached for the camera's housing and the board.
const RESERVED: [&str; 2] = ["camera", "board"];

impl Check<'_, '_> {
    /// Puts the obstacles of `scene` around `robot`: links of its tree, fixed to the root, in the root's frame.
    pub(in crate::problem::resolve) fn scene(&mut self, scene: &At<schema::Scene>, mut robot: Option<&mut Robot>) {
        let own = robot.as_ref().map_or(0, |robot| robot.tree.links.len());
        for obstacle in key!(scene, bodies).elements() {
            let at = key!(obstacle, name);
            let name = at.value.trim();
            let links = robot.as_ref().map(|robot| &robot.tree.links[..own]).unwrap_or_default();
            if name.is_empty() {
                self.fault(&at.path, Reason::Empty);
            } else if RESERVED.contains(&name) || links.iter().any(|link| link.name == name) {
                self.fault(&at.path, Reason::Taken { name: name.into() });
            }
            let body = self.body(&obstacle.with(&obstacle.value.body()));
            let (Some(robot), Some(body)) = (robot.as_deref_mut(), body) else { continue };
            match robot.tree.links[own..].iter_mut().find(|link| link.name == name) {
                Some(link) => link.bodies.push(body),
                None => robot.obstacles.push(robot.tree.attach(name, 0, Pose::identity(), body)),
            }
        }
    }
}
