//! Choosing poses from a survey by any method, with the certificate that goes with the choice.

use std::ops::ControlFlow;

use nalgebra::DMatrix;
use thiserror::Error;

use super::constraints::{Captured, ConstraintError, captured, constraints, known};
use super::objective::Objective;
use super::{ClusteringError, kmeans, random};
use crate::figures::grouped;
use crate::information::Criterion;
use crate::plan::survey::{Survey, SurveyError};
use crate::problem::Method;
use crate::problem::{Accuracy, Problem};
use crate::selection::packed::{inverse, pack, packed_len, unpack};
use crate::selection::{
    Best, Certificate, Constraints, Fewest, InformationFunction, Instance, NotEnough, RelaxationSettings, Search,
    SearchProgress, SelectionError, best, fewest, greedy, improved_greedy, relax, search, start_of_search,
};

/// Why a problem has no plan.
#[derive(Debug, Error)]
pub enum PlanError {
    /// There is nothing to choose from.
    #[error(transparent)]
    Survey(#[from] SurveyError),
    /// More poses are asked for than there are views.
    #[error("{} poses are asked for, but only {} configurations see the board and can be taken", grouped(*count), grouped(*views))]
    TooFewViews {
        /// Poses asked for.
        count: usize,
        /// Views found.
        views: usize,
    },
    /// The poses leave some combination of the intrinsics undetermined.
    #[error("{} cannot determine all intrinsics; left open: {}", describe_tried(*count, *views), describe(combination))]
    Unobservable {
        /// Poses tried.
        count: usize,
        /// Views to choose from: where as many were tried, there are no more.
        views: usize,
        /// Names of the parameters and their coefficients in the combination, largest 1.
        combination: Vec<(String, f64)>,
    },
    /// The poses found leave some combination of the intrinsics all but undetermined, where others might tell far more.
    #[error(
        "the set found, of size {count}, gives less than {:e} of the information that the certificate's bound allows; it all \
             but leaves open: {}",
        Self::LEAST_EFFICIENCY,
        describe(combination)
    )]
    HardlyObservable {
        /// Poses found.
        count: usize,
        /// Names of the parameters and their coefficients in the combination least known, largest 1.
        combination: Vec<(String, f64)>,
    },
    /// The constraints cannot be held.
    #[error(transparent)]
    Constraints(#[from] ConstraintError),
    /// No set of so many poses that the constraints allow was found.
    #[error("{}", describe_room(*count, *found, *at_most))]
    NoRoom {
        /// Poses asked for.
        count: usize,
        /// The most that were found.
        found: usize,
        /// No allowed set has more.
        at_most: usize,
    },
    /// The accuracies are out of reach.
    #[error("{}: {}", describe_reach(*count, *bound), describe_shortfalls(shortfalls))]
    Inaccurate {
        /// Poses of the best set found.
        count: usize,
        /// The accuracies that it misses.
        shortfalls: Vec<ReachedAccuracy>,
        /// Share of the accuracy that no set of so many surpasses: below 1 it is proven that none suffices; infinite if nothing is
        /// known.
        bound: f64,
    },
    /// What is known already is not positive definite.
    #[error("the covariance of the calibration is not positive definite to working precision")]
    Covariance,
    /// The selection was refused.
    #[error(transparent)]
    Selection(SelectionError),
    /// The baseline failed.
    #[error(transparent)]
    Clustering(#[from] ClusteringError),
}

impl PlanError {
    /// Certified efficiency below which a choice is no plan: standard deviations could be a thousandth.
    pub const LEAST_EFFICIENCY: f64 = 1e-6;
}

fn describe_room(count: usize, found: usize, at_most: usize) -> String {
    if at_most >= count {
        format!(
            "no {count} poses that [constraints] allow together were found; the most found are {found}, and it is not \
             proven that there are no more"
        )
    } else if at_most == found {
        format!("[constraints] allow at most {found} poses together, which is proven; {count} are asked for")
    } else {
        format!("[constraints] allow no {count} poses together: {found} were found, and at most {at_most} are possible")
    }
}

fn describe_tried(count: usize, views: usize) -> String {
    match count {
        1 => "1 pose".into(),
        _ if count == views => format!("all {} views together", grouped(count)),
        _ => format!("{count} poses"),
    }
}

fn describe(combination: &[(String, f64)]) -> String {
    let mut terms: Vec<_> = combination.iter().filter(|(_, c)| c.abs() > 1e-3).collect();
    terms.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let mut text = String::new();
    for (i, (name, c)) in terms.into_iter().enumerate() {
        let sign = match (i, *c < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        text += &format!("{sign}{:.3} {name}", c.abs());
    }
    text
}

fn describe_reach(count: usize, bound: f64) -> String {
    if bound < 1.0 {
        format!("not even {count} poses, all that may be chosen, reach the accuracy wished for")
    } else {
        format!("no set of poses was found that reaches the accuracy wished for; with the best, {count} poses")
    }
}

/// An accuracy that a problem wishes for, and what a choice reaches; standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct ReachedAccuracy {
    /// `map_error_px` or the name of an intrinsic.
    pub name: String,
    /// What is wished for.
    pub wished: f64,
    /// What is reached.
    pub reached: f64,
}

fn describe_shortfalls(shortfalls: &[ReachedAccuracy]) -> String {
    let each = shortfalls.iter().map(|ReachedAccuracy { name, wished, reached }| {
        let what = if name == "map_error_px" { "the map error in px".into() } else { format!("sigma of {name}") };
        format!("{what} is {reached:.4} where {wished} is wished")
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Chooses from one survey.
pub struct Chooser<'a> {
    problem: &'a Problem,
    survey: &'a Survey,
    objective: Objective<'a>,
    constraints: Constraints,
    settings: RelaxationSettings,
    map_error: InformationFunction,
    /// p×p information already at hand.
    prior: DMatrix<f64>,
    captured: Vec<Captured>,
}

/// A set of poses and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The views chosen, ascending indices into the survey's.
    pub selected: Vec<usize>,
    /// log Φ of the choice; −∞ if it leaves a combination of the intrinsics undetermined.
    pub log_value: f64,
    /// Standard deviation of each estimated intrinsic; empty if one is undetermined.
    pub sigma: Vec<f64>,
    /// Expected RMS map error in px; infinite if an intrinsic is undetermined.
    pub map_error: f64,
}

impl<'a> Chooser<'a> {
    /// A chooser for the problem that was surveyed, by its criteria and within its constraints.
    ///
    /// # Errors
    /// When the constraints cannot be held, or a view does not give what a criterion needs.
    pub fn new(problem: &'a Problem, survey: &'a Survey) -> Result<Self, PlanError> {
        let captured = captured(problem)?;
        let known = known(problem, &captured)?;
        Self::with(problem, survey, &problem.selection.criteria, known, captured)
    }

    fn with(
        problem: &'a Problem,
        survey: &'a Survey,
        criteria: &[(Criterion, f64)],
        prior: DMatrix<f64>,
        captured: Vec<Captured>,
    ) -> Result<Self, PlanError> {
        Ok(Self {
            problem,
            survey,
            objective: Objective::new(problem, survey, criteria, &prior, &captured)?,
            constraints: constraints(problem, survey)?,
            settings: RelaxationSettings { tolerance: problem.selection.tolerance, ..RelaxationSettings::default() },
            map_error: InformationFunction::variance(&survey.map_weight),
            prior,
            captured,
        })
    }

    /// The same chooser by other criteria, each with its share.
    ///
    /// # Errors
    /// As [`Chooser::new`].
    pub fn by(&self, criteria: &[(Criterion, f64)]) -> Result<Self, PlanError> {
        Self::with(self.problem, self.survey, criteria, self.prior.clone(), self.captured.clone())
    }

    /// The same chooser when the p×p information `prior` on the intrinsics is known too: that of the views taken, say.
    /// Criteria that are not of the intrinsics know nothing of it and are left out; if none remains, `v` takes their place.
    ///
    /// # Errors
    /// As [`Chooser::new`].
    pub fn with_prior(&self, prior: &DMatrix<f64>) -> Result<Self, PlanError> {
        let criteria = self.problem.selection.criteria.iter().filter(|(criterion, _)| criterion.is_of_intrinsics());
        let mut criteria: Vec<_> = criteria.copied().collect();
        if criteria.is_empty() {
            criteria.push((Criterion::V, 1.0));
        }
        let sum: f64 = criteria.iter().map(|(_, share)| share).sum();
        for (_, share) in &mut criteria {
            *share /= sum;
        }
        Self::with(self.problem, self.survey, &criteria, &self.prior + prior, self.captured.clone())
    }

    /// The same chooser by the accuracies that the problem wishes for, instead of its criteria.
    pub(crate) fn by_accuracies(&self) -> Self {
        let accuracies = &self.problem.selection.accuracies;
        Self {
            problem: self.problem,
            survey: self.survey,
            objective: Objective::of_accuracies(self.problem, self.survey, accuracies, &self.prior),
            constraints: self.constraints.clone(),
            settings: self.settings,
            map_error: self.map_error.clone(),
            prior: self.prior.clone(),
            captured: self.captured.clone(),
        }
    }

    /// What it optimises: `v`, or `0.8 v + 0.2 diversity`, or `accuracy`.
    pub fn criterion(&self) -> String {
        self.objective.to_string()
    }

    pub(crate) fn objective(&self) -> &Objective<'a> {
        &self.objective
    }

    pub(crate) fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    pub(crate) fn survey(&self) -> &'a Survey {
        self.survey
    }

    /// The value of the criterion in its own unit: log det for `d` and `diversity`, a variance in px² for `a` and `v`, an
    /// eigenvalue for `e` and `zhang`; of several criteria, or of accuracies, Φ itself.
    pub fn natural(&self, log_value: f64) -> f64 {
        self.objective.natural(log_value)
    }

    /// The certificate for choices of `count` poses, and the best choice found on the way to it.
    ///
    /// # Errors
    /// When there are too few views, or none of the sets tried determines all intrinsics.
    pub fn best(&self, count: usize, seed: u64) -> Result<(Choice, Certificate), PlanError> {
        let instance = self.instance(count)?;
        let Best { selected, relaxation, .. } = best(&instance, &self.settings, seed).map_err(|e| self.explain(e))?;
        Ok((self.assess(selected), relaxation.certificate))
    }

    /// As [`Chooser::best`], then branch and bound until the best choice is proven, the problem's node limit reached, or
    /// `observe` breaks.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn exact(
        &self,
        count: usize,
        seed: u64,
        observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
    ) -> Result<(Choice, Certificate, Search), PlanError> {
        let instance = self.instance(count)?;
        let start = start_of_search(&instance, &self.settings, seed).map_err(|e| self.explain(e))?;
        let found = search(&instance, &start, f64::NEG_INFINITY, self.problem.selection.node_limit, observe);
        if found.log_value == f64::NEG_INFINITY {
            return Err(self.explain(instance.unobservable(&found.selected)));
        }
        Ok((self.assess(found.selected.clone()), start.relaxation.certificate, found))
    }

    /// The fewest poses that reach the accuracies which the problem wishes for, and the chooser by accuracies that explains
    /// the choice. `observe` as in [`Chooser::exact`].
    ///
    /// # Errors
    /// When the accuracies are out of reach, and as [`Chooser::best`].
    pub fn fewest(
        &self,
        seed: u64,
        observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
    ) -> Result<(Choice, Fewest, Self), PlanError> {
        let chooser = self.by_accuracies();
        let most = self.survey.views.len();
        let instance = chooser.instance(most.min(self.constraints.required.len().max(1)))?;
        let node_limit = self.problem.selection.node_limit;
        let found = fewest(&instance, 0.0, most, &self.settings, seed, node_limit, observe);
        let found = found.map_err(|error| match error {
            NotEnough::Selection(error) => chooser.explain(error),
            NotEnough::Never { selected, log_bound } => PlanError::Inaccurate {
                count: selected.len(),
                shortfalls: {
                    let reached = chooser.reached(&chooser.assess(selected)).into_iter();
                    reached.filter(|accuracy| accuracy.reached > accuracy.wished).collect()
                },
                // Φ is of variances, the accuracies of their roots.
                bound: (0.5 * log_bound).exp(),
            },
        })?;
        drop(instance);
        Ok((chooser.assess(found.best.selected.clone()), found, chooser))
    }

    /// The accuracies that the problem wishes for, in its order, and what a choice reaches.
    pub(crate) fn reached(&self, choice: &Choice) -> Vec<ReachedAccuracy> {
        let names = self.problem.estimated_names();
        let reached = |&(accuracy, wished): &(Accuracy, f64)| match accuracy {
            Accuracy::MapError => ReachedAccuracy { name: "map_error_px".into(), wished, reached: choice.map_error },
            Accuracy::Intrinsic(j) => {
                let reached = choice.sigma.get(j).copied().unwrap_or(f64::INFINITY);
                ReachedAccuracy { name: names[j].into(), wished, reached }
            }
        };
        self.problem.selection.accuracies.iter().map(reached).collect()
    }

    /// A bound on every choice of `count` poses, without the effort of choosing the best.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn certificate(&self, count: usize) -> Result<Certificate, PlanError> {
        let instance = self.instance(count)?;
        let start = improved_greedy(&instance).map_err(|e| self.explain(e))?;
        let relaxation = relax(&instance, &start, &self.settings);
        let relaxation = relaxation.ok_or_else(|| self.explain(instance.unobservable(&start)))?;
        Ok(relaxation.certificate)
    }

    /// `count` poses chosen by `method`; [`Method::Exact`] as [`Method::Best`], for its search wants an observer.
    ///
    /// # Errors
    /// As [`Chooser::best`]; random and clustered choices may be singular, which is no error.
    pub fn choose(&self, method: Method, count: usize, seed: u64) -> Result<Choice, PlanError> {
        let instance = self.instance(count)?;
        let improved = || improved_greedy(&instance).map_err(|e| self.explain(e));
        let selected = match method {
            Method::Best | Method::Exact => {
                best(&instance, &self.settings, seed).map_err(|e| self.explain(e))?.selected
            }
            Method::Relaxation => {
                let start = improved()?;
                let relaxation = relax(&instance, &start, &self.settings);
                let relaxation = relaxation.ok_or_else(|| self.explain(instance.unobservable(&start)))?;
                relaxation.rounded(&instance).unwrap_or(start)
            }
            Method::Exchange => improved()?,
            Method::Greedy => greedy(&instance).map_err(|e| self.explain(e))?,
            Method::Random => random(self.survey.views.len(), count, seed),
            Method::KMeansJoints => {
                let joints: Vec<_> = self.survey.views.iter().map(|view| view.q.clone()).collect();
                kmeans(&joints, count, seed)?
            }
            Method::KMeansPositions => {
                let position = |X: &crate::spatial::Pose| X.translation.vector.iter().copied().collect();
                let positions: Vec<_> = self.survey.views.iter().map(|view| position(&view.X_BC)).collect();
                kmeans(&positions, count, seed)?
            }
        };
        Ok(self.assess(selected))
    }

    /// Refuses a choice that leaves a combination of the intrinsics undetermined.
    ///
    /// # Errors
    /// [`PlanError::Unobservable`], with the combination.
    pub fn require_observable(&self, choice: &Choice) -> Result<(), PlanError> {
        if choice.log_value > f64::NEG_INFINITY {
            return Ok(());
        }
        let instance = self.instance(choice.selected.len())?;
        Err(self.explain(instance.unobservable(&choice.selected)))
    }

    /// Refuses a choice of log Φ = `log_value` that is hardly better than none beside what `log_bound` allows.
    pub(crate) fn require_efficient(&self, choice: &Choice, log_bound: f64) -> Result<(), PlanError> {
        if choice.log_value - log_bound >= PlanError::LEAST_EFFICIENCY.ln() {
            return Ok(());
        }
        let instance = self.instance(choice.selected.len())?;
        match self.explain(instance.unobservable(&choice.selected)) {
            PlanError::Unobservable { count, combination, .. } => {
                Err(PlanError::HardlyObservable { count, combination })
            }
            other => Err(other),
        }
    }

    /// Information of a choice on the intrinsics, the prior included, p×p.
    pub fn information(&self, selected: &[usize]) -> DMatrix<f64> {
        let p = self.prior.nrows();
        &self.prior + unpack(&self.survey.information.total(&vec![0.0; packed_len(p)], selected), p)
    }

    /// Each chosen pose's share of the information at hand: `⟨∇log Φ(M), M_i⟩`; with the prior's, the shares add up to one.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn shares(&self, selected: &[usize]) -> Result<Vec<f64>, PlanError> {
        let instance = self.instance(selected.len())?;
        Ok(match instance.gradient(&instance.total(selected)) {
            Some(gradient) => instance.scores_of(&gradient.y, selected),
            None => vec![f64::NAN; selected.len()],
        })
    }

    /// What a set of views is worth, ascending or not, chosen by whatever means.
    pub fn assess(&self, mut selected: Vec<usize>) -> Choice {
        selected.sort_unstable();
        let (sigma, map_error) = self.accuracy(&self.information(&selected));
        Choice { log_value: self.objective.log_value(&selected), map_error, sigma, selected }
    }

    /// Standard deviations and map error by the p×p information M on the intrinsics, as in a [`Choice`].
    pub(crate) fn accuracy(&self, M: &DMatrix<f64>) -> (Vec<f64>, f64) {
        let sigma = match inverse(M) {
            Some(covariance) => covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
            None => vec![],
        };
        (sigma, (-0.5 * self.map_error.log_value(&mut pack(M), M.nrows())).exp())
    }

    pub(crate) fn instance(&self, count: usize) -> Result<Instance<'_>, PlanError> {
        let views = self.survey.views.len();
        if count > views {
            return Err(PlanError::TooFewViews { count, views });
        }
        self.objective.instance(count, self.constraints.clone()).map_err(|e| self.explain(e))
    }

    pub(crate) fn explain(&self, error: SelectionError) -> PlanError {
        match error {
            SelectionError::Unobservable { count, term, combination } => {
                let names = self.objective.parameters(term).iter().cloned();
                PlanError::Unobservable {
                    count,
                    views: self.survey.views.len(),
                    combination: names.zip(combination).collect(),
                }
            }
            SelectionError::NoRoom { count, found, at_most } => PlanError::NoRoom { count, found, at_most },
            other => PlanError::Selection(other),
        }
    }
}
