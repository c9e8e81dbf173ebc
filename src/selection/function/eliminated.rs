//! Information on some parameters where others, which nobody asks for, are estimated beside them.

use nalgebra::{DMatrix, DVector};

use super::{Curvature, Gradient};
use crate::selection::packed::{pack, packed_len, solve_lower, solve_lower_transposed, unpack};

/// A total M of order p whose first s parameters are a nuisance, with its Schur complement `S = M₂₂ − M₂₁ M₁₁⁻¹ M₁₂`.
///
/// S is the least of `K M Kᵀ` over all `K = [X 1]` (Pukelsheim, section 3.11), taken at `X = −M₂₁ M₁₁⁻¹`; so `Φ(S)` is an
/// information function of M where Φ is one of S, with the gradient `KᵀYK`. Its polar function is that of Φ at the block `Y₂₂`:
/// an M with a given S can have any `M₂₁ M₁₁⁻¹`, and an `M₁₁` as small as one likes.
pub(super) struct Eliminated {
    pub(super) S: Vec<f64>,
    /// The packed Cholesky factor of M.
    l: Vec<f64>,
    nuisance: usize,
    p: usize,
}

impl Eliminated {
    /// Of the packed Cholesky factor of M.
    pub(super) fn new(l: &[f64], p: usize, nuisance: usize) -> Self {
        // With M = L Lᵀ the last block of L is a factor of S.
        let row = |i: usize| &l[packed_len(i) + nuisance..=packed_len(i) + i];
        let entry = |i: usize, j: usize| row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum::<f64>();
        let S = (nuisance..p).flat_map(|i| (nuisance..=i).map(move |j| entry(i, j))).collect();
        Self { S, l: l.to_vec(), nuisance, p }
    }

    /// The order of S.
    pub(super) fn order(&self) -> usize {
        self.p - self.nuisance
    }

    /// `K`, p−s × p.
    fn K(&self) -> DMatrix<f64> {
        let Self { l, nuisance: s, p, .. } = self;
        // −X is the solution of `X L₁₁ = L₂₁`.
        let mut K = DMatrix::zeros(p - s, *p);
        for i in *s..*p {
            let mut x: Vec<f64> = l[packed_len(i)..packed_len(i) + s].to_vec();
            solve_lower_transposed(l, *s, &mut x);
            for (j, x) in x.iter().enumerate() {
                K[(i - s, j)] = -x;
            }
            K[(i - s, i)] = 1.0;
        }
        K
    }

    /// The gradient by M of a function whose gradient by S is given.
    pub(super) fn gradient(&self, Gradient { y, mixture }: Gradient) -> Gradient {
        let K = self.K();
        let Y = K.transpose() * unpack(&y, self.order()) * K;
        Gradient { y: pack(&Y), mixture }
    }

    /// The second derivative by M of a function whose gradient and second derivative by S are given. With `E = K Δ` restricted
    /// to the nuisance, S changes by `K Δ Kᵀ` and bends by `−2 E M₁₁⁻¹ Eᵀ`.
    pub(super) fn curvature(&self, of_s: &Curvature, Gradient { y, .. }: &Gradient) -> Curvature {
        let (K, order, s) = (self.K(), self.order(), self.nuisance);
        let eigen = unpack(y, order).symmetric_eigen();
        let roots = eigen.eigenvalues.map(|λ| (2.0 * λ.max(0.0)).sqrt());
        let root = DMatrix::from_diagonal(&roots) * eigen.eigenvectors.transpose();
        let columns = (0..packed_len(self.p)).map(|e| {
            let mut Δ = vec![0.0; packed_len(self.p)];
            Δ[e] = 1.0;
            let KΔ = &K * unpack(&Δ, self.p);
            let mut image = of_s.map(&pack(&(&KΔ * K.transpose())));
            let bent = &root * KΔ.columns(0, s);
            for row in bent.row_iter() {
                let mut row: Vec<f64> = row.iter().copied().collect();
                solve_lower(&self.l, s, &mut row);
                image.extend(row);
            }
            DVector::from_vec(image)
        });
        Curvature::Dense(DMatrix::from_columns(&columns.collect::<Vec<_>>()))
    }
}

/// The packed block of Y that belongs to the parameters asked for.
pub(super) fn without_nuisance(y: &[f64], p: usize, nuisance: usize) -> Vec<f64> {
    (nuisance..p).flat_map(|i| y[packed_len(i) + nuisance..=packed_len(i) + i].iter().copied()).collect()
}
