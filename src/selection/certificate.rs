//! Certificates: how good any selection can be at most.

use super::instance::Instance;

/// A matrix Y that proves a bound on every selection.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Y ⪰ 0, p×p packed.
    pub y: Vec<f64>,
    /// No selection has a greater log Φ.
    pub log_bound: f64,
}

/// Allowance for the rounding of the polar function and the logarithms; that of the scores is bounded term by term.
const ROUNDING: f64 = 1e-12;

impl Certificate {
    /// The bound that packed Y ⪰ 0 proves for the instance: with the scores `s_i = ⟨Y, M_i⟩` of **all** candidates,
    /// `S = ⟨Y, M₀⟩ +` the sum of the k largest, every selection of k has `Φ(M) ≤ S / Φ°(Y)`.
    ///
    /// Wherever Y came from, the bound is evaluated here in plain arithmetic; a poor Y only makes it loose.
    pub fn new(instance: &Instance, y: Vec<f64>) -> Self {
        let scores = instance.scores(&y);
        Self::from_scores(instance, y, &scores)
    }

    /// As [`Certificate::new`] with the scores at `y` at hand.
    pub(super) fn from_scores(instance: &Instance, y: Vec<f64>, scores: &[f64]) -> Self {
        let p = instance.order();
        let prior = crate::information::packed::dual(y.clone(), p);
        let known: f64 = prior.iter().zip(instance.prior()).map(|(y, m)| y * m).sum();
        // Rounding of the scores that count: q products each, whose terms may cancel.
        let least = kth_largest(scores, instance.count());
        let counted = (0..scores.len()).filter(|&i| scores[i] >= least);
        let terms =
            counted.flat_map(|i| instance.candidates().packed(i).iter().zip(&prior).map(|(m, y)| (m * y).abs()));
        let rounding = prior.len() as f64 * f64::EPSILON * terms.sum::<f64>();
        let S = rounding + known + sum_of_largest(scores.to_vec(), instance.count());
        let log_bound = S.ln() - instance.function().log_polar(&y, p) + ROUNDING;
        Self { y, log_bound: if log_bound.is_nan() { f64::INFINITY } else { log_bound } }
    }

    /// The share of the best possible Φ that a selection with this log Φ certainly reaches.
    pub fn efficiency(&self, log_value: f64) -> f64 {
        (log_value - self.log_bound).exp()
    }
}

/// The `count`-th largest number.
fn kth_largest(numbers: &[f64], count: usize) -> f64 {
    *numbers.to_vec().select_nth_unstable_by(count - 1, |a, b| b.total_cmp(a)).1
}

/// Sum of the `count` largest numbers.
pub(super) fn sum_of_largest(mut numbers: Vec<f64>, count: usize) -> f64 {
    if count < numbers.len() {
        numbers.select_nth_unstable_by(count, |a, b| b.total_cmp(a));
        numbers.truncate(count);
    }
    // Sorted, so that the sum does not depend on how the selection left them.
    numbers.sort_unstable_by(f64::total_cmp);
    numbers.iter().sum()
}
