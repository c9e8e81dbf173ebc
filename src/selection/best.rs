//! The default: greedy, the relaxation, its roundings, and exchange from all of them.

use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256Plus;
use rayon::prelude::*;

use super::error::SelectionError;
use super::exchange::{improved, improved_greedy, improved_nearby};
use super::greedy::start_of_sample;
use super::instance::{Instance, Part};
use super::relaxation::{Relaxation, RelaxationSettings, relax};

/// Random roundings tried beside the k largest weights, of functions without and with kinks, on which exchange takes longer.
const ROUNDINGS: usize = 16;
const ROUNDINGS_AT_KINKS: usize = 6;

/// Rounds of kicks at kinks, and the kicks of each. A kick replaces one in so many members by others, drawn from so many times k
/// candidates of the best scores.
const KICK_ROUNDS: usize = 4;
const KICKS: usize = 16;
const KICKED: usize = 3;
const KICKS_AMONG: usize = 15;

/// A selection with the relaxation that bounds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Best {
    /// The candidates selected, ascending.
    pub selected: Vec<usize>,
    /// log Φ of the selection.
    pub log_value: f64,
    /// The relaxation, with the certificate.
    pub relaxation: Relaxation,
}

impl Best {
    /// Checks that the selection, the weights and the certificate are of the instance's candidates.
    pub(super) fn fits(&self, instance: &Instance) -> Result<(), SelectionError> {
        instance.check(&self.selected)?;
        instance.check(&self.relaxation.weights.iter().map(|&(i, _)| i).collect::<Vec<_>>())?;
        self.relaxation.certificate.fits(instance)
    }
}

/// Selects with every means: exchange from greedy, then from roundings of the relaxation, and keeps the best.
///
/// ```
/// use calipose::selection::{InformationFunction, InformationSet, Instance, RelaxationSettings, best};
/// use nalgebra::DMatrix;
///
/// // Three measurements of two parameters; the first two are the best pair.
/// let along = |x: f64, y: f64| DMatrix::from_row_slice(2, 2, &[x * x, x * y, x * y, y * y]);
/// let views = InformationSet::from_matrices(2, &[along(2.0, 0.0), along(0.0, 2.0), along(1.0, 1.0)])?;
/// let instance = Instance::new(&views, None, &InformationFunction::Determinant, 2)?;
/// let found = best(&instance, &RelaxationSettings::default(), 0)?;
/// assert_eq!(found.selected, [0, 1]);
/// assert!(found.relaxation.certificate.efficiency(found.log_value) > 0.99);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`improved_greedy`].
pub fn best(instance: &Instance, settings: &RelaxationSettings, seed: u64) -> Result<Best, SelectionError> {
    let (picked, relaxation) = relax_from_greedy(instance, settings)?;
    Ok(best_from(instance, picked, relaxation, seed))
}

/// As [`best`], from candidates known to be a good selection instead of greedy's picks; it is no worse.
///
/// # Errors
/// As [`relax`].
pub(crate) fn best_from_known(
    instance: &Instance,
    settings: &RelaxationSettings,
    seed: u64,
    known: &[usize],
) -> Result<Best, SelectionError> {
    let relaxation = relax(instance, known, settings)?;
    Ok(best_from(instance, known.to_vec(), relaxation, seed))
}

fn best_from(instance: &Instance, picked: Vec<usize>, relaxation: Relaxation, seed: u64) -> Best {
    let starts = starts(instance, picked, &relaxation, seed);
    let incumbent = improved_within(instance, &starts, &relaxation);
    // A selection that beats the incumbent holds none but these, so that exchange needs to look at no others.
    let scored = relaxation.certificate.open_above(instance, instance.log_value_at(&instance.total(&incumbent)));
    let open = scored.iter().map(|&(i, _)| i);
    let members = ascending(open.chain(starts.iter().flatten().copied()).chain(incumbent.iter().copied()));
    let starts = starts.into_iter().chain([incumbent]);
    let improved: Vec<Vec<usize>> = if members.len() > instance.len() / 2 {
        starts.collect::<Vec<_>>().into_par_iter().map(|start| improved(instance, start)).collect()
    } else {
        let part = Part::new(instance, members);
        let of_part = part.instance();
        let starts: Vec<_> = starts.map(|start| part.places(&start)).collect();
        starts.into_par_iter().map(|start| part.members(&improved(&of_part, start))).collect()
    };
    let mut best = Best { selected: vec![], log_value: f64::NEG_INFINITY, relaxation };
    for selected in improved {
        let log_value = instance.log_value_at(&instance.total(&selected));
        if log_value > best.log_value {
            best.selected = selected;
            best.log_value = log_value;
        }
    }
    if !instance.is_smooth() {
        let kicked = kicked(instance, &best, scored, seed);
        let log_value = instance.log_value_at(&instance.total(&kicked));
        if log_value > best.log_value {
            best.selected = kicked;
            best.log_value = log_value;
        }
    }
    best
}

/// Iterated local search around the best selection (Lourenço, Martin and Stützle 2003), among the candidates of the best scores:
/// at kinks exchange ends in many local optima, often close to each other.
fn kicked(instance: &Instance, best: &Best, mut scored: Vec<(usize, f64)>, seed: u64) -> Vec<usize> {
    let most = (KICKS_AMONG * instance.count()).min(scored.len());
    scored.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let weighted = best.relaxation.weights.iter().map(|&(i, _)| i);
    let scored = scored[..most].iter().map(|&(i, _)| i);
    let part = Part::new(instance, scored.chain(weighted).chain(best.selected.iter().copied()));
    let of_part = part.instance();
    let mut rng = Xoshiro256Plus::seed_from_u64(seed);
    let mut selected = part.places(&best.selected);
    let mut log_value = best.log_value;
    for _ in 0..KICK_ROUNDS {
        let kicks = (0..KICKS).filter_map(|_| kick(&of_part, &selected, &mut rng)).collect::<Vec<_>>();
        let improved: Vec<Vec<usize>> = kicks.into_par_iter().map(|kick| improved_nearby(&of_part, kick)).collect();
        for found in improved {
            let value = of_part.log_value_at(&of_part.total(&found));
            if value > log_value {
                (selected, log_value) = (found, value);
            }
        }
    }
    improved(instance, part.members(&selected))
}

/// A selection in which some, drawn at random, gave place to others; `None` where the constraints leave too few.
fn kick(instance: &Instance, selected: &[usize], rng: &mut impl Rng) -> Option<Vec<usize>> {
    let mut kept: Vec<usize> = selected.to_vec();
    kept.shuffle(rng);
    kept.sort_by_key(|&i| instance.is_open(i));
    kept.truncate((instance.count() - instance.count().div_ceil(KICKED)).max(instance.required().len()));
    let mut others: Vec<usize> = (0..instance.len()).filter(|i| !selected.contains(i)).collect();
    others.shuffle(rng);
    first_allowed(instance, &kept, &others)
}

/// The [start](nonsingular_start) of greedy's picks, and the relaxation from there.
///
/// # Errors
/// As [`improved_greedy`].
pub(crate) fn relax_from_greedy(
    instance: &Instance,
    settings: &RelaxationSettings,
) -> Result<(Vec<usize>, Relaxation), SelectionError> {
    let picked = nonsingular_start(instance)?;
    let relaxation = relax(instance, &picked, settings)?;
    Ok((picked, relaxation))
}

/// Greedy's picks, among an even sample where candidates are many and improved by exchange where they are singular.
///
/// # Errors
/// As [`improved_greedy`].
pub(crate) fn nonsingular_start(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let picked = start_of_sample(instance)?;
    if instance.is_singular(&picked) { improved_greedy(instance) } else { Ok(picked) }
}

/// Greedy's picks and roundings of the relaxation, each once.
fn starts(instance: &Instance, picked: Vec<usize>, relaxation: &Relaxation, seed: u64) -> Vec<Vec<usize>> {
    let mut rng = Xoshiro256Plus::seed_from_u64(seed);
    let mut starts = vec![ascending(picked)];
    for round in 0..=if instance.is_smooth() { ROUNDINGS } else { ROUNDINGS_AT_KINKS } {
        let order = if round == 0 { relaxation.by_weight() } else { relaxation.drawn_by_weight(&mut rng) };
        if let Some(rounded) = first_allowed(instance, instance.required(), &order)
            && !starts.contains(&rounded)
        {
            starts.push(rounded);
        }
    }
    starts
}

/// The best of the first two starts, improved by exchange among their own candidates and those of positive weight.
fn improved_within(instance: &Instance, starts: &[Vec<usize>], relaxation: &Relaxation) -> Vec<usize> {
    let starts = &starts[..starts.len().min(2)];
    let weighted = relaxation.weights.iter().map(|&(i, _)| i);
    let part = Part::new(instance, weighted.chain(starts.iter().flatten().copied()));
    let of_part = part.instance();
    let value = |selected: &Vec<usize>| of_part.log_value_at(&of_part.total(selected));
    let improved = starts.iter().map(|start| improved(&of_part, part.places(start)));
    let best = improved.reduce(|best, other| if value(&other) > value(&best) { other } else { best });
    best.map_or_else(Vec::new, |best| part.members(&best))
}

/// The candidates in ascending order, each once.
pub(super) fn ascending(candidates: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut candidates: Vec<usize> = candidates.into_iter().collect();
    candidates.sort_unstable();
    candidates.dedup();
    candidates
}

/// `included` and the first candidates in `order` that the constraints allow beside those before them, as many as asked for
/// in all, ascending; `None` if there are too few.
pub(super) fn first_allowed(instance: &Instance, included: &[usize], order: &[usize]) -> Option<Vec<usize>> {
    let rules = instance.rules();
    let mut selected = included.to_vec();
    for &i in order {
        if selected.len() == instance.count() {
            break;
        }
        if instance.is_open(i) && rules.allows(&selected, None, i) {
            selected.push(i);
        }
    }
    selected.sort_unstable();
    (selected.len() == instance.count()).then_some(selected)
}

impl Relaxation {
    /// The candidates of positive weight, the greatest first.
    pub(super) fn by_weight(&self) -> Vec<usize> {
        let mut order = self.weights.clone();
        order.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        order.into_iter().map(|(i, _)| i).collect()
    }

    /// The candidates of positive weight in an order drawn at random: first those of weight one, then, by Efraimidis and
    /// Spirakis' keys, a weighted sample without replacement.
    fn drawn_by_weight(&self, rng: &mut impl Rng) -> Vec<usize> {
        let key = |&(i, weight): &(usize, f64)| {
            let draw: f64 = rng.gen_range(f64::MIN_POSITIVE..1.0);
            (if weight > 1.0 - 1e-6 { 0.0 } else { draw.ln() / weight }, i)
        };
        let mut keyed: Vec<(f64, usize)> = self.weights.iter().map(key).collect();
        keyed.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        keyed.into_iter().map(|(_, i)| i).collect()
    }

    /// The candidates of largest weight that the constraints of `instance` allow together, ascending; `None` if those of
    /// positive weight are too few, or leave a combination of the parameters undetermined.
    pub(crate) fn rounded(&self, instance: &Instance) -> Option<Vec<usize>> {
        let rounded = first_allowed(instance, instance.required(), &self.by_weight());
        rounded.filter(|rounded| !instance.is_singular(rounded))
    }
}
