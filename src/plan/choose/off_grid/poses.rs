//! Poses moved together.

use super::local_search::{Candidate, LocalSearch, TRIES};
use crate::feasibility::View;
use crate::plan::choose::choice::Choice;
use crate::plan::choose::chooser::Chooser;
use crate::plan::choose::error::PlanError;
use crate::plan::survey::SurveyError;
use crate::problem::Problem;
use crate::selection::Instance;

/// When moving poses ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolishSettings {
    /// Most cycles over all poses.
    pub cycles: usize,
    /// Gain in log Φ below which a cycle is the last.
    pub least_gain: f64,
}

impl Default for PolishSettings {
    fn default() -> Self {
        Self { cycles: 100, least_gain: 1e-4 }
    }
}

/// Softnesses of functions with kinks, where moving a single pose rarely gains, before the function itself.
const SOFTNESSES: [f64; 3] = [0.3, 0.1, 0.03];

/// Poses with their matrices.
#[derive(Debug, Clone)]
pub(crate) struct Poses(Vec<Candidate>);

/// Poses that were moved.
pub(crate) struct Moved {
    pub(crate) poses: Poses,
    /// log Φ of them.
    pub(crate) log_value: f64,
    /// Cycles over all poses.
    pub(crate) cycles: usize,
    /// Whether the last cycle gained less than the least gain.
    pub(crate) converged: bool,
}

/// Moves the poses of `choice` to better joint values: block-coordinate ascent of log Φ, one pose at a time, the others held, from
/// cycle to cycle until one gains next to nothing. A pose moves only where it stays a view and the constraints allow it; those that
/// they require stay. What comes out is a local optimum at best, and never worse than what went in. `observe` is called after each
/// cycle with log Φ.
///
/// # Errors
/// When the poses leave a combination of the parameters undetermined.
pub(crate) fn moved(
    problem: &Problem,
    chooser: &Chooser,
    choice: &Choice,
    settings: &PolishSettings,
    observe: &mut dyn FnMut(f64),
) -> Result<Moved, PlanError> {
    let search = LocalSearch::new(problem, chooser.survey(), chooser.objective());
    let instance = chooser.instance(choice.selected.len())?;
    let start = choice.selected.iter().map(|&i| &chooser.survey().views[i]);
    let mut current = Poses::new(&search, start).ok_or_else(|| SurveyError::undetermined(problem))?;
    let mut best = Moved { poses: current.clone(), log_value: choice.log_value, cycles: 0, converged: false };
    let fixed: Vec<bool> = choice.selected.iter().map(|i| instance.required().contains(i)).collect();
    let softnesses = if instance.is_smooth() { &[][..] } else { &SOFTNESSES[..] };
    let stages = softnesses.iter().map(|&softness| instance.softened(softness)).chain([instance.clone()]);
    for stage in stages {
        best.converged = false;
        while best.cycles < settings.cycles && !best.converged {
            best.cycles += 1;
            let before = stage.log_value_at(&current.total(&stage));
            for place in (0..fixed.len()).filter(|&place| !fixed[place]) {
                for stretch in TRIES {
                    current.improve(&search, &stage, place, stretch);
                }
            }
            best.converged = stage.log_value_at(&current.total(&stage)) - before < settings.least_gain;
            let log_value = instance.log_value_at(&current.total(&instance));
            if log_value > best.log_value {
                (best.poses, best.log_value) = (current.clone(), log_value);
            }
            observe(best.log_value);
        }
        // The next function goes on from the best by the last one.
        current = best.poses.clone();
    }
    Ok(best)
}

impl Poses {
    pub(crate) fn new<'v>(search: &LocalSearch, views: impl Iterator<Item = &'v View>) -> Option<Self> {
        Some(Self(views.map(|view| search.candidate(view)).collect::<Option<_>>()?))
    }

    /// The views, in their order.
    pub(crate) fn views(&self) -> impl Iterator<Item = &View> {
        self.0.iter().map(|pose| &pose.view)
    }

    /// The views' matrices, in their order.
    pub(crate) fn information(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.0.iter().map(|pose| &pose.information)
    }

    pub(crate) fn total(&self, instance: &Instance) -> Vec<f64> {
        self.without(instance, usize::MAX)
    }

    /// The total of all but one.
    fn without(&self, instance: &Instance, place: usize) -> Vec<f64> {
        let mut total = instance.prior();
        for (_, pose) in self.0.iter().enumerate().filter(|(other, _)| *other != place) {
            add(&mut total, &pose.information, 1.0);
        }
        total
    }

    /// Moves one pose to where log Φ of `instance` is greater, if the simplex method finds such a place; `stretch` as in [`TRIES`].
    fn improve(&mut self, search: &LocalSearch, instance: &Instance, place: usize, stretch: f64) {
        let others: Vec<&View> =
            self.views().enumerate().filter(|(other, _)| *other != place).map(|(_, view)| view).collect();
        let rest = self.without(instance, place);
        let value_with = |information: &[f64]| {
            let mut total = rest.clone();
            add(&mut total, information, 1.0);
            instance.log_value_at(&total)
        };
        let before = value_with(&self.0[place].information);
        let found =
            search.climb(&self.0[place].view, &others, stretch, &|candidate| value_with(&candidate.information));
        if let Some(found) = found.filter(|found| value_with(&found.information) > before) {
            self.0[place] = found;
        }
    }
}

/// `total += weight · information`.
pub(crate) fn add(total: &mut [f64], information: &[f64], weight: f64) {
    for (sum, entry) in total.iter_mut().zip(information) {
        *sum += weight * entry;
    }
}
