//! The fewest candidates whose Φ reaches a level.

use std::ops::ControlFlow;

use super::best::{Best, best};
use super::certificate::Certificate;
use super::exchange::exchange;
use super::greedy::greedy;
use super::instance::{Instance, SelectionError};
use super::relaxation::{RelaxationSettings, relax};
use super::search::{SearchEnd, SearchProgress, search};

/// The smallest selection found, and why there is no smaller one.
#[derive(Debug, Clone, PartialEq)]
pub struct Fewest {
    /// The best selection found of the smallest number that suffices.
    pub best: Best,
    /// Fewer than this are proven not to suffice; the number selected, where the proof is complete.
    pub least: usize,
    /// What proves that `least − 1` do not suffice; `None` if they are fewer than the constraints require.
    pub refutation: Option<Refutation>,
}

/// A proof that so many do not suffice.
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// Certificate for `least − 1`.
    pub certificate: Certificate,
    /// Nodes of the search that was needed beside it; 0 if the certificate's bound alone is below the level.
    pub nodes: usize,
}

/// Why no selection suffices.
#[derive(Debug, Clone, PartialEq)]
pub enum NotEnough {
    /// Nothing can be selected.
    Selection(SelectionError),
    /// No selection that reaches the level was found.
    Never {
        /// The best selection that was found, ascending: of the most that may be selected, unless constraints were in the way.
        selected: Vec<usize>,
        /// No selection of the most that may be selected has a greater log Φ; ∞ where constraints were in the way, so that it is
        /// not known.
        log_bound: f64,
    },
}

impl From<SelectionError> for NotEnough {
    fn from(error: SelectionError) -> Self {
        NotEnough::Selection(error)
    }
}

/// Finds the fewest candidates, at most `most`, with `log Φ ≥ level`. The count of `instance` does not matter.
///
/// From below by the relaxation: a number whose bound is under the level does not suffice, nor do fewer. From above by
/// selecting. Between the two by a search for each number that is open, `node_limit` nodes in all, or until `observe` breaks.
///
/// # Errors
/// When not even `most` suffice, or nothing can be selected.
pub fn fewest(
    instance: &Instance,
    level: f64,
    most: usize,
    settings: &RelaxationSettings,
    seed: u64,
    node_limit: usize,
    observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
) -> Result<Fewest, NotEnough> {
    let fewest_allowed = instance.required().len().max(1);
    let enough = first_enough(instance, level, fewest_allowed, most, settings, seed)?;

    // The least number whose bound reaches the level.
    let bound = |count: usize| -> Result<Option<Certificate>, SelectionError> {
        let smaller = instance.with_count(count)?;
        Ok(relax(&smaller, &enough, settings).map(|relaxation| relaxation.certificate))
    };
    let (mut short, mut least) = (fewest_allowed - 1, enough.len());
    let mut refutation = None;
    while least - short > 1 {
        let middle = usize::midpoint(short, least);
        match bound(middle)? {
            Some(certificate) if certificate.log_bound < level => {
                short = middle;
                refutation = Some(Refutation { certificate, nodes: 0 });
            }
            _ => least = middle,
        }
    }

    // Select from there upwards.
    let mut open = vec![];
    let mut count = least;
    let mut found = loop {
        let attempt = instance.with_count(count).and_then(|instance| best(&instance, settings, seed));
        match attempt {
            Ok(best) if best.log_value >= level => break best,
            Ok(best) => open.push(best),
            // Singular sets, or constraints in the way: a greater number may do.
            Err(_) if count < enough.len() => {}
            Err(error) => return Err(error.into()),
        }
        count += 1;
    };

    // Prove the numbers between not to suffice, or find that one does.
    let mut nodes_left = node_limit;
    for best in open {
        let smaller = instance.with_count(best.selected.len())?;
        let outcome = search(&smaller, &best, level, nodes_left, observe);
        nodes_left -= outcome.nodes.min(nodes_left);
        if outcome.log_value >= level {
            found = Best { selected: outcome.selected, log_value: outcome.log_value, relaxation: best.relaxation };
            break;
        }
        if outcome.end != SearchEnd::Optimal || best.selected.len() != least {
            break;
        }
        least += 1;
        refutation = Some(Refutation { certificate: best.relaxation.certificate, nodes: outcome.nodes });
    }
    Ok(Fewest { best: found, least, refutation })
}

/// A selection that suffices, its size not far from the least.
fn first_enough(
    instance: &Instance,
    level: f64,
    fewest: usize,
    most: usize,
    settings: &RelaxationSettings,
    seed: u64,
) -> Result<Vec<usize>, NotEnough> {
    let open = (0..instance.len()).filter(|&i| instance.is_open(i)).count();
    let most = most.min(instance.required().len() + open).max(fewest);
    let mut count = fewest;
    loop {
        let larger = instance.with_count(count)?;
        let selected = match greedy(&larger) {
            Ok(selected) => selected,
            Err(SelectionError::Unobservable { .. }) if count < most => {
                count = (count + count.div_ceil(2)).min(most);
                continue;
            }
            Err(SelectionError::DeadEnd { selected, .. }) if (fewest..count).contains(&selected) => {
                return in_narrow_room(instance, level, fewest, selected, settings, seed);
            }
            Err(error) => return Err(error.into()),
        };
        if larger.log_value(&larger.total(&selected)) >= level {
            return Ok(selected);
        }
        if count == most {
            let improved = exchange(&larger, selected);
            if larger.log_value(&larger.total(&improved)) >= level {
                return Ok(improved);
            }
            let bounded = relax(&larger, &improved, settings);
            let log_bound = bounded.map_or(f64::INFINITY, |relaxed| relaxed.certificate.log_bound);
            return Err(NotEnough::Never { selected: improved, log_bound });
        }
        count = (count + count.div_ceil(2)).min(most);
    }
}

/// The same where constraints let greedy place no more than `most`: fewer, well placed, may do.
fn in_narrow_room(
    instance: &Instance,
    level: f64,
    fewest: usize,
    most: usize,
    settings: &RelaxationSettings,
    seed: u64,
) -> Result<Vec<usize>, NotEnough> {
    let mut closest: Option<Best> = None;
    for count in (fewest..=most).rev() {
        let Ok(found) = best(&instance.with_count(count)?, settings, seed) else { continue };
        if found.log_value >= level {
            return Ok(found.selected);
        }
        if closest.as_ref().is_none_or(|closest| found.log_value > closest.log_value) {
            closest = Some(found);
        }
    }
    match closest {
        Some(closest) => Err(NotEnough::Never { selected: closest.selected, log_bound: f64::INFINITY }),
        None => Err(SelectionError::DeadEnd { selected: most, count: most + 1 }.into()),
    }
}
