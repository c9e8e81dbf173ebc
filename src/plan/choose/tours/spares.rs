//! Poses that no safe move leads to, and what takes their place.

use super::{POOL, Times};
use crate::feasibility::Collision;
use crate::motion::journey::{Arm, Blocked, Journey, Move};
use crate::motion::{Danger, Safety};
use crate::plan::choose::choice::Choice;
use crate::plan::choose::chooser::Chooser;
use crate::plan::choose::error::PlanError;
use crate::problem::Problem;
use crate::selection::Certificate;

/// Most times that poses give way.
const ROUNDS: usize = 4;

/// Most views that are tried in the place of a pose.
const TRIED: usize = 24;

/// Views within this share of a mean move of one that was tried in vain are not tried.
const NEAR: f64 = 0.2;

/// A pose that gave way to another, because no safe move leads to it.
#[derive(Debug, Clone, PartialEq)]
pub struct GaveWay {
    /// Its place among the survey's views.
    pub view: usize,
    /// What stands in its way.
    pub danger: Danger,
}

/// The moves through poses, joint values in rad or m, as they lie or round about; home comes after them.
pub(crate) fn journey(problem: &Problem, poses: &[&[f64]]) -> Journey {
    let times = Times::new(&problem.motion);
    let collision = Collision::new(&problem.robot, problem.clearance);
    let arm = arm(problem, &collision);
    Journey::new(&arm, &times.stops(poses), times.ends(poses.len()), problem.selection.seed)
}

/// A choice with the moves through it.
#[derive(Debug, Clone, PartialEq)]
pub struct Led {
    /// The choice.
    pub choice: Choice,
    /// The moves, stops numbered as the choice's views, home after them.
    pub journey: Journey,
    /// Poses of the choice before that are not in it.
    pub gave_way: Vec<GaveWay>,
}

impl Chooser<'_> {
    /// The moves through the poses of a choice, as they lie or round about.
    pub fn journey(&self, choice: &Choice) -> Journey {
        let poses: Vec<&[f64]> = choice.selected.iter().map(|&i| self.survey().views[i].q.as_slice()).collect();
        journey(self.problem(), &poses)
    }

    /// The moves through a choice, in which poses that no safe move leads to gave way to spares, as far as there are any.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub(in crate::plan::choose) fn led_to(&self, choice: Choice, certificate: &Certificate) -> Result<Led, PlanError> {
        let journey = self.journey(&choice);
        let mut led = Led { choice, journey, gave_way: vec![] };
        for _ in 0..ROUNDS {
            let cut = cut_off(&led.journey, led.choice.selected.len());
            if cut.is_empty() {
                break;
            }
            let Some(selected) = self.without(&led, &cut, certificate)? else { break };
            let gone = cut.iter().map(|&(place, danger)| GaveWay { view: led.choice.selected[place], danger });
            led.gave_way.extend(gone);
            led.choice = self.assess(selected);
            led.journey = self.journey(&led.choice);
        }
        Ok(led)
    }

    /// The poses with others in place of those that are cut off; none where one has no spare.
    fn without(
        &self,
        led: &Led,
        cut: &[(usize, Danger)],
        certificate: &Certificate,
    ) -> Result<Option<Vec<usize>>, PlanError> {
        let (problem, survey) = (self.problem(), self.survey());
        let selected = &led.choice.selected;
        let instance = self.instance(selected.len())?;
        let is_cut = |place: &usize| cut.iter().any(|(other, _)| other == place);
        let mut kept: Vec<usize> = (0..selected.len()).filter(|place| !is_cut(place)).map(|p| selected[p]).collect();
        if instance.required().iter().any(|i| !kept.contains(i)) || kept.is_empty() {
            return Ok(None);
        }
        // By what they would tell beside all poses: those that are gone tell something that is missed.
        let gradient = instance.gradient_at(&instance.total(selected));
        let scores = instance.scores(gradient.as_ref().map_or(&certificate.y, |gradient| &gradient.y));
        let gone = |i: usize| selected.contains(&i) || led.gave_way.iter().any(|gone| gone.view == i);
        let mut spares: Vec<usize> = (0..scores.len()).filter(|&i| instance.is_open(i) && !gone(i)).collect();
        spares.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
        spares.truncate(POOL);
        let times = Times::new(&problem.motion);
        let collision = Collision::new(&problem.robot, problem.clearance);
        let arm = arm(problem, &collision);
        let q = |i: usize| survey.views[i].q.as_slice();
        let near = NEAR * led.journey.as_numbered / led.journey.moves.len() as f64;
        let mut in_vain: Vec<usize> = cut.iter().map(|&(place, _)| selected[place]).collect();
        for _ in cut {
            let mut tried = 0;
            let spare = spares.iter().copied().find(|&i| {
                if tried == TRIED
                    || !instance.rules().allows(&kept, None, i)
                    || kept.contains(&i)
                    || in_vain.iter().any(|&other| times.between(q(other), q(i)) < near)
                {
                    return false;
                }
                tried += 1;
                let nearest = kept
                    .iter()
                    .copied()
                    .min_by(|&a, &b| times.between(q(a), q(i)).total_cmp(&times.between(q(b), q(i))));
                let is_safe = nearest.is_some_and(|nearest| {
                    !matches!(arm.go(q(nearest), q(i), problem.selection.seed).safety, Some(Err(_)))
                });
                if !is_safe {
                    in_vain.push(i);
                }
                is_safe
            });
            let Some(spare) = spare else { return Ok(None) };
            kept.push(spare);
        }
        Ok((!instance.is_singular(&kept)).then_some(kept))
    }
}

fn arm<'c>(problem: &'c Problem, collision: &'c Collision) -> Arm<'c> {
    let safety = Safety::new(&problem.robot, collision, problem.stability.as_ref());
    Arm::new(&problem.robot, problem.motion.limits(), safety)
}

/// The poses that only moves lead to that are not safe, with what stands in the way of one: of the stretches of safe moves all but that
/// with home, or where there is none, all but the longest. Home is number `poses`.
fn cut_off(journey: &Journey, poses: usize) -> Vec<(usize, Danger)> {
    let blocked = |found: &Move| match found.safety {
        Some(Err(Blocked { danger })) => Some(danger),
        _ => None,
    };
    let mut stretches: Vec<(Vec<usize>, Option<Danger>)> = vec![(vec![], None)];
    for (place, &stop) in journey.order.iter().enumerate() {
        let danger = place.checked_sub(1).and_then(|before| blocked(&journey.moves[before]));
        match (danger, stretches.last_mut()) {
            (None, Some((stretch, _))) => stretch.push(stop),
            (danger, _) => stretches.push((vec![stop], danger)),
        }
    }
    // The way back joins the last stretch to the first.
    if journey.moves.len() == journey.order.len()
        && stretches.len() > 1
        && journey.moves.last().and_then(blocked).is_none()
    {
        let (last, _) = stretches.pop().unwrap_or_default();
        stretches[0].0.extend(last);
    }
    let is_main = |stretch: &[usize]| (stretch.contains(&poses), stretch.len());
    let main = (0..stretches.len()).rev().max_by_key(|&i| is_main(&stretches[i].0)).unwrap_or(0);
    let first_danger = stretches.iter().find_map(|(_, danger)| *danger);
    let others = stretches.into_iter().enumerate().filter(|&(i, _)| i != main);
    others
        .flat_map(|(_, (stretch, danger))| {
            let danger = danger.or(first_danger);
            stretch.into_iter().filter_map(move |stop| Some((stop, danger?)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn journey(order: &[usize], blocked: &[bool]) -> Journey {
        let moves = blocked.iter().map(|&blocked| Move {
            via: vec![],
            seconds: 1.0,
            safety: blocked.then_some(Err(Blocked { danger: Danger::TippingOver })),
        });
        Journey { order: order.to_vec(), moves: moves.collect(), least: 0.0, as_numbered: 0.0 }
    }

    fn cut(order: &[usize], blocked: &[bool], poses: usize) -> Vec<usize> {
        cut_off(&journey(order, blocked), poses).into_iter().map(|(pose, _)| pose).collect()
    }

    #[test]
    fn what_is_not_on_the_stretch_with_home_or_the_longest_is_cut_off() {
        // Four poses, home is number 4.
        assert_eq!(cut(&[4, 0, 2, 1, 3], &[false, false, true, false], 4), [1, 3]);
        assert_eq!(cut(&[4, 0, 2, 1, 3], &[true, false, false, false], 4), [0, 2, 1, 3]);
        // Round: the way back leads to home too.
        assert_eq!(cut(&[4, 0, 2, 1, 3], &[false, true, false, true, false], 4), [2, 1]);
        assert_eq!(cut(&[4, 0, 2, 1, 3], &[false, false, false, true, true], 4), [3]);
        // One move that is not safe, and all are led to by another one.
        assert_eq!(cut(&[4, 0, 2, 1, 3], &[false, false, true, false, false], 4), [0; 0]);
        // Open.
        assert_eq!(cut(&[0, 2, 1, 3], &[true, false, false], 4), [0]);
        assert_eq!(cut(&[0, 2, 1, 3], &[false, true, false], 4), [1, 3]);
        assert_eq!(cut(&[0, 2, 1, 3], &[false, false, false], 4), [0; 0]);
    }
}
