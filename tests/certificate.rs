//! No selection beats its certificate: bounds held against exhaustive search on small random instances.
//!
//! What this does not prove: anything about large instances, where nobody knows the optimum. There the bound rests on
//! being the same few lines of arithmetic as here.

#![allow(non_snake_case, clippy::unwrap_used)]

use calipose::information::packed::pack;
use calipose::information::{InformationError, InformationSet};
use calipose::selection::{
    Certificate, InformationFunction, Instance, RelaxationSettings, SelectionError, best, exchange, greedy, relax,
};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256Plus;

const SEEDS: u64 = 240;

/// A random instance that is small enough to search.
#[derive(Debug)]
struct Case {
    candidates: InformationSet,
    prior: Option<DMatrix<f64>>,
    function: InformationFunction,
    count: usize,
}

fn normal(rng: &mut impl Rng, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| rng.sample(StandardNormal))
}

/// `A Aᵀ` with a p×rank A: a random semidefinite matrix.
fn semidefinite(rng: &mut impl Rng, p: usize, rank: usize) -> DMatrix<f64> {
    let A = normal(rng, p, rank);
    &A * A.transpose()
}

impl Case {
    /// Case `seed`: orders 1 to 4, ranks from one up, with and without prior, units apart by powers of ten, candidates
    /// repeated, every kind of function.
    fn random(seed: u64) -> Self {
        let mut rng = Xoshiro256Plus::seed_from_u64(seed);
        let p = rng.gen_range(1..=4);
        let n = rng.gen_range(p.max(2)..=14);
        let count = rng.gen_range(1..=n.min(4));
        let units = DMatrix::from_diagonal(&normal(&mut rng, p, 1).map(|x| 10f64.powf(2.0 * x)).column(0).into_owned());
        let least_rank = p.div_ceil(count);
        let mut matrices: Vec<_> = (0..n)
            .map(|_| {
                let rank = rng.gen_range(least_rank..=p);
                let size = rng.gen_range(-1.0..1.0f64).exp();
                &units * semidefinite(&mut rng, p, rank) * &units * size
            })
            .collect();
        if rng.gen_bool(0.3) {
            matrices[1] = matrices[0].clone();
        }
        let prior = rng.gen_bool(0.5).then(|| {
            let rank = rng.gen_range(1..=p);
            &units * semidefinite(&mut rng, p, rank) * &units * 0.5
        });
        let function = match seed % 3 {
            0 => InformationFunction::Determinant,
            1 => InformationFunction::variance(&(&units * semidefinite(&mut rng, p, p) * &units)),
            _ => {
                let rank = rng.gen_range(1..=p);
                InformationFunction::variance(&(&units * semidefinite(&mut rng, p, rank) * &units))
            }
        };
        Self { candidates: InformationSet::from_matrices(p, &matrices).unwrap(), prior, function, count }
    }

    fn instance(&self) -> Instance<'_> {
        Instance::new(&self.candidates, self.prior.as_ref(), &self.function, self.count).unwrap()
    }
}

fn value(instance: &Instance, selected: &[usize]) -> f64 {
    let mut ascending = selected.to_vec();
    ascending.sort_unstable();
    instance.log_value(&instance.total(&ascending))
}

/// The greatest log Φ of all selections.
fn optimum(instance: &Instance) -> f64 {
    let n = instance.candidates().len();
    let subsets = (0u32..1 << n).filter(|subset| subset.count_ones() as usize == instance.count());
    let selection = |subset: u32| (0..n).filter(|i| subset >> i & 1 == 1).collect::<Vec<_>>();
    subsets.map(|subset| value(instance, &selection(subset))).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn no_selection_beats_the_bound_and_the_methods_are_in_order() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let instance = case.instance();
        let optimum = optimum(&instance);
        let first = greedy(&instance).unwrap();
        let swapped = exchange(&instance, first.clone());
        let settings = RelaxationSettings::default();
        let relaxation = relax(&instance, &swapped, &settings).unwrap();
        let best = best(&instance, &settings, seed).unwrap();

        // Every selection is among those that the search has seen: no tolerance.
        assert!(value(&instance, &first) <= optimum, "seed {seed}");
        assert!(value(&instance, &swapped) <= optimum, "seed {seed}");
        assert!(value(&instance, &best.selected) <= optimum, "seed {seed}");
        // Each improves on the one before; sums in another order may differ in the last digits.
        assert!(value(&instance, &first) <= value(&instance, &swapped) + 1e-12, "seed {seed}");
        assert!(value(&instance, &swapped) <= value(&instance, &best.selected) + 1e-12, "seed {seed}");
        assert!((value(&instance, &best.selected) - best.log_value).abs() <= 1e-12, "seed {seed}");

        for relaxation in [&relaxation, &best.relaxation] {
            let bound = relaxation.certificate.log_bound;
            assert!(bound >= optimum, "seed {seed}: the bound {bound} is {:e} too low", optimum - bound);
            assert!(relaxation.solved, "seed {seed}: gap {:e}", bound - relaxation.log_value);
            assert!(bound - relaxation.log_value <= settings.tolerance, "seed {seed}");
            assert!(relaxation.log_value >= optimum - 1e-9, "seed {seed}");
            let total: f64 = relaxation.weights.iter().map(|(_, weight)| weight).sum();
            assert!((total - case.count as f64).abs() < 1e-6, "seed {seed}");
            assert!(relaxation.weights.iter().all(|(_, weight)| (0.0..=1.0).contains(weight)), "seed {seed}");
        }
        let efficiency = best.relaxation.certificate.efficiency(best.log_value);
        assert!(efficiency > 0.0 && efficiency <= 1.0, "seed {seed}: {efficiency}");
    }
}

/// A bound does not depend on where Y came from: near the optimum's, far from it, or of deficient rank.
#[test]
fn any_semidefinite_matrix_proves_a_bound() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let instance = case.instance();
        let optimum = optimum(&instance);
        let p = instance.order();
        let mut rng = Xoshiro256Plus::seed_from_u64(seed ^ 0x5EED);
        for rank in (1..=p).chain([2 * p]) {
            let Y = semidefinite(&mut rng, p, rank);
            let bound = Certificate::new(&instance, pack(&Y)).log_bound;
            assert!(bound >= optimum, "seed {seed}, rank {rank}: {bound} < {optimum}");
        }
        let nothing = Certificate::new(&instance, pack(&DMatrix::zeros(p, p)));
        assert_eq!(nothing.log_bound, f64::INFINITY);
    }
}

/// With all candidates selected there is nothing to choose, so bound, relaxation and selection are one.
#[test]
fn the_bound_is_tight_where_there_is_no_choice() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let n = case.candidates.len();
        let instance = Instance::new(&case.candidates, case.prior.as_ref(), &case.function, n).unwrap();
        let best = best(&instance, &RelaxationSettings::default(), seed).unwrap();
        assert_eq!(best.selected, (0..n).collect::<Vec<_>>());
        let slack = best.relaxation.certificate.log_bound - value(&instance, &best.selected);
        assert!((0.0..=1e-9).contains(&slack), "seed {seed}: {slack:e}");
    }
}

#[test]
fn a_candidate_given_twice_counts_twice() {
    let view = DMatrix::from_diagonal_element(2, 2, 1.0);
    let better = &view * 3.0;
    let candidates = InformationSet::from_matrices(2, [&view, &better, &better, &view]).unwrap();
    for function in [InformationFunction::Determinant, InformationFunction::variance(&view)] {
        let instance = Instance::new(&candidates, None, &function, 2).unwrap();
        let best = best(&instance, &RelaxationSettings::default(), 0).unwrap();
        assert_eq!(best.selected, [1, 2]);
        assert!((best.relaxation.certificate.efficiency(best.log_value) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn counts_that_cannot_be_selected_are_refused() {
    let view = DMatrix::identity(2, 2);
    let candidates = InformationSet::from_matrices(2, [&view; 3]).unwrap();
    let function = InformationFunction::Determinant;
    for count in [0, 4, usize::MAX] {
        let refused = Instance::new(&candidates, None, &function, count).unwrap_err();
        assert_eq!(refused, SelectionError::Count { count, candidates: 3 });
    }
    let empty = InformationSet::from_packed(2, vec![]).unwrap();
    assert_eq!(
        Instance::new(&empty, None, &function, 1).unwrap_err(),
        SelectionError::Count { count: 1, candidates: 0 }
    );
}

/// Views of rank one, too few of them, or none that sees the third parameter: the error names what stays open.
#[test]
fn undetermined_parameters_are_named() {
    let along = |direction: [f64; 3]| {
        let g = DMatrix::from_column_slice(3, 1, &direction);
        &g * g.transpose()
    };
    let views = [along([1.0, 0.0, 0.0]), along([0.0, 1.0, 0.0]), along([0.0, 0.0, 1.0])];
    let candidates = InformationSet::from_matrices(3, &views).unwrap();
    for function in [InformationFunction::Determinant, InformationFunction::variance(&DMatrix::identity(3, 3))] {
        let instance = Instance::new(&candidates, None, &function, 2).unwrap();
        for refused in [greedy(&instance).unwrap_err(), best(&instance, &RelaxationSettings::default(), 0).unwrap_err()]
        {
            let SelectionError::Unobservable { count: 2, combination } = refused else { panic!("{refused:?}") };
            assert_eq!(combination.iter().filter(|c| c.abs() > 1e-9).count(), 1, "{combination:?}");
            assert_eq!(combination.iter().copied().fold(0.0, f64::max), 1.0);
        }
        assert_eq!(relax(&instance, &[0, 1], &RelaxationSettings::default()), None);

        // Never seen by anyone: parameters 1 and 2 only as their sum.
        let blind = [along([1.0, 0.0, 0.0]), along([0.0, 1.0, 1.0]), along([1.0, 2.0, 2.0])];
        let candidates = InformationSet::from_matrices(3, &blind).unwrap();
        let refused = Instance::new(&candidates, None, &function, 3).unwrap_err();
        let SelectionError::Unobservable { count: 3, combination } = refused else { panic!("{refused:?}") };
        assert!(combination[0].abs() < 1e-9 && (combination[1] + combination[2]).abs() < 1e-9, "{combination:?}");
        // What is known already may close the gap.
        let prior = along([0.0, 1.0, -1.0]);
        assert!(Instance::new(&candidates, Some(&prior), &function, 3).is_ok());
    }
}

#[test]
fn matrices_that_are_no_information_are_refused() {
    let good = DMatrix::identity(2, 2);
    let refused = |entries: [f64; 4]| {
        InformationSet::from_matrices(2, [&good, &DMatrix::from_row_slice(2, 2, &entries)]).unwrap_err()
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(matches!(
            refused([1.0, 0.0, 0.0, bad]),
            InformationError::NotFinite { candidate: 1, row: 1, column: 1, .. }
        ));
    }
    assert!(matches!(refused([1.0, 2.0, 2.0, 1.0]), InformationError::Indefinite { candidate: 1, .. }));
    assert!(matches!(refused([1.0, 0.0, 0.0, -1.0]), InformationError::Indefinite { candidate: 1, .. }));
}

#[test]
fn orders_that_do_not_fit_are_refused() {
    let view = DMatrix::identity(2, 2);
    let candidates = InformationSet::from_matrices(2, [&view; 3]).unwrap();
    let prior = DMatrix::identity(3, 3);
    assert_eq!(
        Instance::new(&candidates, Some(&prior), &InformationFunction::Determinant, 2).unwrap_err(),
        SelectionError::Order { what: "prior", expected: 2, found: 3 }
    );
    let function = InformationFunction::variance(&DMatrix::identity(1, 1));
    assert_eq!(
        Instance::new(&candidates, None, &function, 2).unwrap_err(),
        SelectionError::Order { what: "weight", expected: 2, found: 1 }
    );
    assert_eq!(
        InformationSet::from_matrices(2, [&view, &prior]).unwrap_err(),
        InformationError::Order { candidate: 1, rows: 3, columns: 3, order: 2 }
    );
}
