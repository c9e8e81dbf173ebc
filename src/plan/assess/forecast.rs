//! What a run would find and take, from a small pilot of every stage on the problem's own numbers.

use std::hint::black_box;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::verify::verify;
use crate::feasibility::{LinkPairs, Rejection, View};
use crate::plan::choose::{Chooser, PICKS, SAMPLED_OFF_GRID};
use crate::plan::document::{
    CameraSights, CheckDocument, CollisionDocument, DiagnosisDocument, Document, LensDocument, NoteDocument,
    ProblemReference, SelfCollision, finite,
};
use crate::plan::survey::{Diagnosis, Survey, join, spacings};
use crate::problem::{Goal, Method, PoseConstraints, Problem};
use crate::sweep::{AxisRule, sweep};
use crate::target::{AxisCase, Board, Checkerboard};
use crate::verification::{Disturbance, Weighing};

/// Configurations tried at most, and how long.
const TRIED: usize = 20_000;
const TRYING: Duration = Duration::from_millis(700);

/// Configurations of the pilot sweep.
const SWEPT: usize = 100_000;

/// Views that the pilot selection has to choose from, and poses that it chooses, at most.
const CANDIDATES: usize = 1200;
const CHOSEN: usize = 40;

/// Fewest poses from whose information that of others is told: hardly fewer determine all intrinsics.
const TELLING: usize = 8;

/// Configurations that the pilot of refinement tries.
const REFINED: usize = 400;

/// Trials of the pilot of verification.
const TRIALS: usize = 8;

/// Boards with more corners than this along a side are thinned out for the pilot.
const ALONG: usize = 12;

/// What selection, the report's curve and k-means beside the plan take of each candidate, in scorings of it by a gradient: whatever
/// the number of poses, and for each pose. Of grids of up to a million views.
const SCORINGS: f64 = 500.0;
const SCORINGS_PER_POSE: f64 = 150.0;

/// How long scorings are timed.
const SCORING: Duration = Duration::from_millis(2);

/// Views that climbs off the grid look at for each joint, whatever the number of poses and for each pose.
const LOOKS: f64 = 20_000.0;
const LOOKS_PER_POSE: f64 = 1_200.0;

/// Selections that it takes to find the fewest poses, with the bounds on fewer.
const FEWEST: f64 = 4.0;

/// Bytes of the program before it does anything.
const PROGRAM: f64 = 30e6;

/// What a run of `plan` is expected to find and to take on this machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Configurations that were tried.
    pub tried: usize,
    /// Views to choose from, those of refinement not counted.
    pub views: usize,
    /// Poses: as many as asked for, or the fewest that reach the accuracies; none where that cannot be told.
    pub count: Option<usize>,
    /// Seconds, a search for the proven best set left out.
    pub seconds: f64,
    /// Bytes of memory at most.
    pub bytes: f64,
}

impl Forecast {
    /// The forecast, and what else `check` says of a problem with these `links`: a diagnosis where views are scarce, a warning
    /// where memory is.
    pub fn document(
        &self,
        problem: &Problem,
        links: &LinkPairs,
        diagnosis: Option<&Diagnosis>,
        memory_warning: Option<String>,
    ) -> CheckDocument {
        let tree = &problem.robot.tree;
        // The mass is that of any configuration.
        let center_of_mass = tree.center_of_mass(&tree.link_poses(&problem.robot.chain.mid_range()));
        let notes = problem.notes.iter().map(|note| NoteDocument { key: note.key.clone(), note: note.text.clone() });
        let selection = &problem.selection;
        CheckDocument {
            header: CheckDocument::header(),
            problem: ProblemReference::new(problem),
            configurations: problem.space.len(),
            estimated_views: self.views,
            estimated_poses: self.count,
            estimated_seconds: finite(self.seconds),
            search_limit_seconds: selection.goal.searches().then_some(selection.time_limit.as_secs_f64()),
            estimated_memory_mb: finite((self.bytes / 1e6).ceil()),
            memory_warning,
            diagnosis: diagnosis.map(DiagnosisDocument::new),
            camera: CameraSights::new(problem),
            lens: LensDocument::new(&problem.camera),
            collision: CollisionDocument::new(problem, links),
            self_collision: SelfCollision::new(problem, links),
            mass_kg: center_of_mass.map(|center| center.mass),
            notes: notes.collect(),
        }
    }
}

/// What was learnt of the candidates.
struct Pilot {
    tried: usize,
    /// Share of the configurations that the sweep hands on.
    handed_on: f64,
    views: Vec<View>,
    /// Seconds to test a candidate, and to test one that is a view.
    test: f64,
    pass: f64,
}

/// Forecasts the run of `plan` that `trials` simulated calibrations end.
pub fn forecast(problem: &Problem, trials: usize) -> Forecast {
    let mut small = thinned(problem);
    // Required poses are no views of the pilot; what is known beforehand stays.
    small.constraints =
        PoseConstraints { captured: problem.constraints.captured.clone(), ..PoseConstraints::default() };
    let corners = problem.target.board.corner_count() as f64 / small.target.board.corner_count() as f64;
    let total = problem.space.size();
    let start = Instant::now();
    let pilot = Pilot::new(&small);
    let prepared = start.elapsed().as_secs_f64() - pilot.test * pilot.handed_on * pilot.tried as f64;
    let share = pilot.views.len() as f64 / pilot.tried.max(1) as f64;
    let views = share * total;
    let candidates = pilot.handed_on * total;
    let test = pilot.test + (corners - 1.0) * pilot.pass * share / pilot.handed_on.max(share).max(f64::MIN_POSITIVE);
    let mut seconds = sweeping(problem) + prepared.max(0.0) + candidates * test;
    let mut kept = views;
    let mut count = problem.selection.goal.count();
    if let Some(chosen) = Chosen::new(&small, &pilot) {
        seconds += views * corners * chosen.inform;
        let weighings = |candidates: f64, k: f64| candidates * chosen.score * (SCORINGS + SCORINGS_PER_POSE * k);
        if let Some((try_one, joined)) = chosen.refining {
            let sample = problem.refinement.sample as f64;
            let picked = count.unwrap_or(PICKS);
            for _ in 0..problem.refinement.rounds {
                seconds += sample * try_one * corners + weighings(kept, picked as f64);
                kept += sample * joined;
            }
        }
        count = count.or_else(|| chosen.count(kept));
        let k = count.unwrap_or(PICKS) as f64;
        seconds += chosen.selection + weighings(kept, k);
        if problem.selection.leaves_grid() {
            let looks = problem.robot.chain.dof() as f64 * (LOOKS + LOOKS_PER_POSE * k);
            seconds +=
                looks * corners * (pilot.pass + chosen.inform) + SAMPLED_OFF_GRID as f64 * pilot.handed_on * test;
        }
        seconds += chosen.trial * corners * k * trials as f64;
    }
    Forecast {
        tried: pilot.tried,
        views: views.round() as usize,
        count,
        seconds,
        bytes: bytes(problem, candidates, kept),
    }
}

/// Bytes at most: the candidates' numbers, the views and what they teach.
fn bytes(problem: &Problem, candidates: f64, views: f64) -> f64 {
    let p = problem.measurement().order();
    let scenarios = problem.robust.as_ref().map_or(1, |robust| robust.scenarios);
    let numbers =
        problem.robot.chain.dof() + p * (p + 1) / 2 * (1 + problem.selection.goal.criteria().len()) * scenarios;
    let seen = problem.visibility.min_corners.map_or(0, |_| problem.target.board.corner_count());
    let view = size_of::<View>() + 8 * (numbers + seen) + 32;
    PROGRAM + candidates * 16.0 + views * view as f64
}

/// The bytes that a run would need at most, from counts alone: quicker than a whole forecast.
pub fn forecast_bytes(problem: &Problem) -> f64 {
    let small = thinned(problem);
    let pilot = Pilot::new(&small);
    let total = problem.space.size();
    let views = pilot.views.len() as f64 / pilot.tried.max(1) as f64 * total;
    let refined = (problem.refinement.rounds * problem.refinement.sample) as f64;
    bytes(problem, pilot.handed_on * total, views + refined)
}

/// The same problem with a board of few corners, as large as the problem's.
fn thinned(problem: &Problem) -> Problem {
    let mut small = problem.clone();
    // Of the other kinds no board is like one with fewer corners.
    let Board::Checkerboard(Checkerboard { columns, rows, square }) = &mut small.target.board else { return small };
    let factor = ((*columns).max(*rows) - 1).div_ceil(ALONG - 1).max(1);
    *columns = ((*columns - 1) / factor + 1).max(2);
    *rows = ((*rows - 1) / factor + 1).max(2);
    *square *= factor as f64;
    let share = small.target.board.corner_count() as f64 / problem.target.board.corner_count() as f64;
    small.visibility.min_corner_spacing *= factor as f64;
    small.visibility.min_corners = problem.visibility.min_corners.map(|least| ((least as f64 * share) as usize).max(4));
    small
}

impl Pilot {
    fn new(problem: &Problem) -> Self {
        let Problem { robot, target, space, .. } = problem;
        let checks = problem.checks();
        let ids: Vec<usize> = space.evenly(TRIED).collect();
        let meets = |&&id: &&usize| {
            let X_TC = target.X_BT.inverse() * robot.camera_pose(&space.configuration(id));
            let axis = X_TC.rotation * nalgebra::Vector3::z();
            let t = -X_TC.translation.z / axis.z;
            let point = X_TC.translation.vector + axis * t;
            t > 0.0 && target.zone.case(point.x, point.y) != AxisCase::Outside
        };
        let (mut tried, mut handed_on, mut views) = (0, 0, Vec::new());
        let (mut testing, mut batch) = (Duration::ZERO, 64);
        while tried < ids.len() && testing < TRYING {
            let some = &ids[tried..(tried + batch).min(ids.len())];
            let candidates: Vec<usize> = match problem.axis {
                AxisRule::Any => some.to_vec(),
                AxisRule::Zone => some.par_iter().filter(meets).copied().collect(),
            };
            let start = Instant::now();
            let tested = candidates.par_iter().map(|&id| checks.view(id, &space.configuration(id)));
            views.extend(tested.collect::<Vec<Result<View, Rejection>>>().into_iter().flatten());
            testing += start.elapsed();
            handed_on += candidates.len();
            tried += some.len();
            batch *= 2;
        }
        views.sort_by_key(|view| view.id);
        views.dedup_by_key(|view| view.id);
        let again = &views[..views.len().min(200)];
        let start = Instant::now();
        let passed = again.par_iter().filter(|view| checks.view(view.id, &view.q).is_ok()).count();
        let pass = start.elapsed().as_secs_f64() / passed.max(1) as f64;
        let test = testing.as_secs_f64() / handed_on.max(1) as f64;
        Self { tried, handed_on: handed_on as f64 / tried.max(1) as f64, views, test, pass }
    }
}

/// Seconds of the whole sweep, from that of a coarser one.
fn sweeping(problem: &Problem) -> f64 {
    let space = problem.space.coarser(SWEPT);
    let start = Instant::now();
    let found = sweep(&problem.robot, &problem.target, &space, problem.axis, &|_| {});
    start.elapsed().as_secs_f64() * problem.space.size() / found.swept.max(1) as f64
}

/// What the pilot of selection, and of what follows it, took.
struct Chosen<'a> {
    problem: &'a Problem,
    survey: Survey,
    /// Seconds to weigh a view.
    inform: f64,
    /// Seconds to score one by a gradient.
    score: f64,
    /// Seconds of the pilot's selection.
    selection: f64,
    /// Seconds of refinement for a configuration, and the share of those that are views.
    refining: Option<(f64, f64)>,
    /// Seconds of a simulated calibration for each of its poses.
    trial: f64,
}

impl<'a> Chosen<'a> {
    /// None where the pilot's views do not suffice for a choice.
    fn new(problem: &'a Problem, pilot: &Pilot) -> Option<Self> {
        let most = pilot.views.len().min(CANDIDATES);
        let stride = pilot.views.len().div_ceil(most.max(1)).max(1);
        let some: Vec<View> = pilot.views.iter().step_by(stride).cloned().collect();
        let start = Instant::now();
        let survey = Survey::of(problem, some).ok()?;
        let inform = start.elapsed().as_secs_f64() / survey.views.len().max(1) as f64;
        let m = survey.views.len();
        if m < 2 {
            return None;
        }
        let asked = problem.selection.goal.count().unwrap_or(CHOSEN);
        let poses = asked.min(CHOSEN).min(m / 2).max(1);
        let settings = &problem.selection;
        let chooser = Chooser::new(problem, &survey).ok()?;
        let start = Instant::now();
        match settings.goal {
            Goal::Best { method, .. } if !matches!(method, Method::Best | Method::Exact) => {
                chooser.choose(method, poses, settings.seed).ok()?;
                chooser.certificate(poses).ok()?;
            }
            _ => drop(chooser.best(poses, settings.seed).ok()?),
        }
        let times = if matches!(settings.goal, Goal::Fewest { .. }) { FEWEST } else { 1.0 };
        let selection = times * start.elapsed().as_secs_f64();
        let choice = chooser.choose(Method::Exchange, poses, settings.seed).ok()?;
        let score = scoring(&chooser, &choice.selected)?;
        drop(chooser);
        let picks: Vec<Vec<f64>> = choice.selected.iter().map(|&i| survey.views[i].q.clone()).collect();
        let refining = (problem.refinement.rounds > 0).then(|| refining(problem, &survey, &picks)).flatten();
        let start = Instant::now();
        let verified = verify(problem, &picks, &Disturbance::default(), Weighing::default(), TRIALS, 0, &|_| {});
        let trial = start.elapsed().as_secs_f64() / (TRIALS * poses) as f64;
        let trial = if verified.is_ok() { trial } else { 0.0 };
        Some(Self { problem, survey, inform, score, selection, refining, trial })
    }

    /// As many of `views` candidates as serve, where no number of poses is asked for.
    fn count(&self, views: f64) -> Option<usize> {
        if let Goal::Within { seconds, .. } = self.problem.selection.goal {
            let found = Chooser::new(self.problem, &self.survey).ok()?.within(seconds).ok()?;
            return Some(found.choice.selected.len());
        }
        self.fewest(views)
    }

    /// The fewest of `views` candidates that reach the accuracies, by the density of the best among the pilot's; none if all
    /// do not suffice.
    fn fewest(&self, views: f64) -> Option<usize> {
        let m = self.survey.views.len() as f64;
        let chooser = Chooser::new(self.problem, &self.survey).ok()?;
        let mut count = CHOSEN as f64;
        for _ in 0..5 {
            // So many of the pilot's are as dense among them as `count` among all; of few the best are a little better.
            let dense = (count * m / views).max(TELLING as f64).min(m).floor();
            let choice = chooser.choose(Method::Greedy, dense as usize, 0).ok()?;
            let needed = dense / choice.log_value.exp();
            if (needed / count - 1.0).abs() < 0.02 {
                break;
            }
            count = needed;
        }
        (count <= views).then_some(count.ceil() as usize)
    }
}

/// Seconds to score a candidate by the gradient at `selected`, on all threads.
fn scoring(chooser: &Chooser, selected: &[usize]) -> Option<f64> {
    let instance = chooser.instance(selected.len()).ok()?;
    let gradient = instance.gradient(selected).ok()?;
    let start = Instant::now();
    let mut scored = 0;
    while start.elapsed() < SCORING {
        scored += black_box(instance.scores(&gradient.y)).len();
    }
    Some(start.elapsed().as_secs_f64() / (scored * rayon::current_num_threads()) as f64)
}

/// Seconds that a configuration around the picks takes, and the share that are views.
fn refining(problem: &Problem, survey: &Survey, picks: &[Vec<f64>]) -> Option<(f64, f64)> {
    let mut small = problem.clone();
    small.refinement.sample = REFINED.max(picks.len());
    let mut refined = survey.clone();
    let start = Instant::now();
    join(&small, &mut refined, picks, &spacings(problem)).ok()?;
    let tried = refined.refined.max(1) as f64;
    let joined = (refined.views.len() - survey.views.len()) as f64;
    Some((start.elapsed().as_secs_f64() / tried, joined / tried))
}
