//! A plan checked from its own numbers.
//!
//! A short way of its own: full matrices, eigenvalues and a sort, none of the code that chose the poses and proved the bound.
//! It shares with that only what the numbers mean: the candidates' views and matrices, rebuilt from the problem file.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::choice::{Chooser, PlanError};
use super::document::{Plan, PlannedPose};
use super::objective::Checked;
use super::proof::{CertificateDocument, FewestDocument, Price};
use super::recall::RecallError;
use super::survey::Survey;
use crate::information::Criterion;
use crate::problem::Problem;
use crate::selection::{Cap, Constraints, Separation};

/// Numbers that are the same agree to this share: they are sums of the same terms in another order.
const SAME: f64 = 1e-7;

/// Why a plan does not hold.
#[derive(Debug, Error)]
pub enum CertifyError {
    /// A number is not what the plan says.
    #[error("{what} is {found} by the problem file, but the plan says {stated}")]
    Number {
        /// What it is.
        what: &'static str,
        /// What the plan says.
        stated: f64,
        /// What it is.
        found: f64,
    },
    /// The criterion is not what the certificate is for.
    #[error("the plan's criterion is \"{stated}\", but its certificate is for \"{found}\"")]
    Criterion {
        /// What the plan says.
        stated: String,
        /// What the certificate says.
        found: String,
    },
    /// The accuracies are not those that the problem file wishes for.
    #[error("the accuracies that the plan was made for are not those of the problem file")]
    Wishes,
    /// The poses miss the accuracies.
    #[error("the poses do not reach the accuracy: the least of (wished / reached)² is {value}")]
    Accuracy {
        /// The plan's value.
        value: f64,
    },
    /// The poses break a constraint.
    #[error("the poses break a constraint of the problem file")]
    Constraints,
    /// The matrix is no certificate.
    #[error("the certificate's matrix for `{criterion}` is not symmetric positive semidefinite of order {order}")]
    Matrix {
        /// Name of the criterion.
        criterion: String,
        /// The order it must have.
        order: usize,
    },
    /// A price or mixture is negative, or of no group or accuracy.
    #[error("the certificate's prices or mixture are negative or name what does not exist")]
    Prices,
    /// The refutation does not refute.
    #[error("the bound for {count} poses does not exclude that they reach the accuracy")]
    Refutation {
        /// The number of poses.
        count: usize,
    },
    /// The plan does not fit the problem's candidates.
    #[error(transparent)]
    Recall(#[from] RecallError),
    /// The problem has no plan any more.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// What was confirmed.
#[derive(Debug, Clone, PartialEq)]
pub struct Confirmed {
    /// Candidates that were scored.
    pub candidates: usize,
    /// The plan's value in the criterion's own unit.
    pub value: f64,
    /// The bound that its certificate proves.
    pub bound: f64,
    /// The efficiency that these two prove.
    pub efficiency: f64,
    /// Fewer poses than this are proven not to reach the accuracies, if some were wished for and a matrix alone proves it.
    pub least: Option<usize>,
}

/// Recomputes all that `plan` claims, from its poses' joint values and its certificate's matrices, on `problem`, surveyed.
/// What it was optimised for is taken from the plan, for the command line may have said otherwise than the file.
///
/// # Errors
/// When anything is not as the plan says.
pub fn certify(plan: &Plan, problem: &Problem, survey: &Survey) -> Result<Confirmed, CertifyError> {
    let (chooser, selected) = plan.recall(problem, survey)?;
    if plan.criterion != chooser.criterion() {
        return Err(CertifyError::Criterion { stated: plan.criterion.clone(), found: chooser.criterion() });
    }
    let terms: Vec<Checked> = chooser.objective().terms(problem, survey);
    number("the number of poses", plan.count as f64, selected.len() as f64)?;
    if !is_allowed(chooser.constraints(), &selected) {
        return Err(CertifyError::Constraints);
    }
    for (pose, &place) in plan.poses.iter().zip(&selected) {
        is_that_view(pose, &PlannedPose::new(problem, &survey.views[place], pose.share))?;
    }

    let value: f64 = terms.iter().map(|term| term.share * term.log_value(&selected)).sum();
    number("the value", plan.value, chooser.natural(value))?;
    for (pose, share) in plan.poses.iter().zip(chooser.shares(&selected)?) {
        number("a pose's share", pose.share, share)?;
    }
    predictions(plan, problem, survey, &chooser.information(&selected))?;
    let bound = log_bound(&plan.certificate, &terms, &chooser, selected.len())?;
    number("the certificate's bound", plan.certificate.bound, chooser.natural(bound))?;
    let efficiency = (value - bound).exp();
    match &plan.search {
        None => number("the bound", plan.bound, chooser.natural(bound))?,
        Some(search) => {
            // Between the two lies what a search may claim; the most it may claim is that they are one.
            let claimed = chooser.log_of(plan.bound);
            if !(claimed >= value - SAME && claimed <= bound + SAME) {
                return Err(CertifyError::Number {
                    what: "the bound",
                    stated: plan.bound,
                    found: chooser.natural(bound),
                });
            }
            if search.end == "optimal" {
                number("the bound of a proven optimum", plan.bound, chooser.natural(value))?;
            }
        }
    }
    number("the efficiency", plan.efficiency, (value - chooser.log_of(plan.bound)).exp())?;
    number("the number of candidates", plan.candidates.kept as f64, survey.views.len() as f64)?;

    let least = match &plan.fewest {
        Some(fewest) => proven_least(fewest, value, &terms, &chooser, &selected)?,
        None => None,
    };
    let (value, bound) = (chooser.natural(value), chooser.natural(bound));
    Ok(Confirmed { candidates: survey.views.len(), value, bound, efficiency, least })
}

/// Checks that the poses reach the accuracies that the problem wishes for and that fewer are proven not to; the least number
/// that may, where a matrix alone proves it.
fn proven_least(
    fewest: &FewestDocument,
    log_value: f64,
    terms: &[Checked],
    chooser: &Chooser,
    selected: &[usize],
) -> Result<Option<usize>, CertifyError> {
    let reached = chooser.reached(&chooser.assess(selected.to_vec()));
    if reached.len() != fewest.accuracies.len() {
        return Err(CertifyError::Wishes);
    }
    for (stated, found) in fewest.accuracies.iter().zip(&reached) {
        if stated.name != found.name || stated.wished != found.wished {
            return Err(CertifyError::Wishes);
        }
        number("an accuracy reached", stated.reached, found.reached)?;
    }
    if log_value < -SAME {
        return Err(CertifyError::Accuracy { value: chooser.natural(log_value) });
    }
    let count = fewest.least.saturating_sub(1);
    let Some(refutation) = &fewest.refutation else {
        // Without a proof only those are out that cannot be chosen.
        let can_be_chosen = count >= chooser.constraints().required.len().max(1);
        return if can_be_chosen { Err(CertifyError::Refutation { count }) } else { Ok(None) };
    };
    let bound = log_bound(refutation, terms, chooser, count)?;
    number("the refutation's bound", refutation.bound, chooser.natural(bound))?;
    if bound >= 0.0 && fewest.nodes == 0 {
        return Err(CertifyError::Refutation { count });
    }
    Ok((bound < 0.0).then_some(fewest.least))
}

fn number(what: &'static str, stated: f64, found: f64) -> Result<(), CertifyError> {
    let same = (stated - found).abs() <= SAME * stated.abs().max(found.abs()).max(f64::MIN_POSITIVE);
    if same { Ok(()) } else { Err(CertifyError::Number { what, stated, found }) }
}

/// What the plan says of a pose for people, held against what its view says.
fn is_that_view(stated: &PlannedPose, found: &PlannedPose) -> Result<(), CertifyError> {
    number("the number of a pose's joints", stated.joints_deg.len() as f64, found.joints_deg.len() as f64)?;
    let numbers = |pose: &PlannedPose| {
        let joints = pose.joints_deg.clone();
        joints.into_iter().chain([pose.tilt_deg, pose.distance_m]).collect::<Vec<_>>()
    };
    for (stated, found) in numbers(stated).into_iter().zip(numbers(found)) {
        if (stated - found).abs() > 1e-9 {
            return Err(CertifyError::Number { what: "a pose's number", stated, found });
        }
    }
    Ok(())
}

fn is_allowed(constraints: &Constraints, selected: &[usize]) -> bool {
    let Constraints { required, forbidden, caps, separations: _ } = constraints;
    required.iter().all(|i| selected.contains(i))
        && !forbidden.iter().any(|i| selected.contains(i))
        && caps.iter().all(|cap| selected.iter().filter(|i| cap.members.contains(i)).count() <= cap.most)
        && pairs(selected).all(|(i, j)| !are_too_close(constraints, i, j))
}

fn pairs(members: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    members.iter().enumerate().flat_map(|(a, &i)| members[a + 1..].iter().map(move |&j| (i, j)))
}

fn are_too_close(constraints: &Constraints, i: usize, j: usize) -> bool {
    constraints.separations.iter().any(|Separation { points, least }| {
        let squares = points[i].iter().zip(&points[j]).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt() < *least
    })
}

/// The predicted standard deviations and map error.
fn predictions(plan: &Plan, problem: &Problem, survey: &Survey, M: &DMatrix<f64>) -> Result<(), CertifyError> {
    let covariance = inverse(M);
    number("the map error", plan.map_error_px, (&survey.map_weight * &covariance).trace().sqrt())?;
    for (j, &stated) in plan.intrinsics.sigma.iter().enumerate().take(problem.estimated.len()) {
        number("a predicted sigma", stated, covariance[(j, j)].sqrt())?;
    }
    number("the number of sigmas", plan.intrinsics.sigma.len() as f64, problem.estimated.len() as f64)
}

impl Checked<'_> {
    /// log Φ of some views.
    fn log_value(&self, selected: &[usize]) -> f64 {
        let M = selected.iter().fold(self.prior.clone(), |M, &i| M + self.candidates.matrix(i));
        match self.criterion {
            Some(Criterion::D | Criterion::Diversity) => log_det(&M) / M.nrows() as f64,
            Some(Criterion::E | Criterion::Zhang) => M.symmetric_eigenvalues().min().ln(),
            // The variance, or the worst of the accuracies'.
            _ => -self.weights.iter().map(|W| (W * inverse(&M)).trace()).fold(0.0, f64::max).ln(),
        }
    }

    /// log Φ° of Y.
    fn log_polar(&self, Y: &DMatrix<f64>, mixture: &[f64]) -> f64 {
        let p = Y.nrows() as f64;
        match self.criterion {
            Some(Criterion::D | Criterion::Diversity) => p.ln() + log_det(Y) / p,
            Some(Criterion::E | Criterion::Zhang) => Y.trace().ln(),
            _ => {
                let sum: f64 = mixture.iter().sum();
                let mixed = if self.criterion.is_some() {
                    self.weights[0].clone()
                } else {
                    let mixed = self.weights.iter().zip(mixture).map(|(W, λ)| W * (λ / sum));
                    mixed.fold(DMatrix::zeros(Y.nrows(), Y.nrows()), |sum, W| sum + W)
                };
                // tr (LᵀYL)^½ for W = L Lᵀ: with Y = R Rᵀ the eigenvalues of LᵀYL are those of RᵀWR.
                let root = square_root(Y);
                let eigenvalues = (root.transpose() * mixed * root).symmetric_eigenvalues();
                2.0 * eigenvalues.iter().map(|λ| λ.max(0.0).sqrt()).sum::<f64>().ln()
            }
        }
    }
}

/// The logarithm of `S / Φ°(Y)`: no allowed `count` of the candidates have a greater log Φ.
fn log_bound(
    certificate: &CertificateDocument,
    terms: &[Checked],
    chooser: &Chooser,
    count: usize,
) -> Result<f64, CertifyError> {
    let accuracies: usize =
        terms.iter().map(|term| if term.criterion.is_none() { term.weights.len() } else { 0 }).sum();
    let caps = chooser.instance(count)?.caps().to_vec();
    let priced = |price: &Price| price.price >= 0.0 && price.group < caps.len();
    let mixed = certificate.mixture.iter().all(|&λ| λ >= 0.0) && certificate.mixture.len() == accuracies;
    if certificate.terms.len() != terms.len() || !mixed || !certificate.prices.iter().all(priced) {
        return Err(CertifyError::Prices);
    }
    let constraints = chooser.constraints();
    let mut scores = vec![0.0; terms[0].candidates.len()];
    let (mut known, mut log_polar) = (0.0, 0.0);
    for (stated, term) in certificate.terms.iter().zip(terms) {
        let Y = matrix(&stated.matrix, term.candidates.order()).ok_or_else(|| CertifyError::Matrix {
            criterion: stated.criterion.clone(),
            order: term.candidates.order(),
        })?;
        for (i, score) in scores.iter_mut().enumerate() {
            *score += term.candidates.matrix(i).dot(&Y);
        }
        known += term.prior.dot(&Y);
        log_polar += term.share * (term.log_polar(&Y, &certificate.mixture) - term.share.ln());
    }
    for &Price { group, price } in &certificate.prices {
        // Beside the groups of the file, only candidates that exclude each other may be priced as one.
        let Cap { members, most } = &caps[group];
        let is_cell = || *most == 1 && pairs(members).all(|(i, j)| are_too_close(constraints, i, j));
        if group >= constraints.caps.len() && !is_cell() {
            return Err(CertifyError::Prices);
        }
        for &i in members {
            scores[i] -= price;
        }
        known += price * *most as f64;
    }
    let mut S = known + constraints.required.iter().map(|&i| scores[i]).sum::<f64>();
    let is_free = |i: &usize| !constraints.required.contains(i) && !constraints.forbidden.contains(i);
    let mut free: Vec<f64> = (0..scores.len()).filter(is_free).map(|i| scores[i]).collect();
    free.sort_unstable_by(|a, b| b.total_cmp(a));
    S += free.iter().take(count - constraints.required.len()).sum::<f64>();
    Ok(S.ln() - log_polar)
}

/// The symmetric positive semidefinite matrix of its rows.
fn matrix(rows: &[Vec<f64>], p: usize) -> Option<DMatrix<f64>> {
    if rows.len() != p || rows.iter().any(|row| row.len() != p || row.iter().any(|entry| !entry.is_finite())) {
        return None;
    }
    let Y = DMatrix::from_fn(p, p, |i, j| rows[i][j]);
    let scaled = scaled(&Y).0;
    (Y == Y.transpose() && scaled.symmetric_eigenvalues().min() >= -1e-9).then_some(Y)
}

/// M in units that make its diagonal 1, and the units: parameters in unlike units lose their small eigenvalues otherwise.
fn scaled(M: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let units = M.diagonal().map(|m| if m > 0.0 { m.sqrt() } else { 1.0 });
    (DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] / (units[i] * units[j])), units)
}

fn log_det(M: &DMatrix<f64>) -> f64 {
    let (scaled, units) = scaled(M);
    scaled.symmetric_eigenvalues().map(f64::ln).sum() + 2.0 * units.map(f64::ln).sum()
}

fn inverse(M: &DMatrix<f64>) -> DMatrix<f64> {
    let (scaled, units) = scaled(M);
    let eigen = scaled.symmetric_eigen();
    let inverted = DMatrix::from_diagonal(&eigen.eigenvalues.map(f64::recip));
    let inverse = &eigen.eigenvectors * inverted * eigen.eigenvectors.transpose();
    DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| inverse[(i, j)] / (units[i] * units[j]))
}

/// A root R with `R Rᵀ = Y`, in Y's units.
fn square_root(Y: &DMatrix<f64>) -> DMatrix<f64> {
    let (scaled, units) = scaled(Y);
    let eigen = scaled.symmetric_eigen();
    let root = &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|λ| λ.max(0.0).sqrt()));
    DMatrix::from_diagonal(&units) * root
}
