//! What anyone's poses are worth, held against what the problem could have had.

mod pose;
mod swaps;
mod why;

pub use pose::{PoseToScore, PosesToScore, Unusable};

use crate::feasibility::View;
use crate::plan::choose::{Choice, Chooser, PlanError, plan_survey};
use crate::plan::document::{
    BestOfAsMany, CombinationTerm, Document, ProblemReference, ScoreDocument, ScoredPose, ScoredSet, ScoredSwap,
    finite, joints_deg,
};
use crate::plan::survey::{Joined, Survey};
use crate::problem::{Goal, Method, Problem, SelectionSettings};
use crate::selection::Certificate;
use swaps::{Swap, one_after_the_other, single};

/// A pose is redundant where less than this share of the information is lost without it.
const REDUNDANT: f64 = 0.01;

/// The same as a share of what a pose of so many has on average: of two hundred poses each has half a hundredth, and all count.
const OF_AVERAGE: f64 = 0.5;

/// Most poses that are looked for off the grid together; more are chosen from what is found for so many.
const MOST_OFF_GRID: usize = 40;

/// Scores the poses of a list, which was `read_as` some format and has places that are only `passed`. They are judged by the criteria
/// of `problem`, beside what is known already; of accuracies requested by the map error.
///
/// Two poses are held against the best two, and so on: the best are chosen from the views of a plan for as many poses, those off the
/// grid included, and from the list itself, as far as a plan could have its poses. Pictures taken already count as one each, and
/// whatever robustness the problem asks for does not, since their joint values are not known.
///
/// `observe` as in [`survey`](crate::plan::survey::survey).
///
/// # Errors
/// When the problem has no views to choose from, or its constraints cannot be held.
pub fn score(
    problem: &Problem,
    read_as: &str,
    list: &PosesToScore,
    passed: usize,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<ScoreDocument, PlanError> {
    let views: Vec<View> = list.poses.iter().filter_map(|pose| pose.view.clone().ok()).collect();
    let count = views.len();
    let stated = asked(problem, count, list.are_taken);
    let document = unscored(&stated, read_as, list, passed);
    if views.is_empty() {
        return Ok(document);
    }
    let off_grid = asked(problem, count.min(MOST_OFF_GRID), list.are_taken);
    let mut survey = plan_survey(&off_grid, observe)?;
    let joined = survey.join_listed(&stated, views, list.are_taken)?;
    let problem = forbidding(stated, &survey, &joined);
    let chooser = Chooser::new(&problem, &survey)?;
    let places: Vec<usize> = joined.iter().map(|joined| joined.place).collect();
    let scored = Scored { problem: &problem, chooser: &chooser, set: chooser.assess(places.clone()), places };
    scored.complete(document, &joined)
}

/// The problem of choosing the best `count` poses by the criteria of `problem`.
fn asked(problem: &Problem, count: usize, are_taken: bool) -> Problem {
    let criteria = problem.selection.goal.criteria().into_owned();
    let goal = Goal::Best { criteria, count: count.max(1), method: Method::Best };
    let SelectionSettings { pictures, .. } = problem.selection;
    let pictures = if are_taken { 1 } else { pictures };
    Problem {
        selection: SelectionSettings { goal, pictures, ..problem.selection.clone() },
        robust: problem.robust.clone().filter(|_| !are_taken),
        ..problem.clone()
    }
}

/// The problem in which no other choice has the poses of a list that a plan could not have.
fn forbidding(mut problem: Problem, survey: &Survey, joined: &[Joined]) -> Problem {
    let excluded = joined.iter().filter(|joined| joined.excluded.is_some()).map(|joined| survey.views[joined.place].id);
    let forbidden = &mut problem.constraints.forbidden;
    forbidden.extend(excluded);
    forbidden.sort_unstable();
    problem
}

/// What is known before anything is surveyed.
fn unscored(problem: &Problem, read_as: &str, list: &PosesToScore, passed: usize) -> ScoreDocument {
    let pose = |pose: &PoseToScore| {
        let unusable = pose.view.as_ref().err();
        ScoredPose {
            name: pose.name.clone(),
            joints_rad: pose.q.clone(),
            joints_deg: pose.q.as_ref().map(|q| joints_deg(&problem.robot.chain, q)),
            reason: unusable.map(|unusable| unusable.reason.into()),
            why: unusable.map(|unusable| unusable.why.clone()),
            excluded: None,
            loss: None,
            map_error_without_px: None,
            redundant: false,
        }
    };
    ScoreDocument {
        header: ScoreDocument::header(),
        problem: ProblemReference::new(problem),
        read_as: read_as.into(),
        listed: list.poses.len(),
        passed,
        count: list.poses.iter().filter(|pose| pose.view.is_ok()).count(),
        pictures: problem.selection.pictures,
        criterion: problem.selection.goal.to_string(),
        joints: problem.robot.chain.joints.iter().map(|joint| joint.name.clone()).collect(),
        poses: list.poses.iter().map(pose).collect(),
        set: None,
        best: None,
        no_best: None,
        efficiency: None,
        equal_best_count: None,
        swaps: vec![],
        exchange: vec![],
    }
}

/// The usable poses of a list among the views of a survey.
struct Scored<'a> {
    problem: &'a Problem,
    chooser: &'a Chooser<'a>,
    /// The places of the poses, in their order.
    places: Vec<usize>,
    set: Choice,
}

impl Scored<'_> {
    /// The document with all that is told of the usable poses.
    fn complete(&self, mut document: ScoreDocument, joined: &[Joined]) -> Result<ScoreDocument, PlanError> {
        let Self { problem, chooser, places, set } = self;
        let count = places.len();
        let redundant_below = REDUNDANT.min(OF_AVERAGE / count as f64);
        let mut kept = Vec::with_capacity(count);
        let usable = document.poses.iter_mut().filter(|pose| pose.reason.is_none());
        for ((pose, joined), number) in usable.zip(joined).zip(0..) {
            let others = places.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, &place)| place);
            let without = chooser.assess(others.collect());
            pose.excluded = joined.excluded.map(|excluded| excluded.name().into());
            pose.loss = finite(-(without.log_value - set.log_value).exp_m1());
            pose.map_error_without_px = finite(without.map_error);
            pose.redundant = pose.loss.is_some_and(|loss| loss < redundant_below);
            if !pose.redundant {
                kept.push(joined.place);
            }
        }
        document.set = Some(ScoredSet {
            value: finite(chooser.natural(set.log_value)).filter(|_| self.determines()),
            map_error_px: finite(set.map_error),
            sigma: self.sigma(set),
            undetermined: self.undetermined(),
            redundant_below,
            map_error_without_redundant_px: (kept.len() < count)
                .then(|| finite(chooser.assess(kept).map_error))
                .flatten(),
        });
        match chooser.best(count, problem.selection.seed) {
            Ok((best, certificate)) => {
                document.efficiency = Some(certificate.efficiency(set.log_value));
                document.equal_best_count = self.equal(&best);
                document.best = Some(self.best(&best, &certificate));
            }
            Err(error) => document.no_best = Some(error.to_string()),
        }
        let names: Vec<String> =
            document.poses.iter().filter(|pose| pose.reason.is_none()).map(|pose| pose.name.clone()).collect();
        // Where the constraints allow no choice of so many, they allow no swap.
        if document.best.is_some() {
            document.swaps = single(chooser, places)?.iter().map(|swap| self.swap(swap, &names)).collect();
            let exchange = one_after_the_other(chooser, places)?;
            document.exchange = exchange.iter().map(|swap| self.swap(swap, &names)).collect();
        }
        Ok(document)
    }

    fn determines(&self) -> bool {
        self.set.log_value > f64::NEG_INFINITY
    }

    fn sigma(&self, choice: &Choice) -> Vec<(String, f64)> {
        let names = self.problem.unknowns().names();
        names.iter().map(ToString::to_string).zip(choice.sigma.iter().copied()).collect()
    }

    fn undetermined(&self) -> Vec<CombinationTerm> {
        match self.chooser.require_observable(&self.set) {
            Err(PlanError::Unobservable { combination, .. }) => {
                combination.into_iter().map(|(name, coefficient)| CombinationTerm { name, coefficient }).collect()
            }
            _ => vec![],
        }
    }

    fn best(&self, best: &Choice, certificate: &Certificate) -> BestOfAsMany {
        let views = &self.chooser.survey().views;
        let forbidden = &self.problem.constraints.forbidden;
        BestOfAsMany {
            views: views.iter().filter(|view| forbidden.binary_search(&view.id).is_err()).count(),
            value: finite(self.chooser.natural(best.log_value)),
            bound: finite(self.chooser.natural(certificate.log_bound)),
            efficiency: certificate.efficiency(best.log_value),
            map_error_px: finite(best.map_error),
            sigma: self.sigma(best),
            joints_deg: best.selected.iter().map(|&i| joints_deg(&self.problem.robot.chain, &views[i].q)).collect(),
        }
    }

    /// The fewest of the best poses that are worth as much as the set, of which `best` are as many as there are in it.
    fn equal(&self, best: &Choice) -> Option<usize> {
        let suffices = |choice: &Choice| self.determines() && choice.log_value >= self.set.log_value;
        let (mut short, mut enough) = (0, self.places.len());
        if !suffices(best) {
            return None;
        }
        while enough - short > 1 {
            let middle = usize::midpoint(short, enough);
            // Too few to be chosen are too few.
            let is_enough =
                self.chooser.best(middle, self.problem.selection.seed).is_ok_and(|(choice, _)| suffices(&choice));
            if is_enough { enough = middle } else { short = middle }
        }
        Some(enough)
    }

    fn swap(&self, swap: &Swap, names: &[String]) -> ScoredSwap {
        let q = &self.chooser.survey().views[swap.incoming].q;
        ScoredSwap {
            out: names[swap.leaving].clone(),
            joints_rad: q.clone(),
            joints_deg: joints_deg(&self.problem.robot.chain, q),
            gain: finite((swap.after.log_value - self.set.log_value).exp_m1()).filter(|_| self.determines()),
            value: finite(self.chooser.natural(swap.after.log_value)),
            map_error_px: finite(swap.after.map_error),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::formats::{ListedPose, PoseList, StatedPlace};
    use crate::plan::survey::survey;
    use crate::problem::Overrides;

    fn listed<'v>(problem: &Problem, views: impl Iterator<Item = &'v View>) -> PosesToScore {
        let pose = |view: &View| ListedPose { name: view.id.to_string(), place: StatedPlace::Joints(view.q.clone()) };
        PosesToScore::listed(problem, &PoseList { poses: views.map(pose).collect(), passed: 0 })
    }

    /// Of so many poses chosen at random each one's information is a small share, and what is redundant is told by its share.
    #[test]
    fn what_is_redundant_is_little_of_an_average_pose() {
        let overrides = Overrides::new().set("sweep.step_deg=20").unwrap().set("selection.off_grid=false").unwrap();
        let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap();
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let chosen = chooser.choose(Method::Random, 80, 1).unwrap();
        let list = listed(&problem, chosen.selected.iter().map(|&i| &survey.views[i]));
        let score = score(&problem, "plan", &list, 0, &|_| {}).unwrap();
        let set = score.set.as_ref().unwrap();
        assert_eq!((score.count, set.redundant_below), (80, 0.5 / 80.0));
        assert!((set.map_error_px.unwrap() / chosen.map_error - 1.0).abs() < 1e-12);
        let kept = |without: &dyn Fn(&ScoredPose) -> bool| {
            let kept = chosen.selected.iter().zip(&score.poses).filter(|(_, pose)| !without(pose));
            chooser.assess(kept.map(|(&i, _)| i).collect())
        };
        for pose in &score.poses {
            let choice = kept(&|other| other.name == pose.name);
            let loss = 1.0 - (choice.log_value - chosen.log_value).exp();
            assert!((pose.loss.unwrap() - loss).abs() < 1e-9);
            assert_eq!(pose.redundant, loss < set.redundant_below);
        }
        let redundant = score.poses.iter().filter(|pose| pose.redundant).count();
        assert!(redundant > 3 && redundant < 80, "{redundant}");
        let without_all = kept(&|pose| pose.redundant).map_error;
        assert!((set.map_error_without_redundant_px.unwrap() / without_all - 1.0).abs() < 1e-9);
        // As few of the best do as much, and one less do not.
        let equal = score.equal_best_count.unwrap();
        let best = |count| chooser.best(count, problem.selection.seed).unwrap().0.log_value;
        assert!(equal < 40 && best(equal) >= chosen.log_value && best(equal - 1) < chosen.log_value, "{equal}");
    }
}
