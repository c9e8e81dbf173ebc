//! Certificates: how good any selection can be at most.

use super::error::SelectionError;
use super::function::Gradient;
use super::group::Group;
use super::instance::Instance;
use super::packed::packed_len;

/// A matrix Y that proves a bound on every selection.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Y ⪰ 0, p×p packed; of several terms one after the other.
    pub y: Vec<f64>,
    /// The mixture λ of a worst variance; empty for other functions.
    pub mixture: Vec<f64>,
    /// Prices ≥ 0 of the groups that bind.
    pub prices: Vec<(Group, f64)>,
    /// No selection has a greater log Φ.
    pub log_bound: f64,
}

/// Allowance for the rounding of the polar function and the logarithms; that of the scores is bounded term by term.
const ROUNDING: f64 = 1e-12;

impl Certificate {
    /// The bound that Y ⪰ 0 and prices u ≥ 0 prove for the instance: with the scores `s_i = ⟨Y, M_i⟩` of **all** candidates,
    /// less the prices of the groups that i counts in,
    ///
    /// ```text
    /// S = ⟨Y, M₀⟩ + the scores of the required + the largest others, k in all + Σ u_g m_g
    /// ```
    ///
    /// and every allowed selection has `Φ(M) ≤ S / Φ°(Y)`. Groups without prices are left out of the bound, which holds for
    /// more selections then and so for the allowed ones too; separations enter by the [balls](Group::Ball) that they imply.
    ///
    /// Wherever Y came from, the bound is evaluated here in plain arithmetic; a poor Y only makes it loose.
    ///
    /// ```
    /// use calipose::selection::{Certificate, Gradient, InformationFunction, InformationSet, Instance};
    /// use nalgebra::DMatrix;
    ///
    /// // One parameter, three views, two to choose: with Y = 1 the best two add up to 5.
    /// let views = InformationSet::from_matrices(1, &[1.0, 2.0, 3.0].map(|m| DMatrix::from_element(1, 1, m)))?;
    /// let instance = Instance::new(&views, None, &InformationFunction::Determinant, 2)?;
    /// let certificate = Certificate::new(&instance, Gradient::new(&[DMatrix::identity(1, 1)], vec![]), vec![])?;
    /// assert!((certificate.log_bound.exp() - 5.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When Y is of another length than the terms' packed matrices, or a price is of no group.
    pub fn new(instance: &Instance, gradient: Gradient, prices: Vec<(Group, f64)>) -> Result<Self, SelectionError> {
        fits(instance, &gradient.y, &prices)?;
        let reduced = instance.rules().reduced(&instance.scores(&gradient.y), &prices);
        Ok(Self::from_reduced(instance, gradient, prices, &reduced))
    }

    /// As [`Certificate::new`] with the scores less the prices at hand.
    pub(super) fn from_reduced(
        instance: &Instance,
        gradient: Gradient,
        prices: Vec<(Group, f64)>,
        reduced: &[f64],
    ) -> Self {
        let rules = instance.rules();
        let dual = instance.dual(&gradient.y);
        let (counted, _) = rules.greatest(reduced, instance.count());
        // Rounding of the scores that count: the terms may cancel, and so may the prices.
        let terms = counted.iter().flat_map(|&i| instance.products(&dual, i).map(f64::abs));
        let paid = prices.iter().map(|&(group, price)| {
            let times = rules.counted(&counted, group).len();
            price * (times + rules.most(group)) as f64
        });
        let operations = dual.len() + prices.len() + counted.len();
        let rounding = operations as f64 * f64::EPSILON * (terms.sum::<f64>() + paid.sum::<f64>());
        let known: f64 = instance.prior().iter().zip(&dual).map(|(m, y)| m * y).sum();
        let capped: f64 = prices.iter().map(|&(group, price)| price * rules.most(group) as f64).sum();
        let mut greatest: Vec<f64> = counted.iter().map(|&i| reduced[i]).collect();
        // Sorted, so that the sum does not depend on how the candidates are numbered.
        greatest.sort_unstable_by(f64::total_cmp);
        let S = rounding + known + capped + greatest.iter().sum::<f64>();
        let log_bound = S.ln() - instance.log_polar(&gradient) + ROUNDING;
        let log_bound = if log_bound.is_nan() { f64::INFINITY } else { log_bound };
        Self { y: gradient.y, mixture: gradient.mixture, prices, log_bound }
    }

    /// Checks that the certificate is of the instance's shape.
    pub(super) fn fits(&self, instance: &Instance) -> Result<(), SelectionError> {
        fits(instance, &self.y, &self.prices)
    }

    /// The candidates that a selection of log Φ above `log_value` may hold, ascending, each with its score less the prices of
    /// its groups: the required ones, those whose scores add up to S, and those whose score is not so much less than the last
    /// of these that the bound, with them forced in, falls to `log_value`.
    pub(crate) fn open_above(&self, instance: &Instance, log_value: f64) -> Vec<(usize, f64)> {
        let rules = instance.rules();
        let reduced = rules.reduced(&instance.scores(&self.y), &self.prices);
        let (counted, least) = rules.greatest(&reduced, instance.count());
        let gradient = Gradient { y: self.y.clone(), mixture: self.mixture.clone() };
        // Not a number where Y bounds nothing, which excludes nothing.
        let S = (self.log_bound + instance.log_polar(&gradient)).exp();
        let bound_with = |i: usize| self.log_bound + (1.0 - (least - reduced[i]).max(0.0) / S).max(0.0).ln();
        let reaches = |i: usize| S.is_nan() || bound_with(i) > log_value;
        let is_open = |i: usize| (instance.is_open(i) && reaches(i)) || counted.binary_search(&i).is_ok();
        (0..instance.len()).filter(|&i| is_open(i)).map(|i| (i, reduced[i])).collect()
    }

    /// The share of the best possible Φ that a selection with this log Φ certainly reaches.
    pub fn efficiency(&self, log_value: f64) -> f64 {
        (log_value - self.log_bound).exp()
    }
}

/// Checks that Y and the prices are of the instance's shape.
fn fits(instance: &Instance, y: &[f64], prices: &[(Group, f64)]) -> Result<(), SelectionError> {
    let (expected, found) = (instance.orders().map(packed_len).sum(), y.len());
    if found != expected {
        return Err(SelectionError::Length { what: "matrix Y", expected, found });
    }
    if let Some(&(group, _)) = prices.iter().find(|&&(group, _)| !instance.rules().has(group)) {
        return Err(SelectionError::NoSuchGroup { group });
    }
    Ok(())
}
