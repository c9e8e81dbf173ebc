//! The selection problem.

mod constraints;
mod packing;
mod part;
mod value;

pub use constraints::{Cap, Constraints, Separation};
pub(super) use packing::{EFFORT, packing};
pub(crate) use part::Part;
pub(super) use value::InstanceCurvature;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::InformationSet;
use super::error::SelectionError;
use super::function::{Gradient, InformationFunction};
use super::group::Group;
use super::packed::{RESOLUTION, cholesky, dual, packed_len, unpack, whiten};
pub(crate) use constraints::Rules;

/// Choose `count` of the candidates so that Φ of their total information is greatest.
///
/// The objective has one term or several: `log Φ = Σ λ_t log Φ_t(M_t)`, the weighted geometric mean of information functions
/// of different matrices of the same candidates, which is an information function of all the blocks `M_t` together. With
/// `Y = (λ_t Y_t)` its polar function is `Φ°(Y) = Π (Φ°_t(Y_t))^λ_t`.
///
/// There may be several scenarios, each with terms of its own; then Φ is the least of theirs, `min_s Φ_s`, and its polar
/// function the sum of theirs: `⟨Y, M⟩ ≥ Σ_s Φ_s(M) Φ°_s(Y_s) ≥ Φ(M) Σ_s Φ°_s(Y_s)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance<'a> {
    /// Of all scenarios, one after the other.
    blocks: Vec<Block<'a>>,
    /// The blocks of each scenario.
    scenarios: Vec<Range<usize>>,
    /// Of the least over the scenarios; 0 for the least itself.
    softness: f64,
    count: usize,
    rules: Arc<Rules>,
}

/// One term of an objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term<'a> {
    /// The candidates' p×p matrices.
    pub candidates: &'a InformationSet,
    /// The p×p information M₀ already at hand, or `None`.
    pub prior: Option<&'a DMatrix<f64>>,
    /// What is great of it.
    pub function: &'a InformationFunction,
    /// Share λ of its scenario's objective; the shares add up to one.
    pub share: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Block<'a> {
    candidates: &'a InformationSet,
    prior: Vec<f64>,
    function: InformationFunction,
    share: f64,
    /// Its entries among those of all blocks.
    place: Range<usize>,
}

impl Block<'_> {
    fn order(&self) -> usize {
        self.candidates.order()
    }
}

impl<'a> Instance<'a> {
    /// An instance with one term and no constraints; `prior` is the p×p information M₀ already at hand, or `None`.
    ///
    /// ```
    /// use calipose::selection::{InformationFunction, InformationSet, Instance, SelectionError};
    /// use nalgebra::DMatrix;
    ///
    /// let views = InformationSet::from_matrices(2, &[DMatrix::identity(2, 2), DMatrix::identity(2, 2)])?;
    /// let instance = Instance::new(&views, None, &InformationFunction::Determinant, 1)?;
    /// assert_eq!((instance.len(), instance.count()), (2, 1));
    /// let prior = DMatrix::identity(3, 3);
    /// let refused = Instance::new(&views, Some(&prior), &InformationFunction::Determinant, 1).unwrap_err();
    /// assert_eq!(refused, SelectionError::Order { what: "prior", expected: 2, found: 3 });
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Instance::constrained`].
    pub fn new(
        candidates: &'a InformationSet,
        prior: Option<&'a DMatrix<f64>>,
        function: &'a InformationFunction,
        count: usize,
    ) -> Result<Self, SelectionError> {
        Self::constrained(&[Term { candidates, prior, function, share: 1.0 }], count, Constraints::default())
    }

    /// An instance with any terms and constraints.
    ///
    /// # Errors
    /// When `count` is 0 or above the number of candidates, the terms do not fit each other, an order does not fit, a prior is
    /// no information matrix, a weight is zero or not finite, the constraints contradict each other, or all candidates
    /// together leave a combination of the parameters undetermined.
    pub fn constrained(terms: &[Term<'a>], count: usize, constraints: Constraints) -> Result<Self, SelectionError> {
        Self::of_scenarios(&[terms.to_vec()], count, constraints)
    }

    /// An instance of the terms of several scenarios, of which the least counts.
    ///
    /// ```
    /// use calipose::selection::{Constraints, InformationFunction, InformationSet, Instance, Term};
    /// use nalgebra::DMatrix;
    ///
    /// // Three views of one parameter, which tell 4, 1 and 2 in one scenario and nothing, 1 and 2 in another.
    /// let views = |told: [f64; 3]| InformationSet::from_matrices(1, &told.map(|m| DMatrix::from_element(1, 1, m)));
    /// let scenarios = [views([4.0, 1.0, 2.0])?, views([0.0, 1.0, 2.0])?];
    /// let function = InformationFunction::Determinant;
    /// let terms = scenarios.each_ref().map(|candidates| vec![Term { candidates, prior: None, function: &function, share: 1.0 }]);
    /// let instance = Instance::of_scenarios(&terms, 2, Constraints::default())?;
    /// assert!((instance.log_value(&[0, 2])?.exp() - 2.0).abs() < 1e-12);
    /// assert!((instance.log_value(&[1, 2])?.exp() - 3.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Instance::constrained`].
    pub fn of_scenarios(
        scenarios: &[Vec<Term<'a>>],
        count: usize,
        constraints: Constraints,
    ) -> Result<Self, SelectionError> {
        let candidates = scenarios.iter().flatten().next().map_or(0, |term| term.candidates.len());
        Self::under(scenarios, count, Arc::new(Rules::new(constraints, candidates)?))
    }

    /// As [`Instance::of_scenarios`], under rules of so many candidates.
    pub(crate) fn under(scenarios: &[Vec<Term<'a>>], count: usize, rules: Arc<Rules>) -> Result<Self, SelectionError> {
        let terms = || scenarios.iter().flatten();
        let candidates: Vec<usize> = terms().map(|term| term.candidates.len()).collect();
        let n = candidates.first().copied().unwrap_or(0);
        let positive = terms().all(|term| term.share > 0.0);
        let sum = |terms: &Vec<Term>| terms.iter().map(|term| term.share).sum::<f64>();
        let odd = scenarios.iter().map(sum).find(|shares| (shares - 1.0).abs() > 1e-9);
        if candidates.iter().any(|&other| other != n) || !positive || odd.is_some() || scenarios.is_empty() {
            let shares = odd.or(scenarios.first().map(sum)).unwrap_or(0.0);
            return Err(SelectionError::Terms { candidates, shares });
        }
        if count == 0 || count > n {
            return Err(SelectionError::Count { count, candidates: n });
        }
        let mut blocks = Vec::with_capacity(candidates.len());
        let mut start = 0;
        for term in terms() {
            let end = start + packed_len(term.candidates.order());
            blocks.push(Block {
                candidates: term.candidates,
                prior: checked_prior(term)?,
                function: checked_function(term)?,
                share: term.share,
                place: start..end,
            });
            start = end;
        }
        let mut first = 0;
        let places = scenarios.iter().map(|terms| {
            let place = first..first + terms.len();
            first = place.end;
            place
        });
        rules.check_count(count, n)?;
        let instance = Self { blocks, scenarios: places.collect(), softness: 0.0, count, rules };
        let everything = instance.everything();
        if instance.log_value_at(&everything) == f64::NEG_INFINITY {
            return Err(instance.least_known(&everything, n));
        }
        Ok(instance)
    }

    /// The same problem with every function [softened](InformationFunction::softened), and the least over the scenarios too.
    #[must_use]
    pub fn softened(&self, softness: f64) -> Self {
        let mut softened = self.clone();
        for block in &mut softened.blocks {
            block.function = block.function.softened(softness);
        }
        softened.softness = softness;
        softened
    }

    /// The same problem with `weight` average views known beforehand.
    pub(crate) fn with_known_mean(&self, weight: f64) -> Self {
        let mut known = self.clone();
        for block in &mut known.blocks {
            for (prior, mean) in block.prior.iter_mut().zip(block.candidates.mean()) {
                *prior += weight * mean;
            }
        }
        known
    }

    /// Whether log Φ has derivatives wherever it is finite.
    pub fn is_smooth(&self) -> bool {
        (self.scenarios.len() == 1 || self.softness > 0.0) && self.blocks.iter().all(|block| block.function.is_smooth())
    }

    /// The same problem for another number of candidates.
    ///
    /// # Errors
    /// When so many cannot be selected.
    pub fn with_count(&self, count: usize) -> Result<Self, SelectionError> {
        self.rules.check_count(count, self.len())?;
        Ok(Self { count, ..self.clone() })
    }

    /// Number n of candidates.
    pub fn len(&self) -> usize {
        self.blocks[0].candidates.len()
    }

    /// Whether there is no candidate; never, for [`Instance::new`] refuses that.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of candidates to select.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Orders p of the terms' matrices.
    pub fn orders(&self) -> impl Iterator<Item = usize> {
        self.blocks.iter().map(Block::order)
    }

    /// Candidates that every selection holds, ascending.
    pub fn required(&self) -> &[usize] {
        &self.rules.required
    }

    /// Whether candidate `i` may be chosen: neither required nor forbidden.
    pub fn is_open(&self, i: usize) -> bool {
        self.rules.is_open(i)
    }

    /// The caps given.
    pub fn caps(&self) -> &[Cap] {
        &self.rules.caps
    }

    pub(crate) fn rules(&self) -> &Rules {
        &self.rules
    }

    /// `M₀ + Σ M_i` of a selection, term after term, packed.
    pub(crate) fn total(&self, selected: &[usize]) -> Vec<f64> {
        let mut total = self.prior();
        for &i in selected {
            self.add_to(&mut total, i, 1.0);
        }
        total
    }

    /// `total += weight · M_i`.
    pub(crate) fn add_to(&self, total: &mut [f64], i: usize, weight: f64) {
        for block in &self.blocks {
            block.candidates.add_to(&mut total[block.place.clone()], i, weight);
        }
    }

    /// Checks that what a caller selected are candidates, each of them once.
    pub(crate) fn check(&self, selected: &[usize]) -> Result<(), SelectionError> {
        let mut is_in = vec![false; self.len()];
        for &candidate in selected {
            let place = is_in.get_mut(candidate);
            let place = place.ok_or(SelectionError::OutOfRange { candidate, candidates: self.len() })?;
            if std::mem::replace(place, true) {
                return Err(SelectionError::Twice { candidate });
            }
        }
        Ok(())
    }

    /// Whether a selection leaves a combination of the parameters undetermined.
    pub(crate) fn is_singular(&self, selected: &[usize]) -> bool {
        self.log_value_at(&self.total(selected)) == f64::NEG_INFINITY
    }

    /// log Φ of a selection; −∞ if it leaves a combination of the parameters undetermined, to working precision.
    ///
    /// # Errors
    /// When the selection names a candidate twice, or one that does not exist.
    pub fn log_value(&self, selected: &[usize]) -> Result<f64, SelectionError> {
        self.check(selected)?;
        Ok(self.log_value_at(&self.total(selected)))
    }

    /// The gradient of log Φ at a selection, for a [`Certificate`](super::Certificate).
    ///
    /// # Errors
    /// When the selection names a candidate twice, or one that does not exist, or leaves a combination of the parameters
    /// undetermined.
    pub fn gradient(&self, selected: &[usize]) -> Result<Gradient, SelectionError> {
        self.check(selected)?;
        self.gradient_at(&self.total(selected)).ok_or_else(|| self.unobservable(selected))
    }

    /// Scores `⟨Y, M_i⟩` of all candidates.
    pub(crate) fn scores(&self, y: &[f64]) -> Vec<f64> {
        let mut scores = vec![0.0; self.len()];
        for block in &self.blocks {
            block.candidates.add_scores(&y[block.place.clone()], &mut scores);
        }
        scores
    }

    /// Scores of all candidates by each of several matrices Y.
    pub(crate) fn scores_by_each(&self, ys: &[&[f64]]) -> Vec<Vec<f64>> {
        let mut scores = vec![vec![0.0; self.len()]; ys.len()];
        for block in &self.blocks {
            let ys: Vec<&[f64]> = ys.iter().map(|y| &y[block.place.clone()]).collect();
            block.candidates.add_scores_by_each(&ys, &mut scores);
        }
        scores
    }

    /// Scores `⟨Y, M_i⟩` of some candidates.
    pub(crate) fn scores_of(&self, y: &[f64], candidates: &[usize]) -> Vec<f64> {
        let dual = self.dual(y);
        candidates.iter().map(|&i| self.products(&dual, i).sum()).collect()
    }

    /// Y with doubled off-diagonal entries, whose dot product with a packed M is `⟨Y, M⟩`.
    pub(crate) fn dual(&self, y: &[f64]) -> Vec<f64> {
        let blocks = self.blocks.iter().map(|block| dual(y[block.place.clone()].to_vec(), block.order()));
        blocks.flatten().collect()
    }

    /// The products that add up to the score of candidate `i`, from [`Instance::dual`].
    pub(crate) fn products(&self, dual: &[f64], i: usize) -> impl Iterator<Item = f64> {
        let blocks = self.blocks.iter();
        blocks.flat_map(move |block| {
            block.candidates.packed(i).iter().zip(&dual[block.place.clone()]).map(|(m, y)| m * y)
        })
    }

    /// The least c with `Y ⪯ c·Y'`, Y' being `before`, a little rounded up; infinite if Y' is singular.
    pub(crate) fn growth(&self, before: &[f64], y: &[f64]) -> f64 {
        let growth = |block: &Block| {
            let p = block.order();
            let mut l = before[block.place.clone()].to_vec();
            if !cholesky(&mut l, p) {
                return f64::INFINITY;
            }
            let mut relative = y[block.place.clone()].to_vec();
            whiten(&l, p, &mut relative);
            unpack(&relative, p).symmetric_eigenvalues().max() * (1.0 + 1e-9)
        };
        self.blocks.iter().map(growth).fold(0.0, f64::max)
    }

    /// M₀ of the terms.
    pub(crate) fn prior(&self) -> Vec<f64> {
        self.blocks.iter().flat_map(|block| block.prior.iter().copied()).collect()
    }

    /// `M₀ + weight · mean M_i`.
    pub(crate) fn with_mean(&self, weight: f64) -> Vec<f64> {
        let mean = |block: &Block| block.candidates.mean();
        let means = self
            .blocks
            .iter()
            .flat_map(|block| block.prior.iter().zip(mean(block)).map(|(m, x)| m + weight * x).collect::<Vec<_>>());
        means.collect()
    }

    /// What all candidates that may be selected tell together.
    fn everything(&self) -> Vec<f64> {
        if self.rules.allows_all() {
            return self.with_mean(self.len() as f64);
        }
        let mut everything = self.total(self.required());
        for i in (0..self.len()).filter(|&i| self.is_open(i)) {
            self.add_to(&mut everything, i, 1.0);
        }
        everything
    }

    /// Whether a parameter is in nothing that is known or `open`.
    pub(crate) fn leaves_nothing_known(&self, known: &[f64], open: &[usize]) -> bool {
        let total = self.with_all(known, open);
        self.diagonal().any(|place| total[place] <= 0.0)
    }

    /// What is known and as much more of each parameter as rounding hides in the information of all `open`, so that it is
    /// regular.
    pub(crate) fn resolved(&self, known: &[f64], open: &[usize]) -> Vec<f64> {
        let total = self.with_all(known, open);
        let mut resolved = known.to_vec();
        let share = 4.0 * self.orders().max().unwrap_or(1) as f64 * RESOLUTION;
        for place in self.diagonal() {
            resolved[place] += share * total[place];
        }
        resolved
    }

    fn with_all(&self, known: &[f64], open: &[usize]) -> Vec<f64> {
        let mut total = known.to_vec();
        for &i in open {
            self.add_to(&mut total, i, 1.0);
        }
        total
    }

    /// Places of the diagonal entries in a total.
    fn diagonal(&self) -> impl Iterator<Item = usize> {
        self.blocks.iter().flat_map(|block| (0..block.order()).map(|j| block.place.start + packed_len(j) + j))
    }

    /// Whether the ranks of the matrices allow that so many determine all parameters.
    pub(crate) fn can_be_regular(&self) -> bool {
        self.blocks.iter().all(|block| {
            let p = block.order();
            let greatest = (0..self.len()).map(|i| rank(block.candidates.packed(i), p)).max().unwrap_or(0);
            rank(&block.prior, p) + self.count * greatest >= p
        })
    }

    /// The error that names the combination of the parameters that a selection knows least.
    pub(crate) fn unobservable(&self, selected: &[usize]) -> SelectionError {
        self.least_known(&self.total(selected), selected.len())
    }

    /// As [`Instance::unobservable`] for a total of `count` views.
    pub(crate) fn least_known(&self, total: &[f64], count: usize) -> SelectionError {
        let everything = self.with_mean(self.len() as f64);
        let weakest = self.blocks.iter().enumerate().map(|(term, block)| {
            let M = unpack(&total[block.place.clone()], block.order());
            // Scaled by what all candidates know of each parameter, so that units do not decide.
            let everything = unpack(&everything[block.place.clone()], block.order());
            let scale = everything.diagonal().map(|m| if m > 0.0 { m.sqrt().recip() } else { 1.0 });
            let scaled = DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] * scale[i] * scale[j]);
            let eigen = scaled.symmetric_eigen();
            let weakest = eigen.eigenvectors.column(eigen.eigenvalues.imin()).component_mul(&scale);
            let largest = weakest[weakest.iamax()];
            let combination = (weakest / largest).iter().copied().collect();
            (eigen.eigenvalues.min(), SelectionError::Unobservable { count, term, combination })
        });
        let least = weakest.min_by(|a, b| a.0.total_cmp(&b.0));
        least.map_or(SelectionError::Count { count, candidates: self.len() }, |(_, error)| error)
    }
}

/// The rank of a packed positive semidefinite matrix: its eigenvalues that are not rounding once the diagonal is scaled to one.
fn rank(packed: &[f64], p: usize) -> usize {
    let M = unpack(packed, p);
    let scale = M.diagonal().map(|m| if m > 0.0 { m.sqrt().recip() } else { 0.0 });
    let scaled = DMatrix::from_fn(p, p, |i, j| M[(i, j)] * scale[i] * scale[j]);
    scaled.symmetric_eigenvalues().iter().filter(|&&λ| λ > RESOLUTION).count()
}

fn checked_prior(term: &Term) -> Result<Vec<f64>, SelectionError> {
    let p = term.candidates.order();
    let Some(prior) = term.prior else { return Ok(vec![0.0; packed_len(p)]) };
    for found in [prior.nrows(), prior.ncols()] {
        if found != p {
            return Err(SelectionError::Order { what: "prior", expected: p, found });
        }
    }
    let checked = InformationSet::from_matrices(p, [prior]).map_err(SelectionError::Prior)?;
    Ok(checked.packed(0).to_vec())
}

fn checked_function(term: &Term) -> Result<InformationFunction, SelectionError> {
    let p = term.candidates.order();
    let nuisance = term.function.nuisance();
    if nuisance >= p {
        return Err(SelectionError::Order { what: "nuisance", expected: p - 1, found: nuisance });
    }
    let factors = term.function.factors();
    let own = if let InformationFunction::Eliminated { of, .. } = term.function { of } else { term.function };
    if factors.is_empty() && matches!(own, InformationFunction::WorstVariance { .. }) {
        return Err(SelectionError::Weight);
    }
    for factor in factors {
        if factor.nrows() != p - nuisance {
            return Err(SelectionError::Order { what: "weight", expected: p - nuisance, found: factor.nrows() });
        }
        if factor.is_empty() || factor.iter().any(|entry| !entry.is_finite()) {
            return Err(SelectionError::Weight);
        }
    }
    Ok(term.function.clone())
}
