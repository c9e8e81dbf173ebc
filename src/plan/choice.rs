//! Choosing poses from a survey by any method, with the certificate that goes with the choice.

use nalgebra::DMatrix;
use thiserror::Error;

use super::survey::{Survey, SurveyError};
use crate::information::Criterion;
use crate::information::packed::unpack;
use crate::problem::{Problem, SelectionSettings};
use crate::selection::{
    Best, Certificate, ClusteringError, InformationFunction, Instance, Method, RelaxationSettings, SelectionError,
    best, exchange, greedy, kmeans, random, relax,
};

/// Why a problem has no plan.
#[derive(Debug, Error)]
pub enum PlanError {
    /// There is nothing to choose from.
    #[error(transparent)]
    Survey(#[from] SurveyError),
    /// More poses are asked for than there are views.
    #[error("{count} poses are asked for, but only {views} configurations see the board and can be taken")]
    TooFewViews {
        /// Poses asked for.
        count: usize,
        /// Views found.
        views: usize,
    },
    /// The poses leave some combination of the intrinsics undetermined.
    #[error("{count} poses cannot determine all intrinsics; they leave open: {}", describe(combination))]
    Unobservable {
        /// Poses tried.
        count: usize,
        /// Names of the intrinsics and their coefficients in the combination, largest 1.
        combination: Vec<(&'static str, f64)>,
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

fn describe(combination: &[(&str, f64)]) -> String {
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

/// Chooses from one survey.
pub struct Chooser<'a> {
    survey: &'a Survey,
    criterion: Criterion,
    names: Vec<&'static str>,
    function: InformationFunction,
    map_error: InformationFunction,
    settings: RelaxationSettings,
    /// p×p information already at hand.
    prior: DMatrix<f64>,
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
    /// A chooser for the problem that was surveyed.
    pub fn new(problem: &Problem, survey: &'a Survey) -> Self {
        let SelectionSettings { criterion, tolerance, .. } = problem.selection;
        let prior = DMatrix::zeros(problem.estimated.len(), problem.estimated.len());
        let map_error = InformationFunction::variance(&survey.map_weight);
        let function = match criterion {
            Criterion::D => InformationFunction::Determinant,
            Criterion::V => map_error.clone(),
        };
        let settings = RelaxationSettings { tolerance, ..RelaxationSettings::default() };
        Self { survey, criterion, names: problem.estimated_names(), function, map_error, settings, prior }
    }

    /// The same chooser when `prior` is known already: the p×p information of the views taken, say.
    #[must_use]
    pub fn with_prior(self, prior: DMatrix<f64>) -> Self {
        Self { prior, ..self }
    }

    /// The value of the criterion in its own unit: `log det M` for `d`, the map error's variance in px² for `v`.
    pub fn natural(&self, log_value: f64) -> f64 {
        match self.criterion {
            Criterion::D => log_value * self.names.len() as f64,
            Criterion::V => (-log_value).exp(),
        }
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

    /// A bound on every choice of `count` poses, without the effort of choosing the best.
    ///
    /// # Errors
    /// As [`Chooser::best`].
    pub fn certificate(&self, count: usize) -> Result<Certificate, PlanError> {
        let instance = self.instance(count)?;
        let start = exchange(&instance, greedy(&instance).map_err(|e| self.explain(e))?);
        let relaxation = relax(&instance, &start, &self.settings);
        relaxation
            .map(|relaxation| relaxation.certificate)
            .ok_or(PlanError::Unobservable { count, combination: vec![] })
    }

    /// `count` poses chosen by `method`.
    ///
    /// # Errors
    /// As [`Chooser::best`]; random and clustered choices may be singular, which is no error.
    pub fn choose(&self, method: Method, count: usize, seed: u64) -> Result<Choice, PlanError> {
        let instance = self.instance(count)?;
        let greedy = || greedy(&instance).map_err(|e| self.explain(e));
        let selected = match method {
            Method::Best => best(&instance, &self.settings, seed).map_err(|e| self.explain(e))?.selected,
            Method::Relaxation => {
                let start = exchange(&instance, greedy()?);
                let relaxation = relax(&instance, &start, &self.settings);
                relaxation.ok_or_else(|| self.explain(instance.unobservable(&start)))?.largest(count)
            }
            Method::Exchange => exchange(&instance, greedy()?),
            Method::Greedy => greedy()?,
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

    /// Information of a choice, the prior included, p×p.
    pub fn information(&self, selected: &[usize]) -> DMatrix<f64> {
        let p = self.names.len();
        let nothing = vec![0.0; crate::information::packed::packed_len(p)];
        &self.prior + unpack(&self.survey.information.total(&nothing, selected), p)
    }

    /// Each chosen pose's share of the information at hand: `⟨∇log Φ(M), M_i⟩`; with the prior's, the shares add up to one.
    pub fn shares(&self, selected: &[usize]) -> Vec<f64> {
        let p = self.names.len();
        let M = crate::information::packed::pack(&self.information(selected));
        let Some(y) = self.function.gradient(&M, p) else { return vec![f64::NAN; selected.len()] };
        let y = crate::information::packed::dual(y, p);
        let share = |&i: &usize| self.survey.information.packed(i).iter().zip(&y).map(|(m, y)| m * y).sum();
        selected.iter().map(share).collect()
    }

    fn assess(&self, mut selected: Vec<usize>) -> Choice {
        selected.sort_unstable();
        let p = self.names.len();
        let M = self.information(&selected);
        let packed = crate::information::packed::pack(&M);
        let sigma = match M.cholesky() {
            Some(factor) => factor.inverse().diagonal().iter().map(|variance| variance.sqrt()).collect(),
            None => vec![],
        };
        Choice {
            log_value: self.function.log_value(&mut packed.clone(), p),
            map_error: (-0.5 * self.map_error.log_value(&mut packed.clone(), p)).exp(),
            sigma,
            selected,
        }
    }

    fn instance(&self, count: usize) -> Result<Instance<'_>, PlanError> {
        let views = self.survey.views.len();
        if count > views {
            return Err(PlanError::TooFewViews { count, views });
        }
        Instance::new(&self.survey.information, Some(&self.prior), &self.function, count).map_err(|e| self.explain(e))
    }

    fn explain(&self, error: SelectionError) -> PlanError {
        match error {
            SelectionError::Unobservable { count, combination } => {
                PlanError::Unobservable { count, combination: self.names.iter().copied().zip(combination).collect() }
            }
            other => PlanError::Selection(other),
        }
    }
}
