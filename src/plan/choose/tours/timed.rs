//! As many poses as serve, by the time of their tour.

use std::collections::BTreeMap;

use super::bound::{FIRST, Good, nearest};
use super::swaps::{Aim, Market, Route};
use super::{POOL, Times, Toured};
use crate::plan::choose::choice::Choice;
use crate::plan::choose::chooser::Chooser;
use crate::plan::choose::error::PlanError;
use crate::plan::choose::refined_survey::PICKS;
use crate::selection::{Instance, Part, improved_greedy};

/// Numbers of poses that are tried in vain before more are no better.
const IN_VAIN: usize = 2;

/// First step between numbers of poses tried, as a share of them.
const STEP: f64 = 0.25;

/// Finds choices of as many poses as serve.
pub(in crate::plan::choose) struct Numbers<'a> {
    chooser: &'a Chooser<'a>,
    times: Times<'a>,
    /// Joint values of all views.
    joints: Vec<&'a [f64]>,
    /// Views that poses are chosen from.
    pool: Vec<usize>,
    /// Time that lies between two poses at least, s.
    nearest: f64,
}

impl<'a> Numbers<'a> {
    /// # Errors
    /// As [`Chooser::best`].
    pub(in crate::plan::choose) fn new(chooser: &'a Chooser<'a>) -> Result<Self, PlanError> {
        let survey = chooser.survey();
        let count = PICKS.max(chooser.problem().constraints.required.len()).min(survey.views.len());
        let instance = chooser.instance(count)?;
        let times = Times::new(&chooser.problem().motion);
        let mut open: Vec<usize> = (0..survey.views.len()).filter(|&i| instance.is_open(i)).collect();
        let allowed: Vec<usize> = open.iter().chain(instance.required()).copied().collect();
        let joints = survey.joints();
        let nearest = nearest(&instance, &joints, &times, &allowed);
        let scores = instance.scores(&chooser.certificate(count)?.y);
        open.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
        open.truncate(POOL);
        open.sort_unstable();
        Ok(Self { chooser, times, joints, pool: open, nearest })
    }

    /// Most poses whose tour may take so long.
    pub(in crate::plan::choose) fn most(&self, seconds: f64) -> usize {
        let views = self.joints.len();
        let least = |of: &dyn Fn(&[f64]) -> f64| self.joints.iter().map(|q| of(q)).fold(f64::INFINITY, f64::min);
        let home = least(&|q| self.times.begin(q)) + least(&|q| self.times.end(q));
        // Rounding must not exclude a tour that just fits.
        let fits = |count: usize| {
            let moving = home + self.nearest * count.saturating_sub(1) as f64;
            self.times.total(moving, count) <= seconds * (1.0 + 1e-12)
        };
        let each = self.times.total(self.nearest, 1);
        let about = if each > 0.0 { (seconds / each).min(views as f64) as usize + 1 } else { views };
        (0..=about.min(views)).rev().find(|&count| fits(count)).unwrap_or(0)
    }

    /// The choice of greatest log Φ found whose tour keeps the time.
    ///
    /// # Errors
    /// When no tour found that determines all intrinsics is so short.
    pub(in crate::plan::choose) fn within(&self, seconds: f64) -> Result<Toured, PlanError> {
        let most = self.most(seconds);
        let least = self.chooser.problem().constraints.required.len().max(1);
        let mut known: BTreeMap<usize, Option<Route>> = BTreeMap::new();
        let mut shortest = f64::INFINITY;
        let mut at = |count: usize| -> f64 {
            if !(least..=most).contains(&count) {
                return f64::NEG_INFINITY;
            }
            if !known.contains_key(&count) {
                let beside = known.values().flatten().min_by_key(|other| other.order.len().abs_diff(count)).cloned();
                let aim = Aim::MostInformation { most: seconds - self.times.total(0.0, count) };
                let found = self.traded(count, aim, beside.as_ref(), &mut shortest);
                known.insert(count, found);
            }
            known[&count].as_ref().map_or(f64::NEG_INFINITY, |found| found.log_value)
        };
        let mut count = self.about(seconds).clamp(least, most.max(least));
        let mut value = at(count);
        // Fewer, until some fit.
        while value == f64::NEG_INFINITY && count > least {
            count = (count * 3 / 4).max(least);
            value = at(count);
        }
        let mut step = ((STEP * count as f64) as usize).max(1);
        while step > 0 {
            let tries = [count + step, count.saturating_sub(step)].map(|other| (at(other), other));
            match tries.into_iter().reduce(|a, b| if b.0 > a.0 { b } else { a }) {
                Some((better, other)) if better > value => (value, count) = (better, other),
                _ => step /= 2,
            }
        }
        match known.remove(&count).flatten() {
            Some(found) if found.log_value > f64::NEG_INFINITY => Ok(self.timed(found)),
            _ => Err(PlanError::NoTime { seconds, shortest }),
        }
    }

    /// The choice of the shortest tour found whose log Φ is 0 at least, from one that is so; and what no tour of such a choice, of
    /// `least` poses or more, takes less than, s.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub(in crate::plan::choose) fn soonest(&self, start: &Choice, least: usize) -> Result<(Toured, f64), PlanError> {
        let aim = Aim::LeastTime { floor: 0.0 };
        let mut best: Option<Route> = None;
        let total = |toured: &Route| self.times.total(toured.moving, toured.order.len());
        let mut in_vain = 0;
        let mut count = start.selected.len();
        while in_vain < IN_VAIN && count <= self.joints.len() {
            let least_total = self.times.total(self.nearest * (count - 1) as f64, count);
            if best.as_ref().is_some_and(|best| total(best) <= least_total) {
                break;
            }
            let instance = self.chooser.instance(count)?;
            let first = (count == start.selected.len()).then(|| self.market(&instance).route(&start.selected));
            let found = self.traded(count, aim, first.as_ref().or(best.as_ref()), &mut 0.0);
            match found {
                Some(found) if best.as_ref().is_none_or(|best| total(&found) < total(best)) => {
                    best = Some(found);
                    in_vain = 0;
                }
                _ => in_vain += 1,
            }
            count += 1;
        }
        let found = best.map_or_else(|| self.toured(start.clone()), |best| Ok(self.timed(best)))?;
        let mut bound = found.seconds;
        for count in least..=self.joints.len() {
            let moving = self.nearest * (count - 1) as f64;
            let least_total = self.times.total(moving, count);
            // Beyond, more poses take longer, or as long.
            if least_total >= bound || count >= found.choice.selected.len() + PICKS {
                bound = bound.min(least_total);
                break;
            }
            let instance = self.chooser.instance(count)?;
            let certificate = self.chooser.certificate(count)?;
            let good = Good {
                instance: &instance,
                certificate: &certificate,
                floor: 0.0,
                joints: &self.joints,
                times: &self.times,
                first: FIRST,
            };
            bound = bound.min(self.times.total(good.least_moving(), count));
        }
        Ok((found, bound))
    }

    fn market<'m>(&'m self, instance: &'m Instance<'m>) -> Market<'m> {
        Market::new(
            instance,
            &self.joints,
            &self.times,
            self.pool.iter().copied(),
            self.chooser.problem().selection.seed,
        )
    }

    /// The best for `aim` of `count` poses, from the most informative ones and from a set of another number; the shortest of all tours
    /// that were looked at is noted.
    fn traded(&self, count: usize, aim: Aim, beside: Option<&Route>, shortest: &mut f64) -> Option<Route> {
        let instance = self.chooser.instance(count).ok()?;
        let market = self.market(&instance);
        let part = Part::new(&instance, self.pool.iter().copied());
        let most_informative = improved_greedy(&part.instance()).ok().map(|places| part.members(&places));
        let near = Some(&self.chooser.survey().near).filter(|near| near.len() == count).cloned();
        let resized = beside.and_then(|beside| market.resized(beside, count));
        let mut best: Option<Route> = None;
        for start in [most_informative, near, resized].into_iter().flatten() {
            let found = market.trade(&start, aim, &mut |seen| {
                if seen.log_value > f64::NEG_INFINITY {
                    *shortest = shortest.min(self.times.total(seen.moving, count));
                }
            });
            let worth = |set: &Option<Route>| set.as_ref().and_then(|set| aim.worth(set.log_value, set.moving));
            if worth(&found) > worth(&best) {
                best = found;
            }
        }
        best
    }

    /// About how many of the most informative poses take so long.
    fn about(&self, seconds: f64) -> usize {
        let count = PICKS.max(self.chooser.problem().constraints.required.len()).min(self.joints.len());
        let total = self.chooser.instance(count).ok().and_then(|instance| {
            let part = Part::new(&instance, self.pool.iter().copied());
            let toured = self.market(&instance).route(&part.members(&improved_greedy(&part.instance()).ok()?));
            Some(self.times.total(toured.moving, count))
        });
        total.map_or(count, |total| (count as f64 * seconds / total.max(f64::MIN_POSITIVE)) as usize)
    }

    fn timed(&self, toured: Route) -> Toured {
        let seconds = self.times.total(toured.moving, toured.order.len());
        Toured { choice: self.chooser.assess(toured.order), seconds }
    }

    /// Time of a tour of so many poses whose moves take `moving`, s.
    pub(in crate::plan::choose) fn total(&self, moving: f64, poses: usize) -> f64 {
        self.times.total(moving, poses)
    }

    /// A choice with its tour.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub(in crate::plan::choose) fn toured(&self, choice: Choice) -> Result<Toured, PlanError> {
        let instance = self.chooser.instance(choice.selected.len())?;
        let toured = self.market(&instance).route(&choice.selected);
        Ok(Toured { choice, seconds: self.times.total(toured.moving, toured.order.len()) })
    }
}
