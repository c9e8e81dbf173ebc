//! Poses pulled together along their tour.

use super::swaps::Aim;
use super::times::Times;
use crate::feasibility::View;
use crate::plan::choose::error::PlanError;
use crate::plan::choose::off_grid::{Candidate, LocalSearch, TRIES, add};
use crate::plan::survey::SurveyError;
use crate::problem::Problem;
use crate::selection::Instance;

/// What all moves count in the first cycle, in log Φ or as a share of what may be given up of it, and how much more from cycle to cycle.
const FIRST_PRICE: f64 = 0.2;
const STEEPER: f64 = 2.0;

/// Most cycles over all poses, and those of them that go too far.
const CYCLES: usize = 12;
const CYCLES_BEYOND: usize = 3;

/// Poses on a tour.
#[derive(Clone)]
struct Pulled {
    /// In the order of the tour.
    poses: Vec<Candidate>,
    total: Vec<f64>,
    log_value: f64,
    moving: f64,
}

/// What pulls poses.
pub(super) struct Pull<'a> {
    pub(super) search: LocalSearch<'a>,
    pub(super) problem: &'a Problem,
    pub(super) instance: &'a Instance<'a>,
    pub(super) times: &'a Times<'a>,
}

impl Pull<'_> {
    /// Joint values of the poses moved towards their neighbours on the tour, one after the other, with what moves count rising from
    /// cycle to cycle: the best for `aim` that was found. Poses that the constraints require stay, as the others stay views that the
    /// constraints allow. `None` if nothing better was found.
    ///
    /// # Errors
    /// When the poses leave a combination of the parameters undetermined.
    pub(super) fn pulled(&self, start: &[&View], aim: Aim) -> Result<Option<Vec<Vec<f64>>>, PlanError> {
        let poses: Option<Vec<Candidate>> = start.iter().map(|view| self.search.candidate(view)).collect();
        let mut current = self.ordered(&poses.ok_or_else(|| SurveyError::undetermined(self.problem))?);
        let worth = |pulled: &Pulled| aim.worth(pulled.log_value, pulled.moving);
        let first = worth(&current);
        let mut best = current.clone();
        if current.moving == 0.0 {
            return Ok(None);
        }
        let mut per_second = match aim {
            Aim::LeastTime { floor } => FIRST_PRICE * (current.log_value - floor).max(0.0) / current.moving,
            Aim::MostInformation { .. } => FIRST_PRICE / current.moving,
        };
        let mut beyond = 0;
        for _ in 0..CYCLES {
            let found = self.cycle(current.clone(), per_second);
            if worth(&found) > worth(&best) {
                best = found.clone();
            }
            let is_beyond = match aim {
                Aim::LeastTime { floor } => found.log_value < floor,
                Aim::MostInformation { most } => found.moving <= most,
            };
            if is_beyond {
                // Back to the last that was not, by half the step.
                beyond += 1;
                per_second /= STEEPER.sqrt();
            } else {
                current = found;
                per_second *= if beyond == 0 { STEEPER } else { 1.0 };
            }
            if beyond == CYCLES_BEYOND {
                break;
            }
        }
        Ok((worth(&best) > first).then(|| best.poses.into_iter().map(|pose| pose.view.q).collect()))
    }

    /// Poses in their best order.
    fn ordered(&self, poses: &[Candidate]) -> Pulled {
        let joints: Vec<&[f64]> = poses.iter().map(|pose| pose.view.q.as_slice()).collect();
        let (order, moving) = self.times.ordered(&joints, self.problem.selection.seed);
        let mut total = self.instance.prior();
        let poses: Vec<Candidate> = order.into_iter().map(|place| poses[place].clone()).collect();
        for pose in &poses {
            add(&mut total, &pose.information, 1.0);
        }
        Pulled { poses, log_value: self.instance.log_value_at(&total), total, moving }
    }

    /// Each pose once moved to where log Φ is greatest, less what the moves take.
    fn cycle(&self, mut pulled: Pulled, per_second: f64) -> Pulled {
        let required = &self.problem.constraints.required;
        for place in 0..pulled.poses.len() {
            if required.contains(&pulled.poses[place].view.id) {
                continue;
            }
            let others = pulled.poses.iter().enumerate().filter(|(other, _)| *other != place);
            let others: Vec<&View> = others.map(|(_, pose)| &pose.view).collect();
            let mut rest = pulled.total.clone();
            add(&mut rest, &pulled.poses[place].information, -1.0);
            let (before, after) = (place.checked_sub(1), place + 1);
            let value = |pose: &Candidate| {
                let mut total = rest.clone();
                add(&mut total, &pose.information, 1.0);
                let q = &pose.view.q;
                let arriving = before.map(|other| self.times.between(&pulled.poses[other].view.q, q));
                let leaving = pulled.poses.get(after).map(|other| self.times.between(q, &other.view.q));
                let moving =
                    arriving.unwrap_or_else(|| self.times.begin(q)) + leaving.unwrap_or_else(|| self.times.end(q));
                self.instance.log_value_in_place(&mut total) - per_second * moving
            };
            let own = value(&pulled.poses[place]);
            let start = &pulled.poses[place].view;
            let ends = TRIES.iter().filter_map(|&stretch| self.search.climb(start, &others, stretch, &value));
            let better = ends.map(|end| (value(&end), end)).filter(|(value, _)| *value > own);
            if let Some((_, end)) = better.max_by(|a, b| a.0.total_cmp(&b.0)) {
                add(&mut rest, &end.information, 1.0);
                pulled.total = rest;
                pulled.poses[place] = end;
            }
        }
        self.ordered(&pulled.poses)
    }
}
