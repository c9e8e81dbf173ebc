//! Which links stand in the way of candidates.

use rayon::prelude::*;

use crate::feasibility::{Checks, LinkPair, Rejection};
use crate::problem::Problem;
use crate::sweep::{Candidates, JointSpace};

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
pub(crate) fn contacts(
    problem: &Problem,
    checks: &Checks,
    space: &JointSpace,
    candidates: &Candidates,
) -> Vec<Contact> {
    let tree = &problem.robot.tree;
    let collides = |&id: &usize| -> Option<Vec<f64>> {
        let q = space.configuration(id);
        let verdict = checks.view(id, &q);
        matches!(verdict, Err(Rejection::SelfCollision | Rejection::SceneCollision)).then_some(q)
    };
    let step = candidates.len().div_ceil(TRIED).max(1);
    let tried: Vec<usize> = candidates.iter().step_by(step).collect();
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
