//! What is optimised: the problem's criteria on the survey's views, in the terms of [`selection`](crate::selection).

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::constraints::Captured;
use crate::feasibility::View;
use crate::information::{Criterion, DiversityModel, Measurement, ZHANG_DIRECTIONS};
use crate::plan::survey::{Survey, SurveyError};
use crate::problem::{Accuracy, Goal, Problem};
use crate::selection::InformationSet;
use crate::selection::packed::{pack, packed_len, unpack};
use crate::selection::{Constraints, InformationFunction, Instance, SelectionError, Term};
use crate::spatial::Pose;
use crate::target::Corners;

/// Criteria, each with its share, on the views of a survey.
#[derive(Debug, Clone)]
pub(crate) struct Objective<'a> {
    terms: Vec<ObjectiveTerm<'a>>,
}

#[derive(Debug, Clone)]
struct ObjectiveTerm<'a> {
    /// None for accuracies.
    criterion: Option<Criterion>,
    share: f64,
    candidates: Cow<'a, InformationSet>,
    prior: Option<DMatrix<f64>>,
    function: InformationFunction,
    /// Names of the parameters.
    parameters: Vec<String>,
    source: Source,
}

/// Where a view's matrix comes from.
#[derive(Debug, Clone)]
enum Source {
    /// Its information on the intrinsics.
    Intrinsics,
    /// The same with the intrinsics in other units.
    Scaled(Vec<f64>),
    /// Its share of Zhang's closed form.
    Zhang,
    /// The model of the views' features.
    Diversity(DiversityModel),
}

impl Source {
    /// The packed matrix of a view; `None` if its corners do not fix what is needed.
    fn information(&self, measurement: &Measurement, view: &View) -> Option<Vec<f64>> {
        let View { X_CT, seen, .. } = view;
        match self {
            Source::Intrinsics => measurement.information(X_CT, seen),
            Source::Scaled(units) => {
                let mut information = measurement.information(X_CT, seen)?;
                let pairs = (0..units.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
                for (entry, (i, j)) in information.iter_mut().zip(pairs) {
                    *entry *= units[i] * units[j];
                }
                Some(information)
            }
            Source::Zhang => measurement.zhang_information(X_CT, seen),
            Source::Diversity(model) => Some(model.information(X_CT)),
        }
    }
}

impl<'a> Objective<'a> {
    /// The weighted geometric mean of `criteria`, shares beside them; `prior` is the p×p information on the intrinsics that
    /// is known already, that of the views `captured` included. These count in criteria that are not of the intrinsics too.
    ///
    /// # Errors
    /// When a view's corners do not fix what a criterion needs.
    pub(crate) fn new(
        problem: &Problem,
        survey: &'a Survey,
        criteria: &[(Criterion, f64)],
        prior: &DMatrix<f64>,
        captured: &[Captured],
    ) -> Result<Self, SurveyError> {
        let terms: Result<Vec<_>, _> = criteria
            .iter()
            .map(|&(criterion, share)| ObjectiveTerm::new(problem, survey, criterion, share, prior, captured))
            .collect();
        Ok(Self { terms: terms? })
    }

    /// The worst of the accuracies requested, as a share: Φ ≥ 1 when all are reached.
    pub(crate) fn of_accuracies(
        problem: &Problem,
        survey: &'a Survey,
        accuracies: &[(Accuracy, f64)],
        prior: &DMatrix<f64>,
    ) -> Self {
        let weights = accuracy_weights(survey, accuracies);
        let term = ObjectiveTerm {
            criterion: None,
            share: 1.0,
            candidates: Cow::Borrowed(&survey.information),
            prior: Some(prior.clone()),
            function: InformationFunction::worst_variance(&weights),
            parameters: owned(&problem.unknowns().names()),
            source: Source::Intrinsics,
        };
        Self { terms: vec![term] }
    }

    /// The matrices of a view, swept or not, term after term as in an instance's totals; `None` if its corners do not fix what
    /// a criterion needs.
    pub(crate) fn information(&self, measurement: &Measurement, view: &View) -> Option<Vec<f64>> {
        let terms = self.terms.iter().map(|term| term.source.information(measurement, view));
        Some(terms.collect::<Option<Vec<_>>>()?.concat())
    }

    /// The same objective on other views, given by their [`Objective::information`].
    pub(crate) fn on(&self, views: &[Vec<f64>]) -> Objective<'static> {
        let mut start = 0;
        let terms = self.terms.iter().map(|term| {
            let p = term.candidates.order();
            let place = start..start + packed_len(p);
            start = place.end;
            let table = views.iter().flat_map(|view| view[place.clone()].iter().copied()).collect();
            ObjectiveTerm {
                candidates: Cow::Owned(InformationSet::from_packed_trusted(p, table)),
                prior: term.prior.clone(),
                function: term.function.clone(),
                parameters: term.parameters.clone(),
                source: term.source.clone(),
                ..*term
            }
        });
        Objective { terms: terms.collect() }
    }

    /// The problem of choosing `count` views.
    ///
    /// # Errors
    /// As [`Instance::constrained`].
    pub(crate) fn instance(&self, count: usize, constraints: Constraints) -> Result<Instance<'_>, SelectionError> {
        let terms: Vec<Term<'_>> = self
            .terms
            .iter()
            .map(|term| Term {
                candidates: &term.candidates,
                prior: term.prior.as_ref(),
                function: &term.function,
                share: term.share,
            })
            .collect();
        Instance::constrained(&terms, count, constraints)
    }

    /// log Φ of the views `selected`, whatever the constraints; −∞ if they leave a combination undetermined.
    pub(crate) fn log_value(&self, selected: &[usize]) -> f64 {
        let log_value = |term: &ObjectiveTerm| {
            let p = term.candidates.order();
            let prior = term.prior.as_ref().map_or_else(|| vec![0.0; packed_len(p)], pack);
            term.share * term.function.log_value(&mut term.candidates.total(&prior, selected), p)
        };
        self.terms.iter().map(log_value).sum()
    }

    /// Names of the parameters of a term.
    pub(crate) fn parameters(&self, term: usize) -> &[String] {
        &self.terms[term].parameters
    }

    /// The criteria, their shares and their orders p, term by term.
    pub(crate) fn criteria(&self) -> impl Iterator<Item = (Option<Criterion>, f64, usize)> {
        self.terms.iter().map(|term| (term.criterion, term.share, term.parameters.len()))
    }

    /// log Φ in the unit of a lone criterion: log det for `d` and `diversity`, a variance in px² for `a` and `v`, an
    /// eigenvalue for `e` and `zhang`; of several criteria, Φ itself.
    pub(crate) fn natural(&self, log_value: f64) -> f64 {
        match self.terms.as_slice() {
            [term] => match term.criterion {
                Some(Criterion::D | Criterion::Diversity) => log_value * term.parameters.len() as f64,
                Some(Criterion::A | Criterion::V) => (-log_value).exp(),
                Some(Criterion::E | Criterion::Zhang) | None => log_value.exp(),
            },
            _ => log_value.exp(),
        }
    }
}

impl std::fmt::Display for Objective<'_> {
    /// `v`, or `0.8 v + 0.2 diversity`, or `accuracy`.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let criteria: Option<Vec<_>> =
            self.terms.iter().map(|term| term.criterion.map(|criterion| (criterion, term.share))).collect();
        f.write_str(&criteria.map_or_else(|| Goal::ACCURACY.into(), |criteria| Criterion::describe(&criteria)))
    }
}

impl<'a> ObjectiveTerm<'a> {
    fn new(
        problem: &Problem,
        survey: &'a Survey,
        criterion: Criterion,
        share: f64,
        prior: &DMatrix<f64>,
        captured: &[Captured],
    ) -> Result<Self, SurveyError> {
        let names = owned(&problem.unknowns().names());
        let borrowed = Cow::Borrowed(&survey.information);
        let poses = || survey.views.iter().map(|view| view.X_CT).collect::<Vec<_>>();
        let term = |candidates, prior, function, parameters, source| Self {
            criterion: Some(criterion),
            share,
            candidates,
            prior,
            function,
            parameters,
            source,
        };
        let intrinsics = Source::Intrinsics;
        Ok(match criterion {
            Criterion::D => term(borrowed, Some(prior.clone()), InformationFunction::Determinant, names, intrinsics),
            Criterion::V => {
                let function = InformationFunction::variance(&survey.map_weight);
                term(borrowed, Some(prior.clone()), function, names, intrinsics)
            }
            Criterion::A => {
                let function = InformationFunction::variance(&pixel_weight(problem));
                term(borrowed, Some(prior.clone()), function, names, intrinsics)
            }
            Criterion::E => {
                let units = problem.unknowns().pixel_units();
                let D = DMatrix::from_diagonal(&units.clone().into());
                let candidates = Cow::Owned(survey.information.scaled(&units));
                let prior = &D * prior * &D;
                term(candidates, Some(prior), InformationFunction::min_eigenvalue(), names, Source::Scaled(units))
            }
            Criterion::Zhang => {
                let measurement = problem.measurement();
                let undetermined = SurveyError::PoseUndetermined { board: problem.target.board.to_string() };
                let set = |views: Vec<(&Pose, &Corners)>| measurement.zhang_set(views).ok_or(undetermined.clone());
                let candidates = set(survey.views.iter().map(|view| (&view.X_CT, &view.seen)).collect())?;
                let known = set(captured.iter().map(|view| (&view.X_CT, &view.seen)).collect())?;
                let prior = unpack(&known.sum(), candidates.order());
                let function = InformationFunction::min_eigenvalue();
                term(Cow::Owned(candidates), Some(prior), function, owned(&ZHANG_DIRECTIONS), Source::Zhang)
            }
            Criterion::Diversity => {
                let poses = poses();
                let model = DiversityModel::new(&poses);
                let (candidates, monomials) = (model.information_set(&poses), model.monomials());
                let known = model.information_set(&captured.iter().map(|view| view.X_CT).collect::<Vec<_>>());
                let prior = unpack(&candidates.mean(), monomials.len()) * DiversityModel::PRIOR
                    + unpack(&known.sum(), monomials.len());
                let function = InformationFunction::Determinant;
                term(Cow::Owned(candidates), Some(prior), function, monomials, Source::Diversity(model))
            }
        })
    }
}

/// The weight of `a`: of the variances in the units that each move the image by 1 px.
fn pixel_weight(problem: &Problem) -> DMatrix<f64> {
    let units = problem.unknowns().pixel_units();
    DMatrix::from_diagonal(&DVector::from_vec(units).map(|unit| unit.powi(-2)))
}

/// The weights of the accuracies' variances, each as a share of the variance requested.
fn accuracy_weights(survey: &Survey, accuracies: &[(Accuracy, f64)]) -> Vec<DMatrix<f64>> {
    accuracies.iter().map(|&(accuracy, requested)| accuracy.weight(survey) / (requested * requested)).collect()
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

impl Accuracy {
    /// The p×p weight C of the accuracy's variance `tr(C cov θ)`.
    fn weight(self, survey: &Survey) -> DMatrix<f64> {
        let p = survey.information.order();
        match self {
            Accuracy::MapError => survey.map_weight.clone(),
            Accuracy::Intrinsic(j) => {
                let mut weight = DMatrix::zeros(p, p);
                weight[(j, j)] = 1.0;
                weight
            }
        }
    }
}
