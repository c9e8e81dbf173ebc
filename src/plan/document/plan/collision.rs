//! What the poses of a plan were tested against.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::feasibility::LinkPairs;
use crate::problem::Problem;
use crate::robot::Robot;

/// What the poses of a plan were tested for that could be hit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CollisionDocument {
    /// Whether any pair of links was tested. If not, the poses may drive the robot into itself, the board or what stands around
    /// it.
    pub tested: bool,
    /// Least distance between links, and of links from obstacles.
    pub clearance_m: f64,
    /// Names of the obstacles around the robot. Where there are none the robot's surroundings were not looked at.
    pub scene: Vec<String>,
    /// Names of the joints whose moving part, up to the next joint, has no body and was not tested.
    pub joints_without_bodies: Vec<String>,
    /// Pairs of links that were not tested because they were in contact in every random configuration.
    pub always_in_contact: Vec<[String; 2]>,
}

impl CollisionDocument {
    /// What `links`, the pairs of the problem's links, are tested for.
    pub fn new(problem: &Problem, links: &LinkPairs) -> Self {
        let Robot { tree, obstacles, .. } = &problem.robot;
        let name = |link: usize| tree.links[link].name.clone();
        Self {
            tested: !links.tested.is_empty(),
            clearance_m: problem.clearance,
            scene: obstacles.iter().map(|&link| name(link)).collect(),
            joints_without_bodies: problem.robot.joints_without_bodies().map(|joint| joint.name.clone()).collect(),
            always_in_contact: links.always.iter().map(|pair| pair.map(name)).collect(),
        }
    }
}
