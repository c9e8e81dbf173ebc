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
//!
//! Two functions are least values and have kinks. [`InformationFunction::softened`] gives each a smooth stand-in that is an
//! information function too, for algorithms that need derivatives; bounds are proven for the function itself.

mod curvature;
mod eliminated;
mod soft_minimum;

pub(crate) use curvature::Curvature;
pub(crate) use soft_minimum::LogSoftMinimum;

use nalgebra::DMatrix;

use super::lanes::{self, LANES, Lanes};
use super::packed::{
    cholesky, inverse_of_factor, is_resolved, log_det, log_det_of, pack, packed_len, solve_lower,
    solve_lower_transposed, unpack,
};
use eliminated::{Eliminated, without_nuisance};
use soft_minimum::SoftMinimum;

/// An information function of p×p matrices.
#[derive(Debug, Clone, PartialEq)]
pub enum InformationFunction {
    /// `Φ(M) = det(M)^(1/p)`, criterion `d`; `Φ°(Y) = p det(Y)^(1/p)`.
    Determinant,
    /// `Φ(M) = 1 / tr(Lᵀ M⁻¹ L)`, criteria `a` and `v`, with the p×r factor L of the weight `W = L Lᵀ`;
    /// `Φ°(Y) = (tr (Lᵀ Y L)^½)²`.
    Variance(DMatrix<f64>),
    /// `Φ(M) = λ_min(M)`, criteria `e` and `zhang`; `Φ°(Y) = tr Y`.
    MinEigenvalue {
        /// 0 for the function itself; up to 1 for its stand-in.
        softness: f64,
    },
    /// `Φ(M) = min_j 1 / tr(L_jᵀ M⁻¹ L_j)`: all of several accuracies at once. For any mixture λ ≥ 0 that adds up to 1, it is at
    /// most the variance function of `W = Σ λ_j L_j L_jᵀ`, whose polar function serves.
    WorstVariance {
        /// The factors `L_j`, each of p rows.
        factors: Vec<DMatrix<f64>>,
        /// 0 for the function itself; up to 1 for its stand-in.
        softness: f64,
    },
    /// `Φ(S)` of the Schur complement S of the first parameters: what is known of the others where these are estimated beside
    /// them and nobody asks for their values.
    Eliminated {
        /// How many they are.
        nuisance: usize,
        /// Φ.
        of: Box<InformationFunction>,
    },
}

/// The gradient of log Φ.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// Y, packed.
    pub y: Vec<f64>,
    /// The mixture λ of a worst variance at which Y is the gradient of the variance function; empty for other functions.
    pub mixture: Vec<f64>,
}

impl Gradient {
    /// Of the p×p matrix Y of each term.
    pub fn new(y: &[DMatrix<f64>], mixture: Vec<f64>) -> Self {
        Self { y: y.iter().flat_map(pack).collect(), mixture }
    }
}

impl InformationFunction {
    /// The variance function of a positive semidefinite p×p weight W.
    pub fn variance(weight: &DMatrix<f64>) -> Self {
        InformationFunction::Variance(factor(weight))
    }

    /// The least eigenvalue.
    pub fn min_eigenvalue() -> Self {
        InformationFunction::MinEigenvalue { softness: 0.0 }
    }

    /// The least of the variance functions of positive semidefinite p×p weights.
    pub fn worst_variance<'a>(weights: impl IntoIterator<Item = &'a DMatrix<f64>>) -> Self {
        InformationFunction::WorstVariance { factors: weights.into_iter().map(factor).collect(), softness: 0.0 }
    }

    /// The same of the parameters but the first `nuisance`, which are estimated beside them.
    #[must_use]
    pub fn beside(self, nuisance: usize) -> Self {
        match self {
            function if nuisance == 0 => function,
            InformationFunction::Eliminated { nuisance: others, of } => {
                InformationFunction::Eliminated { nuisance: nuisance + others, of }
            }
            function => InformationFunction::Eliminated { nuisance, of: Box::new(function) },
        }
    }

    /// The factors of its weights; none where it has no weights.
    pub(super) fn factors(&self) -> &[DMatrix<f64>] {
        match self {
            InformationFunction::Determinant | InformationFunction::MinEigenvalue { .. } => &[],
            InformationFunction::Variance(factor) => std::slice::from_ref(factor),
            InformationFunction::WorstVariance { factors, .. } => factors,
            InformationFunction::Eliminated { of, .. } => of.factors(),
        }
    }

    /// How many variances it mixes: the length of [`Gradient::mixture`].
    pub(super) fn mixed(&self) -> usize {
        match self {
            InformationFunction::WorstVariance { factors, .. } => factors.len(),
            InformationFunction::Eliminated { of, .. } => of.mixed(),
            _ => 0,
        }
    }

    /// How many of its parameters, the first, are a nuisance.
    pub fn nuisance(&self) -> usize {
        if let InformationFunction::Eliminated { nuisance, .. } = self { *nuisance } else { 0 }
    }

    /// Whether log Φ has derivatives wherever it is finite.
    pub fn is_smooth(&self) -> bool {
        match self {
            InformationFunction::Determinant | InformationFunction::Variance(_) => true,
            InformationFunction::MinEigenvalue { softness } | InformationFunction::WorstVariance { softness, .. } => {
                *softness > 0.0
            }
            InformationFunction::Eliminated { of, .. } => of.is_smooth(),
        }
    }

    /// The smooth stand-in of a function with kinks at `0 < softness < 1`, the function itself as it tends to 0; others as
    /// they are.
    #[must_use]
    pub fn softened(&self, softness: f64) -> Self {
        match self {
            InformationFunction::MinEigenvalue { .. } => InformationFunction::MinEigenvalue { softness },
            InformationFunction::WorstVariance { factors, .. } => {
                InformationFunction::WorstVariance { factors: factors.clone(), softness }
            }
            InformationFunction::Eliminated { nuisance, of } => of.softened(softness).beside(*nuisance),
            smooth => smooth.clone(),
        }
    }

    /// `log Φ(M)` of a packed matrix of order p, which serves as work space; −∞ if M is singular to working precision.
    pub(crate) fn log_value(&self, m: &mut [f64], p: usize) -> f64 {
        match self {
            InformationFunction::MinEigenvalue { softness } => {
                let M = unpack(m, p);
                if !factored(m, p) {
                    return f64::NEG_INFINITY;
                }
                let λ = M.symmetric_eigenvalues();
                if is_above_rounding(λ.as_slice()) { least(λ.as_slice(), *softness) } else { f64::NEG_INFINITY }
            }
            _ if !factored(m, p) => f64::NEG_INFINITY,
            InformationFunction::Determinant => log_det(m, p) / p as f64,
            InformationFunction::Variance(factor) => -variance(factor, m, p).ln(),
            InformationFunction::WorstVariance { factors, softness } => {
                let values: Vec<f64> = factors.iter().map(|factor| variance(factor, m, p).recip()).collect();
                least(&values, *softness)
            }
            InformationFunction::Eliminated { nuisance, of } => {
                of.log_value(&mut Eliminated::new(m, p, *nuisance).S, p - nuisance)
            }
        }
    }

    /// [`InformationFunction::log_value`] of several matrices at once, to the same bits; they serve as work space. A value that does
    /// not exceed `above` may be −∞ instead.
    pub(crate) fn log_values(&self, m: &mut [Lanes], p: usize, above: f64) -> Lanes {
        let lane_of = |m: &[Lanes], lane: usize| m.iter().map(|entry| entry[lane]).collect::<Vec<f64>>();
        if let InformationFunction::MinEigenvalue { softness } = self {
            let candidates =
                if *softness == 0.0 && above.is_finite() { lanes::exceed(m, p, above.exp()) } else { [true; LANES] };
            return std::array::from_fn(|lane| {
                if candidates[lane] { self.log_value(&mut lane_of(m, lane), p) } else { f64::NEG_INFINITY }
            });
        }
        let (is_definite, is_clearly_resolved) = lanes::factor(m, p);
        let is_regular: [bool; LANES] = std::array::from_fn(|lane| {
            is_definite[lane] && (is_clearly_resolved[lane] || is_resolved(&lane_of(m, lane), p))
        });
        let variances = |factor: &DMatrix<f64>| lanes::variance(m, factor.as_slice(), p);
        let log_values = match self {
            InformationFunction::Determinant => {
                std::array::from_fn(|lane| log_det_of((0..p).map(|i| m[packed_len(i) + i][lane])) / p as f64)
            }
            InformationFunction::Variance(factor) => variances(factor).map(|variance| -variance.ln()),
            InformationFunction::WorstVariance { factors, softness } => {
                let variances: Vec<Lanes> = factors.iter().map(variances).collect();
                let value = |lane: usize| variances.iter().map(|each| each[lane].recip()).collect::<Vec<f64>>();
                std::array::from_fn(|lane| if is_regular[lane] { least(&value(lane), *softness) } else { f64::NAN })
            }
            InformationFunction::Eliminated { nuisance, of } => {
                let mut S = lanes::last_block(m, p, *nuisance);
                of.log_values(&mut S, p - nuisance, above)
            }
            InformationFunction::MinEigenvalue { .. } => [f64::NAN; LANES],
        };
        std::array::from_fn(|lane| if is_regular[lane] { log_values[lane] } else { f64::NEG_INFINITY })
    }

    /// The gradient Y of log Φ at packed M; where Φ has a kink one of its supergradients. `None` if M is singular.
    pub(crate) fn gradient(&self, m: &[f64], p: usize) -> Option<Gradient> {
        let mut l = m.to_vec();
        if !factored(&mut l, p) {
            return None;
        }
        let y = match self {
            InformationFunction::Determinant => inverse_of_factor(&l, p) / p as f64,
            InformationFunction::Variance(factor) => {
                let X = solved(&l, factor);
                &X * X.transpose() / (X.transpose() * unpack(m, p) * &X).trace()
            }
            InformationFunction::MinEigenvalue { softness } => {
                let eigen = unpack(m, p).symmetric_eigen();
                let λ = eigen.eigenvalues.as_slice();
                if !is_above_rounding(λ) {
                    return None;
                }
                let slopes = slopes(λ, *softness);
                let U = &eigen.eigenvectors;
                U * DMatrix::from_diagonal(&slopes.into()) * U.transpose()
            }
            InformationFunction::WorstVariance { factors, softness } => {
                let X: Vec<_> = factors.iter().map(|factor| solved(&l, factor)).collect(); // M⁻¹ L_j
                let values: Vec<f64> = factors.iter().map(|factor| variance(factor, &l, p).recip()).collect();
                // ∂Φ_j = Φ_j² M⁻¹ L_j L_jᵀ M⁻¹.
                let mut mixture: Vec<f64> =
                    slopes(&values, *softness).iter().zip(&values).map(|(slope, Φ)| slope * Φ * Φ).collect();
                let Y = X.iter().zip(&mixture).fold(DMatrix::zeros(p, p), |Y, (X, &λ)| Y + X * X.transpose() * λ);
                let sum: f64 = mixture.iter().sum();
                for λ in &mut mixture {
                    *λ /= sum;
                }
                return Some(Gradient { y: pack(&Y), mixture });
            }
            InformationFunction::Eliminated { nuisance, of } => {
                let left = Eliminated::new(&l, p, *nuisance);
                return Some(left.gradient(of.gradient(&left.S, p - nuisance)?));
            }
        };
        Some(Gradient { y: pack(&y), mixture: vec![] })
    }

    /// `log Φ°(Y)` of a packed positive semidefinite Y; −∞ where Φ° vanishes, which bounds nothing. Of a worst variance the
    /// polar function of its upper bound with this `mixture`, which others do not use; of a stand-in that of the function
    /// itself.
    pub(crate) fn log_polar(&self, y: &[f64], p: usize, mixture: &[f64]) -> f64 {
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
            InformationFunction::MinEigenvalue { .. } => unpack(y, p).trace().ln(),
            InformationFunction::WorstVariance { factors, .. } => {
                let sum: f64 = mixture.iter().sum();
                let usable = mixture.len() == factors.len() && mixture.iter().all(|&λ| λ >= 0.0) && sum > 0.0;
                if !usable {
                    return f64::NEG_INFINITY;
                }
                let scaled: Vec<_> = factors.iter().zip(mixture).map(|(L, λ)| L * (λ / sum).sqrt()).collect();
                let columns: Vec<_> = scaled.iter().flat_map(|L| L.column_iter()).collect();
                InformationFunction::Variance(DMatrix::from_columns(&columns)).log_polar(y, p, &[])
            }
            InformationFunction::Eliminated { nuisance, of } => {
                of.log_polar(&without_nuisance(y, p, *nuisance), p - nuisance, mixture)
            }
        }
    }

    /// The second derivative of log Φ at packed M; `None` if M is singular or Φ not smooth.
    pub(crate) fn curvature(&self, m: &[f64], p: usize) -> Option<Curvature> {
        if !self.is_smooth() {
            return None;
        }
        let mut l = m.to_vec();
        if !factored(&mut l, p) {
            return None;
        }
        match self {
            InformationFunction::Determinant => Some(Curvature::of_determinant(l, p)),
            InformationFunction::Variance(factor) => Some(Curvature::of_variance(l, factor)),
            InformationFunction::MinEigenvalue { softness } => {
                let eigen = unpack(m, p).symmetric_eigen();
                let λ = eigen.eigenvalues.as_slice();
                let soft = is_above_rounding(λ).then(|| SoftMinimum::new(λ, *softness))?;
                Some(Curvature::of_min_eigenvalue(eigen.eigenvectors, &soft))
            }
            InformationFunction::WorstVariance { factors, softness } => {
                let values: Vec<f64> = factors.iter().map(|factor| variance(factor, &l, p).recip()).collect();
                Some(Curvature::of_worst_variance(&l, factors, &values, &SoftMinimum::new(&values, *softness)))
            }
            InformationFunction::Eliminated { nuisance, of } => {
                let left = Eliminated::new(&l, p, *nuisance);
                let order = p - nuisance;
                Some(left.curvature(&of.curvature(&left.S, order)?, &of.gradient(&left.S, order)?))
            }
        }
    }
}

/// The t at which the soft least eigenvalue of packed M is that of `det(M − t·1)`; `None` if M is singular.
pub(crate) fn shift_of_soft_least(m: &[f64], p: usize, softness: f64) -> Option<f64> {
    let λ = unpack(m, p).symmetric_eigenvalues();
    is_above_rounding(λ.as_slice()).then(|| SoftMinimum::new(λ.as_slice(), softness).t)
}

/// Replaces packed M by its Cholesky factor; `false` if M is singular to working precision.
fn factored(m: &mut [f64], p: usize) -> bool {
    cholesky(m, p) && is_resolved(m, p)
}

/// Whether the least of a symmetric matrix's eigenvalues is more than the rounding of the greatest.
fn is_above_rounding(λ: &[f64]) -> bool {
    let least = λ.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = λ.iter().copied().fold(0.0, f64::max);
    least > 8.0 * λ.len() as f64 * f64::EPSILON * greatest
}

/// The logarithm of the least of positive numbers, or of their soft minimum; −∞ if one is not positive.
fn least(numbers: &[f64], softness: f64) -> f64 {
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    if least.is_nan() || least <= 0.0 {
        f64::NEG_INFINITY
    } else if softness > 0.0 {
        SoftMinimum::new(numbers, softness).log_value
    } else {
        least.ln()
    }
}

/// The derivatives of [`least`] by the numbers; where there is a kink, of the first of the least.
fn slopes(numbers: &[f64], softness: f64) -> Vec<f64> {
    if softness > 0.0 {
        return SoftMinimum::new(numbers, softness).slopes;
    }
    let least = (0..numbers.len()).min_by(|&i, &j| numbers[i].total_cmp(&numbers[j]));
    (0..numbers.len()).map(|i| if Some(i) == least { numbers[i].recip() } else { 0.0 }).collect()
}

/// L with `L Lᵀ = W`, p×r, of a positive semidefinite W.
fn factor(weight: &DMatrix<f64>) -> DMatrix<f64> {
    let p = weight.nrows();
    // In units that make the diagonal 1: those of k3 and fx are so unlike that W's small eigenvalues drown otherwise.
    let units = weight.diagonal().map(|w| if w > 0.0 { w.sqrt() } else { 1.0 });
    let eigen = DMatrix::from_fn(p, p, |i, j| weight[(i, j)] / (units[i] * units[j])).symmetric_eigen();
    // Eigenvalues of rounding's size are zero; as columns of L they would be noise that log Φ° takes for signal.
    let least = eigen.eigenvalues.max() * p as f64 * f64::EPSILON;
    let columns: Vec<_> = (0..p)
        .filter(|&j| eigen.eigenvalues[j] > least)
        .map(|j| eigen.eigenvectors.column(j).component_mul(&units) * eigen.eigenvalues[j].sqrt())
        .collect();
    DMatrix::from_fn(p, columns.len(), |i, j| columns[j][i])
}

/// `tr(Lᵀ M⁻¹ L)` with the packed Cholesky factor of M.
fn variance(factor: &DMatrix<f64>, l: &[f64], p: usize) -> f64 {
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
        solve_lower(l, p, column);
        variance += column.iter().map(|x| x * x).sum::<f64>();
    }
    variance
}

/// `M⁻¹ X` with the packed Cholesky factor of M.
fn solved(l: &[f64], X: &DMatrix<f64>) -> DMatrix<f64> {
    let mut X = X.clone();
    let p = X.nrows();
    for column in X.as_mut_slice().chunks_exact_mut(p) {
        solve_lower(l, p, column);
        solve_lower_transposed(l, p, column);
    }
    X
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256Plus;

    use super::*;
    use crate::selection::packed::packed_len;

    const P: usize = 4;

    fn functions() -> Vec<InformationFunction> {
        let W = DMatrix::from_row_slice(P, 2, &[1.0, 0.2, 0.0, 2.0, -1.0, 0.3, 0.5, 0.0]);
        vec![
            InformationFunction::Determinant,
            InformationFunction::variance(&(&W * W.transpose())),
            InformationFunction::variance(&DMatrix::identity(P, P)),
            InformationFunction::Determinant.beside(1),
            InformationFunction::variance(&DMatrix::from_row_slice(2, 2, &[0.4, 0.1, 0.1, 2.0])).beside(P - 2),
        ]
    }

    fn with_kinks() -> Vec<InformationFunction> {
        let W = DMatrix::from_row_slice(P, 2, &[1.0, 0.2, 0.0, 2.0, -1.0, 0.3, 0.5, 0.0]);
        let single = DMatrix::from_diagonal_element(P, P, 0.7).select_columns(&[1]);
        let weights = [&W * W.transpose(), &single * single.transpose(), DMatrix::identity(P, P) * 0.3];
        let least = InformationFunction::min_eigenvalue();
        vec![least.clone(), InformationFunction::worst_variance(&weights), least.beside(2)]
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
            let soft = with_kinks().into_iter().flat_map(|f| [0.5, 0.1].map(|softness| f.softened(softness)));
            for f in functions().into_iter().chain(soft) {
                let at = |t: f64| f.log_value(&mut moved(&m, &Δ, t), P);
                let slope_at = |t: f64| inner(&f.gradient(&moved(&m, &Δ, t), P).unwrap().y, &Δ);
                let h = 1e-6;
                let slope = slope_at(0.0);
                prop_assert!((slope - (at(h) - at(-h)) / (2.0 * h)).abs() < 1e-6 * (1.0 + slope.abs().powi(3)));
                let bend: f64 = f.curvature(&m, P).unwrap().map(&Δ).iter().map(|x| x * x).sum();
                let second = (slope_at(-h) - slope_at(h)) / (2.0 * h);
                prop_assert!((bend - second).abs() < 1e-5 * (1.0 + bend.powi(2)), "{f:?} {bend} {second}");
            }
        }

        /// Beside singular matrices, indefinite ones, and ones that only the inverse tells to be regular.
        #[test]
        fn many_values_are_those_of_each(matrices in prop::collection::vec(matrix(), LANES - 3), scale in 1e-8..1.0f64) {
            let mut odd = [vec![0.0; packed_len(P)], matrices[0].iter().map(|x| -x).collect(), matrices[1].clone()];
            let last = packed_len(P - 1);
            // The last row and column all but those of the first.
            for (place, from) in (last..).zip([0, 1, 3]) {
                odd[2][place] = matrices[1][from];
            }
            odd[2][last + P - 1] = matrices[1][0] * (1.0 + scale);
            let each: Vec<Vec<f64>> = matrices.into_iter().chain(odd).collect();
            let soft = with_kinks().into_iter().map(|f| f.softened(0.1));
            for f in functions().into_iter().chain(with_kinks()).chain(soft) {
                let expected: Vec<f64> = each.iter().map(|m| f.log_value(&mut m.clone(), P)).collect();
                let side_by_side: Vec<Lanes> =
                    (0..packed_len(P)).map(|place| std::array::from_fn(|lane| each[lane][place])).collect();
                let found = f.log_values(&mut side_by_side.clone(), P, f64::NEG_INFINITY);
                prop_assert_eq!(&found[..], &expected, "{:?}", f);
                for &above in &expected {
                    let found = f.log_values(&mut side_by_side.clone(), P, above);
                    for (found, &expected) in found.into_iter().zip(&expected) {
                        prop_assert!(found == expected || (found == f64::NEG_INFINITY && expected <= above));
                    }
                }
            }
        }

        #[test]
        fn the_laws_of_information_functions(m in matrix(), a in matrix(), y in matrix()) {
            for f in functions().into_iter().chain(with_kinks()) {
                let log = |m: &[f64]| f.log_value(&mut m.to_vec(), P);
                // homogeneous of degree one
                let twice: Vec<f64> = m.iter().map(|x| 2.0 * x).collect();
                prop_assert!((log(&twice) - log(&m) - 2f64.ln()).abs() < 1e-10);
                // ⟨Y, M⟩ = 1 at the gradient, and the polar inequality is tight there
                let gradient = f.gradient(&m, P).unwrap();
                prop_assert!((inner(&gradient.y, &m) - 1.0).abs() < 1e-9);
                prop_assert!((log(&m) + f.log_polar(&gradient.y, P, &gradient.mixture)).abs() < 1e-6);
                // the polar inequality for any Y, and the gain's bound for any change
                let mixture = [0.2, 0.5, 0.3];
                prop_assert!(log(&m) + f.log_polar(&y, P, &mixture) <= inner(&y, &m).ln() + 1e-10);
                let sum = moved(&m, &a, 1.0);
                prop_assert!(log(&sum) - log(&m) <= (1.0 + inner(&gradient.y, &a)).ln() + 1e-10);
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

    fn normal(rng: &mut impl Rng, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| rng.sample(StandardNormal))
    }

    /// Fewer views of rank one than parameters determine nothing, whatever rounding makes of their sum; nor does a sum tell its least
    /// eigenvalue that is less than the rounding of the greatest.
    #[test]
    fn what_rounding_leaves_is_no_information() {
        let functions = [
            InformationFunction::Determinant,
            InformationFunction::variance(&DMatrix::identity(P, P)),
            InformationFunction::min_eigenvalue(),
            InformationFunction::worst_variance(&[DMatrix::identity(P, P)]),
        ];
        for seed in 0..400 {
            let mut rng = Xoshiro256Plus::seed_from_u64(seed);
            let units = normal(&mut rng, P, 1).map(|x| 10f64.powf(x));
            let views = (1..P).map(|_| normal(&mut rng, P, 1).component_mul(&units));
            let sum = pack(&views.fold(DMatrix::zeros(P, P), |sum, a| sum + &a * a.transpose()));
            let A = normal(&mut rng, P, P);
            let mut apart = &A * A.transpose() + DMatrix::identity(P, P);
            apart.row_mut(0).scale_mut(1e12);
            apart.column_mut(0).scale_mut(1e12);
            let of_least = |function: &InformationFunction| *function == functions[2];
            for function in &functions {
                for M in [&sum, &pack(&apart)] {
                    let known = M != &sum && !of_least(function);
                    assert_eq!(function.log_value(&mut M.clone(), P).is_finite(), known, "seed {seed}: {function:?}");
                    assert_eq!(function.gradient(M, P).is_some(), known, "seed {seed}: {function:?}");
                }
            }
        }
    }
}
