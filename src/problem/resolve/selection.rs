//! What to select.

use std::collections::BTreeMap;
use std::time::Duration;

use super::check::Check;
use crate::continuum::ContinuumSettings;
use crate::information::Criterion;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema::{self, Named, TextOrTable};
use crate::problem::text::{At, key};
use crate::problem::{Accuracy, Goal, Least, Method, SelectionSettings};

/// Number of poses where the file does not say.
const DEFAULT_COUNT: usize = 10;

/// Share of the information that is given up for a shorter tour where the file does not say.
const TOUR_TOLERANCE: f64 = 0.01;

/// Standard deviations requested: far from any that can be had, but such that their squares are numbers.
const REQUESTED: Allowed = Allowed::between(1e-9, 1e9);

impl Check<'_, '_> {
    pub(super) fn selection(&mut self, selection: &At<schema::Selection>, estimated: &[&str]) -> SelectionSettings {
        let time_limit = self.number(&key!(selection, time_limit_s), Allowed::between(0.0, 1e6));
        let goal = self.goal(selection, estimated);
        SelectionSettings {
            tour_tolerance: self.tour_tolerance(selection, &goal),
            goal,
            pictures: self.count(&key!(selection, pictures), Allowed::between(1.0, 1000.0)),
            off_grid: selection.value.off_grid,
            continuum: ContinuumSettings {
                tolerance: self.number(&key!(selection, continuum_tolerance), Allowed::between(1e-6, 10.0)),
                most_boxes: self.count(&key!(selection, continuum_boxes), Allowed::between(0.0, 1e9)),
            },
            seed: selection.value.seed,
            tolerance: self.number(&key!(selection, tolerance), Allowed::between(1e-12, 0.1)),
            time_limit: Duration::try_from_secs_f64(time_limit).unwrap_or_default(),
            node_limit: self.count(&key!(selection, node_limit), Allowed::between(0.0, 1e12)),
        }
    }

    /// Methods that stand for themselves give nothing up, and choices by time nothing beside what they ask for.
    fn tour_tolerance(&mut self, selection: &At<schema::Selection>, goal: &Goal) -> f64 {
        let by_time = match goal {
            Goal::Within { .. } => Some(key!(selection, time).path),
            Goal::Fewest { least: Least::Time, .. } => Some(key!(selection, least).path),
            _ => None,
        };
        let method = goal.method();
        let Some(stated) = key!(selection, tour_tolerance).given() else {
            return if method == Method::Best && by_time.is_none() { TOUR_TOLERANCE } else { 0.0 };
        };
        let tolerance = self.number(&stated, Allowed::between(0.0, 0.9));
        if let (Some(by_time), true) = (by_time, tolerance > 0.0) {
            self.excluded(&[&key!(selection, tour_tolerance)], &by_time.to_string());
        } else if tolerance > 0.0 && !matches!(method, Method::Best | Method::Exact) {
            let to = format!("poses chosen by `{}`", method.name());
            self.not_applicable(&stated.path, &to, "leave it out, or choose by `best` or `exact`");
        }
        tolerance
    }

    /// Either accuracies or criteria: what only one of them has a use for is refused beside the other.
    fn goal(&mut self, selection: &At<schema::Selection>, estimated: &[&str]) -> Goal {
        let (criterion, count, method) = (key!(selection, criterion), key!(selection, count), key!(selection, method));
        let (time, least) = (key!(selection, time), key!(selection, least));
        if let Some(accuracy) = key!(selection, accuracy).given() {
            self.excluded(&[&criterion, &count, &method, &time], &accuracy.path.to_string());
            let least = least.value.map_or(Least::Poses, |least| least.0);
            return Goal::Fewest { accuracies: self.accuracies(&accuracy, estimated), least };
        }
        self.refused(&[&least], "choices without `accuracy`", "leave it out, or request an accuracy");
        let criteria = match criterion.given() {
            Some(criterion) => self.criteria(&criterion),
            None => vec![(Criterion::V, 1.0)],
        };
        if let Some(time) = time.given() {
            self.excluded(&[&count, &method], &time.path.to_string());
            return Goal::Within { criteria, seconds: self.number(&key!(time, most_s), Allowed::positive(1e6)) };
        }
        Goal::Best {
            criteria,
            count: count.value.map_or(DEFAULT_COUNT, |count| count as usize),
            method: method.value.map_or(Method::Best, |method| method.0),
        }
    }

    /// Shares are normalised to add up to one.
    fn criteria(
        &mut self,
        criterion: &At<TextOrTable<Named<Criterion>, BTreeMap<String, f64>>>,
    ) -> Vec<(Criterion, f64)> {
        let shares = match criterion.value {
            TextOrTable::Text(criterion) => return vec![(criterion.0, 1.0)],
            TextOrTable::Table(shares) => criterion.with(shares),
        };
        if shares.value.is_empty() {
            self.fault(&shares.path, Reason::Empty);
        }
        let sum: f64 = shares.value.values().sum();
        let mut criteria = Vec::new();
        for (name, share) in shares.entries() {
            if let Ok(criterion) = name.parse() {
                criteria.push((criterion, part(self.number(&share, Allowed::positive(1e6)), sum)));
            } else {
                self.unknown(&share.path, name, &Criterion::ALL.map(Criterion::name));
            }
        }
        criteria.sort_by_key(|&(criterion, _)| criterion);
        criteria
    }

    fn accuracies(&mut self, requested: &At<BTreeMap<String, f64>>, estimated: &[&str]) -> Vec<(Accuracy, f64)> {
        if requested.value.is_empty() {
            self.fault(&requested.path, Reason::Empty);
        }
        let mut accuracies = Vec::new();
        for (name, sigma) in requested.entries() {
            let value = self.number(&sigma, REQUESTED);
            if name == Accuracy::MAP_ERROR {
                accuracies.push((Accuracy::MapError, value));
            } else if let Some(j) = estimated.iter().position(|known| known == name) {
                accuracies.push((Accuracy::Intrinsic(j), value));
            } else {
                self.unknown(&sigma.path, name, &[&[Accuracy::MAP_ERROR], estimated].concat());
            }
        }
        accuracies
    }
}

/// The share `part / whole` to fifteen decimals: 0.7 of 0.7, 0.2 and 0.1 is 0.7, though their sum in binary is not 1.
fn part(part: f64, whole: f64) -> f64 {
    let share = part / whole;
    let rounded = (share * 1e15).round() / 1e15;
    if rounded > 0.0 { rounded } else { share }
}
