//! The survey: all that is known of the candidates before any is chosen.

mod contacts;
mod continuum;
mod diagnosis;
mod listed;
mod refine;
mod scenarios;
mod smell;
mod trial;

pub use contacts::Contact;
pub use continuum::PricedPictures;
pub use diagnosis::{Diagnosis, Miss, Obstacle, diagnose};
pub use listed::Excluded;
pub(crate) use listed::{Joined, up_to_limits};
pub use refine::NoView;
pub(crate) use refine::{join, spacings};
pub use scenarios::Scenario;
pub(crate) use scenarios::Scene;
pub use smell::Smell;
pub use trial::Trial;

use nalgebra::DMatrix;
use rayon::prelude::*;
use thiserror::Error;

use crate::feasibility::{Checks, LinkPairs, Rejection, View, feasible_views};
use crate::figures::grouped;
use crate::problem::{Problem, Robustness};
use crate::selection::InformationSet;
use crate::sweep::{Candidates, Sweep, sweep};
use contacts::contacts;
use scenarios::certain;

/// The views of a problem and what each would teach.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// What the sweep found.
    pub sweep: Sweep,
    /// The candidates that passed every check, by ascending id.
    pub views: Vec<View>,
    /// Candidates rejected, by the reasons of [`Rejection::ALL`].
    pub rejected: [usize; Rejection::ALL.len()],
    /// The pairs of links by what was done about them.
    pub links: LinkPairs,
    /// Configurations tried around picked poses, beside the swept ones.
    pub refined: usize,
    /// How many of the views are off the grid; they are the last.
    pub off_grid: usize,
    /// Places of poses that were found to be good together, ascending; the best choice of as many is no worse.
    pub good: Vec<usize>,
    /// Places of poses that were found to be nearly as good together with a shorter tour, ascending.
    pub near: Vec<usize>,
    /// The views' information on the estimated intrinsics, in the views' order.
    pub information: InformationSet,
    /// The p×p weight of the map error.
    pub map_weight: DMatrix<f64>,
    /// The scenarios that the plan must withstand, beside the set-up as stated.
    pub scenarios: Vec<Scenario>,
}

/// Why a problem has no views to choose from.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SurveyError {
    /// No optical axis meets the zone.
    #[error("none of the {} configurations points the camera at the target zone", grouped(*swept))]
    NoCandidates {
        /// Configurations swept.
        swept: usize,
        /// What stands in the way.
        diagnosis: Box<Diagnosis>,
    },
    /// No candidate passes every check.
    #[error("none of the {} candidates is a view; candidates rejected, by reason: {}", grouped(*candidates), describe_rejections(&**rejected))]
    NoViews {
        /// Candidates that passed the sweep.
        candidates: usize,
        /// How many were rejected for each reason of [`Rejection::ALL`].
        rejected: Box<[usize; Rejection::ALL.len()]>,
        /// The pairs of links that collide in those rejected for that, the most frequent first.
        contacts: Vec<Contact>,
        /// What stands in the way.
        diagnosis: Box<Diagnosis>,
    },
    /// No view of the set-up as stated is one often enough in those that may be.
    #[error(
        "none of the {} views of the set-up as stated is a view in {} % of {} set-ups drawn from `robust`",
        grouped(*views), 100.0 * seen_share, grouped(*draws)
    )]
    NothingCertain {
        /// Views of the set-up as stated.
        views: usize,
        /// Share of the set-ups drawn in which one must be a view.
        seen_share: f64,
        /// Set-ups drawn.
        draws: usize,
    },
    /// In a scenario nothing is seen.
    #[error("in scenario {scenario} of those drawn from `robust` none of the {} views is a view", grouped(*views))]
    BlindScenario {
        /// The scenario, from 1; the set-up as stated is 0.
        scenario: usize,
        /// Views to choose from.
        views: usize,
    },
    /// A view's pose is not determined by its own corners.
    #[error("the corners of the {board} do not determine its pose in the image")]
    PoseUndetermined {
        /// The board.
        board: String,
    },
}

impl SurveyError {
    /// Of a view in which the board's pose is not determined.
    pub(crate) fn undetermined(problem: &Problem) -> Self {
        Self::PoseUndetermined { board: problem.target.board.to_string() }
    }
}

fn describe_rejections(rejected: &[usize]) -> String {
    let counted: Vec<String> = Rejection::ALL
        .iter()
        .zip(rejected)
        .filter(|&(_, &count)| count > 0)
        .map(|(reason, count)| format!("{} {}", reason.name().replace('_', " "), grouped(*count)))
        .collect();
    counted.join(", ")
}

/// The candidates that passed every check, before it is known what they would teach.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Feasible {
    views: Vec<View>,
    rejected: [usize; Rejection::ALL.len()],
    links: LinkPairs,
}

/// Sweeps, filters and weighs the candidates of `problem`; `observe` as in [`sweep`].
///
/// # Errors
/// When no candidate is left.
pub fn survey(problem: &Problem, observe: &(dyn Fn(usize) + Sync)) -> Result<Survey, SurveyError> {
    let sweep = candidates(problem, observe)?;
    let feasible = feasible(problem, &sweep)?;
    weighed(problem, sweep, feasible)
}

/// As [`survey`], without finding out what stands in the way where there are no views.
pub(crate) fn quick_survey(problem: &Problem) -> Option<Survey> {
    let Problem { robot, target, space, .. } = problem;
    let sweep = sweep(robot, target, space, problem.axis, &|_| {});
    let checks = problem.checks();
    let (views, rejected) = certain_views(problem, &checks, &sweep.candidates);
    if views.is_empty() {
        return None;
    }
    let links = checks.collision().links().clone();
    weighed(problem, sweep, Feasible { views, rejected, links }).ok()
}

/// The first stage of a survey: the candidates. It depends on robot, target, joint space and axis rule alone.
pub(crate) fn candidates(problem: &Problem, observe: &(dyn Fn(usize) + Sync)) -> Result<Sweep, SurveyError> {
    let Problem { robot, target, space, .. } = problem;
    let sweep = sweep(robot, target, space, problem.axis, observe);
    if sweep.candidates.is_empty() {
        return Err(SurveyError::NoCandidates { swept: sweep.swept, diagnosis: Box::new(diagnose(problem)) });
    }
    Ok(sweep)
}

/// The second stage: those that are views. It depends, beside the first, on camera, limits of visibility, clearance,
/// stability, and what the plan must withstand.
pub(crate) fn feasible(problem: &Problem, sweep: &Sweep) -> Result<Feasible, SurveyError> {
    let space = &problem.space;
    let checks = problem.checks();
    let (views, rejected) = certain_views(problem, &checks, &sweep.candidates);
    if let (true, Some(Robustness { seen_share, draws, .. })) = (views.is_empty(), &problem.robust)
        && rejected[Rejection::Uncertain as usize] > 0
    {
        let views = rejected[Rejection::Uncertain as usize];
        return Err(SurveyError::NothingCertain { views, seen_share: *seen_share, draws: *draws });
    }
    if views.is_empty() {
        let contacts = contacts(problem, &checks, space, &sweep.candidates);
        let diagnosis = Box::new(diagnose(problem));
        let rejected = Box::new(rejected);
        return Err(SurveyError::NoViews { candidates: sweep.candidates.len(), rejected, contacts, diagnosis });
    }
    let links = checks.collision().links().clone();
    Ok(Feasible { views, rejected, links })
}

/// The candidates that are views, in as many of the set-ups that may be as the problem demands, and how many were rejected for each
/// reason.
pub(crate) fn certain_views(
    problem: &Problem,
    checks: &Checks,
    candidates: &Candidates,
) -> (Vec<View>, [usize; Rejection::ALL.len()]) {
    let (views, mut rejected) = feasible_views(checks, &problem.space, candidates);
    let seen_as_stated = views.len();
    let views = certain(problem, views);
    rejected[Rejection::Uncertain as usize] = seen_as_stated - views.len();
    (views, rejected)
}

/// The third stage: what the views would teach, which depends on the noise and on what is estimated too.
pub(crate) fn weighed(problem: &Problem, sweep: Sweep, feasible: Feasible) -> Result<Survey, SurveyError> {
    let Feasible { views, rejected, links } = feasible;
    let survey = Survey { sweep, rejected, links, ..Survey::of(problem, views)? };
    let is_blind = |scenario: &Scenario| scenario.information.mean().iter().all(|&entry| entry == 0.0);
    match survey.scenarios.iter().position(is_blind) {
        Some(scenario) => Err(SurveyError::BlindScenario { scenario: scenario + 1, views: survey.views.len() }),
        None => Ok(survey),
    }
}

impl Survey {
    /// The place among the views of the configuration of that id; `None` if it is no view.
    pub fn index_of(&self, id: usize) -> Option<usize> {
        self.views.binary_search_by_key(&id, |view| view.id).ok()
    }

    /// The places of the views at these joint values, ascending; empty where one is no view, or two are the same.
    pub(crate) fn places_of(&self, joints: &[Vec<f64>]) -> Vec<usize> {
        let views = self.views.par_iter().enumerate().filter(|(_, view)| joints.contains(&view.q));
        let places: Vec<usize> = views.map(|(place, _)| place).collect();
        if places.len() == joints.len() { places } else { vec![] }
    }

    /// The views' joint values, rad or m.
    pub(crate) fn joints(&self) -> Vec<&[f64]> {
        self.views.iter().map(|view| view.q.as_slice()).collect()
    }

    /// The views off the grid.
    pub fn off_grid_views(&self) -> &[View] {
        &self.views[self.views.len() - self.off_grid..]
    }

    /// The survey of some of its views alone, by their places, ascending; none of them off the grid.
    pub(crate) fn only(&self, places: &[usize]) -> Self {
        let of_scenario = |scenario: &Scenario| Scenario {
            problem: scenario.problem.clone(),
            information: scenario.information.select(places),
            map_weight: scenario.map_weight.clone(),
        };
        Self {
            sweep: Sweep { candidates: Candidates::default(), ..self.sweep },
            views: places.iter().map(|&i| self.views[i].clone()).collect(),
            rejected: self.rejected,
            links: self.links.clone(),
            refined: self.refined,
            off_grid: 0,
            good: vec![],
            near: vec![],
            information: self.information.select(places),
            map_weight: self.map_weight.clone(),
            scenarios: self.scenarios.iter().map(of_scenario).collect(),
        }
    }

    /// The set-up as stated, and the scenarios, ready to look at views.
    pub(crate) fn scenes<'a>(&'a self, problem: &'a Problem) -> Vec<Scene<'a>> {
        let stated = Scene::new(problem);
        let drawn: Vec<Scene> = self.scenarios.iter().map(|scenario| stated.of_drawn(&scenario.problem)).collect();
        std::iter::once(stated).chain(drawn).collect()
    }

    /// The survey of these views alone, wherever they come from.
    ///
    /// # Errors
    /// When a view's pose is not determined by its own corners.
    pub(crate) fn of(problem: &Problem, views: Vec<View>) -> Result<Self, SurveyError> {
        let information = problem
            .measurement()
            .information_set(views.par_iter().map(|view| (&view.X_CT, &view.seen)))
            .ok_or_else(|| SurveyError::undetermined(problem))?;
        let scenarios = Scenario::all(problem, &views)?;
        Ok(Self {
            sweep: Sweep { swept: views.len(), ..Sweep::default() },
            views,
            rejected: [0; Rejection::ALL.len()],
            links: LinkPairs::default(),
            refined: 0,
            off_grid: 0,
            good: vec![],
            near: vec![],
            information,
            map_weight: problem.unknowns().map_error_weight(),
            scenarios,
        })
    }
}
