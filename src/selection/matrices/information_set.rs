//! The information matrices of all candidates, in one table.

use faer::linalg::matmul::matmul;
use faer::{Accum, ColMut, ColRef, Mat, MatRef, Par};
use nalgebra::DMatrix;
use rayon::prelude::*;
use thiserror::Error;

use super::packed::{cholesky, dual, pack, packed_len, unpack};

/// n symmetric positive semidefinite p×p matrices, one per candidate: a row-major n × p(p+1)/2 table of their lower triangles, row by
/// row.
#[derive(Debug, Clone, PartialEq)]
pub struct InformationSet {
    order: usize,
    table: Vec<f64>,
}

/// Why a matrix is not an information matrix.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InformationError {
    /// Wrong number of entries.
    #[error("the table holds {found} numbers; matrices of order {order} need a multiple of {expected}")]
    Shape {
        /// Order p.
        order: usize,
        /// p(p+1)/2.
        expected: usize,
        /// Numbers given.
        found: usize,
    },
    /// A matrix is not of the set's order.
    #[error("matrix {candidate} is {rows}×{columns}; the set's matrices are {order}×{order}")]
    Order {
        /// Candidate, from 0.
        candidate: usize,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// Order p.
        order: usize,
    },
    /// An entry is NaN or infinite.
    #[error("matrix {candidate} has the entry {value} in row {row}, column {column}; entries must be finite")]
    NotFinite {
        /// Candidate, from 0.
        candidate: usize,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A matrix is not positive semidefinite.
    #[error("matrix {candidate} is not positive semidefinite: it has the eigenvalue {eigenvalue:e}")]
    Indefinite {
        /// Candidate, from 0.
        candidate: usize,
        /// The least eigenvalue, as a share of the greatest diagonal entry, parameters being in units in which the mean of all
        /// matrices has a diagonal of ones.
        eigenvalue: f64,
    },
}

/// Rows scored by one task: large enough to outweigh its start, the same on any number of threads.
const ROWS_PER_TASK: usize = 4096;

/// Negative eigenvalues of this size, as a share of the greatest diagonal entry, are rounding.
const TOLERANCE: f64 = 1e-9;

impl InformationSet {
    /// A set of matrices of order `p` from a row-major table of packed matrices.
    ///
    /// # Errors
    /// When the table's length is not a multiple of p(p+1)/2, an entry is not finite, or a matrix is not positive
    /// semidefinite: to 10⁻⁹ of its greatest diagonal entry, parameters being in units in which the mean of all matrices has
    /// a diagonal of ones.
    pub fn from_packed(order: usize, table: Vec<f64>) -> Result<Self, InformationError> {
        let set = Self::from_packed_unchecked(order, table)?;
        (0..set.len()).into_par_iter().try_for_each(|i| check_finite(set.packed(i), order, i))?;
        let mean = set.mean();
        let unit = |m: f64| if m > 0.0 { m.sqrt() } else { 1.0 };
        let units: Vec<f64> = (0..order).map(|i| unit(mean[packed_len(i) + i])).collect();
        (0..set.len()).into_par_iter().try_for_each(|i| check_semidefinite(set.packed(i), order, i, &units))?;
        Ok(set)
    }

    /// As [`InformationSet::from_packed`] for matrices known to be semidefinite.
    pub(crate) fn from_packed_unchecked(order: usize, table: Vec<f64>) -> Result<Self, InformationError> {
        let expected = packed_len(order);
        if order == 0 || !table.len().is_multiple_of(expected) {
            return Err(InformationError::Shape { order, expected, found: table.len() });
        }
        Ok(Self { order, table })
    }

    /// As [`InformationSet::from_packed`] for a table whose shape and matrices are right by construction.
    pub(crate) fn from_packed_trusted(order: usize, table: Vec<f64>) -> Self {
        debug_assert!(order > 0 && table.len().is_multiple_of(packed_len(order)));
        Self { order, table }
    }

    /// Adds the candidates of another set of the same order, after those that are there.
    pub(crate) fn append(&mut self, other: &Self) {
        debug_assert_eq!(self.order, other.order);
        self.table.extend(&other.table);
    }

    /// The set of `D M_i D`, D = diag(`scale`): the matrices for parameters in units of `scale`.
    #[must_use]
    pub(crate) fn scaled(&self, scale: &[f64]) -> Self {
        let factors: Vec<f64> =
            (0..self.order).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| scale[i] * scale[j]).collect();
        let mut table = self.table.clone();
        for row in table.chunks_exact_mut(factors.len()) {
            for (entry, factor) in row.iter_mut().zip(&factors) {
                *entry *= factor;
            }
        }
        Self { order: self.order, table }
    }

    /// A set of p×p matrices, all of the order `order`.
    ///
    /// ```
    /// use calipose::selection::{InformationError, InformationSet};
    /// use nalgebra::DMatrix;
    ///
    /// let views = InformationSet::from_matrices(2, &[DMatrix::identity(2, 2)])?;
    /// assert_eq!((views.len(), views.order()), (1, 2));
    /// let refused = InformationSet::from_matrices(2, &[DMatrix::identity(3, 3)]).unwrap_err();
    /// assert_eq!(refused, InformationError::Order { candidate: 0, rows: 3, columns: 3, order: 2 });
    /// # Ok::<(), InformationError>(())
    /// ```
    ///
    /// # Errors
    /// When a matrix is of another order, and as [`InformationSet::from_packed`].
    pub fn from_matrices<'a>(
        order: usize,
        matrices: impl IntoIterator<Item = &'a DMatrix<f64>>,
    ) -> Result<Self, InformationError> {
        let mut table = Vec::new();
        for (candidate, matrix) in matrices.into_iter().enumerate() {
            let (rows, columns) = matrix.shape();
            if (rows, columns) != (order, order) {
                return Err(InformationError::Order { candidate, rows, columns, order });
            }
            table.extend(pack(matrix));
        }
        Self::from_packed(order, table)
    }

    /// The set of the matrices of `candidates`, in their order.
    #[must_use]
    pub(crate) fn select(&self, candidates: &[usize]) -> Self {
        let mut table = Vec::with_capacity(candidates.len() * packed_len(self.order));
        for &i in candidates {
            table.extend_from_slice(self.packed(i));
        }
        Self { order: self.order, table }
    }

    /// Order p of the matrices.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Number n of candidates.
    pub fn len(&self) -> usize {
        self.table.len() / packed_len(self.order)
    }

    /// Whether there is no candidate.
    pub fn is_empty(&self) -> bool {
        self.table.is_empty()
    }

    /// Candidate `i`'s matrix, packed.
    pub(crate) fn packed(&self, i: usize) -> &[f64] {
        let q = packed_len(self.order);
        &self.table[i * q..(i + 1) * q]
    }

    /// Candidate `i`'s matrix, p×p; `None` if there is no such candidate.
    pub fn matrix(&self, i: usize) -> Option<DMatrix<f64>> {
        (i < self.len()).then(|| unpack(self.packed(i), self.order))
    }

    /// `sum += weight · M_i`, packed.
    pub(crate) fn add_to(&self, sum: &mut [f64], i: usize, weight: f64) {
        for (sum, entry) in sum.iter_mut().zip(self.packed(i)) {
            *sum += weight * entry;
        }
    }

    /// `prior + Σ M_i` over the given candidates, packed.
    pub(crate) fn total(&self, prior: &[f64], selected: &[usize]) -> Vec<f64> {
        let mut sum = prior.to_vec();
        for &i in selected {
            self.add_to(&mut sum, i, 1.0);
        }
        sum
    }

    /// The sum of all matrices, packed.
    pub(crate) fn sum(&self) -> Vec<f64> {
        let mut sum = vec![0.0; packed_len(self.order)];
        for i in 0..self.len() {
            self.add_to(&mut sum, i, 1.0);
        }
        sum
    }

    /// The mean of all matrices, packed.
    pub(crate) fn mean(&self) -> Vec<f64> {
        let mut sum = vec![0.0; packed_len(self.order)];
        for i in 0..self.len() {
            self.add_to(&mut sum, i, 1.0 / self.len() as f64);
        }
        sum
    }

    /// `scores[i] += ⟨Y, M_i⟩` for every candidate; `y` is packed. The result does not depend on the number of
    /// threads.
    pub(crate) fn add_scores(&self, y: &[f64], scores: &mut [f64]) {
        let q = packed_len(self.order);
        let weights = dual(y.to_vec(), self.order);
        let rows = self.table.par_chunks(ROWS_PER_TASK * q);
        rows.zip(scores.par_chunks_mut(ROWS_PER_TASK)).for_each(|(rows, scores)| {
            let table = MatRef::from_row_major_slice(rows, scores.len(), q);
            matmul(ColMut::from_slice_mut(scores), Accum::Add, table, ColRef::from_slice(&weights), 1.0, Par::Seq);
        });
    }

    /// As [`InformationSet::add_scores`] by each of several matrices Y, `scores` beside them: the table is read once for all.
    pub(crate) fn add_scores_by_each(&self, ys: &[&[f64]], scores: &mut [Vec<f64>]) {
        let q = packed_len(self.order);
        let weights: Vec<f64> = ys.iter().flat_map(|y| dual(y.to_vec(), self.order)).collect();
        let weights = MatRef::from_column_major_slice(&weights, q, ys.len());
        let product = |rows: &[f64]| {
            let table = MatRef::from_row_major_slice(rows, rows.len() / q, q);
            let mut product = Mat::zeros(table.nrows(), ys.len());
            matmul(product.as_mut(), Accum::Replace, table, weights, 1.0, Par::Seq);
            product
        };
        let products: Vec<Mat<f64>> = self.table.par_chunks(ROWS_PER_TASK * q).map(product).collect();
        for (task, product) in products.iter().enumerate() {
            for (scores, column) in scores.iter_mut().zip(product.col_iter()) {
                for (score, term) in scores[task * ROWS_PER_TASK..].iter_mut().zip(column.iter()) {
                    *score += term;
                }
            }
        }
    }
}

/// Checks that a matrix has finite entries.
fn check_finite(packed: &[f64], p: usize, candidate: usize) -> Result<(), InformationError> {
    for row in 0..p {
        for column in 0..=row {
            let value = packed[packed_len(row) + column];
            if !value.is_finite() {
                return Err(InformationError::NotFinite { candidate, row, column, value });
            }
        }
    }
    Ok(())
}

/// Checks that a finite matrix is semidefinite, for parameters in these units.
///
/// Units make the tolerance mean the same for every parameter. They are of all matrices together: where one tells almost nothing
/// of a parameter, its entries there are rounding of those elsewhere in it.
fn check_semidefinite(packed: &[f64], p: usize, candidate: usize, units: &[f64]) -> Result<(), InformationError> {
    let scaled = DMatrix::from_fn(p, p, |i, j| packed[packed_len(i.max(j)) + i.min(j)] / (units[i] * units[j]));
    let greatest = scaled.diagonal().max();
    let scaled = if greatest > 0.0 { scaled / greatest } else { scaled };
    let mut shifted = pack(&(&scaled + DMatrix::identity(p, p) * TOLERANCE));
    if cholesky(&mut shifted, p) {
        return Ok(());
    }
    Err(InformationError::Indefinite { candidate, eigenvalue: scaled.symmetric_eigenvalues().min() })
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256Plus;

    use super::*;

    #[test]
    fn scores_are_inner_products() {
        let matrices = [
            DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 3.0]),
            DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0]),
        ];
        let set = InformationSet::from_matrices(2, &matrices).unwrap();
        let y = DMatrix::from_row_slice(2, 2, &[1.0, -2.0, -2.0, 5.0]);
        let mut scores = vec![10.0; 2];
        set.add_scores(&pack(&y), &mut scores);
        for (score, m) in scores.iter().zip(&matrices) {
            assert!((score - 10.0 - (&y * m).trace()).abs() < 1e-14);
        }
        let ys = [pack(&y), vec![1.0, 0.0, 1.0]];
        let mut each = vec![vec![1.0; 2]; 2];
        set.add_scores_by_each(&ys.each_ref().map(Vec::as_slice), &mut each);
        assert_eq!(each, [vec![scores[0] - 9.0, scores[1] - 9.0], vec![6.0, 2.0]]);
        assert_eq!(set.matrix(0).as_ref(), Some(&matrices[0]));
        assert_eq!(set.total(&[0.5, 0.0, 0.0], &[0, 1]), [3.5, 1.0, 3.0]);
    }

    #[test]
    fn bad_matrices_are_named() {
        let set = |table: &[f64]| InformationSet::from_packed(2, table.to_vec());
        assert!(matches!(set(&[1.0, 0.0]), Err(InformationError::Shape { expected: 3, found: 2, .. })));
        assert!(matches!(
            set(&[1.0, 0.0, 1.0, 1.0, f64::NAN, 1.0]),
            Err(InformationError::NotFinite { candidate: 1, row: 1, column: 0, .. })
        ));
        assert!(matches!(set(&[1.0, 2.0, 1.0]), Err(InformationError::Indefinite { candidate: 0, .. })));
        assert!(matches!(set(&[1.0, 0.0, -1.0]), Err(InformationError::Indefinite { .. })));
        // What is rounding and what is not does not depend on the unit.
        for unit in [1e-12, 1.0, 1e12] {
            assert!(matches!(set(&[unit, 1.000_001 * unit, unit]), Err(InformationError::Indefinite { .. })));
            assert!(set(&[unit, (1.0 + 1e-13) * unit, unit]).is_ok());
        }
        assert!(set(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).is_ok());
    }

    /// Where a view tells little of a parameter, what whitening leaves there is rounding of the rest; of one that tells much,
    /// or in a set that knows the parameter no better, it is not.
    #[test]
    fn rounding_is_told_by_the_scale_of_all_matrices() {
        let mut rng = Xoshiro256Plus::seed_from_u64(4);
        let p = 9;
        let mut draw = || DMatrix::from_fn(p, 1, |_, _| rng.sample::<f64, _>(StandardNormal));
        let mut vectors: Vec<DMatrix<f64>> = (0..50).map(|_| draw()).collect();
        let sum = vectors.iter().fold(DMatrix::zeros(p, p), |sum, g| sum + g * g.transpose());
        let L = sum.cholesky().unwrap().l();
        for vector in &mut vectors[..20] {
            let mut white = draw();
            white[p - 1] *= 1e-5;
            *vector = &L * white;
        }
        let whitener = L.try_inverse().unwrap();
        let whitened = vectors.iter().map(|g| &whitener * (g * g.transpose()) * whitener.transpose());
        let whitened: Vec<DMatrix<f64>> = whitened.collect();
        let least = |M: &DMatrix<f64>| {
            let scale = M.diagonal().map(f64::sqrt);
            DMatrix::from_fn(p, p, |i, j| M[(i, j)] / (scale[i] * scale[j])).symmetric_eigenvalues().min()
        };
        assert!(whitened.iter().map(least).fold(0.0, f64::min) < -TOLERANCE);
        let set = |others: &[DMatrix<f64>], odd: DMatrix<f64>| {
            InformationSet::from_matrices(odd.nrows(), others.iter().chain([&odd]))
        };
        assert!(set(&whitened[1..], whitened[0].clone()).is_ok());
        let odd = DMatrix::from_row_slice(2, 2, &[1.0, 2e-7, 2e-7, 1e-14]);
        let refused = |others: &[DMatrix<f64>]| matches!(set(others, odd.clone()), Err(InformationError::Indefinite { candidate, .. }) if candidate == others.len());
        assert!(refused(&[]) && refused(&[DMatrix::from_diagonal(&vec![1.0, 1e-14].into())]));
        assert!(!refused(&[DMatrix::identity(2, 2)]));
    }
}
