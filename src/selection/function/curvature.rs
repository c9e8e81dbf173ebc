//! The second derivative of log Φ.

use nalgebra::{DMatrix, DVector};

use super::soft_minimum::SoftMinimum;
use crate::selection::packed::{pack, packed_len, solve_lower, unpack, whiten};

/// The negative second derivative of log Φ at a point, as the square of a linear map: `−D²log Φ[Δ, Δ] = ‖map(Δ)‖²`.
#[derive(Debug, Clone)]
pub(crate) enum Curvature {
    /// Diagonal off the diagonal of Δ, in suitable coordinates.
    Split {
        /// Packed Cholesky factor of the matrix that becomes the identity; none to leave Δ as it is.
        whitener: Option<Vec<f64>>,
        /// Rotation U of the coordinates after that: `Uᵀ Δ U`.
        rotation: Option<DMatrix<f64>>,
        /// Weights of the entries off the diagonal, row by row.
        off_diagonal: Vec<f64>,
        /// p×p map of the diagonal entries.
        diagonal: DMatrix<f64>,
    },
    /// Any linear map of packed Δ.
    Dense(DMatrix<f64>),
}

impl Curvature {
    /// `‖M^(−½) Δ M^(−½)‖² / p` with the packed Cholesky factor of M.
    pub(crate) fn of_determinant(l: Vec<f64>, p: usize) -> Self {
        let λ = DVector::from_element(p, 1.0 / p as f64);
        let diagonal = DMatrix::from_diagonal(&λ.map(f64::sqrt));
        Curvature::Split { whitener: Some(l), rotation: None, off_diagonal: pairs(&λ), diagonal }
    }

    /// In coordinates that whiten M and diagonalise W, with Σ λ = 1: `2 Σᵢⱼ λᵢ Δᵢⱼ² − (Σᵢ λᵢ Δᵢᵢ)²`.
    pub(crate) fn of_variance(l: Vec<f64>, factor: &DMatrix<f64>) -> Self {
        let X = whitened(&l, factor);
        let eigen = (&X * X.transpose() / X.norm_squared()).symmetric_eigen();
        let λ = eigen.eigenvalues.map(|λ| λ.max(0.0));
        // On the diagonal, with z = √λ Δ and the unit vector √λ: 2‖z‖² − ⟨√λ, z⟩².
        let root = λ.map(f64::sqrt);
        let mut diagonal =
            DMatrix::identity(λ.len(), λ.len()) * 2f64.sqrt() - (2f64.sqrt() - 1.0) * &root * root.transpose();
        for (mut column, root) in diagonal.column_iter_mut().zip(&root) {
            column *= *root;
        }
        Curvature::Split {
            whitener: Some(l),
            rotation: Some(eigen.eigenvectors),
            off_diagonal: pairs(&(&λ * 2.0)),
            diagonal,
        }
    }

    /// Of the soft minimum of the eigenvalues, whose eigenvectors are the columns of U: that of the soft minimum on the
    /// diagonal, `2 (ε/p) / ((λᵢ − t)(λⱼ − t))` off it.
    pub(crate) fn of_min_eigenvalue(U: DMatrix<f64>, soft: &SoftMinimum) -> Self {
        let p = U.nrows();
        let pair = |(i, j): (usize, usize)| (2.0 * soft.slopes[i] / soft.gaps[j]).sqrt();
        let off_diagonal = (0..p).flat_map(|i| (0..i).map(move |j| (i, j))).map(pair).collect();
        let mut diagonal = DMatrix::identity(p, p);
        for column in diagonal.as_mut_slice().chunks_exact_mut(p) {
            soft.second_derivative(column);
        }
        Curvature::Split { whitener: None, rotation: Some(U), off_diagonal, diagonal }
    }

    /// Of the soft minimum of `Φ_j = 1 / ‖X_j‖²`, `X_j = L⁻¹ L_j`: that of the soft minimum in `Φ_j`, and for each j
    /// `−D²Φ_j = 2 Φ_j² (‖Δ X_j‖² − Φ_j ⟨X_j, Δ X_j⟩²)` in coordinates that whiten M, which is the square of `ΔX_j` less
    /// its part along `X_j`.
    pub(crate) fn of_worst_variance(l: &[f64], factors: &[DMatrix<f64>], values: &[f64], soft: &SoftMinimum) -> Self {
        let p = factors.first().map_or(0, DMatrix::nrows);
        let white: Vec<_> = factors.iter().map(|factor| whitened(l, factor)).collect();
        let rows: usize = factors.len() + white.iter().map(DMatrix::len).sum::<usize>();
        let mut map = DMatrix::zeros(rows, packed_len(p));
        for (e, mut image) in map.column_iter_mut().enumerate() {
            let mut Δ = vec![0.0; packed_len(p)];
            Δ[e] = 1.0;
            whiten(l, p, &mut Δ);
            let Δ = unpack(&Δ, p);
            let mut changes = Vec::with_capacity(factors.len());
            let mut row = factors.len();
            for ((X, &Φ), slope) in white.iter().zip(values).zip(&soft.slopes) {
                let ΔX = &Δ * X;
                let along = ΔX.dot(X);
                changes.push(Φ * Φ * along);
                let across = (ΔX - X * (Φ * along)) * (2.0 * slope).sqrt() * Φ;
                image.rows_mut(row, across.len()).copy_from_slice(across.as_slice());
                row += across.len();
            }
            soft.second_derivative(&mut changes);
            image.rows_mut(0, changes.len()).copy_from_slice(&changes);
        }
        // As many rows as Δ has entries say the same.
        Curvature::Dense(if map.nrows() > map.ncols() { map.qr().r() } else { map })
    }

    /// The image of packed Δ.
    pub(crate) fn map(&self, Δ: &[f64]) -> Vec<f64> {
        match self {
            Curvature::Dense(map) => (map * DVector::from_column_slice(Δ)).as_slice().to_vec(),
            Curvature::Split { whitener, rotation, off_diagonal, diagonal } => {
                let p = diagonal.nrows();
                let mut Δ = Δ.to_vec();
                if let Some(l) = whitener {
                    whiten(l, p, &mut Δ);
                }
                if let Some(U) = rotation {
                    Δ = pack(&(U.transpose() * unpack(&Δ, p) * U));
                }
                let on_diagonal = DVector::from_fn(p, |i, _| Δ[packed_len(i) + i]);
                let below = (0..p).flat_map(|i| Δ[packed_len(i)..packed_len(i) + i].iter());
                let mut image: Vec<f64> = below.zip(off_diagonal).map(|(x, weight)| x * weight).collect();
                image.extend((diagonal * on_diagonal).iter());
                image
            }
        }
    }
}

/// `√(λᵢ + λⱼ)` for i > j, row by row: both off-diagonal entries of a pair in one coordinate.
fn pairs(λ: &DVector<f64>) -> Vec<f64> {
    (0..λ.len()).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| (λ[i] + λ[j]).sqrt()).collect()
}

/// `L⁻¹ X`.
fn whitened(l: &[f64], X: &DMatrix<f64>) -> DMatrix<f64> {
    let mut X = X.clone();
    let p = X.nrows();
    for column in X.as_mut_slice().chunks_exact_mut(p) {
        solve_lower(l, p, column);
    }
    X
}
