//! The default: greedy, the relaxation, its rounding, and exchange from both.

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256Plus;

use super::exchange::exchange;
use super::greedy::greedy;
use super::instance::{Instance, SelectionError};
use super::relaxation::{Relaxation, RelaxationSettings, relax};

/// Random roundings tried beside the k largest weights.
const ROUNDINGS: usize = 16;

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

/// Selects with every means: exchange from greedy, then from roundings of the relaxation, and keeps the best.
///
/// # Errors
/// When greedy leaves a combination of the parameters undetermined.
pub fn best(instance: &Instance, settings: &RelaxationSettings, seed: u64) -> Result<Best, SelectionError> {
    let start = exchange(instance, greedy(instance)?);
    let total = instance.total(&start);
    let relaxation = relax(instance, &start, settings).ok_or_else(|| instance.unobservable(&start))?;
    let mut best = Best { log_value: instance.log_value(&total), selected: start, relaxation };
    let mut rng = Xoshiro256Plus::seed_from_u64(seed);
    let mut tried = vec![best.selected.clone()];
    for round in 0..=ROUNDINGS {
        let rounded = if round == 0 {
            best.relaxation.largest(instance.count())
        } else {
            round_at_random(&best.relaxation, instance.count(), &mut rng)
        };
        if tried.contains(&rounded) || rounded.len() < instance.count() {
            continue;
        }
        tried.push(rounded.clone());
        let selected = exchange(instance, rounded);
        let log_value = instance.log_value(&instance.total(&selected));
        if log_value > best.log_value {
            best.selected = selected;
            best.log_value = log_value;
        }
    }
    Ok(best)
}

/// `count` candidates drawn without replacement, the chance of each following its weight: every candidate of weight one
/// and, by Efraimidis and Spirakis' keys, a weighted sample of the rest. Ascending.
fn round_at_random(relaxation: &Relaxation, count: usize, rng: &mut impl Rng) -> Vec<usize> {
    let mut keyed: Vec<(f64, usize)> = relaxation
        .weights
        .iter()
        .map(|&(i, weight)| {
            let draw: f64 = rng.gen_range(f64::MIN_POSITIVE..1.0);
            (if weight > 1.0 - 1e-6 { 0.0 } else { draw.ln() / weight }, i)
        })
        .collect();
    keyed.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut selected: Vec<usize> = keyed.into_iter().take(count).map(|(_, i)| i).collect();
    selected.sort_unstable();
    selected
}

impl Relaxation {
    /// The `count` candidates of largest weight, ascending.
    pub fn largest(&self, count: usize) -> Vec<usize> {
        let mut order = self.weights.clone();
        order.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut selected: Vec<usize> = order.into_iter().take(count).map(|(i, _)| i).collect();
        selected.sort_unstable();
        selected
    }
}
