//! What must hold on a robot's way: its links keep apart from each other and from what is around them, and it does not tip over.

use std::ops::Range;

use super::way::{Margins, Measure};
use crate::feasibility::{Collision, LinkPair, Stability};
use crate::robot::{Robot, Tree};

/// By how much less, m, the clearance and the tip-over margin may be on the way than at a pose, up to half of them. The best poses often
/// lie at the very border of what is allowed, and of a way that begins there nothing could be proven. Of a clearance of 0 nothing is spared.
const SLACK: f64 = 1e-3;

/// What must hold on a robot's way, as far as it is tested.
#[derive(Debug, Clone, Copy)]
pub struct Safety<'a> {
    tree: &'a Tree,
    collision: &'a Collision,
    /// None where no link has a mass.
    stability: Option<&'a Stability>,
}

/// What a margin is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Danger {
    /// Two links, by their numbers in the tree: their distance less the clearance that they keep on the way.
    Contact(LinkPair),
    /// The robot's balance: its tip-over margin less the least allowed on the way.
    TippingOver,
}

impl<'a> Safety<'a> {
    /// Of a robot, by its tests.
    pub fn new(robot: &'a Robot, collision: &'a Collision, stability: Option<&'a Stability>) -> Self {
        let has_mass = robot.tree.links.iter().any(|link| link.mass.is_some_and(|point| point.mass > 0.0));
        Self { tree: &robot.tree, collision, stability: stability.filter(|_| has_mass) }
    }

    /// Whether nothing is tested.
    pub fn is_empty(&self) -> bool {
        self.collision.is_empty() && self.stability.is_none()
    }

    /// What the margin of that number is of.
    pub fn danger(&self, margin: usize) -> Danger {
        let tested = &self.collision.links().tested;
        tested.get(margin).map_or(Danger::TippingOver, |&(pair, _)| Danger::Contact(pair))
    }

    /// The margins of one kind after the other, those that there are: a proof is as fine as the least margin wants it, and how far links
    /// keep apart is worth knowing where the balance is touch and go.
    pub fn kinds(&self) -> Vec<MarginKind<'_>> {
        let pairs = self.collision.links().tested.len();
        let contact = MarginKind { safety: self, margins: 0..pairs, kept: kept(self.collision.clearance()) };
        let balance = self.stability.map(|stability| MarginKind {
            safety: self,
            margins: pairs..pairs + 1,
            kept: kept(stability.margin),
        });
        // Pairs of links without solids are never near each other.
        let contact = Some(contact).filter(|_| !self.collision.is_empty());
        contact.into_iter().chain(balance).collect()
    }
}

/// The margins of one kind, numbered from 0: the distances of links, or the balance.
#[derive(Debug, Clone)]
pub struct MarginKind<'a> {
    safety: &'a Safety<'a>,
    margins: Range<usize>,
    /// What is kept of the distances or of the tip-over margin, m.
    kept: f64,
}

impl MarginKind<'_> {
    /// Whether it is the balance.
    pub fn is_balance(&self) -> bool {
        self.danger(0) == Danger::TippingOver
    }

    /// How many margins there are of it, one at least.
    pub fn count(&self) -> usize {
        self.margins.len()
    }

    /// What its margin of that number is of.
    pub fn danger(&self, margin: usize) -> Danger {
        self.safety.danger(self.margins.start + margin)
    }

    /// The distance, or tip-over margin, m, that goes with a margin.
    pub fn distance(&self, margin: f64) -> f64 {
        margin + self.kept
    }
}

impl Margins for MarginKind<'_> {
    fn at<'q>(&'q self, q: &'q [f64]) -> Measure<'q> {
        let measure = self.safety.at(q);
        Box::new(move |margin, enough| measure(self.margins.start + margin, enough))
    }

    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        self.safety.changes(from, to)[self.margins.clone()].to_vec()
    }
}

/// What is kept on the way of a distance that poses keep, m.
fn kept(of_poses: f64) -> f64 {
    of_poses - SLACK.min(0.5 * of_poses.max(0.0))
}

impl Margins for Safety<'_> {
    fn at<'q>(&'q self, q: &'q [f64]) -> Measure<'q> {
        let X_BL = self.tree.link_poses(q);
        let placed = self.collision.placed(&X_BL);
        Box::new(move |margin, enough| match (self.danger(margin), self.stability) {
            (Danger::Contact(_), _) => {
                let clearance = kept(self.collision.clearance());
                placed.gap(margin, enough + clearance) - clearance
            }
            (Danger::TippingOver, Some(stability)) => {
                stability.margin_at(self.tree, &X_BL).map_or(f64::NAN, |found| found - kept(stability.margin))
            }
            (Danger::TippingOver, None) => f64::NAN,
        })
    }

    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let mut changes = self.collision.changes(self.tree, from, to);
        changes.extend(self.stability.map(|stability| stability.change(self.tree, from, to)));
        changes
    }
}
