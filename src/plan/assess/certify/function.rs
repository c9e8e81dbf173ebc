//! Information functions and the matrices that they are of: full, symmetric, by their eigenvalues.

use nalgebra::{DMatrix, DVector};

use super::error::CertifyError;

/// Rounding moves a sum of matrices of order p, scaled to a unit diagonal, by no more than p times this.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Φ, as in the table of [`evidence`](super::evidence).
pub(super) enum Function {
    Determinant,
    LeastEigenvalue,
    Variance(DMatrix<f64>),
    WorstVariance(Vec<DMatrix<f64>>),
    /// Φ of what is left on the parameters but the first, which are estimated beside them: of the Schur complement.
    Beside(usize, Box<Function>),
}

impl Function {
    /// Number of variances that are mixed.
    pub(super) fn mixed(&self) -> usize {
        match self {
            Self::Determinant | Self::LeastEigenvalue | Self::Variance(_) => 0,
            Self::WorstVariance(weights) => weights.len(),
            Self::Beside(_, of) => of.mixed(),
        }
    }

    /// The same beside the first `nuisance` parameters.
    pub(super) fn beside(self, nuisance: usize) -> Self {
        if nuisance == 0 { self } else { Self::Beside(nuisance, Box::new(self)) }
    }

    /// What it is of the parameters that it asks for, and how many there are of all `order`.
    pub(super) fn asked(&self, order: usize) -> (&Self, usize) {
        match self {
            Self::Beside(nuisance, of) => of.asked(order - nuisance),
            own => (own, order),
        }
    }

    /// log Φ(M).
    pub(super) fn log_value(&self, M: &DMatrix<f64>) -> f64 {
        match self {
            Self::Determinant => log_det(M) / M.nrows() as f64,
            Self::LeastEigenvalue => M.symmetric_eigenvalues().min().ln(),
            Self::Variance(W) => -(W * inverse(M)).trace().ln(),
            Self::WorstVariance(weights) => -worst(weights, &inverse(M)).1.ln(),
            Self::Beside(nuisance, of) => of.log_value(&left(M, *nuisance).0),
        }
    }

    /// How far rounding may move log Φ(M). Where it moves M by no more than a share ρ, `(1 − ρ) M ⪯ M' ⪯ (1 + ρ) M`, it moves
    /// every Φ by no more than that, for Φ is monotone and homogeneous, and so are Schur complements.
    pub(super) fn uncertainty(&self, M: &DMatrix<f64>) -> f64 {
        match self {
            Self::LeastEigenvalue => uncertainty(&(M / M.diagonal().max())),
            Self::Determinant | Self::Variance(_) | Self::WorstVariance(_) => uncertainty(&scaled(M).0),
            Self::Beside(_, of) => of.uncertainty(M),
        }
    }

    /// The gradient of log Φ at M; of a least number the first's.
    pub(super) fn gradient(&self, M: &DMatrix<f64>) -> DMatrix<f64> {
        let of_variance = |W: &DMatrix<f64>| {
            let covariance = inverse(M);
            &covariance * W * &covariance / (W * &covariance).trace()
        };
        match self {
            Self::Determinant => inverse(M) / M.nrows() as f64,
            Self::LeastEigenvalue => {
                let eigen = M.clone().symmetric_eigen();
                let least = eigen.eigenvalues.imin();
                let v = eigen.eigenvectors.column(least);
                v * v.transpose() / eigen.eigenvalues[least]
            }
            Self::Variance(W) => of_variance(W),
            Self::WorstVariance(weights) => of_variance(&weights[worst(weights, &inverse(M)).0]),
            Self::Beside(nuisance, of) => {
                let (S, K) = left(M, *nuisance);
                K.transpose() * of.gradient(&S) * K
            }
        }
    }

    /// log Φ°(Y) with the eigenvalues of Y, scaled, moved by `shift`; Φ° is monotone.
    pub(super) fn log_polar(&self, Y: &DMatrix<f64>, mixture: &[f64], shift: f64) -> f64 {
        match self {
            Self::Determinant => {
                let p = Y.nrows() as f64;
                let (scaled, units) = scaled(Y);
                let eigenvalues = scaled.symmetric_eigenvalues().map(|λ| (λ + shift).max(0.0).ln());
                p.ln() + (eigenvalues.sum() + 2.0 * units.map(f64::ln).sum()) / p
            }
            Self::LeastEigenvalue => Y.trace().ln(),
            Self::Variance(W) => log_polar_of_variance(W, Y, shift),
            Self::WorstVariance(weights) => {
                let mixed = weights.iter().zip(mixture).map(|(W, λ)| W * *λ);
                log_polar_of_variance(&mixed.fold(Y * 0.0, |sum, W| sum + W), Y, shift)
            }
            Self::Beside(nuisance, of) => of.log_polar(&last(Y, *nuisance), mixture, shift),
        }
    }
}

/// The block of the parameters but the first `nuisance`.
pub(super) fn last(M: &DMatrix<f64>, nuisance: usize) -> DMatrix<f64> {
    let p = M.nrows() - nuisance;
    M.view((nuisance, nuisance), (p, p)).into_owned()
}

/// The Schur complement of the first `nuisance` parameters of M, the inverse of [`last`] of M⁻¹, and the K with which it is
/// `K M Kᵀ`.
fn left(M: &DMatrix<f64>, nuisance: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let S = inverse(&last(&inverse(M), nuisance));
    let (p, s) = (S.nrows(), nuisance);
    let across = -M.view((s, 0), (p, s)) * inverse(&M.view((0, 0), (s, s)).into_owned());
    let K = DMatrix::from_fn(p, s + p, |i, j| if j < s { across[(i, j)] } else { f64::from(u8::from(i + s == j)) });
    (S, K)
}

/// The greatest of `tr(W_j M⁻¹)`, and which it is.
fn worst(weights: &[DMatrix<f64>], covariance: &DMatrix<f64>) -> (usize, f64) {
    let variances = weights.iter().map(|W| (W * covariance).trace()).enumerate();
    variances.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN))
}

/// `2 log tr (LᵀYL)^½` for W = L Lᵀ. The trace is the sum of the singular values of `RᵀL` for `Y = R Rᵀ`; the solver works with
/// their squares, and so has the rounding of these.
fn log_polar_of_variance(W: &DMatrix<f64>, Y: &DMatrix<f64>, shift: f64) -> f64 {
    let (L, R) = (square_root(W, 0.0), square_root(Y, shift));
    let roots = (R.transpose() * L).singular_values();
    let moved = |σ: f64| (σ * σ + shift * roots.max().powi(2)).max(0.0).sqrt();
    2.0 * roots.map(moved).sum().ln()
}

/// The symmetric matrix of its lower triangle, row by row, as a view's information is given.
pub(super) fn matrix(packed: Option<Vec<f64>>, p: usize) -> Result<DMatrix<f64>, CertifyError> {
    let packed = packed.ok_or(CertifyError::Undetermined)?;
    let entry = |i: usize, j: usize| packed[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    Ok(DMatrix::from_fn(p, p, entry))
}

/// D M D, D = diag(units).
pub(super) fn in_units(M: &DMatrix<f64>, units: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] * (units[i] * units[j]))
}

/// The symmetric positive semidefinite matrix of its rows.
pub(super) fn semidefinite(rows: &[Vec<f64>], p: usize) -> Option<DMatrix<f64>> {
    if rows.len() != p || rows.iter().any(|row| row.len() != p || row.iter().any(|entry| !entry.is_finite())) {
        return None;
    }
    let Y = DMatrix::from_fn(p, p, |i, j| rows[i][j]);
    let scaled = scaled(&Y).0;
    (Y == Y.transpose() && scaled.symmetric_eigenvalues().min() >= -1e-9).then_some(Y)
}

/// M in units that make its diagonal 1, and the units: parameters in unlike units lose their small eigenvalues otherwise.
pub(super) fn scaled(M: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let units = M.diagonal().map(|m| if m > 0.0 { m.sqrt() } else { 1.0 });
    (DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] / (units[i] * units[j])), units)
}

/// How far rounding may move a matrix with a diagonal of at most 1, as a share of it; infinite if it is singular.
pub(super) fn uncertainty(scaled: &DMatrix<f64>) -> f64 {
    let share = ROUNDING * scaled.nrows() as f64 / scaled.symmetric_eigenvalues().min();
    if share > 0.0 { share } else { f64::INFINITY }
}

fn log_det(M: &DMatrix<f64>) -> f64 {
    let (scaled, units) = scaled(M);
    scaled.symmetric_eigenvalues().map(f64::ln).sum() + 2.0 * units.map(f64::ln).sum()
}

pub(super) fn inverse(M: &DMatrix<f64>) -> DMatrix<f64> {
    let (scaled, units) = scaled(M);
    let eigen = scaled.symmetric_eigen();
    let inverted = DMatrix::from_diagonal(&eigen.eigenvalues.map(f64::recip));
    let inverse = &eigen.eigenvectors * inverted * eigen.eigenvectors.transpose();
    DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| inverse[(i, j)] / (units[i] * units[j]))
}

/// A root R with `R Rᵀ = Y`, in Y's units, the eigenvalues moved by `shift`.
fn square_root(Y: &DMatrix<f64>, shift: f64) -> DMatrix<f64> {
    let (scaled, units) = scaled(Y);
    let eigen = scaled.symmetric_eigen();
    let roots = eigen.eigenvalues.map(|λ| (λ + shift).max(0.0).sqrt());
    DMatrix::from_diagonal(&units) * &eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}
