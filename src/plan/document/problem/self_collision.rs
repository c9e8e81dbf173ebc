//! The pairs of links by what is done about them.

use schemars::JsonSchema;
use serde::Serialize;

use crate::feasibility::{LinkPair, LinkPairs};
use crate::problem::Problem;

/// The pairs of links that have bodies, obstacles among them. Shares and distances are of 1000 random configurations.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SelfCollision {
    /// Least distance that links must keep.
    pub clearance_mm: f64,
    /// Not tested: neighbours.
    pub adjacent: Vec<[String; 2]>,
    /// Not tested: the problem file or the robot's description says so.
    pub ignored: Vec<[String; 2]>,
    /// Not tested: in contact in every configuration.
    pub always_in_contact: Vec<[String; 2]>,
    /// Tested, though within the clearance in none.
    pub never_seen: Vec<[String; 2]>,
    /// Tested and within the clearance in every configuration, though not always in contact.
    pub always_within_clearance: Vec<ClosePair>,
    /// Tested.
    pub tested: Vec<TestedPair>,
}

/// Two links that are always within the clearance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ClosePair {
    /// The links.
    pub links: [String; 2],
    /// Least distance; 0 where they touch.
    pub nearest_mm: f64,
    /// Greatest distance.
    pub farthest_mm: f64,
}

/// Two links that are tested against each other.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TestedPair {
    /// The links.
    pub links: [String; 2],
    /// Share of the configurations in which they are within the clearance.
    pub share: f64,
}

impl SelfCollision {
    /// What is done about `links`, the pairs of the problem's links; `None` for robots without bodies.
    pub fn new(problem: &Problem, links: &LinkPairs) -> Option<Self> {
        if *links == LinkPairs::default() {
            return None;
        }
        let named = |pair: LinkPair| pair.map(|link| problem.robot.tree.links[link].name.clone());
        let all = |pairs: &[LinkPair]| pairs.iter().copied().map(named).collect();
        let never = links.tested.iter().filter(|(_, share)| *share == 0.0);
        let close = links.close.iter().map(|close| ClosePair {
            links: named(close.links),
            nearest_mm: close.nearest * 1e3,
            farthest_mm: close.farthest * 1e3,
        });
        let tested = links.tested.iter().map(|&(pair, share)| TestedPair { links: named(pair), share });
        Some(Self {
            clearance_mm: problem.clearance * 1e3,
            adjacent: all(&links.adjacent),
            ignored: all(&links.disabled),
            always_in_contact: all(&links.always),
            never_seen: never.map(|&(pair, _)| named(pair)).collect(),
            always_within_clearance: close.collect(),
            tested: tested.collect(),
        })
    }
}
