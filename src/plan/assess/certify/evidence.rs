//! What a plan's poses are worth and what its certificate proves, by the definitions alone.
//!
//! Nothing here is shared with the code that chose the poses and proved the bound: the problem's models (robot, camera, board,
//! what one view tells), full matrices, eigenvalues and a sort. The definitions, for the certificate in the plan's document:
//!
//! ```text
//! value     log Φ(M) = Σ_t λ_t log Φ_t(M_t),  M_t = M_t0 + Σ M_ti over the poses, λ_t the criteria's shares
//!           of several scenarios the least of theirs, or, as every λ_t is a share of all of them, their mean
//! polar     Φ°(Y) = inf ⟨Y, M⟩ / Φ(M) over M ≻ 0;  of several criteria log Φ°(Y) = Σ_t λ_t (log Φ_t°(Y_t) − log λ_t)
//!           of the least of several scenarios Φ°(Y) = Σ of theirs
//! scores    s_i = Σ_t ⟨Y_t, M_ti⟩, less the prices of the groups that i is in
//! bound     S = Σ_t ⟨Y_t, M_t0⟩ + the scores of the required + the greatest others, k in all + Σ_c price_c · most_c
//!           and log Φ(M) ≤ log S − log Φ°(Y) for every allowed set of k, because ⟨Y, M⟩ ≤ S and Φ(M) Φ°(Y) ≤ ⟨Y, M⟩
//!
//! criterion        M_i                                     Φ                     Φ°
//! d, diversity     of the intrinsics; z zᵀ of the view     (det M)^(1/p)         p (det Y)^(1/p)
//! e, zhang         in px units; Zhang's closed form        least eigenvalue      tr Y
//! a, v             of the intrinsics                       1 / tr(W M⁻¹)         (tr (Lᵀ Y L)^½)²,  W = L Lᵀ
//! accuracy         of the intrinsics                       1 / max_j tr(W_j M⁻¹) that of W = Σ λ_j W_j, λ the mixture
//! ```
//!
//! Sources: Pukelsheim, *Optimal Design of Experiments* (1993), chapters 5 and 7 (information functions and polarity); the
//! book's page "The method" has the proofs.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector, Point3, Vector3};
use rayon::prelude::*;

use super::error::CertifyError;
use super::function::{Function, in_units, inverse, last, matrix, scaled, uncertainty};
use super::rules::Rules;
use crate::feasibility::{MARKER_MARGIN, View};
use crate::information::{Criterion, DiversityModel, Measurement, NoiseModel, Unweighted};
use crate::plan::survey::{Scenario, Scene, Survey};
use crate::problem::{Accuracy, Goal, Problem, RobustGoal};
use crate::spatial::Pose;
use crate::target::{Corners, Marker};

/// A logarithm and how far rounding, here and where the plan was made, may have moved it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounded {
    pub(super) log: f64,
    pub(super) uncertainty: f64,
}

/// Standard deviations and map error that the poses promise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Accuracies {
    /// Of each estimated intrinsic.
    pub(super) sigma: Vec<f64>,
    /// In px.
    pub(super) map_error: f64,
    /// How far rounding may have moved them, as a share.
    pub(super) uncertainty: f64,
}

/// What a problem's poses and certificates are judged by.
pub(super) struct Evidence<'a> {
    pub(super) problem: &'a Problem,
    /// The set-up as stated, and the scenarios.
    pub(super) set_ups: Vec<SetUp<'a>>,
    /// What is known for a calibration that weighs nothing, where that is not the same.
    unweighted: Option<Unweighted>,
    /// Scenario after scenario.
    pub(super) terms: Vec<Term>,
    pub(super) rules: Rules,
}

/// A set-up, stated or drawn.
pub(super) struct SetUp<'a> {
    pub(super) problem: &'a Problem,
    measurement: Measurement<'a>,
    /// The views of the set-up as stated, as they are here; none where they are no views.
    pub(super) views: Vec<Option<Cow<'a, View>>>,
    /// `X_CT` and the corners seen of the views taken already.
    captured: Vec<(Pose, Corners)>,
    /// Information before the first pose on what is estimated of all views together.
    known: DMatrix<f64>,
}

/// One term of what is optimised.
pub(super) struct Term {
    pub(super) scenario: usize,
    pub(super) name: &'static str,
    /// Of all that it stands together with.
    pub(super) share: f64,
    pub(super) source: Source,
    /// M₀.
    pub(super) known: DMatrix<f64>,
    pub(super) function: Function,
}

/// What a view's matrix is.
pub(super) enum Source {
    /// Its information on the intrinsics.
    Intrinsics,
    /// That with each intrinsic in its unit.
    InUnits(DVector<f64>),
    /// Its part in Zhang's closed form.
    Zhang,
    /// `z zᵀ` of its features.
    Diversity(DiversityModel),
}

impl<'a> SetUp<'a> {
    fn new(
        problem: &'a Problem,
        views: Vec<Option<Cow<'a, View>>>,
        captured: Vec<(Pose, Corners)>,
    ) -> Result<Self, CertifyError> {
        let measurement = problem.measurement();
        let taken = problem.measurement_of_one_picture();
        let mut known = stated(problem);
        let p = known.nrows();
        for (X_CT, seen) in &captured {
            known += matrix(taken.information(X_CT, seen), p)?;
        }
        Ok(Self { problem, measurement, views, captured, known })
    }

    /// The set-up as stated, in which all views and those taken already must show the board, and the scenarios, in which some may not.
    fn all(problem: &'a Problem, survey: &'a Survey) -> Result<Vec<Self>, CertifyError> {
        let as_stated = survey.views.iter().map(|view| Some(Cow::Borrowed(view))).collect();
        let taken = captured(problem).enumerate();
        let taken = taken.map(|(view, seen)| seen.ok_or(CertifyError::CapturedUnseen { view: view + 1 }));
        let mut set_ups = vec![Self::new(problem, as_stated, taken.collect::<Result<_, _>>()?)?];
        let stated = Scene::new(problem);
        for Scenario { problem: drawn, .. } in &survey.scenarios {
            let scene = stated.of_drawn(drawn);
            let views = survey.views.par_iter().map(|view| scene.view(view).map(Cow::Owned)).collect();
            set_ups.push(Self::new(drawn, views, captured(drawn).flatten().collect())?);
        }
        Ok(set_ups)
    }
}

impl<'a> Evidence<'a> {
    /// For a plan of what the problem asks for.
    pub(super) fn new(problem: &'a Problem, survey: &'a Survey) -> Result<Self, CertifyError> {
        let set_ups = SetUp::all(problem, survey)?;
        let mut unweighted = None;
        if problem.noise.model != NoiseModel::Constant || problem.target.warp.is_some() {
            let SetUp { measurement, captured, .. } = &set_ups[0];
            let mut known = Unweighted::new(&last(&stated(problem), measurement.nuisance()));
            for (X_CT, seen) in captured {
                let taken = problem.measurement_of_one_picture();
                known.add(&taken, X_CT, seen).ok_or(CertifyError::Undetermined)?;
            }
            unweighted = Some(known);
        }
        let rules = Rules::new(problem, survey);
        let mut evidence = Self { problem, set_ups, unweighted, terms: Vec::new(), rules };
        // Of the mean every scenario has an equal part.
        let part = if evidence.is_worst() { 1.0 } else { evidence.set_ups.len() as f64 };
        for scenario in 0..evidence.set_ups.len() {
            match &problem.selection.goal {
                Goal::Best { criteria, .. } | Goal::Within { criteria, .. } => {
                    for &(criterion, share) in criteria {
                        let term = evidence.term(scenario, criterion, share / part)?;
                        evidence.terms.push(term);
                    }
                }
                Goal::Fewest { accuracies, .. } => evidence.terms.push(evidence.accuracy_term(scenario, accuracies)),
            }
        }
        Ok(evidence)
    }

    /// Information before the first pose on what is estimated of all views together.
    pub(super) fn known(&self) -> &DMatrix<f64> {
        &self.set_ups[0].known
    }

    /// Whether the least of the scenarios counts.
    pub(super) fn is_worst(&self) -> bool {
        self.problem.robust.as_ref().is_some_and(|robust| robust.goal == RobustGoal::Worst)
    }

    /// The terms of which the least counts, or all of them.
    fn apart(&self) -> impl Iterator<Item = &[Term]> {
        let together = !self.is_worst();
        self.terms.chunk_by(move |a, b| together || a.scenario == b.scenario)
    }

    /// The term of a criterion: its definition.
    fn term(&self, scenario: usize, criterion: Criterion, share: f64) -> Result<Term, CertifyError> {
        let SetUp { problem, measurement, views, captured, known } = &self.set_ups[scenario];
        let unknowns = problem.unknowns();
        let nuisance = measurement.nuisance();
        let units = || DVector::from_vec([vec![1.0; nuisance], unknowns.pixel_units()].concat());
        let (source, known, function) = match criterion {
            Criterion::D => (Source::Intrinsics, known.clone(), Function::Determinant.beside(nuisance)),
            Criterion::A => {
                let weight = DVector::from_vec(unknowns.pixel_units()).map(|unit| unit.powi(-2));
                let function = Function::Variance(DMatrix::from_diagonal(&weight));
                (Source::Intrinsics, known.clone(), function.beside(nuisance))
            }
            Criterion::V => {
                let function = Function::Variance(unknowns.map_error_weight());
                (Source::Intrinsics, known.clone(), function.beside(nuisance))
            }
            Criterion::E => {
                let function = Function::LeastEigenvalue.beside(nuisance);
                (Source::InUnits(units()), in_units(known, &units()), function)
            }
            Criterion::Zhang => {
                let mut known = DMatrix::zeros(5, 5);
                let taken = problem.measurement_of_one_picture();
                for (X_CT, seen) in captured {
                    known += matrix(taken.zhang_information(X_CT, seen), 5)?;
                }
                (Source::Zhang, known, Function::LeastEigenvalue)
            }
            Criterion::Diversity => {
                let stated: Vec<Pose> = self.set_ups[0].views.iter().flatten().map(|view| view.X_CT).collect();
                let model = DiversityModel::new(&stated);
                let p = model.monomials().len();
                let of_view = |X_CT| matrix(Some(model.information(X_CT)), p);
                let mut known = DMatrix::zeros(p, p);
                for view in views.iter().flatten() {
                    known += of_view(&view.X_CT)? * (DiversityModel::PRIOR / views.len() as f64);
                }
                for (X_CT, _) in captured {
                    known += of_view(X_CT)?;
                }
                (Source::Diversity(model), known, Function::Determinant)
            }
        };
        Ok(Term { scenario, name: criterion.name(), share, source, known, function })
    }

    /// The worst of the accuracies, each variance as a share of what is requested.
    fn accuracy_term(&self, scenario: usize, accuracies: &[(Accuracy, f64)]) -> Term {
        let SetUp { problem, measurement, known, .. } = &self.set_ups[scenario];
        let p = problem.unknowns().len();
        let weight = |&(accuracy, requested): &(Accuracy, f64)| {
            let weight = match accuracy {
                Accuracy::MapError => problem.unknowns().map_error_weight(),
                Accuracy::Intrinsic(j) => DMatrix::from_fn(p, p, |r, c| if r == j && c == j { 1.0 } else { 0.0 }),
            };
            weight / (requested * requested)
        };
        let function = Function::WorstVariance(accuracies.iter().map(weight).collect()).beside(measurement.nuisance());
        Term { scenario, name: Goal::ACCURACY, share: 1.0, source: Source::Intrinsics, known: known.clone(), function }
    }

    /// A term's matrix of a view.
    pub(super) fn matrix(&self, term: &Term, view: usize) -> Result<DMatrix<f64>, CertifyError> {
        let SetUp { measurement, views, .. } = &self.set_ups[term.scenario];
        let p = term.known.nrows();
        let Some(view) = &views[view] else { return Ok(DMatrix::zeros(p, p)) };
        let View { X_CT, seen, .. } = view.as_ref();
        match &term.source {
            Source::Intrinsics => matrix(measurement.information(X_CT, seen), p),
            Source::InUnits(units) => Ok(in_units(&matrix(measurement.information(X_CT, seen), p)?, units)),
            Source::Zhang => matrix(measurement.zhang_information(X_CT, seen), p),
            Source::Diversity(model) => matrix(Some(model.information(X_CT)), p),
        }
    }

    /// M of a term.
    fn total(&self, term: &Term, selected: &[usize]) -> Result<DMatrix<f64>, CertifyError> {
        selected.iter().try_fold(term.known.clone(), |M, &i| Ok(M + self.matrix(term, i)?))
    }

    /// log Φ of the poses by some of the terms.
    fn log_value_of(&self, terms: &[Term], selected: &[usize]) -> Result<Rounded, CertifyError> {
        let mut value = Rounded { log: 0.0, uncertainty: 0.0 };
        for term in terms {
            let M = self.total(term, selected)?;
            value.log += term.share * term.function.log_value(&M);
            value.uncertainty += term.share * term.function.uncertainty(&M);
        }
        Ok(value)
    }

    /// log Φ of the poses.
    pub(super) fn log_value(&self, selected: &[usize]) -> Result<Rounded, CertifyError> {
        let mut least = Rounded { log: f64::INFINITY, uncertainty: 0.0 };
        for terms in self.apart() {
            let value = self.log_value_of(terms, selected)?;
            least = Rounded { log: least.log.min(value.log), uncertainty: least.uncertainty.max(value.uncertainty) };
        }
        Ok(least)
    }

    /// Each pose's share of the information, `⟨∇log Φ(M), M_i⟩`; of several scenarios in the first that has the least value.
    pub(super) fn shares(&self, selected: &[usize]) -> Result<Vec<f64>, CertifyError> {
        let mut least = (f64::INFINITY, &self.terms[..0]);
        for terms in self.apart() {
            let value = self.log_value_of(terms, selected)?.log;
            if value < least.0 {
                least = (value, terms);
            }
        }
        let mut shares = vec![0.0; selected.len()];
        for term in least.1 {
            let Y = term.function.gradient(&self.total(term, selected)?) * term.share;
            for (share, &i) in shares.iter_mut().zip(selected) {
                *share += self.matrix(term, i)?.dot(&Y);
            }
        }
        Ok(shares)
    }

    /// σ = √diag(M⁻¹) and √tr(W M⁻¹) of the poses, by scenario.
    pub(super) fn accuracies(&self, scenario: usize, selected: &[usize]) -> Result<Accuracies, CertifyError> {
        let SetUp { problem, measurement, views, known, .. } = &self.set_ups[scenario];
        let mut M = known.clone();
        for &i in selected {
            let Some(view) = &views[i] else { continue };
            M += matrix(measurement.information(&view.X_CT, &view.seen), M.nrows())?;
        }
        let covariance = last(&inverse(&M), measurement.nuisance());
        let map_error = (problem.unknowns().map_error_weight() * &covariance).trace().sqrt();
        let sigma = covariance.diagonal().iter().map(|variance| variance.sqrt()).collect();
        Ok(Accuracies { sigma, map_error, uncertainty: uncertainty(&scaled(&M).0) })
    }

    /// The covariance of the poses' intrinsics where nothing is weighed, if that is not the same.
    pub(super) fn unweighted(&self, selected: &[usize]) -> Result<Option<DMatrix<f64>>, CertifyError> {
        let Some(mut unweighted) = self.unweighted.clone() else { return Ok(None) };
        let SetUp { measurement, views, .. } = &self.set_ups[0];
        for view in selected.iter().filter_map(|&i| views[i].as_ref()) {
            unweighted.add(measurement, &view.X_CT, &view.seen).ok_or(CertifyError::Undetermined)?;
        }
        Ok(unweighted.covariance())
    }

    /// log Φ in the unit in which plans state it: log det, a variance, an eigenvalue; of several criteria or accuracies Φ.
    pub(super) fn natural(&self, log: f64) -> f64 {
        match self.lone() {
            Some((Function::Determinant, order)) => log * order as f64,
            Some((Function::Variance(_), _)) => (-log).exp(),
            _ => log.exp(),
        }
    }

    /// log Φ of what a plan states.
    pub(super) fn log_of(&self, natural: f64) -> f64 {
        match self.lone() {
            Some((Function::Determinant, order)) => natural / order as f64,
            Some((Function::Variance(_), _)) => -natural.ln(),
            _ => natural.ln(),
        }
    }

    /// The function of the first term, if all are of one criterion, and of how many parameters it is.
    fn lone(&self) -> Option<(&Function, usize)> {
        let first = self.terms.first().filter(|first| self.terms.iter().all(|term| term.name == first.name))?;
        Some(first.function.asked(first.known.nrows()))
    }
}

/// `X_CT` and the corners seen of the views taken already; none of those that do not show enough of the board.
fn captured(problem: &Problem) -> impl Iterator<Item = Option<(Pose, Corners)>> {
    let corners: Vec<Point3<f64>> = problem.target.board.corners().collect();
    let markers = problem.target.board.markers();
    let least = problem.visibility.min_corners.unwrap_or(corners.len());
    problem.constraints.captured.iter().map(move |q| {
        let X_CT = problem.robot.camera_pose(q).inverse() * problem.target.X_BT;
        let is_seen = |corner: &Point3<f64>, margin: f64| {
            problem.camera.project(&(X_CT * corner)).is_some_and(|pixel| problem.camera.contains(&pixel, margin))
        };
        let is_cut = |i: usize| {
            let is_whole = |marker: &Marker| marker.outline.iter().all(|point| is_seen(point, MARKER_MARGIN));
            markers.iter().any(|marker| marker.corners.contains(&i) && !is_whole(marker))
        };
        let seen: Vec<usize> = (0..corners.len()).filter(|&i| is_seen(&corners[i], 0.0) && !is_cut(i)).collect();
        let faces_camera = (X_CT.rotation * Vector3::z()).dot(&X_CT.translation.vector) < 0.0;
        (faces_camera && seen.len() >= least).then_some((X_CT, Corners::Some(seen)))
    })
}

/// Information of the standard deviations stated: of the heights of a board that may bulge, in their deviations, and of the
/// intrinsics.
fn stated(problem: &Problem) -> DMatrix<f64> {
    let nuisance = problem.measurement().nuisance();
    let order = nuisance + problem.unknowns().len();
    let mut known = DMatrix::zeros(order, order);
    for height in 0..nuisance {
        known[(height, height)] = 1.0;
    }
    for &(j, sigma) in &problem.prior_sigma {
        known[(nuisance + j, nuisance + j)] += sigma.powi(-2);
    }
    known
}
