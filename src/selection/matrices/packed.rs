//! Small symmetric matrices in packed storage.
//!
//! A p×p symmetric matrix is its lower triangle, row by row: entry (i, j), j ≤ i, at `i (i + 1) / 2 + j`. Rows are
//! contiguous, so the inner loops below run over slices; the factorisations and solves allocate nothing.

use nalgebra::DMatrix;

/// Length of a packed matrix of order `p`.
pub(crate) const fn packed_len(p: usize) -> usize {
    p * (p + 1) / 2
}

/// Packs the lower triangle of a square matrix.
pub(crate) fn pack(matrix: &DMatrix<f64>) -> Vec<f64> {
    let p = matrix.nrows();
    (0..p).flat_map(|i| (0..=i).map(move |j| matrix[(i, j)])).collect()
}

/// The full symmetric p×p matrix of its packed lower triangle.
pub(crate) fn unpack(packed: &[f64], p: usize) -> DMatrix<f64> {
    DMatrix::from_fn(p, p, |i, j| if i >= j { packed[packed_len(i) + j] } else { packed[packed_len(j) + i] })
}

/// The packed symmetric matrix with doubled off-diagonal entries: its dot product with a packed M is `⟨Y, M⟩`.
pub(crate) fn dual(mut packed: Vec<f64>, p: usize) -> Vec<f64> {
    for i in 0..p {
        for entry in &mut packed[packed_len(i)..packed_len(i) + i] {
            *entry *= 2.0;
        }
    }
    packed
}

/// Replaces packed `M` by its Cholesky factor, `M = L Lᵀ`; `false` if M is not positive definite, to working
/// precision.
#[must_use]
pub(crate) fn cholesky(m: &mut [f64], p: usize) -> bool {
    for i in 0..p {
        let (before, rest) = m.split_at_mut(packed_len(i));
        let row_i = &mut rest[..=i];
        let original = row_i[i];
        for j in 0..i {
            let row_j = &before[packed_len(j)..=packed_len(j) + j];
            row_i[j] = (row_i[j] - dot(&row_i[..j], &row_j[..j])) / row_j[j];
        }
        let pivot = original - dot(&row_i[..i], &row_i[..i]);
        // A pivot that cancelled down to rounding noise says nothing of the matrix any more.
        if pivot.is_nan() || pivot <= 8.0 * f64::EPSILON * original {
            return false;
        }
        row_i[i] = pivot.sqrt();
    }
    true
}

/// Relative size of what rounding leaves uncertain in the entries of a sum of information matrices, `√(m_ii m_jj)` being one.
pub(crate) const RESOLUTION: f64 = 1e-13;

/// Whether the matrix of a Cholesky factor is positive definite beyond rounding: scaled to a unit diagonal, so that units do
/// not decide, its least eigenvalue exceeds [`RESOLUTION`].
///
/// The trace of the scaled inverse, at least `1 / λ_min`, is the sum of the variance inflations `m_ii (M⁻¹)_ii`: how much more
/// uncertain a parameter is than it were if the others were known. The scaled determinant spares most matrices the inverse,
/// for it is below `e λ_min`.
pub(crate) fn is_resolved(l: &[f64], p: usize) -> bool {
    let row = |i: usize| &l[packed_len(i)..=packed_len(i) + i];
    let determinant: f64 = (0..p).map(|i| row(i)[i] * row(i)[i] / dot(row(i), row(i))).product();
    if determinant > std::f64::consts::E * p as f64 * RESOLUTION {
        return true;
    }
    let mut column = vec![0.0; p];
    let mut inflations = 0.0;
    for j in 0..p {
        column.fill(0.0);
        column[j] = dot(row(j), row(j)).sqrt();
        solve_lower(l, p, &mut column);
        inflations += dot(&column, &column);
    }
    inflations < RESOLUTION.recip()
}

/// `M⁻¹`, p×p; `None` if M is not positive definite beyond rounding.
pub(crate) fn inverse(m: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let p = m.nrows();
    let mut l = pack(m);
    (cholesky(&mut l, p) && is_resolved(&l, p)).then(|| inverse_of_factor(&l, p))
}

/// `(L Lᵀ)⁻¹` of a packed Cholesky factor.
pub(crate) fn inverse_of_factor(l: &[f64], p: usize) -> DMatrix<f64> {
    let mut X = DMatrix::identity(p, p);
    for column in X.as_mut_slice().chunks_exact_mut(p) {
        solve_lower_transposed(l, p, column);
    }
    &X * X.transpose()
}

/// `log det M` of a Cholesky factor.
pub(crate) fn log_det(l: &[f64], p: usize) -> f64 {
    log_det_of((0..p).map(|i| l[packed_len(i) + i]))
}

/// `log det M` of the pivots of its Cholesky factor.
pub(crate) fn log_det_of(pivots: impl Iterator<Item = f64> + Clone) -> f64 {
    // One logarithm for all: the product of few pivots of a scaled matrix neither over- nor underflows in practice,
    // and is taken apart where it would.
    let product: f64 = pivots.clone().product();
    if product.is_normal() { 2.0 * product.ln() } else { 2.0 * pivots.map(f64::ln).sum::<f64>() }
}

/// `x ← L⁻¹ x`.
pub(crate) fn solve_lower(l: &[f64], p: usize, x: &mut [f64]) {
    for i in 0..p {
        let row = &l[packed_len(i)..=packed_len(i) + i];
        x[i] = (x[i] - dot(&row[..i], &x[..i])) / row[i];
    }
}

/// `x ← L⁻ᵀ x`.
pub(crate) fn solve_lower_transposed(l: &[f64], p: usize, x: &mut [f64]) {
    for i in (0..p).rev() {
        let row = &l[packed_len(i)..=packed_len(i) + i];
        x[i] /= row[i];
        let known = x[i];
        for (x, entry) in x[..i].iter_mut().zip(row) {
            *x -= entry * known;
        }
    }
}

/// `C ← L⁻¹ C L⁻ᵀ` for packed symmetric `c`: M in the coordinates in which `L Lᵀ` is the identity.
pub(crate) fn whiten(l: &[f64], p: usize, c: &mut [f64]) {
    // Row by row, X = L⁻¹ C restricted to its lower triangle and then X L⁻ᵀ, as in LAPACK's sygs2.
    for k in 0..p {
        let pivot = l[packed_len(k) + k];
        let ckk = c[packed_len(k) + k] / (pivot * pivot);
        c[packed_len(k) + k] = ckk;
        for i in k + 1..p {
            c[packed_len(i) + k] /= pivot;
            c[packed_len(i) + k] -= 0.5 * ckk * l[packed_len(i) + k];
        }
        for i in k + 1..p {
            let (lik, cik) = (l[packed_len(i) + k], c[packed_len(i) + k]);
            for j in k + 1..=i {
                c[packed_len(i) + j] -= lik * c[packed_len(j) + k] + cik * l[packed_len(j) + k];
            }
        }
        for i in k + 1..p {
            c[packed_len(i) + k] -= 0.5 * ckk * l[packed_len(i) + k];
        }
        // Column k of the trailing solve: c[k+1.., k] ← L[k+1.., k+1..]⁻¹ c[k+1.., k].
        for i in k + 1..p {
            let mut x = c[packed_len(i) + k];
            for j in k + 1..i {
                x -= l[packed_len(i) + j] * c[packed_len(j) + k];
            }
            c[packed_len(i) + k] = x / l[packed_len(i) + i];
        }
    }
}

/// `Σ aᵢ bᵢ`.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn positive_definite(p: usize) -> impl Strategy<Value = DMatrix<f64>> {
        prop::collection::vec(-1.0..1.0, p * p).prop_map(move |v| {
            let a = DMatrix::from_vec(p, p, v);
            &a * a.transpose() + DMatrix::identity(p, p) * 0.1
        })
    }

    proptest! {
        #[test]
        fn factors_agree_with_nalgebra(m in positive_definite(7), c in positive_definite(7)) {
            let mut l = pack(&m);
            prop_assert!(cholesky(&mut l, 7));
            let reference = m.clone().cholesky().unwrap();
            let L = reference.l();
            prop_assert!((unpack(&l, 7).lower_triangle() - &L).norm() < 1e-12);
            prop_assert!((log_det(&l, 7) - m.determinant().ln()).abs() < 1e-10);
            let mut x: Vec<f64> = (0..7).map(f64::from).collect();
            let b = nalgebra::DVector::from_vec(x.clone());
            solve_lower(&l, 7, &mut x);
            prop_assert!((&L * nalgebra::DVector::from_vec(x) - b).norm() < 1e-10);
            let mut w = pack(&c);
            whiten(&l, 7, &mut w);
            let inverse = L.clone().try_inverse().unwrap();
            prop_assert!((unpack(&w, 7) - &inverse * &c * inverse.transpose()).norm() < 1e-9);
            let inner: f64 = dual(pack(&m), 7).iter().zip(pack(&c)).map(|(a, b)| a * b).sum();
            prop_assert!((inner - (&m * &c).trace()).abs() < 1e-9);
        }
    }

    /// Sums of fewer rank-one matrices than parameters, in units far apart: whatever rounding makes of them is not resolved.
    #[test]
    fn what_rounding_leaves_of_a_singular_matrix_is_not_resolved() {
        let mut state = 1u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let p = 6;
        let mut factored = 0;
        for _ in 0..2000 {
            let mut sum = vec![0.0; packed_len(p)];
            let units: Vec<f64> = (0..p).map(|_| 10f64.powf(16.0 * draw())).collect();
            let mut add = |sum: &mut Vec<f64>, size: f64| {
                let a: Vec<f64> = units.iter().map(|unit| unit * draw() * size).collect();
                for i in 0..p {
                    for j in 0..=i {
                        sum[packed_len(i) + j] += a[i] * a[j];
                    }
                }
            };
            for _ in 1..p {
                add(&mut sum, 1.0);
            }
            let mut l = sum.clone();
            if cholesky(&mut l, p) {
                factored += 1;
                assert!(!is_resolved(&l, p));
            }
            assert_eq!(inverse(&unpack(&sum, p)), None);
            // A last one of a hundredth's size resolves it, by either way of telling.
            add(&mut sum, 1e-2);
            assert!(cholesky(&mut sum, p) && is_resolved(&sum, p));
        }
        assert!(factored > 100, "{factored}");
    }

    #[test]
    fn a_determinant_below_every_double_has_its_logarithm() {
        let l = pack(&DMatrix::from_diagonal_element(4, 4, 1e-100));
        assert!((log_det(&l, 4) + 800.0 * 10f64.ln()).abs() < 1e-9);
    }

    #[test]
    fn singular_and_indefinite_matrices_have_no_factor() {
        for m in [[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [0.0, 0.0, 1.0], [f64::NAN, 0.0, 1.0]] {
            assert!(!cholesky(&mut m.clone(), 2));
        }
    }
}
