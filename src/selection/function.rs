//! Information functions: how good a total information matrix is, as one number.
//!
//! An information function Φ (Pukelsheim, *Optimal Design of Experiments*, chapter 5) is concave, monotone and homogeneous
//! of degree one on the positive semidefinite matrices: twice the views give twice the information. Three consequences
//! carry everything in [`selection`](super):
//!
//! - log Φ is concave, so its relaxation has one optimum. Its gradient Y at M satisfies `⟨Y, M⟩ = 1`.
//! - `Φ(M + Δ) ≤ Φ(M)·(1 + ⟨Y, Δ⟩)` bounds what any change can gain before it is evaluated.
//! - `Φ(M)·Φ°(Y) ≤ ⟨Y, M⟩` for **every** Y ⪰ 0, with the polar function `Φ°(Y) = min ⟨Y, M⟩ / Φ(M)`: the certificate.
//!
//! Ratios of Φ are efficiencies: a plan with half the Φ needs twice the views, by every criterion alike.

use nalgebra::{DMatrix, DVector};

use crate::information::packed::{cholesky, log_det, pack, packed_len, solve_lower, unpack, whiten};

/// An information function of p×p matrices.
#[derive(Debug, Clone, PartialEq)]
pub enum InformationFunction {
    /// `Φ(M) = det(M)^(1/p)`, criterion `d`; `Φ°(Y) = p det(Y)^(1/p)`.
    Determinant,
    /// `Φ(M) = 1 / tr(Lᵀ M⁻¹ L)`, criterion `v`, with the p×r factor L of the weight `W = L Lᵀ`;
    /// `Φ°(Y) = (tr (Lᵀ Y L)^½)²`.
    Variance(DMatrix<f64>),
}

impl InformationFunction {
    /// The variance function of a positive semidefinite p×p weight W.
    pub fn variance(weight: &DMatrix<f64>) -> Self {
        let p = weight.nrows();
        let eigen = weight.clone().symmetric_eigen();
        // Eigenvalues of rounding's size are zero; as columns of L they would be noise that log Φ° takes for signal.
        let least = eigen.eigenvalues.max() * p as f64 * f64::EPSILON;
        let columns: Vec<_> = (0..p)
            .filter(|&j| eigen.eigenvalues[j] > least)
            .map(|j| eigen.eigenvectors.column(j) * eigen.eigenvalues[j].sqrt())
            .collect();
        InformationFunction::Variance(DMatrix::from_fn(p, columns.len(), |i, j| columns[j][i]))
    }

    /// `log Φ(M)` of a packed matrix of order p, which serves as work space; −∞ if M is singular.
    pub fn log_value(&self, m: &mut [f64], p: usize) -> f64 {
        if !cholesky(m, p) {
            return f64::NEG_INFINITY;
        }
        match self {
            InformationFunction::Determinant => log_det(m, p) / p as f64,
            InformationFunction::Variance(factor) => {
                let mut column = [0.0; 32];
                let mut long_column = Vec::new();
                let column = if p <= column.len() {
                    &mut column[..p]
                } else {
                    long_column.resize(p, 0.0);
                    &mut long_column
                };
                let mut variance = 0.0;
                for j in 0..factor.ncols() {
                    column.copy_from_slice(&factor.as_slice()[j * p..(j + 1) * p]);
                    solve_lower(m, p, column);
                    variance += column.iter().map(|x| x * x).sum::<f64>();
                }
                -variance.ln()
            }
        }
    }

    /// The gradient Y of log Φ at packed M, packed; `None` if M is singular.
    pub fn gradient(&self, m: &[f64], p: usize) -> Option<Vec<f64>> {
        let mut l = m.to_vec();
        if !cholesky(&mut l, p) {
            return None;
        }
        Some(match self {
            InformationFunction::Determinant => pack(&(inverse(&l, p) / p as f64)),
            InformationFunction::Variance(factor) => {
                let mut X = factor.clone(); // M⁻¹ L
                solve_columns(&l, &mut X);
                let variance = X.norm_squared();
                solve_columns_transposed(&l, &mut X);
                pack(&(&X * X.transpose() / variance))
            }
        })
    }

    /// `log Φ°(Y)` of a packed positive semidefinite Y; −∞ where Φ° vanishes, which bounds nothing.
    pub fn log_polar(&self, y: &[f64], p: usize) -> f64 {
        match self {
            InformationFunction::Determinant => {
                let mut l = y.to_vec();
                if cholesky(&mut l, p) { (p as f64).ln() + log_det(&l, p) / p as f64 } else { f64::NEG_INFINITY }
            }
            InformationFunction::Variance(factor) => {
                let eigenvalues = (factor.transpose() * unpack(y, p) * factor).symmetric_eigenvalues();
                // A bound must not gain from rounding, which the root would magnify where an eigenvalue is small.
                let rounding = 4.0 * p as f64 * f64::EPSILON * eigenvalues.amax();
                2.0 * eigenvalues.iter().map(|λ| (λ - rounding).max(0.0).sqrt()).sum::<f64>().ln()
            }
        }
    }

    /// The second derivative of log Φ at packed M; `None` if M is singular.
    pub fn curvature(&self, m: &[f64], p: usize) -> Option<Curvature> {
        let mut whitener = m.to_vec();
        if !cholesky(&mut whitener, p) {
            return None;
        }
        Some(match self {
            // −D²logΦ[Δ, Δ] = ‖M^(−½) Δ M^(−½)‖² / p.
            InformationFunction::Determinant => {
                let λ = DVector::from_element(p, 1.0 / p as f64);
                let diagonal = DMatrix::from_diagonal(&λ.map(f64::sqrt));
                Curvature { whitener, rotation: None, off_diagonal: pairs(&λ), diagonal }
            }
            // In coordinates that whiten M and diagonalise W, with Σ λ = 1:
            // −D²logΦ[Δ, Δ] = 2 Σᵢⱼ λᵢ Δᵢⱼ² − (Σᵢ λᵢ Δᵢᵢ)².
            InformationFunction::Variance(factor) => {
                let mut X = factor.clone();
                solve_columns(&whitener, &mut X);
                let eigen = (&X * X.transpose() / X.norm_squared()).symmetric_eigen();
                let λ = eigen.eigenvalues.map(|λ| λ.max(0.0));
                let mut diagonal = pack(&(DMatrix::from_diagonal(&(&λ * 2.0)) - &λ * λ.transpose()));
                for i in 0..p {
                    diagonal[packed_len(i) + i] += 1e-14; // λ = 0 where W is singular
                }
                let positive = cholesky(&mut diagonal, p);
                debug_assert!(positive);
                let diagonal = unpack(&diagonal, p).lower_triangle().transpose();
                Curvature { whitener, rotation: Some(eigen.eigenvectors), off_diagonal: pairs(&(&λ * 2.0)), diagonal }
            }
        })
    }
}

/// `√(λᵢ + λⱼ)` for i > j, row by row: both off-diagonal entries of a pair in one coordinate.
fn pairs(λ: &DVector<f64>) -> Vec<f64> {
    (0..λ.len()).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| (λ[i] + λ[j]).sqrt()).collect()
}

/// The negative second derivative of log Φ at a point, as the square of a linear map: `−D²log Φ[Δ, Δ] = ‖map(Δ)‖²`.
#[derive(Debug, Clone)]
pub struct Curvature {
    /// Packed Cholesky factor of M.
    whitener: Vec<f64>,
    /// Coordinates in which the map is diagonal off the diagonal.
    rotation: Option<DMatrix<f64>>,
    /// Weights of the off-diagonal entries, row by row.
    off_diagonal: Vec<f64>,
    /// p×p map of the diagonal entries.
    diagonal: DMatrix<f64>,
}

impl Curvature {
    /// The image of packed Δ: p(p+1)/2 coordinates.
    pub fn map(&self, Δ: &[f64]) -> Vec<f64> {
        let p = self.diagonal.nrows();
        let mut white = Δ.to_vec();
        whiten(&self.whitener, p, &mut white);
        if let Some(U) = &self.rotation {
            white = pack(&(U.transpose() * unpack(&white, p) * U));
        }
        let on_diagonal = DVector::from_fn(p, |i, _| white[packed_len(i) + i]);
        let below = (0..p).flat_map(|i| white[packed_len(i)..packed_len(i) + i].iter());
        let mut image: Vec<f64> = below.zip(&self.off_diagonal).map(|(x, weight)| x * weight).collect();
        image.extend((&self.diagonal * on_diagonal).iter());
        image
    }
}

/// `X ← L⁻¹ X`.
fn solve_columns(l: &[f64], X: &mut DMatrix<f64>) {
    let p = X.nrows();
    for column in X.as_mut_slice().chunks_exact_mut(p) {
        solve_lower(l, p, column);
    }
}

/// `X ← L⁻ᵀ X`.
fn solve_columns_transposed(l: &[f64], X: &mut DMatrix<f64>) {
    let p = X.nrows();
    for column in X.as_mut_slice().chunks_exact_mut(p) {
        for i in (0..p).rev() {
            column[i] /= l[packed_len(i) + i];
            let x = column[i];
            for j in 0..i {
                column[j] -= l[packed_len(i) + j] * x;
            }
        }
    }
}

/// `M⁻¹ = L⁻ᵀ L⁻¹` of a packed Cholesky factor.
fn inverse(l: &[f64], p: usize) -> DMatrix<f64> {
    let mut X = DMatrix::identity(p, p);
    solve_columns_transposed(l, &mut X);
    &X * X.transpose()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const P: usize = 4;

    fn functions() -> Vec<InformationFunction> {
        let W = DMatrix::from_row_slice(P, 2, &[1.0, 0.2, 0.0, 2.0, -1.0, 0.3, 0.5, 0.0]);
        vec![
            InformationFunction::Determinant,
            InformationFunction::variance(&(&W * W.transpose())),
            InformationFunction::variance(&DMatrix::identity(P, P)),
        ]
    }

    fn matrix() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-1.0..1.0, P * P).prop_map(|v| {
            let a = DMatrix::from_vec(P, P, v);
            pack(&(&a * a.transpose() + DMatrix::identity(P, P) * 0.2))
        })
    }

    fn moved(m: &[f64], Δ: &[f64], t: f64) -> Vec<f64> {
        m.iter().zip(Δ).map(|(m, d)| m + t * d).collect()
    }

    fn inner(y: &[f64], m: &[f64]) -> f64 {
        (unpack(y, P) * unpack(m, P)).trace()
    }

    proptest! {
        #[test]
        fn derivatives_equal_finite_differences(m in matrix(), a in matrix(), b in matrix()) {
            let Δ = moved(&a, &b, -1.0);
            for f in functions() {
                let at = |t: f64| f.log_value(&mut moved(&m, &Δ, t), P);
                let h = 1e-4;
                let slope = inner(&f.gradient(&m, P).unwrap(), &Δ);
                prop_assert!((slope - (at(h) - at(-h)) / (2.0 * h)).abs() < 1e-5 * (1.0 + slope.abs().powi(3)));
                let bend: f64 = f.curvature(&m, P).unwrap().map(&Δ).iter().map(|x| x * x).sum();
                let second = -(at(h) - 2.0 * at(0.0) + at(-h)) / (h * h);
                prop_assert!((bend - second).abs() < 1e-3 * (1.0 + bend.powi(2)), "{bend} {second}");
            }
        }

        #[test]
        fn the_laws_of_information_functions(m in matrix(), a in matrix(), y in matrix()) {
            for f in functions() {
                let log = |m: &[f64]| f.log_value(&mut m.to_vec(), P);
                // homogeneous of degree one
                let twice: Vec<f64> = m.iter().map(|x| 2.0 * x).collect();
                prop_assert!((log(&twice) - log(&m) - 2f64.ln()).abs() < 1e-10);
                // ⟨Y, M⟩ = 1 at the gradient, and the polar inequality is tight there
                let gradient = f.gradient(&m, P).unwrap();
                prop_assert!((inner(&gradient, &m) - 1.0).abs() < 1e-9);
                prop_assert!((log(&m) + f.log_polar(&gradient, P)).abs() < 1e-6);
                // the polar inequality for any Y, and the gain's bound for any change
                prop_assert!(log(&m) + f.log_polar(&y, P) <= inner(&y, &m).ln() + 1e-10);
                let sum = moved(&m, &a, 1.0);
                prop_assert!(log(&sum) - log(&m) <= (1.0 + inner(&gradient, &a)).ln() + 1e-10);
            }
        }
    }

    #[test]
    fn a_singular_matrix_has_no_information() {
        for f in functions() {
            assert_eq!(f.log_value(&mut vec![0.0; packed_len(P)], P), f64::NEG_INFINITY);
            assert_eq!(f.gradient(&vec![0.0; packed_len(P)], P), None);
        }
    }
}
