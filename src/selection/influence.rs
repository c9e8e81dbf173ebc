//! What each member of a selection is worth, and which candidates could take its place.

use rayon::prelude::*;

use super::error::SelectionError;
use super::instance::Instance;

/// A candidate that can take a member's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spare {
    /// The candidate.
    pub candidate: usize,
    /// log Φ of the selection with it.
    pub log_value: f64,
}

/// Allowance for rounding when a bound is held against a value in log Φ.
const ROUNDING: f64 = 1e-9;

/// Where so little of Φ is left without a member, in log Φ, the gradient of the rest is mostly rounding and bounds nothing.
const TOO_LITTLE: f64 = 12.0;

/// log Φ of a selection without each of its members, in their order; −∞ where the others leave a combination of the
/// parameters undetermined.
///
/// # Errors
/// When `selected` are not candidates, each once.
pub fn without_each(instance: &Instance, selected: &[usize]) -> Result<Vec<f64>, SelectionError> {
    instance.check(selected)?;
    // Summed anew rather than subtracted: where a member carries almost all, the difference would be rounding.
    Ok(selected.iter().map(|&i| instance.log_value_at(&instance.total(&others(selected, i)))).collect())
}

/// For each member of a selection, in their order, the `most` candidates that leave the greatest log Φ when they take its
/// place, the best first, equal ones by index; only those that the constraints allow beside the other members and that `serves`
/// accepts, which is asked with the member and the candidate. A required member has no spares.
///
/// # Errors
/// When `selected` are not candidates, each once.
pub fn spares(
    instance: &Instance,
    selected: &[usize],
    most: usize,
    serves: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<Vec<Vec<Spare>>, SelectionError> {
    instance.check(selected)?;
    if most == 0 {
        return Ok(vec![vec![]; selected.len()]);
    }
    let best = |(&leaving, bounds): (&usize, Vec<f64>)| {
        let serves = |candidate: usize| serves(leaving, candidate);
        if instance.is_open(leaving) { spares_for(instance, selected, leaving, &bounds, most, &serves) } else { vec![] }
    };
    Ok(selected.par_iter().zip(replacement_bounds(instance, selected)).map(best).collect())
}

/// The spares of the member `leaving`, from `bounds` of what log Φ can be with each candidate in its place.
fn spares_for(
    instance: &Instance,
    selected: &[usize],
    leaving: usize,
    bounds: &[f64],
    most: usize,
    serves: &dyn Fn(usize) -> bool,
) -> Vec<Spare> {
    let rules = instance.rules();
    let rest = instance.total(&others(selected, leaving));
    let mut candidates: Vec<usize> =
        (0..instance.len()).filter(|&j| instance.is_open(j) && !selected.contains(&j)).collect();
    candidates.sort_unstable_by(|&a, &b| bounds[b].total_cmp(&bounds[a]).then(a.cmp(&b)));
    let mut best: Vec<Spare> = Vec::with_capacity(most + 1);
    let mut work = Vec::new();
    for candidate in candidates {
        if best.len() == most && best.last().is_some_and(|last| bounds[candidate] + ROUNDING < last.log_value) {
            break;
        }
        if !serves(candidate) || !rules.is_free() && !rules.allows(selected, Some(leaving), candidate) {
            continue;
        }
        work.clone_from(&rest);
        instance.add_to(&mut work, candidate, 1.0);
        let spare = Spare { candidate, log_value: instance.log_value_in_place(&mut work) };
        let behind = |other: &Spare| {
            other.log_value > spare.log_value || (other.log_value == spare.log_value && other.candidate < candidate)
        };
        best.insert(best.partition_point(behind), spare);
        best.truncate(most);
    }
    best
}

fn others(selected: &[usize], leaving: usize) -> Vec<usize> {
    selected.iter().copied().filter(|&i| i != leaving).collect()
}

/// For each member, and each candidate in its place, what log Φ can be at most. Two bounds spare most candidates the
/// evaluation, with the gradients Y of the selection M and `Y'` of the rest `M' = M − M_i`:
///
/// ```text
/// Φ(M' + M_j) ≤ Φ(M') (1 + ⟨Y', M_j⟩),      Φ(M' + M_j) ≤ Φ(M) (1 + ⟨Y, M_j⟩ − ⟨Y, M_i⟩)
/// ```
fn replacement_bounds(instance: &Instance, selected: &[usize]) -> Vec<Vec<f64>> {
    let total = instance.total(selected);
    let before = instance.log_value_at(&total);
    let rests: Vec<Vec<f64>> = selected.iter().map(|&i| instance.total(&others(selected, i))).collect();
    let resolved = |rest: &&Vec<f64>| instance.log_value_at(rest) > before - TOO_LITTLE;
    let gradients: Vec<Option<Vec<f64>>> = std::iter::once(instance.gradient_at(&total))
        .chain(rests.iter().map(|rest| Some(rest).filter(resolved).and_then(|rest| instance.gradient_at(rest))))
        .map(|gradient| gradient.map(|gradient| gradient.y))
        .collect();
    let known: Vec<&[f64]> = gradients.iter().flatten().map(Vec::as_slice).collect();
    let mut scores = instance.scores_by_each(&known).into_iter();
    let mut scores = gradients.iter().map(|gradient| gradient.as_ref().and_then(|_| scores.next()));
    let of_total = scores.next().flatten();
    let bounds = |((&leaving, rest), of_rest): ((&usize, &Vec<f64>), Option<Vec<f64>>)| {
        let mut bounds = vec![f64::INFINITY; instance.len()];
        let mut tighten = |log_value: f64, scores: &[f64], taken: f64| {
            for (bound, score) in bounds.iter_mut().zip(scores) {
                *bound = bound.min(log_value + (score - taken).max(-1.0).ln_1p());
            }
        };
        if let Some(scores) = &of_total {
            tighten(before, scores, scores[leaving]);
        }
        if let Some(scores) = &of_rest {
            tighten(instance.log_value_at(rest), scores, 0.0);
        }
        bounds
    };
    selected.iter().zip(&rests).zip(scores).map(bounds).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256Plus;

    use super::*;
    use crate::selection::{Cap, Constraints, InformationFunction, InformationSet, Separation, Term};

    /// Every replacement tried, by every function, with and without constraints.
    #[test]
    fn spares_are_those_of_an_exhaustive_search() {
        let mut rng = Xoshiro256Plus::seed_from_u64(5);
        let (n, p, k) = (60, 3, 4);
        for round in 0..40 {
            let mut normal = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| rng.sample(StandardNormal));
            // Of rank one: without one of four members little may be left, without one of three nothing.
            let matrices: Vec<DMatrix<f64>> = (0..n)
                .map(|_| {
                    let a: DMatrix<f64> = normal(p, 1);
                    &a * a.transpose()
                })
                .collect();
            let weights = [0, 1].map(|_| {
                let a = normal(p, p);
                &a * a.transpose()
            });
            let points: Vec<Vec<f64>> = (0..n).map(|_| normal(2, 1).as_slice().to_vec()).collect();
            let candidates = InformationSet::from_matrices(p, &matrices).unwrap();
            let functions = [
                InformationFunction::Determinant,
                InformationFunction::variance(&weights[0]),
                InformationFunction::min_eigenvalue(),
                InformationFunction::worst_variance(&weights),
            ];
            let function = &functions[round % 4];
            let mut constraints = Constraints::default();
            if round % 3 == 1 {
                constraints.required = vec![0];
                constraints.forbidden = vec![7, 8];
                constraints.caps = vec![Cap { members: (0..30).collect(), most: 2 }];
                constraints.separations = vec![Separation::of(&points, 0.4)];
            }
            let count = if round % 5 == 0 { p } else { k };
            let term = Term { candidates: &candidates, prior: None, function, share: 1.0 };
            let instance = Instance::constrained(&[term], count, constraints).unwrap();
            let selected = crate::selection::greedy(&instance).unwrap();
            let found = spares(&instance, &selected, 5, &|_, _| true).unwrap();
            for (place, &leaving) in selected.iter().enumerate() {
                let mut expected: Vec<Spare> = (0..n)
                    .filter(|&j| instance.is_open(leaving) && instance.is_open(j) && !selected.contains(&j))
                    .filter(|&j| instance.rules().allows(&selected, Some(leaving), j))
                    .map(|j| {
                        let mut replaced = others(&selected, leaving);
                        replaced.push(j);
                        Spare { candidate: j, log_value: instance.log_value_at(&instance.total(&replaced)) }
                    })
                    .collect();
                expected.sort_by(|a, b| b.log_value.total_cmp(&a.log_value).then(a.candidate.cmp(&b.candidate)));
                expected.truncate(5);
                assert_eq!(found[place], expected, "{round} {leaving}");
            }
            let without = without_each(&instance, &selected).unwrap();
            assert_eq!(without.len(), count);
            assert_eq!(without.contains(&f64::NEG_INFINITY), count == p, "{without:?}");
        }
    }
}
