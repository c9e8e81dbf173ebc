//! What the poses were tested against, and what stands in their way.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::feasibility::{Checks, LinkPair, LinkPairs, Rejection};
use crate::problem::Problem;
use crate::robot::Robot;
use crate::sweep::JointSpace;

/// What the poses of a plan were tested for that could be hit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// Two links in each other's way, in candidates that only collisions keep from being views.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Names of the links.
    pub links: [String; 2],
    /// In how many of the candidates looked at they are within the clearance.
    pub count: usize,
    /// How many candidates were looked at.
    pub of: usize,
    /// Least distance in these, m; 0 where they touch.
    pub nearest: f64,
    /// Greatest distance, m.
    pub farthest: f64,
}

/// Candidates that are tried for [`contacts`], and how many of those that collide are looked at.
const TRIED: usize = 200_000;
const LOOKED_AT: usize = 1000;

/// The pairs of links that collide in candidates rejected for collision, those that do most often first.
pub(crate) fn contacts(problem: &Problem, checks: &Checks, space: &JointSpace, candidates: &[usize]) -> Vec<Contact> {
    let tree = &problem.robot.tree;
    let collides = |&id: &usize| -> Option<Vec<f64>> {
        let verdict = checks.view(id, space.configuration(id));
        let collides = matches!(verdict, Err(Rejection::SelfCollision | Rejection::SceneCollision));
        collides.then(|| space.configuration(id))
    };
    let step = candidates.len().div_ceil(TRIED).max(1);
    let tried: Vec<usize> = candidates.iter().copied().step_by(step).collect();
    let mut found: Vec<Vec<f64>> = tried.par_iter().filter_map(collides).collect();
    found.truncate(LOOKED_AT);
    let gaps: Vec<Vec<(LinkPair, f64)>> =
        found.par_iter().map(|q| checks.collision().gaps(&tree.link_poses(q))).collect();
    let contact = |(i, &(pair, _)): (usize, &(LinkPair, f64))| {
        let gaps = gaps.iter().map(|gaps| gaps[i].1.max(0.0));
        Contact {
            links: pair.map(|link| tree.links[link].name.clone()),
            count: gaps.clone().filter(|gap| *gap <= problem.clearance).count(),
            of: found.len(),
            nearest: gaps.clone().fold(f64::INFINITY, f64::min),
            farthest: gaps.fold(0.0, f64::max),
        }
    };
    let mut contacts: Vec<Contact> =
        gaps.first().into_iter().flatten().enumerate().map(contact).filter(|contact| contact.count > 0).collect();
    contacts.sort_by_key(|contact| std::cmp::Reverse(contact.count));
    contacts
}
