//! What bounds scores at all joint values: a matrix Y, and prices of balls of pictures where poses are kept apart.
//!
//! Both are those of a relaxation on views, whose best joint values and balls are found by cutting planes. What a relaxation promises
//! holds of its own views alone: in the gaps between its balls views score more, those that climbs find join, and with them new
//! balls. The rounds need not end: each has a dual that bounds all joint values, and the one of least promise beyond its views is kept.

use std::sync::Arc;

use rayon::prelude::*;

use super::choice::Choice;
use super::chooser::Chooser;
use super::constraints::place_of_pictures;
use super::error::PlanError;
use super::off_grid::{Candidate, LocalSearch};
use crate::continuum::PictureBall;
use crate::feasibility::View;
use crate::plan::survey::PricedPictures;
use crate::problem::Problem;
use crate::selection::packed::dot;
use crate::selection::{Certificate, Gradient, Group, Instance, RelaxationSettings, highest, relax};

/// Views of the greatest scores among which it is sought, beside those off the grid: where poses may repeat, and where not.
const COLUMNS: usize = 60;
const SEPARATED_COLUMNS: usize = 1000;

/// Gap of the relaxation where poses may repeat.
const GAP: f64 = 1e-6;

/// Most rounds, and rounds in a row that promise nothing better after which no more are made.
const ROUNDS: usize = 24;
const VAIN_ROUNDS: usize = 5;

/// Views that climbs start from in a round, beside those found before, and how wide their simplices are.
const STARTS: usize = 60;
const STRETCHES: [f64; 3] = [0.1, 0.3, 1.0];

/// Share of the least score among the best k by which others must exceed it to join, and how many do in a round.
const BEYOND: f64 = 0.005;
const JOINING: usize = 40;

/// The share of half the least distance that the pictures of those which join keep from each other.
const APART: f64 = 0.2;

/// Y and the balls.
pub(super) struct Dual {
    pub(super) gradient: Gradient,
    pub(super) balls: Vec<PricedPictures>,
    /// The greatest score, less prices, of the views that were looked at.
    pub(super) score: f64,
}

impl Dual {
    /// What it bounds log Φ of `count` poses by if no view scores more than `score`, less prices.
    pub(super) fn log_bound(&self, instance: &Instance, count: usize, score: f64) -> f64 {
        let prior = dot(&instance.prior(), &instance.dual(&self.gradient.y));
        let paid: f64 = self.balls.iter().map(|ball| ball.price).sum();
        (prior + paid + count as f64 * score).ln() - instance.log_polar(&self.gradient)
    }

    /// Of `count` poses that may repeat; those of `choice` are looked at in any case.
    pub(super) fn repeated(
        chooser: &Chooser,
        choice: &Choice,
        certificate: &Certificate,
        count: usize,
    ) -> Result<Self, PlanError> {
        let (problem, survey, objective) = (chooser.problem(), chooser.survey(), chooser.objective());
        let instance = chooser.instance(count)?;
        let scores = instance.scores(&certificate.y);
        let off_grid = survey.views.len() - survey.off_grid;
        let mut places = highest(&scores, (0..scores.len()).filter(|&i| instance.is_open(i)), COLUMNS);
        places.extend((off_grid..survey.views.len()).chain(choice.selected.iter().copied()));
        places.sort_unstable();
        places.dedup();
        // Weights that add up to one, on `count` times the information.
        let search = LocalSearch::new(problem, survey, objective);
        let matrices = places.iter().filter_map(|&i| Some(search.candidate(&survey.views[i])?.information));
        let repeated = objective.on(&matrices.collect::<Vec<_>>()).known_share(1.0 / count as f64);
        let relaxed = repeated.instance(1, &Arc::default()).map_err(|error| chooser.explain(error))?;
        let all: Vec<usize> = (0..relaxed.len()).collect();
        let fine = RelaxationSettings { tolerance: GAP, ..RelaxationSettings::default() };
        let relaxation = relax(&relaxed, &all, &fine).map_err(|error| chooser.explain(error))?;
        let Certificate { y, mixture, .. } = relaxation.certificate;
        let gradient = Gradient { y, mixture };
        let score = instance.scores(&gradient.y).into_iter().fold(0.0, f64::max);
        Ok(Self { gradient, balls: Vec::new(), score })
    }

    /// Of `count` poses whose pictures are kept apart. `goes_on` may end the rounds; the best until then is returned, if there is one.
    pub(super) fn separated(
        chooser: &Chooser,
        certificate: &Certificate,
        count: usize,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Self>, PlanError> {
        let (problem, all) = (chooser.problem(), chooser.survey());
        let mut survey = chooser.highest(certificate, count, SEPARATED_COLUMNS)?;
        survey.add_off_grid(problem, &all.off_grid_views().iter().map(|view| view.q.clone()).collect::<Vec<_>>())?;
        let (mut best, mut least, mut vain) = (None, f64::INFINITY, 0);
        for _ in 0..ROUNDS {
            if vain == VAIN_ROUNDS || !goes_on() {
                break;
            }
            let chooser = Chooser::new(problem, &survey)?;
            let Ok(certificate) = chooser.certificate(count) else { break };
            let instance = chooser.instance(count)?;
            let round = Round::new(&chooser, &instance, certificate, count);
            let found = round.climbed(&chooser, &instance);
            let score = found.first().map_or(round.level, |(score, _)| *score);
            let dual = Self { gradient: round.gradient, balls: round.balls, score };
            let bound = dual.log_bound(&instance, count, score);
            if bound < least {
                (best, least, vain) = (Some(dual), bound, 0);
            } else {
                vain += 1;
            }
            let joining = joining(problem, found, round.level);
            if joining.is_empty() {
                break;
            }
            survey.add_off_grid(problem, &joining)?;
        }
        Ok(best)
    }
}

/// A relaxation's prices.
struct Round {
    gradient: Gradient,
    balls: Vec<PricedPictures>,
    /// The balls, prepared.
    prepared: Vec<PictureBall>,
    /// Scores less prices, descending, with the views' places.
    reduced: Vec<(f64, usize)>,
    /// No view of the relaxation scores more, less prices and its own ball's.
    level: f64,
}

impl Round {
    fn new(chooser: &Chooser, instance: &Instance, certificate: Certificate, count: usize) -> Self {
        let (problem, views) = (chooser.problem(), &chooser.survey().views);
        let Certificate { y, mixture, prices, .. } = certificate;
        let of_pictures = place_of_pictures(problem);
        let mut balls: Vec<PricedPictures> = Vec::new();
        for (group, price) in prices {
            if let Group::Ball { separation, between } = group
                && Some(separation) == of_pictures
            {
                let [a, b] = between.map(|i| views[i].q.as_slice());
                balls.push(PricedPictures::new(a, b, price));
            }
        }
        let mut prepared: Vec<PictureBall> = balls.iter().map(|ball| ball.ball(problem)).collect();
        let scores = instance.scores(&y);
        let less = |i: usize, prepared: &[PictureBall]| scores[i] - price(problem, prepared, &views[i]);
        let mut reduced: Vec<(f64, usize)> =
            (0..scores.len()).filter(|&i| instance.is_open(i)).map(|i| (less(i, &prepared), i)).collect();
        reduced.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        reduced.truncate(STARTS.max(count));
        let level = reduced.get(count - 1).map_or(0.0, |(score, _)| *score);
        // A set of views has each once; of joint values what is near one takes its place.
        for &(_, i) in &reduced[..reduced.len().min(count)] {
            let left = less(i, &prepared) - level;
            if left > 0.0 {
                let ball = PricedPictures::new(&views[i].q, &views[i].q, left);
                prepared.push(ball.ball(problem));
                balls.push(ball);
            }
        }
        Self { gradient: Gradient { y, mixture }, balls, prepared, reduced, level }
    }

    /// Where climbs end, the greatest score less prices first.
    fn climbed(&self, chooser: &Chooser, instance: &Instance) -> Vec<(f64, Candidate)> {
        let (problem, survey) = (chooser.problem(), chooser.survey());
        let search = LocalSearch::new(problem, survey, chooser.objective());
        let dual = instance.dual(&self.gradient.y);
        let value = |found: &Candidate| dot(&found.information, &dual) - price(problem, &self.prepared, &found.view);
        let mut starts: Vec<&View> = self.reduced.iter().take(STARTS).map(|&(_, i)| &survey.views[i]).collect();
        starts.extend(survey.off_grid_views());
        let climbs = starts.par_iter().flat_map_iter(|start| STRETCHES.map(|stretch| (start, stretch)));
        let climbed = climbs.filter_map(|(start, stretch)| search.climb(start, &[], stretch, &value));
        let mut climbed: Vec<(f64, Candidate)> = climbed.map(|found| (value(&found), found)).collect();
        climbed.sort_by(|a, b| b.0.total_cmp(&a.0));
        climbed
    }
}

/// What a view scores less.
fn price(problem: &Problem, balls: &[PictureBall], view: &View) -> f64 {
    PictureBall::price_of(balls, &view.picture(&problem.camera, &problem.target.board))
}

/// The joint values of the best found that score more than `level`, no two pictures of them near each other.
fn joining(problem: &Problem, found: Vec<(f64, Candidate)>, level: f64) -> Vec<Vec<f64>> {
    let mut balls: Vec<PictureBall> = Vec::new();
    let mut joining = Vec::new();
    for (_, Candidate { view, .. }) in found.into_iter().filter(|(score, _)| *score > (1.0 + BEYOND) * level) {
        let centre = view.picture(&problem.camera, &problem.target.board);
        if joining.len() < JOINING && !balls.iter().any(|ball| ball.contains(&centre)) {
            balls.push(PictureBall { centre, radius: APART * 0.5 * problem.picture_separation(), price: 0.0 });
            joining.push(view.q);
        }
    }
    joining
}
