//! Values and bounds by their definitions: full matrices, eigenvalues and a sort, none of the code that chose the poses and
//! proved the bound.

use nalgebra::{DMatrix, DVector};

use super::error::CertifyError;
use crate::information::Criterion;
use crate::plan::choose::{ACCURACY, TermDefinition};
use crate::plan::document::{CertificateDocument, CertificateTerm, Price};
use crate::selection::{Cap, Constraints, Separation};

/// A logarithm and how far rounding, here and where the plan was made, may have moved it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounded {
    pub(crate) log: f64,
    pub(crate) uncertainty: f64,
}

/// Rounding moves a sum of matrices of order p, scaled to a unit diagonal, by no more than p times this.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// log Φ of some views, all terms together.
pub(crate) fn log_value(terms: &[TermDefinition], selected: &[usize]) -> Rounded {
    let mut value = Rounded { log: 0.0, uncertainty: 0.0 };
    for term in terms {
        let M = term.total(selected);
        value.log += term.share * term.log_value(&M);
        value.uncertainty += term.share * term.uncertainty(&M);
    }
    value
}

/// Each view's share of the information, `⟨∇log Φ(M), M_i⟩`.
pub(crate) fn shares(terms: &[TermDefinition], selected: &[usize]) -> Vec<f64> {
    let mut shares = vec![0.0; selected.len()];
    for term in terms {
        let Y = term.gradient(&term.total(selected)) * term.share;
        for (share, &i) in shares.iter_mut().zip(selected) {
            *share += term.candidates.matrix(i).dot(&Y);
        }
    }
    shares
}

/// log Φ in the unit in which plans state it.
pub(crate) fn natural(terms: &[TermDefinition], log: f64) -> f64 {
    match terms {
        [term] => match term.criterion {
            Some(Criterion::D | Criterion::Diversity) => log * term.prior.nrows() as f64,
            Some(Criterion::A | Criterion::V) => (-log).exp(),
            Some(Criterion::E | Criterion::Zhang) | None => log.exp(),
        },
        _ => log.exp(),
    }
}

/// log Φ of what a plan states.
pub(crate) fn log_of(terms: &[TermDefinition], natural: f64) -> f64 {
    match terms {
        [term] => match term.criterion {
            Some(Criterion::D | Criterion::Diversity) => natural / term.prior.nrows() as f64,
            Some(Criterion::A | Criterion::V) => -natural.ln(),
            Some(Criterion::E | Criterion::Zhang) | None => natural.ln(),
        },
        _ => natural.ln(),
    }
}

impl TermDefinition<'_> {
    fn total(&self, selected: &[usize]) -> DMatrix<f64> {
        selected.iter().fold(self.prior.clone(), |M, &i| M + self.candidates.matrix(i))
    }

    /// log Φ(M).
    fn log_value(&self, M: &DMatrix<f64>) -> f64 {
        match self.criterion {
            Some(Criterion::D | Criterion::Diversity) => log_det(M) / M.nrows() as f64,
            Some(Criterion::E | Criterion::Zhang) => M.symmetric_eigenvalues().min().ln(),
            // The variance, or the worst of the accuracies'.
            _ => -self.weights.iter().map(|W| (W * inverse(M)).trace()).fold(0.0, f64::max).ln(),
        }
    }

    /// How far rounding may move log Φ(M). Where it moves M by no more than a share ρ, `(1 − ρ) M ⪯ M' ⪯ (1 + ρ) M`, it moves
    /// every Φ by no more than that, for Φ is monotone and homogeneous.
    fn uncertainty(&self, M: &DMatrix<f64>) -> f64 {
        match self.criterion {
            Some(Criterion::E | Criterion::Zhang) => uncertainty(&(M / M.diagonal().max()), M.nrows()),
            _ => uncertainty(&scaled(M).0, M.nrows()),
        }
    }

    /// The gradient of log Φ at M; of a least number the first's.
    fn gradient(&self, M: &DMatrix<f64>) -> DMatrix<f64> {
        match self.criterion {
            Some(Criterion::D | Criterion::Diversity) => inverse(M) / M.nrows() as f64,
            Some(Criterion::E | Criterion::Zhang) => {
                let eigen = M.clone().symmetric_eigen();
                let least = eigen.eigenvalues.imin();
                let v = eigen.eigenvectors.column(least);
                v * v.transpose() / eigen.eigenvalues[least]
            }
            _ => {
                let covariance = inverse(M);
                let variance = |W: &&DMatrix<f64>| (*W * &covariance).trace();
                let worst = self.weights.iter().max_by(|a, b| variance(a).total_cmp(&variance(b)));
                worst.map_or_else(|| M * f64::NAN, |W| &covariance * W * &covariance / variance(&W))
            }
        }
    }

    /// log Φ° of Y with its eigenvalues, scaled, moved by `shift`; Φ° is monotone.
    fn log_polar(&self, Y: &DMatrix<f64>, mixture: &[f64], shift: f64) -> f64 {
        let p = Y.nrows() as f64;
        match self.criterion {
            Some(Criterion::D | Criterion::Diversity) => {
                let (scaled, units) = scaled(Y);
                let eigenvalues = scaled.symmetric_eigenvalues().map(|λ| (λ + shift).max(0.0).ln());
                p.ln() + (eigenvalues.sum() + 2.0 * units.map(f64::ln).sum()) / p
            }
            Some(Criterion::E | Criterion::Zhang) => Y.trace().ln(),
            _ => {
                let weight = if self.criterion.is_some() {
                    self.weights[0].clone()
                } else {
                    let mixed = self.weights.iter().zip(mixture).map(|(W, λ)| W * *λ);
                    mixed.fold(Y * 0.0, |sum, W| sum + W)
                };
                // tr (LᵀYL)^½ for W = L Lᵀ is the sum of the singular values of RᵀL for Y = R Rᵀ; the solver works with their
                // squares, and so has the rounding of these.
                let (L, R) = (square_root(&weight, 0.0), square_root(Y, shift));
                let roots = (R.transpose() * L).singular_values();
                let moved = |σ: f64| (σ * σ + shift * roots.max().powi(2)).max(0.0).sqrt();
                2.0 * roots.map(moved).sum().ln()
            }
        }
    }
}

/// The logarithm of `S / Φ°(Y)`: no allowed `count` of the candidates have a greater log Φ. `caps` are the groups that prices
/// may name: first those of the constraints, then others, which are checked.
pub(crate) fn log_bound(
    certificate: &CertificateDocument,
    terms: &[TermDefinition],
    constraints: &Constraints,
    caps: &[Cap],
    count: usize,
) -> Result<Rounded, CertifyError> {
    // The bound is what is computed here; whether it is the one stated the caller asks.
    let CertificateDocument { bound: _, terms: stated, mixture, prices } = certificate;
    let accuracies: usize =
        terms.iter().map(|term| if term.criterion.is_none() { term.weights.len() } else { 0 }).sum();
    let priced = |&Price { group, price }: &Price| price >= 0.0 && group < caps.len();
    let in_all = if accuracies == 0 { 0.0 } else { 1.0 };
    let mixed = mixture.len() == accuracies
        && mixture.iter().all(|&λ| λ >= 0.0)
        && (mixture.iter().sum::<f64>() - in_all).abs() < 1e-9;
    if stated.len() != terms.len() || !mixed || !prices.iter().all(priced) {
        return Err(CertifyError::Prices);
    }
    let mut scores = vec![0.0; terms[0].candidates.len()];
    // Sums of the products' sizes, for rounding.
    let mut sizes = scores.clone();
    let (mut known, mut entries) = (0.0, 0);
    let (mut least_polar, mut greatest_polar) = (0.0, 0.0);
    for (CertificateTerm { criterion, share, matrix }, term) in stated.iter().zip(terms) {
        let name = term.criterion.map_or(ACCURACY, Criterion::name);
        if criterion != name {
            return Err(CertifyError::Criterion { stated: name.into(), found: criterion.clone() });
        }
        if *share != term.share {
            return Err(CertifyError::Number { what: "a share".into(), stated: *share, found: term.share });
        }
        let p = term.candidates.order();
        let Y =
            semidefinite(matrix, p).ok_or_else(|| CertifyError::Matrix { criterion: criterion.clone(), order: p })?;
        let size = Y.abs();
        for (i, (score, total)) in scores.iter_mut().zip(&mut sizes).enumerate() {
            let M = term.candidates.matrix(i);
            *score += M.dot(&Y);
            *total += M.abs().dot(&size);
        }
        known += term.prior.dot(&Y);
        entries += p * p;
        let shift = ROUNDING * p as f64;
        // Of the values that rounding leaves open the least, so that the bound holds.
        least_polar += term.share * (term.log_polar(&Y, mixture, -shift) - term.share.ln());
        greatest_polar += term.share * (term.log_polar(&Y, mixture, shift) - term.share.ln());
    }
    for &Price { group, price } in prices {
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
    let is_free = |i: &usize| !constraints.required.contains(i) && !constraints.forbidden.contains(i);
    let mut free: Vec<usize> = (0..scores.len()).filter(is_free).collect();
    free.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]));
    free.truncate(count - constraints.required.len());
    let counted = || constraints.required.iter().chain(&free);
    let S = known + counted().map(|&i| scores[i]).sum::<f64>();
    let rounding = entries as f64 * f64::EPSILON * counted().map(|&i| sizes[i]).sum::<f64>();
    let log = (S + rounding).ln() - least_polar;
    Ok(Rounded { log, uncertainty: 2.0 * rounding / S + greatest_polar - least_polar })
}

pub(crate) fn pairs(members: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    members.iter().enumerate().flat_map(|(a, &i)| members[a + 1..].iter().map(move |&j| (i, j)))
}

pub(crate) fn are_too_close(constraints: &Constraints, i: usize, j: usize) -> bool {
    constraints.separations.iter().any(|Separation { points, least }| {
        let squares = points[i].iter().zip(&points[j]).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt() < *least
    })
}

/// The symmetric positive semidefinite matrix of its rows.
fn semidefinite(rows: &[Vec<f64>], p: usize) -> Option<DMatrix<f64>> {
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

/// How far rounding may move a matrix with a diagonal of at most 1, as a share of it; infinite if it is singular.
fn uncertainty(scaled: &DMatrix<f64>, p: usize) -> f64 {
    let share = ROUNDING * p as f64 / scaled.symmetric_eigenvalues().min();
    if share > 0.0 { share } else { f64::INFINITY }
}

fn log_det(M: &DMatrix<f64>) -> f64 {
    let (scaled, units) = scaled(M);
    scaled.symmetric_eigenvalues().map(f64::ln).sum() + 2.0 * units.map(f64::ln).sum()
}

pub(crate) fn inverse(M: &DMatrix<f64>) -> DMatrix<f64> {
    let (scaled, units) = scaled(M);
    let eigen = scaled.symmetric_eigen();
    let inverted = DMatrix::from_diagonal(&eigen.eigenvalues.map(f64::recip));
    let inverse = &eigen.eigenvectors * inverted * eigen.eigenvectors.transpose();
    DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| inverse[(i, j)] / (units[i] * units[j]))
}

/// How far rounding may move M, as a share of it.
pub(crate) fn uncertainty_of(M: &DMatrix<f64>) -> f64 {
    uncertainty(&scaled(M).0, M.nrows())
}

/// A root R with `R Rᵀ = Y`, in Y's units, the eigenvalues moved by `shift`.
fn square_root(Y: &DMatrix<f64>, shift: f64) -> DMatrix<f64> {
    let (scaled, units) = scaled(Y);
    let eigen = scaled.symmetric_eigen();
    let roots = eigen.eigenvalues.map(|λ| (λ + shift).max(0.0).sqrt());
    DMatrix::from_diagonal(&units) * &eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}
