//! The selection problem, and the errors of an ill-posed one.

use nalgebra::DMatrix;
use thiserror::Error;

use super::function::InformationFunction;
use crate::information::packed::{packed_len, unpack};
use crate::information::{InformationError, InformationSet};

/// Choose `count` of the candidates so that `Φ(M₀ + Σ M_i)` is greatest.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance<'a> {
    candidates: &'a InformationSet,
    prior: Vec<f64>,
    function: &'a InformationFunction,
    count: usize,
}

/// Why nothing can be selected.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SelectionError {
    /// More views are asked for than there are candidates, or none.
    #[error("{count} of {candidates} candidates cannot be selected; ask for at least 1 and at most {candidates}")]
    Count {
        /// Number asked for.
        count: usize,
        /// Number of candidates.
        candidates: usize,
    },
    /// The prior or the function is of another order than the candidates.
    #[error("the {what} is of order {found}, the candidates' matrices of order {expected}")]
    Order {
        /// What does not fit.
        what: &'static str,
        /// Order of the candidates.
        expected: usize,
        /// Its order.
        found: usize,
    },
    /// The prior is not an information matrix.
    #[error("the prior is refused: {0}")]
    Prior(#[source] InformationError),
    /// The weight of the variance is zero or not finite.
    #[error("the weight of the variance is zero or not finite; nothing can be made small by it")]
    Weight,
    /// Some combination of the parameters is not determined.
    #[error("{count} views leave a combination of the parameters undetermined")]
    Unobservable {
        /// Number of views that were tried: as many as asked for, or all candidates together.
        count: usize,
        /// The combination, one coefficient per parameter, scaled so that the largest is 1 in size.
        combination: Vec<f64>,
    },
}

impl<'a> Instance<'a> {
    /// An instance; `prior` is the p×p information M₀ already at hand, or `None`.
    ///
    /// # Errors
    /// When `count` is 0 or above the number of candidates, an order does not fit, the prior is no information matrix, the
    /// weight is zero or not finite, or all candidates together leave a combination of the parameters undetermined.
    pub fn new(
        candidates: &'a InformationSet,
        prior: Option<&DMatrix<f64>>,
        function: &'a InformationFunction,
        count: usize,
    ) -> Result<Self, SelectionError> {
        if count == 0 || count > candidates.len() {
            return Err(SelectionError::Count { count, candidates: candidates.len() });
        }
        let p = candidates.order();
        let fits = |what, found| {
            if found == p { Ok(()) } else { Err(SelectionError::Order { what, expected: p, found }) }
        };
        if let InformationFunction::Variance(factor) = function {
            fits("weight", factor.nrows())?;
            if factor.is_empty() || factor.iter().any(|entry| !entry.is_finite()) {
                return Err(SelectionError::Weight);
            }
        }
        let prior = match prior {
            Some(prior) => {
                fits("prior", prior.nrows())?;
                fits("prior", prior.ncols())?;
                let checked = InformationSet::from_matrices(p, [prior]).map_err(SelectionError::Prior)?;
                checked.packed(0).to_vec()
            }
            None => vec![0.0; packed_len(p)],
        };
        let instance = Self { candidates, prior, function, count };
        let everything = instance.with_mean(candidates.len() as f64);
        if instance.log_value(&everything) == f64::NEG_INFINITY {
            return Err(instance.least_known(&everything, candidates.len()));
        }
        Ok(instance)
    }

    /// The candidates.
    pub fn candidates(&self) -> &InformationSet {
        self.candidates
    }

    /// Number of candidates to select.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Φ.
    pub fn function(&self) -> &InformationFunction {
        self.function
    }

    /// `M₀ + Σ M_i` of a selection, packed.
    pub fn total(&self, selected: &[usize]) -> Vec<f64> {
        self.candidates.total(&self.prior, selected)
    }

    /// log Φ of a packed total; −∞ if it is singular.
    pub fn log_value(&self, total: &[f64]) -> f64 {
        self.function.log_value(&mut total.to_vec(), self.order())
    }

    /// Order p of the matrices.
    pub fn order(&self) -> usize {
        self.candidates.order()
    }

    /// Scores `⟨Y, M_i⟩` of all candidates at packed Y.
    pub fn scores(&self, y: &[f64]) -> Vec<f64> {
        let mut scores = vec![0.0; self.candidates.len()];
        self.candidates.add_scores(y, &mut scores);
        scores
    }

    /// M₀, packed.
    pub(super) fn prior(&self) -> &[f64] {
        &self.prior
    }

    /// `M₀ + weight · mean M_i`, packed.
    pub(super) fn with_mean(&self, weight: f64) -> Vec<f64> {
        self.prior.iter().zip(self.candidates.mean()).map(|(a, b)| a + weight * b).collect()
    }

    /// The error that names the combination of the parameters that a selection knows least.
    pub fn unobservable(&self, selected: &[usize]) -> SelectionError {
        self.least_known(&self.total(selected), selected.len())
    }

    /// As [`Instance::unobservable`] for a packed total of `count` views.
    pub(super) fn least_known(&self, total: &[f64], count: usize) -> SelectionError {
        let M = unpack(total, self.order());
        // Scaled by what all candidates know of each parameter, so that units do not decide.
        let everything = unpack(&self.with_mean(self.candidates.len() as f64), self.order());
        let scale = everything.diagonal().map(|m| if m > 0.0 { m.sqrt().recip() } else { 1.0 });
        let eigen = DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] * scale[i] * scale[j]).symmetric_eigen();
        let weakest = eigen.eigenvectors.column(eigen.eigenvalues.imin()).component_mul(&scale);
        let largest = weakest[weakest.iamax()];
        SelectionError::Unobservable { count, combination: (weakest / largest).iter().copied().collect() }
    }
}
