//! Sets of poses traded against the time that their tours take.
//!
//! Swaps of single poses lead from a good set to others, by what a pose tells and what its way takes; poses off the grid are also
//! pulled towards their neighbours on the tour. Both find local optima. What no set is faster than is proven apart from that.

mod bound;
mod pulls;
mod spares;
mod swaps;
mod timed;
mod times;

#[cfg(test)]
mod tests;

use super::choice::Choice;
use super::chooser::Chooser;
use super::error::PlanError;
use super::off_grid::LocalSearch;
use crate::plan::survey::Survey;
use crate::problem::{Goal, Least, Problem};
use crate::selection::{Certificate, Instance};
use bound::{FIRST, Good};
use pulls::Pull;
pub(crate) use spares::journey;
pub use spares::{GaveWay, Led};
use swaps::{Aim, Market, Route};
pub(super) use timed::Numbers;
pub(crate) use times::Times;

/// Most views that a set is traded from.
const POOL: usize = 3000;

/// What a choice was made for beside its information.
#[derive(Debug, Clone, PartialEq)]
pub struct Trade {
    /// The best of as many poses found, where the choice is another one with a shorter tour.
    pub best: Option<Toured>,
    /// What no tour of as good a choice takes less than, s.
    pub least_seconds: Option<f64>,
    /// Most poses whose tour may keep the time that the problem allows.
    pub most_poses: Option<usize>,
}

impl Trade {
    /// What is left of it where poses gave way to others.
    pub(super) fn after(self, gave_way: &[GaveWay]) -> Self {
        if gave_way.is_empty() { self } else { Self { best: None, least_seconds: None, ..self } }
    }
}

/// A choice and the time of its tour with straight moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Toured {
    /// The choice.
    pub choice: Choice,
    /// Time of the moves and pictures, s.
    pub seconds: f64,
}

impl Chooser<'_> {
    /// The most informative choice found, of as many poses as serve, whose tour keeps a time with straight moves, s.
    ///
    /// # Errors
    /// When no tour found is so short, and as [`Chooser::best`].
    pub(crate) fn within(&self, seconds: f64) -> Result<Toured, PlanError> {
        Numbers::new(self)?.within(seconds)
    }

    /// Among sets of as many poses whose log Φ is at least `floor`, that of the shortest tour found; the choice itself where none is
    /// shorter. `certificate` is that of the survey's views for as many poses.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub(super) fn shorter(
        &self,
        choice: Choice,
        certificate: &Certificate,
        floor: f64,
    ) -> Result<(Choice, Trade), PlanError> {
        let instance = self.instance(choice.selected.len())?;
        let times = Times::new(&self.problem().motion);
        let open = certificate.open_above(&instance, floor);
        let (before, found) = self.fastest(&instance, &times, &choice, open, floor);
        let joints = self.survey().joints();
        let good = Good { instance: &instance, certificate, floor, joints: &joints, times: &times, first: FIRST };
        let count = choice.selected.len();
        let total = |moving: f64| times.total(moving, count);
        let mut trade = Trade { best: None, least_seconds: Some(total(good.least_moving())), most_poses: None };
        if found.moving < before.moving {
            trade.best = Some(Toured { choice, seconds: total(before.moving) });
            return Ok((self.assess(found.order), trade));
        }
        Ok((choice, trade))
    }

    /// The choice with its tour, and the fastest set found whose log Φ is at least `floor`, from those of the views that score most.
    fn fastest(
        &self,
        instance: &Instance,
        times: &Times,
        choice: &Choice,
        mut scored: Vec<(usize, f64)>,
        floor: f64,
    ) -> (Route, Route) {
        let survey = self.survey();
        scored.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        scored.truncate(POOL);
        let pool = scored.into_iter().map(|(i, _)| i);
        let joints = survey.joints();
        let market = Market::new(instance, &joints, times, pool, self.problem().selection.seed);
        let before = market.route(&choice.selected);
        let starts = [&choice.selected, &survey.near].into_iter().filter(|start| start.len() == choice.selected.len());
        let found = starts.filter_map(|start| market.trade(start, Aim::LeastTime { floor }, &mut |_| {}));
        let found = found.reduce(|best, other| if other.moving < best.moving { other } else { best });
        let found = found.unwrap_or_else(|| before.clone());
        (before, found)
    }
}

/// Adds to the survey the poses of `survey.good` pulled together on their tour, where the problem lets poses leave the grid and is about
/// the time that they take.
///
/// # Errors
/// As [`Chooser::best`].
pub(super) fn pull_together(problem: &Problem, survey: &mut Survey) -> Result<(), PlanError> {
    let settings = &problem.selection;
    let by_time = matches!(settings.goal, Goal::Within { .. } | Goal::Fewest { least: Least::Time, .. });
    if survey.good.is_empty() || settings.tour_tolerance == 0.0 && !by_time {
        return Ok(());
    }
    let pulled = {
        let chooser = Chooser::new(problem, survey)?;
        let count = survey.good.len();
        let instance = chooser.instance(count)?;
        let times = Times::new(&problem.motion);
        let choice = match chooser.known_to_be_good(&instance) {
            Some(good) => chooser.assess(good.to_vec()),
            None => chooser.best(count, settings.seed)?.0,
        };
        let (start, aim) = match &settings.goal {
            Goal::Within { seconds, .. } => {
                (choice.selected, Aim::MostInformation { most: seconds - times.total(0.0, count) })
            }
            goal => {
                let mut floor = choice.log_value + (1.0 - settings.tour_tolerance).ln();
                if goal.proves_fewest() {
                    floor = if by_time { 0.0 } else { floor.max(0.0) };
                }
                let scores = instance.scores(&instance.gradient(&choice.selected).map_err(|e| chooser.explain(e))?.y);
                let scored = (0..scores.len()).filter(|&i| instance.is_open(i)).map(|i| (i, scores[i])).collect();
                (chooser.fastest(&instance, &times, &choice, scored, floor).1.order, Aim::LeastTime { floor })
            }
        };
        let search = LocalSearch::new(problem, survey, chooser.objective());
        let start: Vec<_> = start.iter().map(|&i| &survey.views[i]).collect();
        Pull { search, problem, instance: &instance, times: &times }.pulled(&start, aim)?
    };
    if let Some(pulled) = pulled {
        survey.add_off_grid(problem, &pulled)?;
        survey.near = survey.places_of(&pulled);
    }
    Ok(())
}
