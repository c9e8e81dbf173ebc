//! What varies, checked: levels that are listed, or a distribution that they are drawn from.

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use serde_json::Value;
use statrs::distribution::{ContinuousCDF, Normal};

use super::base::Refusal;
use super::file::{self, Scale, Sequence};
use crate::figures::short;
use crate::problem::{Allowed, At, Check, KeyPath, Optional, Reason, key};

/// Numbers of an experiment's file: far beyond what any key allows, but such that sums and products are numbers.
const NUMBER: Allowed = Allowed::between(-1e12, 1e12);

/// Levels of a factor; more are a slip of the pen.
pub(super) const MOST_LEVELS: usize = 100_000;

/// What varies over an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// Its name in tables and figures.
    pub name: String,
    pub(super) source: Source,
}

/// Where the levels of a factor come from.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Source {
    /// A list.
    Levels(Vec<Level>),
    /// A distribution of the key's values.
    Drawn { key: String, draw: Draw, round_to: Option<f64> },
}

/// A value of a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// What it is called.
    pub name: String,
    /// The value, if it is a number.
    pub number: Option<f64>,
    /// `KEY=VALUE` of each key that it sets.
    pub set: Vec<String>,
}

impl Level {
    /// The level at which `key` has the number `value`.
    pub(super) fn of_number(key: &str, value: f64) -> Self {
        // 0.1 + 0.2 is written 0.3; and a key that takes whole numbers takes no 8.0.
        let value: f64 = format!("{value:.12e}").parse().unwrap_or(value);
        Self { name: value.to_string(), number: Some(value), set: vec![format!("{key}={value}")] }
    }

    /// The level at which `key` has `value`.
    fn of_value(key: &str, value: &Value) -> Option<Self> {
        if let Some(number) = value.as_f64() {
            return Some(Self::of_number(key, number));
        }
        let text = toml::Value::try_from(value).ok()?.to_string();
        let name = value.as_str().map_or_else(|| text.clone(), str::to_owned);
        Some(Self { name, number: None, set: vec![format!("{key}={text}")] })
    }
}

impl Factor {
    /// The key that it sets, if it sets one alone.
    pub(super) fn key(&self) -> Option<&str> {
        match &self.source {
            Source::Levels(levels) => match &levels[0].set[..] {
                [only] => only.split('=').next(),
                _ => None,
            },
            Source::Drawn { key, .. } => Some(key),
        }
    }

    /// How many levels are listed; none of a distribution.
    pub fn levels(&self) -> Option<&[Level]> {
        match &self.source {
            Source::Levels(levels) => Some(levels),
            Source::Drawn { .. } => None,
        }
    }

    /// The level at `share` (from 0 to 1, exclusive) of the distribution, or of the list.
    pub(super) fn level_at(&self, share: f64) -> Level {
        match &self.source {
            Source::Levels(levels) => levels[((share * levels.len() as f64) as usize).min(levels.len() - 1)].clone(),
            Source::Drawn { key, draw, round_to } => {
                let value = draw.quantile(share);
                Level::of_number(key, round_to.map_or(value, |unit| (value / unit).round() * unit))
            }
        }
    }

    /// Levels that stand for all that may be drawn, to be tried on a problem.
    pub(super) fn samples(&self) -> Vec<Level> {
        match &self.source {
            Source::Levels(levels) => levels.clone(),
            Source::Drawn { .. } => [0.001, 0.5, 0.999].map(|share| self.level_at(share)).into(),
        }
    }
}

/// A distribution that values are drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Draw {
    Uniform([f64; 2]),
    LogUniform([f64; 2]),
    Normal { mean: f64, sigma: f64 },
}

impl Draw {
    fn quantile(self, share: f64) -> f64 {
        match self {
            Self::Uniform([min, max]) => min + share * (max - min),
            Self::LogUniform([min, max]) => (min.ln() + share * (max / min).ln()).exp(),
            Self::Normal { mean, sigma } => Normal::new(mean, sigma).map_or(mean, |normal| normal.inverse_cdf(share)),
        }
    }
}

/// Coordinate `dimension` of draw `index`, from 0 to 1, exclusive.
pub(super) fn coordinate(sequence: Sequence, seed: u32, index: u32, dimension: u32) -> f64 {
    match sequence {
        // The sequence has 2¹⁶ points of 256 dimensions; each further block of points is one of its own.
        Sequence::Sobol => {
            let block = index >> 16;
            let share = sobol_burley::sample(index & 0xffff, dimension, seed.wrapping_add(block.wrapping_mul(0x9e37)));
            // Off 0, where normal distributions have no value.
            f64::from(share) + f64::from(f32::EPSILON) / 4.0
        }
        Sequence::Random => {
            let stream = (u64::from(seed) << 40) ^ (u64::from(index) << 8) ^ u64::from(dimension);
            Xoshiro256PlusPlus::seed_from_u64(stream).sample(rand::distributions::Open01)
        }
    }
}

/// Dimensions that the sequence has.
pub(super) const MOST_FACTORS: usize = 200;

/// The factor that the file states, or none if something is wrong with it; `sampled` says whether values are drawn.
pub(super) fn factor(check: &mut Check, stated: &At<file::Factor>, sampled: bool) -> Option<Factor> {
    let faults = check.faults.len();
    let sources: [&dyn Optional; 6] = [
        &key!(stated, values),
        &key!(stated, range),
        &key!(stated, uniform),
        &key!(stated, log_uniform),
        &key!(stated, normal),
        &key!(stated, levels),
    ];
    let given: Vec<_> = sources.into_iter().filter(|source| source.is_given()).collect();
    match given[..] {
        [] => {
            let names = ["values", "range", "uniform", "log_uniform", "normal", "levels"];
            check.fault(&key!(stated, values).path, Reason::Missing { allowed: names.map(String::from).into() });
            return None;
        }
        [first, second, ..] => {
            check.fault(second.path(), Reason::Conflict { with: first.path().to_string() });
            return None;
        }
        [_] => {}
    }
    let found = if key!(stated, levels).is_given() { several_keys(check, stated) } else { one_key(check, stated) };
    if let Some(Factor { source: Source::Drawn { .. }, .. }) = &found
        && !sampled
        && let Some(drawn) = given.first()
    {
        let instead =
            "draw settings with `design = { kind = \"sampled\", draws = 256 }`, or give `values` or a `range`";
        check.not_applicable(drawn.path(), "a design that is not sampled", instead);
    }
    if let Some(levels) = found.as_ref().and_then(Factor::levels) {
        let path = given.first().map_or(&stated.path, |source| source.path());
        let mut names: Vec<&str> = levels.iter().map(|level| level.name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            check.fault(path, Reason::Duplicate { name: pair[0].to_owned() });
        }
    }
    if check.faults.len() == faults { found } else { None }
}

/// A factor whose levels set several keys.
fn several_keys(check: &mut Check, stated: &At<file::Factor>) -> Option<Factor> {
    let instead = "the levels set keys themselves";
    check.refused(&[&key!(stated, key), &key!(stated, round_to)], "a factor with `levels`", instead);
    let name = check.required(key!(stated, name), &[])?;
    let levels = key!(stated, levels);
    let levels = levels.elements().map(|level| {
        let name = level.value.name.trim().to_owned();
        if name.is_empty() {
            check.fault(&key!(level, name).path, Reason::Empty);
        }
        Level { number: name.parse().ok(), name, set: level.value.set.clone() }
    });
    let levels = levels.collect();
    Some(Factor { name: name.value.clone(), source: Source::Levels(levels) })
}

/// A factor of one key.
fn one_key(check: &mut Check, stated: &At<file::Factor>) -> Option<Factor> {
    let key = check.required(key!(stated, key), &[])?.value;
    let name = stated.value.name.as_ref().unwrap_or(key).clone();
    let drawn = |draw| Source::Drawn { key: key.clone(), draw, round_to: stated.value.round_to };
    let round_to = key!(stated, round_to);
    if let Some(unit) = key!(stated, round_to).given() {
        check.number(&unit, Allowed::positive(1e12));
    }
    let source = if let Some(values) = key!(stated, values).given() {
        check.refused(&[&round_to], "listed values", "write them as they are to be");
        Source::Levels(listed(check, key, &values))
    } else if let Some(range) = key!(stated, range).given() {
        check.refused(&[&round_to], "a range", "choose `step` accordingly");
        Source::Levels(spaced(check, key, &range)?)
    } else if let Some(ends) = key!(stated, uniform).given() {
        drawn(Draw::Uniform(check.range(&ends, NUMBER)))
    } else if let Some(ends) = key!(stated, log_uniform).given() {
        drawn(Draw::LogUniform(check.range(&ends, Allowed::positive(1e12))))
    } else {
        let normal = key!(stated, normal).given()?;
        let mean = check.number(&key!(normal, mean), NUMBER);
        drawn(Draw::Normal { mean, sigma: check.number(&key!(normal, sigma), Allowed::positive(1e12)) })
    };
    Some(Factor { name, source })
}

fn listed(check: &mut Check, key: &str, values: &At<Vec<Value>>) -> Vec<Level> {
    if values.value.is_empty() {
        check.fault(&values.path, Reason::Empty);
    }
    let mut levels = Vec::with_capacity(values.value.len());
    for value in values.elements() {
        if let Some(level) = Level::of_value(key, value.value) {
            levels.push(level);
        } else {
            let (found, expected) = (value.value.to_string(), "a value that TOML has".to_owned());
            check.fault(&value.path, Reason::Type { found, expected });
        }
    }
    levels
}

fn spaced(check: &mut Check, key: &str, range: &At<file::Range>) -> Option<Vec<Level>> {
    let faults = check.faults.len();
    let (step, count) = (key!(range, step), key!(range, count));
    let from = check.number(&key!(range, from), NUMBER);
    let to = check.number(&key!(range, to), NUMBER);
    let logarithmic = range.value.scale.0 == Scale::Logarithmic;
    if logarithmic {
        check.refused(&[&step], "a logarithmic range", "give `count`");
        for end in [key!(range, from), key!(range, to)] {
            check.number(&end, Allowed::positive(1e12));
        }
    }
    if step.is_given() {
        check.excluded(&[&count], step.path.name());
    }
    let steps = match (range.value.step, range.value.count) {
        (Some(_), Some(_)) => None,
        (None, None) => {
            let allowed = vec!["step".to_owned(), "count".to_owned()];
            check.fault(&step.path, Reason::Missing { allowed });
            None
        }
        (Some(_), None) => {
            let step = check.number(&step.given()?, NUMBER);
            // A multiple of the step at the end belongs to the range however it rounds.
            let steps = ((to - from) / step * (1.0 + 1e-12) + 1e-12).floor();
            if step == 0.0 || steps < 0.0 {
                // Towards the end.
                check.fault(&key!(range, step).path, Reason::Reversed { min: from, max: to });
                None
            } else {
                Some((steps, step))
            }
        }
        (None, Some(levels)) => {
            check.count(&count.given()?, Allowed::between(1.0, MOST_LEVELS as f64));
            let steps = f64::from(levels.max(1) - 1);
            let span = if logarithmic { (to / from).ln() } else { to - from };
            Some((steps, if steps > 0.0 { span / steps } else { 0.0 }))
        }
    };
    let (steps, step) = steps?;
    if steps + 1.0 > MOST_LEVELS as f64 {
        check.fault(&range.path, Reason::TooManyCells { cells: steps + 1.0, most: MOST_LEVELS });
    }
    if check.faults.len() > faults {
        return None;
    }
    let value = |i: usize| {
        let way = i as f64 * step;
        if logarithmic { from * way.exp() } else { from + way }
    };
    Some((0..=steps as usize).map(|i| Level::of_number(key, value(i))).collect())
}

/// Levels of a factor that are tried when the file is read.
const TRIED: usize = 200;

/// Tries every level by itself, as far as that can be done at once, and refuses those that `refused` has reasons against.
pub(super) fn try_levels(
    check: &mut Check,
    stated: &At<Vec<file::Factor>>,
    factors: &[Factor],
    refused: &(dyn Fn(&[String]) -> Vec<Refusal> + Sync),
) {
    for (stated, factor) in stated.elements().zip(factors) {
        let levels = factor.samples();
        let some: Vec<usize> = (0..levels.len()).step_by(levels.len().div_ceil(TRIED).max(1)).collect();
        let refusals: Vec<Vec<Refusal>> = some.par_iter().map(|&i| refused(&levels[i].set)).collect();
        let placed =
            some.iter().zip(refusals).flat_map(|(i, refusals)| refusals.into_iter().map(move |each| (*i, each)));
        for (level, Refusal { reason, of_key }) in placed {
            let path = place_of(&stated, of_key, level);
            // What is wrong with the key, or with all that may be drawn, is told once.
            if !check.faults.iter().any(|fault| fault.reason == reason && fault.key == path.to_string()) {
                check.fault(&path, reason);
            }
        }
    }
}

/// Where a factor's level is refused: at the key, if that is what is wrong; else where the level stands.
fn place_of(stated: &At<file::Factor>, of_key: bool, level: usize) -> KeyPath {
    let value = stated.value;
    if of_key && value.key.is_some() {
        return key!(stated, key).path;
    }
    if value.values.is_some() {
        return key!(stated, values).path.at(level);
    }
    if !value.levels.is_empty() {
        return key!(stated, levels).path.at(level);
    }
    let sources: [&dyn Optional; 4] =
        [&key!(stated, range), &key!(stated, uniform), &key!(stated, log_uniform), &key!(stated, normal)];
    sources.into_iter().find(|source| source.is_given()).map_or(stated.path.clone(), |source| source.path().clone())
}

/// The interval from one number to another, as a level.
pub(super) fn interval_name(low: f64, high: f64) -> String {
    format!("{} to {}", short(low), short(high))
}
