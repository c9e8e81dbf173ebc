//! RRT-Connect (Kuffner and `LaValle` 2000): two trees of safe moves, from the start and from the goal, grow by turns towards
//! random configurations and towards each other.
//!
//! Every move is proven when it is made. To prove only those of the way found (Bohlin and Kavraki 2000) could save little: of all
//! configurations measured for a way of six joints among boxes, a fourth is measured in the search, the others to shorten it and
//! to bound its margins.

use rand::Rng;

use super::between;
use super::scout::Scout;
use super::tree::Tree;
use crate::robot::Limits;

/// Most that a move of a tree costs, as a share of what it costs to move all joints from end to end. From 0.05 to 0.3 it matters
/// little.
const STEP: f64 = 0.1;

/// The corners of a safe way, if the trees meet within the effort allowed; else how many configurations either tree has.
pub(super) fn connect(scout: &mut Scout, from: &[f64], to: &[f64]) -> Result<Vec<Vec<f64>>, [usize; 2]> {
    let limits = scout.space.limits;
    let end = |value: fn(&Limits) -> f64| limits.iter().map(value).collect::<Vec<_>>();
    let step = STEP * scout.cost(&end(|joint| joint.min), &end(|joint| joint.max));
    let mut trees = [Tree::rooted(from), Tree::rooted(to)];
    for turn in [0, 1].into_iter().cycle() {
        if scout.is_exhausted() {
            break;
        }
        let [start, goal] = &mut trees;
        let (grown, other) = if turn == 0 { (start, goal) } else { (goal, start) };
        let target = sample(scout);
        let near = grown.nearest(&target, scout.space.cost);
        if let Some(tip) = advance(scout, grown, near, &target, step)
            && let Some(met) = reach(scout, other, grown.at(tip), step)
        {
            return Ok(if turn == 0 { joined(grown, tip, other, met) } else { joined(other, met, grown, tip) });
        }
    }
    Err(trees.map(|tree| tree.len()))
}

/// From the root of one tree to the place where it meets the other, and on to the root of that.
fn joined(start: &Tree, tip: usize, goal: &Tree, met: usize) -> Vec<Vec<f64>> {
    let (mut way, mut rest) = (start.branch(tip), goal.branch(met));
    rest.pop();
    way.extend(rest.into_iter().rev());
    way
}

/// A random configuration within the limits. To draw more of them about the ends or about the trees found ways neither sooner nor
/// shorter.
fn sample(scout: &mut Scout) -> Vec<f64> {
    let mut value = |limits: &Limits| limits.min + (limits.max - limits.min) * scout.rng.r#gen::<f64>();
    scout.space.limits.iter().map(&mut value).collect()
}

/// Grows a tree by a move from one of its nodes towards the target; the new node, unless the move is not safe or the effort
/// spent.
fn advance(scout: &mut Scout, tree: &mut Tree, node: usize, target: &[f64], step: f64) -> Option<usize> {
    let from = tree.at(node);
    let share = step / scout.cost(from, target);
    let to = if share < 1.0 { between(from, target, share) } else { target.to_vec() };
    if scout.is_exhausted() || !scout.is_safe(from, &to) {
        return None;
    }
    scout.effort.nodes += 1;
    Some(tree.add(node, to))
}

/// Grows a tree from its nearest node to the target, move by move; its node there, if it gets there.
fn reach(scout: &mut Scout, tree: &mut Tree, target: &[f64], step: f64) -> Option<usize> {
    let mut node = tree.nearest(target, scout.space.cost);
    while tree.at(node) != target {
        node = advance(scout, tree, node, target, step)?;
    }
    Some(node)
}
