//! What is optimised: the problem's criteria on the survey's views, in the terms of [`selection`](crate::selection).

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::constraints::Known;
use crate::feasibility::View;
use crate::information::{Criterion, DiversityModel, Measurement, ZHANG_DIRECTIONS};
use crate::plan::survey::{Scenario, Scene, Survey, SurveyError};
use crate::problem::{Accuracy, Goal, Problem, RobustGoal};
use crate::selection::InformationSet;
use crate::selection::packed::{pack, packed_len, unpack};
use crate::selection::{InformationFunction, Instance, Rules, SelectionError, Term};
use crate::target::Warp;

/// Criteria, each with its share, on the views of a survey, in every scenario that the plan must withstand.
#[derive(Debug, Clone)]
pub(crate) struct Objective<'a> {
    /// Scenario after scenario.
    terms: Vec<ObjectiveTerm<'a>>,
    /// What counts of the scenarios.
    goal: RobustGoal,
    scenarios: usize,
}

#[derive(Debug, Clone)]
struct ObjectiveTerm<'a> {
    /// The scenario; 0 for the set-up as stated.
    scenario: usize,
    /// None for accuracies.
    criterion: Option<Criterion>,
    /// Among the scenario's.
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

/// A set-up, stated or drawn, with what a survey found for it.
struct SetUp<'a> {
    scenario: usize,
    problem: &'a Problem,
    /// The set-up as stated.
    stated: &'a Problem,
    /// The views of the set-up as stated.
    views: &'a [View],
    information: &'a InformationSet,
    map_weight: &'a DMatrix<f64>,
}

impl<'a> SetUp<'a> {
    /// The set-up as stated, and the scenarios.
    fn all(problem: &'a Problem, survey: &'a Survey) -> impl Iterator<Item = Self> {
        let Survey { views, information, map_weight, scenarios, .. } = survey;
        let as_stated = Self { scenario: 0, problem, stated: problem, views, information, map_weight };
        let drawn =
            scenarios.iter().zip(1..).map(move |(Scenario { problem: drawn, information, map_weight }, scenario)| {
                Self { scenario, problem: drawn, stated: problem, views, information, map_weight }
            });
        std::iter::once(as_stated).chain(drawn)
    }

    /// The views as they are here; none where they are no views.
    fn seen(&self) -> Vec<Option<View>> {
        if self.scenario == 0 {
            return self.views.iter().cloned().map(Some).collect();
        }
        let stated = Scene::new(self.stated);
        let scene = stated.of_drawn(self.problem);
        self.views.par_iter().map(|view| scene.view(view)).collect()
    }
}

impl<'a> Objective<'a> {
    /// The weighted geometric mean of `criteria`, shares beside them, in every scenario; `known` is what is known in each of them. It
    /// counts in criteria that are not of the intrinsics too.
    ///
    /// # Errors
    /// When a view's corners do not fix what a criterion needs.
    pub(crate) fn new(
        problem: &'a Problem,
        survey: &'a Survey,
        criteria: &[(Criterion, f64)],
        known: &[Known],
    ) -> Result<Self, SurveyError> {
        let mut terms = Vec::with_capacity(criteria.len() * known.len());
        for (set_up, known) in SetUp::all(problem, survey).zip(known) {
            for &(criterion, share) in criteria {
                terms.push(ObjectiveTerm::new(&set_up, criterion, share, known)?);
            }
        }
        Ok(Self { terms, ..Self::none(problem, survey) })
    }

    /// The worst of the accuracies requested, as a share: Φ ≥ 1 when all are reached.
    pub(crate) fn of_accuracies(
        problem: &'a Problem,
        survey: &'a Survey,
        accuracies: &[(Accuracy, f64)],
        known: &[Known],
    ) -> Self {
        let nuisance = problem.measurement().nuisance();
        let term = |(set_up, known): (SetUp<'a>, &Known)| ObjectiveTerm {
            scenario: set_up.scenario,
            criterion: None,
            share: 1.0,
            candidates: Cow::Borrowed(set_up.information),
            prior: Some(known.information.clone()),
            function: InformationFunction::worst_variance(&accuracy_weights(set_up.map_weight, accuracies))
                .beside(nuisance),
            parameters: parameters(problem),
            source: Source::Intrinsics,
        };
        Self { terms: SetUp::all(problem, survey).zip(known).map(term).collect(), ..Self::none(problem, survey) }
    }

    /// Without terms.
    fn none(problem: &Problem, survey: &Survey) -> Self {
        let goal = problem.robust.as_ref().map_or(RobustGoal::Mean, |robust| robust.goal);
        Self { terms: vec![], goal, scenarios: 1 + survey.scenarios.len() }
    }

    /// The matrices of a view, swept or not, term after term as in an instance's totals; `None` if its corners do not fix what
    /// a criterion needs. `scenes` are the set-ups, the stated one first, in which the view is one.
    pub(crate) fn information(&self, scenes: &[Scene], view: &View) -> Option<Vec<f64>> {
        let mut information = Vec::new();
        let mut seen = Some(Cow::Borrowed(view));
        let mut scenario = 0;
        for term in &self.terms {
            let scene = &scenes[term.scenario];
            if term.scenario != scenario {
                scenario = term.scenario;
                seen = scene.view(view).map(Cow::Owned);
            }
            match &seen {
                Some(view) => information.extend(term.source.information(&scene.measurement, view)?),
                None => information.extend(std::iter::repeat_n(0.0, packed_len(term.candidates.order()))),
            }
        }
        Some(information)
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
        Objective { terms: terms.collect(), ..*self }
    }

    /// The same where that share of what is known is.
    pub(crate) fn known_share(mut self, share: f64) -> Self {
        for prior in self.terms.iter_mut().filter_map(|term| term.prior.as_mut()) {
            *prior *= share;
        }
        self
    }

    /// The problem of choosing `count` views under rules of them all.
    ///
    /// # Errors
    /// As [`Instance::constrained`].
    pub(crate) fn instance(&self, count: usize, rules: &Arc<Rules>) -> Result<Instance<'_>, SelectionError> {
        let mut scenarios: Vec<Vec<Term<'_>>> = Vec::with_capacity(self.scenarios);
        for terms in self.apart() {
            let terms = terms.iter().map(|term| Term {
                candidates: &term.candidates,
                prior: term.prior.as_ref(),
                function: &term.function,
                share: self.weight(term),
            });
            scenarios.push(terms.collect());
        }
        Instance::under(&scenarios, count, Arc::clone(rules))
    }

    /// log Φ of the views `selected`, whatever the constraints; −∞ if they leave a combination undetermined.
    pub(crate) fn log_value(&self, selected: &[usize]) -> f64 {
        let log_value = |term: &ObjectiveTerm| {
            let p = term.candidates.order();
            let prior = term.prior.as_ref().map_or_else(|| vec![0.0; packed_len(p)], pack);
            self.weight(term) * term.function.log_value(&mut term.candidates.total(&prior, selected), p)
        };
        let of_those = |terms: &[ObjectiveTerm]| terms.iter().map(log_value).sum();
        self.apart().map(of_those).fold(f64::INFINITY, f64::min)
    }

    /// The terms of which the least counts, or all of them.
    fn apart(&self) -> impl Iterator<Item = &[ObjectiveTerm<'a>]> {
        let together = self.goal == RobustGoal::Mean;
        self.terms.chunk_by(move |a, b| together || a.scenario == b.scenario)
    }

    /// A term's share of all that it stands together with.
    fn weight(&self, term: &ObjectiveTerm) -> f64 {
        match self.goal {
            RobustGoal::Mean => term.share / self.scenarios as f64,
            RobustGoal::Worst => term.share,
        }
    }

    /// What Y, term after term and packed, is on the information of what is estimated, in each scenario: its score of a view is the
    /// sum of theirs. None where a criterion is of something else.
    pub(crate) fn on_measured(&self, y: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut rest = y;
        let mut scenarios: Vec<Vec<f64>> = Vec::with_capacity(self.scenarios);
        for term in &self.terms {
            let p = term.candidates.order();
            let (own, others) = rest.split_at(packed_len(p));
            rest = others;
            let own: Vec<f64> = match &term.source {
                Source::Intrinsics => own.to_vec(),
                Source::Scaled(units) => {
                    let pairs = (0..p).flat_map(|i| (0..=i).map(move |j| (i, j)));
                    own.iter().zip(pairs).map(|(y, (i, j))| y * units[i] * units[j]).collect()
                }
                Source::Zhang | Source::Diversity(_) => return None,
            };
            match scenarios.get_mut(term.scenario) {
                Some(sum) => sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own),
                None => scenarios.push(own),
            }
        }
        Some(scenarios)
    }

    /// Names of the parameters of a term.
    pub(crate) fn parameters(&self, term: usize) -> &[String] {
        &self.terms[term].parameters
    }

    /// Number of set-ups that count, the stated one among them.
    pub(crate) fn scenarios(&self) -> usize {
        self.scenarios
    }

    /// Term by term the scenario, the criterion, its share and its order p.
    pub(crate) fn criteria(&self) -> impl Iterator<Item = (usize, Option<Criterion>, f64, usize)> {
        self.terms.iter().map(|term| (term.scenario, term.criterion, self.weight(term), term.parameters.len()))
    }

    /// log Φ in the unit of a lone criterion: log det for `d` and `diversity`, a variance in px² for `a` and `v`, an
    /// eigenvalue for `e` and `zhang`; of several criteria, Φ itself.
    pub(crate) fn natural(&self, log_value: f64) -> f64 {
        let lone = self.terms.chunk_by(|a, b| a.criterion == b.criterion).map(|terms| &terms[0]).collect::<Vec<_>>();
        match lone.as_slice() {
            [term] => match term.criterion {
                Some(Criterion::D | Criterion::Diversity) => {
                    log_value * (term.parameters.len() - term.function.nuisance()) as f64
                }
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
        let terms = self.terms.iter().take_while(|term| term.scenario == 0);
        let criteria: Option<Vec<_>> =
            terms.map(|term| term.criterion.map(|criterion| (criterion, term.share))).collect();
        f.write_str(&criteria.map_or_else(|| Goal::ACCURACY.into(), |criteria| Criterion::describe(&criteria)))
    }
}

impl<'a> ObjectiveTerm<'a> {
    fn new(set_up: &SetUp<'a>, criterion: Criterion, share: f64, known: &Known) -> Result<Self, SurveyError> {
        let SetUp { scenario, problem, information, map_weight, .. } = *set_up;
        let Known { captured, information: prior } = known;
        let nuisance = problem.measurement().nuisance();
        let names = parameters(problem);
        let borrowed = Cow::Borrowed(information);
        let term = |candidates, prior, function, parameters, source| Self {
            scenario,
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
            Criterion::D => {
                let function = InformationFunction::Determinant.beside(nuisance);
                term(borrowed, Some(prior.clone()), function, names, intrinsics)
            }
            Criterion::V => {
                let function = InformationFunction::variance(map_weight).beside(nuisance);
                term(borrowed, Some(prior.clone()), function, names, intrinsics)
            }
            Criterion::A => {
                let function = InformationFunction::variance(&pixel_weight(problem)).beside(nuisance);
                term(borrowed, Some(prior.clone()), function, names, intrinsics)
            }
            Criterion::E => {
                let mut units = vec![1.0; nuisance];
                units.extend(problem.unknowns().pixel_units());
                let D = DMatrix::from_diagonal(&units.clone().into());
                let candidates = Cow::Owned(information.scaled(&units));
                let prior = &D * prior * &D;
                let function = InformationFunction::min_eigenvalue().beside(nuisance);
                term(candidates, Some(prior), function, names, Source::Scaled(units))
            }
            Criterion::Zhang => {
                let directions = owned(&ZHANG_DIRECTIONS);
                let candidates = Source::Zhang.set(set_up, directions.len())?;
                let measurement = problem.measurement_of_one_picture();
                let known =
                    measurement.zhang_set(captured.iter().map(|view| (&view.X_CT, &view.seen)).collect::<Vec<_>>());
                let known = known.ok_or_else(|| SurveyError::undetermined(problem))?;
                let prior = unpack(&known.sum(), candidates.order());
                let function = InformationFunction::min_eigenvalue();
                term(Cow::Owned(candidates), Some(prior), function, directions, Source::Zhang)
            }
            Criterion::Diversity => {
                // The features mean the same in every scenario.
                let model = DiversityModel::new(&set_up.views.iter().map(|view| view.X_CT).collect::<Vec<_>>());
                let monomials = model.monomials();
                let source = Source::Diversity(model.clone());
                let candidates = source.set(set_up, monomials.len())?;
                let known = model.information_set(&captured.iter().map(|view| view.X_CT).collect::<Vec<_>>());
                let prior = unpack(&candidates.mean(), monomials.len()) * DiversityModel::PRIOR
                    + unpack(&known.sum(), monomials.len());
                let function = InformationFunction::Determinant;
                term(Cow::Owned(candidates), Some(prior), function, monomials, source)
            }
        })
    }
}

impl Source {
    /// The matrices of order p of all views in a set-up; zero where they are none.
    fn set(&self, set_up: &SetUp, p: usize) -> Result<InformationSet, SurveyError> {
        let measurement = set_up.problem.measurement();
        let information = set_up.seen().into_par_iter().map(|view| match view {
            Some(view) => self.information(&measurement, &view),
            None => Some(vec![0.0; packed_len(p)]),
        });
        let information = information.collect::<Option<Vec<_>>>();
        let information = information.ok_or_else(|| SurveyError::undetermined(set_up.problem))?;
        Ok(InformationSet::from_packed_trusted(p, information.concat()))
    }
}

/// The weight of `a`: of the variances in the units that each move the image by 1 px.
fn pixel_weight(problem: &Problem) -> DMatrix<f64> {
    let units = problem.unknowns().pixel_units();
    DMatrix::from_diagonal(&DVector::from_vec(units).map(|unit| unit.powi(-2)))
}

/// The weights of the accuracies' variances, each as a share of the variance requested.
fn accuracy_weights(map_weight: &DMatrix<f64>, accuracies: &[(Accuracy, f64)]) -> Vec<DMatrix<f64>> {
    accuracies.iter().map(|&(accuracy, requested)| accuracy.weight(map_weight) / (requested * requested)).collect()
}

/// Names of what is estimated of all views together.
fn parameters(problem: &Problem) -> Vec<String> {
    let heights = &Warp::NAMES[..problem.measurement().nuisance()];
    owned(&[heights, &problem.unknowns().names()].concat())
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

impl Accuracy {
    /// The p×p weight C of the accuracy's variance `tr(C cov θ)`.
    fn weight(self, map_weight: &DMatrix<f64>) -> DMatrix<f64> {
        match self {
            Accuracy::MapError => map_weight.clone(),
            Accuracy::Intrinsic(j) => {
                let mut weight = map_weight * 0.0;
                weight[(j, j)] = 1.0;
                weight
            }
        }
    }
}
