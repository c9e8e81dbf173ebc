//! Branch and bound: the best set, proven.
//!
//! A node fixes some candidates in and some out and bounds the rest by its relaxation. Three things shrink the tree:
//! reduced costs, by which a node's own scores fix further candidates; the incumbent, which prunes every node whose bound
//! does not exceed it; and the best bound first. Nodes are worked on in batches of fixed size, in parallel within a batch, so
//! that the search is the same on any number of threads.

mod fewest;
mod node;

pub use fewest::{Fewest, NotEnough, Refutation, fewest};

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::best::{Best, ascending, best, first_allowed};
use super::best_first::BestFirst;
use super::error::SelectionError;
use super::exchange::improved;
use super::greedy;
use super::instance::{Instance, Part};
use super::relaxation::{Relaxation, RelaxationSettings, greatest, relax};
use node::{Ladder, Relaxed};

/// Nodes worked on at a time.
const BATCH: usize = 32;

/// A gap in log Φ below which a bound and a value are the same.
const SAME: f64 = 1e-9;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchEnd {
    /// The selection is proven to be the best.
    Optimal,
    /// The node limit was reached.
    NodeLimit,
    /// The observer stopped the search.
    Stopped,
}

/// Where a search stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchProgress {
    /// Nodes worked on.
    pub nodes: usize,
    /// Nodes waiting.
    pub open: usize,
    /// log Φ of the best selection so far.
    pub log_value: f64,
    /// No selection has a greater log Φ.
    pub log_bound: f64,
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// The best selection found, ascending.
    pub selected: Vec<usize>,
    /// Its log Φ.
    pub log_value: f64,
    /// No selection has a greater log Φ; at [`SearchEnd::Optimal`] to within 10⁻⁹ the same.
    pub log_bound: f64,
    /// Nodes worked on.
    pub nodes: usize,
    /// Candidates that reduced costs left open at the root.
    pub open_at_root: usize,
    /// How it ended.
    pub end: SearchEnd,
}

/// A part of the search space.
#[derive(Debug, Clone)]
struct Node {
    /// Candidates fixed in, the required ones among them.
    included: Vec<usize>,
    /// Candidates neither in nor out, ascending.
    open: Vec<usize>,
    /// Weights of the open ones to start from.
    weights: Vec<f64>,
    log_bound: f64,
}

/// The start of a search: [`best`]; where all that it tries is singular, a selection of log Φ = −∞ and the relaxation from more
/// candidates.
///
/// # Errors
/// When no allowed set was found, or no set of so many can determine all parameters.
pub fn start_of_search(instance: &Instance, settings: &RelaxationSettings, seed: u64) -> Result<Best, SelectionError> {
    match best(instance, settings, seed) {
        Err(error @ SelectionError::Unobservable { .. }) if instance.can_be_regular() => {
            let selected = improved(instance, greedy::start(instance)?);
            let relaxation = relaxed_from_many(instance, settings).ok_or(error)?;
            Ok(Best { selected, log_value: f64::NEG_INFINITY, relaxation })
        }
        result => result,
    }
}

/// The relaxation from equal weights on evenly spaced candidates, as many as determine all parameters.
fn relaxed_from_many(instance: &Instance, settings: &RelaxationSettings) -> Option<Relaxation> {
    let mut many = instance.count();
    loop {
        many = (2 * many).min(instance.len());
        let spaced: Vec<usize> = (0..many).map(|c| c * instance.len() / many).collect();
        let relaxation = relax(instance, &spaced, settings).ok();
        if relaxation.is_some() || many == instance.len() {
            return relaxation;
        }
    }
}

/// Searches for the best selection, starting from `start`, until it is proven, `node_limit` nodes are worked on, or
/// `observe` breaks. Selections whose log Φ is below `least_wanted` are of no interest and count as impossible.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use calipose::selection::{
///     InformationFunction, InformationSet, Instance, RelaxationSettings, SearchEnd, search, start_of_search,
/// };
/// use nalgebra::DMatrix;
///
/// let along = |x: f64, y: f64| DMatrix::from_row_slice(2, 2, &[x * x, x * y, x * y, y * y]);
/// let views = InformationSet::from_matrices(2, &[along(2.0, 0.0), along(0.0, 2.0), along(1.0, 1.0)])?;
/// let instance = Instance::new(&views, None, &InformationFunction::Determinant, 2)?;
/// let start = start_of_search(&instance, &RelaxationSettings::default(), 0)?;
/// let found = search(&instance, &start, f64::NEG_INFINITY, 1000, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!((found.selected, found.end), (vec![0, 1], SearchEnd::Optimal));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the start is not one of this instance.
pub fn search(
    instance: &Instance,
    start: &Best,
    least_wanted: f64,
    node_limit: usize,
    observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
) -> Result<Search, SelectionError> {
    start.fits(instance)?;
    let mut root = root(instance, start, start.log_value.max(least_wanted) + SAME);
    let mut incumbent = (start.log_value, start.selected.clone());
    let in_question = root.open.iter().chain(instance.required()).chain(&incumbent.1);
    let mut found = if 2 * root.open.len() > instance.len() {
        searched(instance, root, incumbent, least_wanted, node_limit, observe)
    } else {
        // Nodes look at these candidates alone.
        let part = Part::new(instance, ascending(in_question.copied()));
        (root.included, root.open) = (part.places(&root.included), part.places(&root.open));
        incumbent.1 = part.places(&incumbent.1);
        let mut found = searched(&part.instance(), root, incumbent, least_wanted, node_limit, observe);
        found.selected = part.members(&found.selected);
        found
    };
    found.log_bound = found.log_bound.min(start.relaxation.certificate.log_bound);
    Ok(found)
}

/// The search below a `root`, which beats the incumbent.
fn searched(
    instance: &Instance,
    root: Node,
    mut incumbent: (f64, Vec<usize>),
    least_wanted: f64,
    node_limit: usize,
    observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
) -> Search {
    let ladder = Ladder::new(instance);
    let threshold = |incumbent: &(f64, Vec<usize>)| incumbent.0.max(least_wanted) + SAME;
    let mut nodes = 0;
    let open_at_root = root.open.len();
    let mut parts = BestFirst::new(root.log_bound, root);
    let end = loop {
        while parts.bound().is_some_and(|log_bound| log_bound <= threshold(&incumbent)) {
            parts.pop();
        }
        let log_bound = parts.bound().unwrap_or(incumbent.0).max(incumbent.0);
        let progress = SearchProgress { nodes, open: parts.len(), log_value: incumbent.0, log_bound };
        if parts.bound().is_none() {
            break SearchEnd::Optimal;
        }
        if nodes >= node_limit {
            break SearchEnd::NodeLimit;
        }
        if observe(&progress).is_break() {
            break SearchEnd::Stopped;
        }
        let best = std::iter::from_fn(|| parts.pop()).map(|(_, node)| node);
        let batch: Vec<Node> = best.take(BATCH.min(node_limit - nodes)).collect();
        nodes += batch.len();
        let limit = threshold(&incumbent);
        let outcomes: Vec<Outcome> = batch.into_par_iter().map(|node| work(&ladder, node, limit)).collect();
        for outcome in outcomes {
            if let Some(found) = outcome.found.filter(|found| found.0 > incumbent.0) {
                incumbent = found;
            }
            for child in outcome.children {
                parts.push(child.log_bound, child);
            }
        }
    };
    let open_bound = parts.bound().unwrap_or(f64::NEG_INFINITY);
    let (log_value, selected) = incumbent;
    // Everything pruned is at most as good as the threshold it was pruned by.
    let log_bound = open_bound.max(log_value.max(least_wanted) + SAME);
    Search { selected, log_value, log_bound, nodes, open_at_root, end }
}

/// What became of a node.
struct Outcome {
    children: Vec<Node>,
    /// The best selection seen there.
    found: Option<(f64, Vec<usize>)>,
}

impl Outcome {
    fn consider(&mut self, found: (f64, Vec<usize>)) {
        if self.found.as_ref().is_none_or(|best| found.0 > best.0) {
            self.found = Some(found);
        }
    }
}

/// The whole search space, less what reduced costs exclude.
fn root(instance: &Instance, start: &Best, threshold: f64) -> Node {
    let certificate = &start.relaxation.certificate;
    let rules = instance.rules();
    let allowed = |i: usize| instance.is_open(i) && (rules.is_free() || rules.allows(instance.required(), None, i));
    let open = certificate.open_above(instance, threshold).into_iter().filter(|&(i, _)| allowed(i));
    let (open, scores): (Vec<usize>, Vec<f64>) = open.unzip();
    let mut weights = vec![0.0; open.len()];
    for &(i, weight) in &start.relaxation.weights {
        if let Ok(place) = open.binary_search(&i) {
            weights[place] = weight;
        }
    }
    let free = instance.count() - instance.required().len();
    let weights = filled(weights, &scores, free as f64);
    Node { included: instance.required().to_vec(), open, weights, log_bound: certificate.log_bound }
}

/// Bounds a node, fixes what its scores allow, and branches on the rest.
fn work(ladder: &Ladder, node: Node, threshold: f64) -> Outcome {
    let instance = ladder.instance;
    let mut outcome = Outcome { children: vec![], found: None };
    let mut included = node.included;
    let mut open = node.open;
    let mut weights = node.weights;
    let mut log_bound = node.log_bound;
    loop {
        let free = instance.count() - included.len();
        if free == 0 {
            included.sort_unstable();
            let value = instance.log_value_at(&instance.total(&included));
            outcome.consider((value, included));
            return outcome;
        }
        if open.len() < free {
            return outcome;
        }
        let known = instance.total(&included);
        let tolerance = 1e-3 * (log_bound - threshold).max(SAME);
        let relaxed = match ladder.relax(&known, &open, free, weights, threshold, tolerance) {
            Some(relaxed) => Some(relaxed),
            None if instance.leaves_nothing_known(&known, &open) => return outcome,
            None => relaxed_from_afar(ladder, &known, &open, free, threshold, tolerance),
        };
        // Its gradients may bound nothing, and then its scores fix nothing.
        let Some(relaxed) = relaxed.filter(|relaxed| relaxed.log_bound.is_finite()) else {
            let alike = (vec![free as f64 / open.len() as f64; open.len()], vec![0.0; open.len()]);
            outcome.children = branch(instance, included, &open, &alike.0, &alike.1, log_bound);
            return outcome;
        };
        log_bound = log_bound.min(relaxed.log_bound);
        if log_bound <= threshold {
            return outcome;
        }
        if let Some(found) = rounded(instance, &included, &open, &relaxed.weights, threshold) {
            outcome.consider(found);
        }
        let Some(fixed) = fix(instance, &relaxed, &included, &open, free, threshold) else { return outcome };
        let changed = !fixed.included.is_empty();
        let before = open.len();
        included.extend(fixed.included);
        open = fixed.open;
        weights = filled(fixed.weights, &fixed.scores, (instance.count() - included.len()) as f64);
        if changed || open.len() * 10 < before * 9 {
            continue;
        }
        outcome.children = branch(instance, included, &open, &weights, &fixed.scores, log_bound);
        return outcome;
    }
}

/// The relaxation from equal weights; where these are singular too, with a little known beside, which bounds Φ for the more.
fn relaxed_from_afar(
    ladder: &Ladder,
    known: &[f64],
    open: &[usize],
    free: usize,
    threshold: f64,
    tolerance: f64,
) -> Option<Relaxed> {
    let equal = vec![free as f64 / open.len() as f64; open.len()];
    let from = |known: &[f64]| ladder.relax(known, open, free, equal.clone(), threshold, tolerance);
    from(known).or_else(|| from(&ladder.instance.resolved(known, open)))
}

/// Two children: with and without the candidate that is least decided.
fn branch(
    instance: &Instance,
    included: Vec<usize>,
    open: &[usize],
    weights: &[f64],
    scores: &[f64],
    log_bound: f64,
) -> Vec<Node> {
    let undecided = |c: usize| (weights[c] - 0.5).abs();
    let Some(place) = (0..open.len()).min_by(|&a, &b| undecided(a).total_cmp(&undecided(b)).then(a.cmp(&b))) else {
        return vec![];
    };
    let left = (instance.count() - included.len()) as f64;
    let mut with = included.clone();
    with.push(open[place]);
    let node = |included: Vec<usize>, kept: &dyn Fn(usize) -> bool, left: f64| {
        let places: Vec<usize> = (0..open.len()).filter(|&c| c != place && kept(open[c])).collect();
        let scores: Vec<f64> = places.iter().map(|&c| scores[c]).collect();
        let weights = filled(places.iter().map(|&c| weights[c]).collect(), &scores, left);
        Node { included, open: places.iter().map(|&c| open[c]).collect(), weights, log_bound }
    };
    let rules = instance.rules();
    let beside = |j: usize| rules.is_free() || rules.allows(&with, None, j);
    vec![node(with.clone(), &beside, left - 1.0), node(included, &|_| true, left)]
}

/// What reduced costs decide.
struct Fixed {
    included: Vec<usize>,
    open: Vec<usize>,
    weights: Vec<f64>,
    scores: Vec<f64>,
}

/// With the scores of the node's bound and ν between the last of the greatest and the first of the others, forcing a
/// candidate in or out lowers S by |ν − s|; where the bound then falls to the threshold, it cannot be. `None` if candidates
/// that must be in exclude each other.
fn fix(
    instance: &Instance,
    relaxed: &Relaxed,
    included: &[usize],
    open: &[usize],
    free: usize,
    threshold: f64,
) -> Option<Fixed> {
    let scores = &relaxed.scores;
    let top = greatest(scores, free);
    let mut is_top = vec![false; open.len()];
    for &c in &top {
        is_top[c] = true;
    }
    let last = top.iter().map(|&c| scores[c]).fold(f64::INFINITY, f64::min);
    let first = (0..open.len()).filter(|&c| !is_top[c]).map(|c| scores[c]).fold(f64::NEG_INFINITY, f64::max);
    let S = (relaxed.log_bound + relaxed.log_polar).exp();
    // The least S that does not fall to the threshold.
    let needed = (threshold + relaxed.log_polar).exp();
    let mut fixed = Fixed { included: vec![], open: vec![], weights: vec![], scores: vec![] };
    for (c, &i) in open.iter().enumerate() {
        if is_top[c] && S - (scores[c] - first) <= needed {
            fixed.included.push(i);
        } else if is_top[c] || S - (last - scores[c]) > needed {
            fixed.open.push(i);
            fixed.weights.push(relaxed.weights[c]);
            fixed.scores.push(scores[c]);
        }
    }
    let rules = instance.rules();
    if !rules.is_free() && !fixed.included.is_empty() {
        let mut now = included.to_vec();
        for &i in &fixed.included {
            if !rules.allows(&now, None, i) {
                return None;
            }
            now.push(i);
        }
        let Fixed { included, open, weights, scores } = fixed;
        let places: Vec<usize> = (0..open.len()).filter(|&c| rules.allows(&now, None, open[c])).collect();
        fixed = Fixed {
            included,
            open: places.iter().map(|&c| open[c]).collect(),
            weights: places.iter().map(|&c| weights[c]).collect(),
            scores: places.iter().map(|&c| scores[c]).collect(),
        };
    }
    Some(fixed)
}

/// The selection of the greatest weights that is allowed, improved by exchange where it promises to beat the incumbent.
fn rounded(
    instance: &Instance,
    included: &[usize],
    open: &[usize],
    weights: &[f64],
    threshold: f64,
) -> Option<(f64, Vec<usize>)> {
    let mut places: Vec<usize> = (0..open.len()).collect();
    places.sort_unstable_by(|&a, &b| weights[b].total_cmp(&weights[a]).then(a.cmp(&b)));
    let order: Vec<usize> = places.into_iter().map(|c| open[c]).collect();
    let selected = first_allowed(instance, included, &order)?;
    let value = instance.log_value_at(&instance.total(&selected));
    if value > threshold {
        let improved = improved(instance, selected.clone());
        let better = instance.log_value_at(&instance.total(&improved));
        return Some(if better > value { (better, improved) } else { (value, selected) });
    }
    Some((value, selected))
}

/// Weights moved so that they add up to `sum`: scaled down, or the positive ones up and then a few of the others, the best
/// scores first, so that few are fractional.
fn filled(mut weights: Vec<f64>, scores: &[f64], sum: f64) -> Vec<f64> {
    let now: f64 = weights.iter().sum();
    if now > sum {
        return weights.iter().map(|weight| weight * sum / now).collect();
    }
    let mut missing = sum - now;
    let (positive, mut others): (Vec<usize>, Vec<usize>) = (0..weights.len()).partition(|&c| weights[c] > 0.0);
    others.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
    others.truncate(2 * missing.ceil() as usize);
    for group in [positive, others] {
        let room: f64 = group.iter().map(|&c| 1.0 - weights[c]).sum();
        if room > 0.0 && missing > 0.0 {
            let share = (missing / room).min(1.0);
            for &c in &group {
                weights[c] += share * (1.0 - weights[c]);
            }
            missing -= share * room;
        }
    }
    weights
}
