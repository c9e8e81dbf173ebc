//! Choosing poses from a survey by any method, with the certificate that goes with the choice.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::choice::{Choice, Reached};
use super::constraints::{Captured, Known, constraints, stated_of_intrinsics};
use super::error::PlanError;
use super::objective::Objective;
use super::{ClusteringError, KMeans, Points, random};
use crate::feasibility::View;
use crate::information::{Criterion, NoiseModel, Unweighted};
use crate::plan::survey::Survey;
use crate::problem::{Accuracy, Goal, Method, Problem};
use crate::selection::packed::{pack, packed_len, unpack};
use crate::selection::{
    Best, Certificate, Fewest, InformationFunction, Instance, NotEnough, RelaxationSettings, Rules, Search,
    SearchProgress, SelectionError, best, best_from_known, fewest, greedy, highest, improved_greedy, relax_from_greedy,
    search, start_of_search,
};

/// Chooses from one survey.
pub struct Chooser<'a> {
    problem: &'a Problem,
    survey: &'a Survey,
    objective: Objective<'a>,
    rules: Arc<Rules>,
    settings: RelaxationSettings,
    /// What is known already, in the set-up as stated and in each scenario.
    known: Vec<Known>,
}

impl<'a> Chooser<'a> {
    /// A chooser for the problem that was surveyed, by what it asks for and within its constraints.
    ///
    /// # Errors
    /// When the constraints cannot be held, or a view does not give what a criterion needs.
    pub fn new(problem: &'a Problem, survey: &'a Survey) -> Result<Self, PlanError> {
        let mut known = vec![Known::as_stated(problem)?];
        for scenario in &survey.scenarios {
            known.push(Known::as_drawn(problem, &scenario.problem));
        }
        let objective = match &problem.selection.goal {
            Goal::Best { criteria, .. } | Goal::Within { criteria, .. } => {
                Objective::new(problem, survey, criteria, &known)?
            }
            Goal::Fewest { accuracies, .. } => Objective::of_accuracies(problem, survey, accuracies, &known),
        };
        Self::with(problem, survey, objective, known)
    }

    fn with(
        problem: &'a Problem,
        survey: &'a Survey,
        objective: Objective<'a>,
        known: Vec<Known>,
    ) -> Result<Self, PlanError> {
        Ok(Self {
            problem,
            survey,
            objective,
            rules: Arc::new(
                Rules::new(constraints(problem, survey)?, survey.views.len()).map_err(PlanError::Selection)?,
            ),
            settings: RelaxationSettings { tolerance: problem.selection.tolerance, ..RelaxationSettings::default() },
            known,
        })
    }

    /// The same chooser by criteria, each with its share.
    ///
    /// # Errors
    /// As [`Chooser::new`].
    pub fn by(&self, criteria: &[(Criterion, f64)]) -> Result<Self, PlanError> {
        self.by_criteria_knowing(criteria, self.known.clone())
    }

    /// The same chooser when the information `prior` on what is estimated is known too: that of the views taken, say.
    /// Criteria that are not of the intrinsics know nothing of it and are left out; if none remains, `v` takes their place, as it
    /// does that of accuracies.
    ///
    /// # Errors
    /// As [`Chooser::new`].
    pub fn with_prior(&self, prior: &DMatrix<f64>) -> Result<Self, PlanError> {
        let mut criteria = self.problem.selection.goal.criteria().into_owned();
        criteria.retain(|(criterion, _)| criterion.is_of_intrinsics());
        if criteria.is_empty() {
            criteria.push((Criterion::V, 1.0));
        }
        let sum: f64 = criteria.iter().map(|(_, share)| share).sum();
        for (_, share) in &mut criteria {
            *share /= sum;
        }
        let mut known = self.known.clone();
        for known in &mut known {
            known.information += prior;
        }
        self.by_criteria_knowing(&criteria, known)
    }

    fn by_criteria_knowing(&self, criteria: &[(Criterion, f64)], known: Vec<Known>) -> Result<Self, PlanError> {
        let objective = Objective::new(self.problem, self.survey, criteria, &known)?;
        Self::with(self.problem, self.survey, objective, known)
    }

    /// What it optimises: `v`, or `0.8 v + 0.2 diversity`, or `accuracy`.
    pub fn criterion(&self) -> String {
        self.objective.to_string()
    }

    pub(crate) fn objective(&self) -> &Objective<'a> {
        &self.objective
    }

    pub(crate) fn problem(&self) -> &'a Problem {
        self.problem
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
        let found = match self.known_to_be_good(&instance) {
            Some(good) => best_from_known(&instance, &self.settings, seed, good),
            None => best(&instance, &self.settings, seed),
        };
        let Best { selected, relaxation, .. } = found.map_err(|e| self.explain(e))?;
        Ok((self.assess(selected), relaxation.certificate))
    }

    /// The views known to be good together, where they are a choice such as asked for.
    pub(super) fn known_to_be_good(&self, instance: &Instance) -> Option<&'a [usize]> {
        let good = self.survey.good.as_slice();
        let is_choice = good.len() == instance.count() && instance.required().iter().all(|i| good.contains(i));
        (is_choice && !instance.is_singular(good)).then_some(good)
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
        let start = match self.known_to_be_good(&instance) {
            Some(good) => best_from_known(&instance, &self.settings, seed, good),
            None => start_of_search(&instance, &self.settings, seed),
        };
        let start = start.map_err(|e| self.explain(e))?;
        let found = search(&instance, &start, f64::NEG_INFINITY, self.problem.selection.node_limit, observe)
            .map_err(|e| self.explain(e))?;
        if found.log_value == f64::NEG_INFINITY {
            return Err(self.explain(instance.unobservable(&found.selected)));
        }
        Ok((self.assess(found.selected.clone()), start.relaxation.certificate, found))
    }

    /// The fewest poses that reach the accuracies which the problem requests. `observe` as in [`Chooser::exact`].
    ///
    /// # Errors
    /// When the accuracies are out of reach, and as [`Chooser::best`].
    pub(super) fn fewest(
        &self,
        seed: u64,
        observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
    ) -> Result<(Choice, Fewest), PlanError> {
        let most = self.survey.views.len();
        let instance = self.instance(most.min(self.rules.required.len().max(1)))?;
        let node_limit = self.problem.selection.node_limit;
        let found = fewest(&instance, 0.0, most, &self.settings, seed, node_limit, observe);
        let found = found.map_err(|error| match error {
            NotEnough::Selection(error) => self.explain(error),
            NotEnough::Never { selected, log_bound } => PlanError::Inaccurate {
                count: selected.len(),
                shortfalls: {
                    let reached = self.reached(&self.assess(selected)).into_iter();
                    reached.filter(|accuracy| accuracy.reached > accuracy.requested).collect()
                },
                // Φ is of variances, the accuracies of their roots.
                bound: (0.5 * log_bound).exp(),
            },
        })?;
        Ok((self.assess(found.best.selected.clone()), found))
    }

    /// The accuracies that the problem requests, in its order, and what a choice reaches, in the worst scenario.
    pub(crate) fn reached(&self, choice: &Choice) -> Vec<Reached> {
        let names = self.problem.unknowns().names();
        let mut everywhere = vec![(choice.sigma.clone(), choice.map_error)];
        for (scenario, known) in self.survey.scenarios.iter().zip(&self.known[1..]) {
            let total = scenario.information.total(&pack(&known.information), &choice.selected);
            everywhere.push(self.accuracy_by(&unpack(&total, known.information.nrows()), &scenario.map_weight));
        }
        let reached = |&(accuracy, requested): &(Accuracy, f64)| {
            let name = match accuracy {
                Accuracy::MapError => Accuracy::MAP_ERROR,
                Accuracy::Intrinsic(j) => names[j],
            };
            let of = |(sigma, map_error): &(Vec<f64>, f64)| match accuracy {
                Accuracy::MapError => *map_error,
                Accuracy::Intrinsic(j) => sigma.get(j).copied().unwrap_or(f64::INFINITY),
            };
            Reached { name: name.into(), requested, reached: everywhere.iter().map(of).fold(0.0, f64::max) }
        };
        self.problem.selection.goal.accuracies().iter().map(reached).collect()
    }

    /// A bound on every choice of `count` poses, without the effort of choosing the best.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn certificate(&self, count: usize) -> Result<Certificate, PlanError> {
        let instance = self.instance(count)?;
        let (_, relaxation) = relax_from_greedy(&instance, &self.settings).map_err(|e| self.explain(e))?;
        Ok(relaxation.certificate)
    }

    /// The survey of those swept views alone that score most by a certificate for choices of `count` poses, `most` at most, and of
    /// those that the constraints require.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub(super) fn highest(&self, certificate: &Certificate, count: usize, most: usize) -> Result<Survey, PlanError> {
        let instance = self.instance(count)?;
        let scores = instance.scores(&certificate.y);
        let swept = self.survey.views.len() - self.survey.off_grid;
        let mut places = highest(&scores, (0..swept).filter(|&i| instance.is_open(i)), most);
        places.extend(instance.required());
        places.sort_unstable();
        Ok(self.survey.only(&places))
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
                let (_, relaxation) = relax_from_greedy(&instance, &self.settings).map_err(|e| self.explain(e))?;
                relaxation.rounded(&instance).map_or_else(improved, Ok)?
            }
            Method::Exchange => improved()?,
            Method::Greedy => greedy(&instance).map_err(|e| self.explain(e))?,
            Method::Random => random(self.survey.views.len() - self.survey.off_grid, count, seed),
            Method::KMeansJoints | Method::KMeansPositions => {
                let features = self.features(method)?.unwrap_or_default();
                KMeans::new(&features, seed).members(count)?
            }
        };
        Ok(self.assess(selected))
    }

    /// What `method` clusters: of each view the joint values, or the camera's position in the base frame; none if it does not
    /// cluster.
    ///
    /// # Errors
    /// When the values are not finite.
    pub(crate) fn features(&self, method: Method) -> Result<Option<Points>, ClusteringError> {
        // The baselines know nothing of views off the grid.
        let views = self.survey.views[..self.survey.views.len() - self.survey.off_grid].iter();
        match method {
            Method::KMeansJoints => Points::new(views.map(|view| &view.q)).map(Some),
            Method::KMeansPositions => Points::new(views.map(|view| &view.X_BC.translation.vector)).map(Some),
            _ => Ok(None),
        }
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

    /// Information of a choice on the intrinsics, the prior included, p×p; of a board that may bulge on its heights before
    /// them.
    pub fn information(&self, selected: &[usize]) -> DMatrix<f64> {
        let prior = &self.known[0].information;
        let p = prior.nrows();
        prior + unpack(&self.survey.information.total(&vec![0.0; packed_len(p)], selected), p)
    }

    /// Each chosen pose's share of the information at hand: `⟨∇log Φ(M), M_i⟩`; with the prior's, the shares add up to one.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn shares(&self, selected: &[usize]) -> Result<Vec<f64>, PlanError> {
        let instance = self.instance(selected.len())?;
        Ok(match instance.gradient_at(&instance.total(selected)) {
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

    /// Information that is known already, in the set-up as stated and in each scenario.
    pub(crate) fn known(&self) -> impl Iterator<Item = &DMatrix<f64>> {
        self.known.iter().map(|known| &known.information)
    }

    /// Covariance of the intrinsics by information M, as of [`Chooser::information`]; `None` if it leaves one undetermined.
    pub(crate) fn covariance(&self, M: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        self.problem.measurement().covariance(M)
    }

    /// Standard deviations and map error by information M, as in a [`Choice`].
    pub(crate) fn accuracy(&self, M: &DMatrix<f64>) -> (Vec<f64>, f64) {
        self.accuracy_by(M, &self.survey.map_weight)
    }

    fn accuracy_by(&self, M: &DMatrix<f64>, map_weight: &DMatrix<f64>) -> (Vec<f64>, f64) {
        let nuisance = self.problem.measurement().nuisance();
        let log_value = InformationFunction::variance(map_weight).beside(nuisance).log_value(&mut pack(M), M.nrows());
        let sigma = |covariance: DMatrix<f64>| covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        (self.covariance(M).map_or_else(Vec::new, sigma), (-0.5 * log_value).exp())
    }

    /// Standard deviations and map error of `views`, with those taken already, if the corners, which scatter unequally, are all
    /// given one weight, and the board is taken for flat: what OpenCV's `calibrateCamera` makes of it. `None` where all scatter
    /// alike on a flat board, or an intrinsic is left undetermined.
    pub(crate) fn unweighted<'v>(&self, views: impl IntoIterator<Item = &'v View>) -> Option<(Vec<f64>, f64)> {
        let Self { problem, survey, .. } = self;
        let measurement = problem.measurement();
        if problem.noise.model == NoiseModel::Constant && measurement.warp.is_none() {
            return None;
        }
        let mut estimate = Unweighted::new(&stated_of_intrinsics(problem));
        let taken = self.known[0].captured.iter().map(|Captured { X_CT, seen }| (X_CT, seen));
        let chosen = views.into_iter().map(|view| (&view.X_CT, &view.seen));
        for (X_CT, seen) in taken {
            estimate.add(&problem.measurement_of_one_picture(), X_CT, seen)?;
        }
        for (X_CT, seen) in chosen {
            estimate.add(&measurement, X_CT, seen)?;
        }
        let covariance = estimate.covariance()?;
        let map_error = (&survey.map_weight * &covariance).trace().sqrt();
        Some((covariance.diagonal().map(f64::sqrt).iter().copied().collect(), map_error))
    }

    pub(crate) fn instance(&self, count: usize) -> Result<Instance<'_>, PlanError> {
        let views = self.survey.views.len();
        if count > views {
            return Err(PlanError::TooFewViews { count, views });
        }
        self.objective.instance(count, &self.rules).map_err(|e| self.explain(e))
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
