//! No selection beats its certificate: bounds held against exhaustive search on small random instances.
//!
//! What this does not prove: anything about large instances, where nobody knows the optimum. There the bound rests on
//! being the same few lines of arithmetic as here.

use std::ops::ControlFlow;

use calipose::selection::InformationError;
use calipose::selection::{
    Best, Cap, Certificate, Constraints, Gradient, Group, InformationFunction, InformationSet, Instance, NotEnough,
    RelaxationSettings, SearchEnd, SelectionError, Separation, Term, best, exchange, fewest, greedy, improved_greedy,
    relax, search, spares, start_of_search, without_each,
};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256Plus;

const SEEDS: u64 = 700;

/// Cases before this one have one scenario.
const ONE_SCENARIO: u64 = 420;

/// Cases from this one on have a parameter that nobody asks for.
const NUISANCE: u64 = 600;

/// Kinds of terms from this one on are those before beside such a parameter.
const BESIDE: u64 = 10;

/// A random instance that is small enough to search.
#[derive(Debug, Clone)]
struct Case {
    /// The terms of each scenario.
    scenarios: Vec<Vec<OwnedTerm>>,
    count: usize,
    constraints: Constraints,
}

#[derive(Debug, Clone)]
struct OwnedTerm {
    candidates: InformationSet,
    prior: Option<DMatrix<f64>>,
    function: InformationFunction,
    share: f64,
}

fn normal(rng: &mut impl Rng, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| rng.sample(StandardNormal))
}

/// `A Aᵀ` with a p×rank A: a random semidefinite matrix.
fn semidefinite(rng: &mut impl Rng, p: usize, rank: usize) -> DMatrix<f64> {
    let A = normal(rng, p, rank);
    &A * A.transpose()
}

impl OwnedTerm {
    /// Orders 1 to 4, ranks from one up, with and without prior, units apart by powers of ten, candidates repeated. From kind
    /// 10 on one more parameter, of which something is known, is estimated beside those asked for.
    fn random(rng: &mut impl Rng, kind: u64, n: usize, count: usize, share: f64) -> Self {
        let asked = rng.gen_range(1..=4.min(n));
        let nuisance = usize::from(kind >= BESIDE);
        let (kind, p) = (kind % BESIDE, nuisance + asked);
        // The least eigenvalue means something only where the units are alike.
        let spread = if kind == 3 { 0.2 } else { 2.0 };
        let units = DMatrix::from_diagonal(&normal(rng, p, 1).map(|x| 10f64.powf(spread * x)).column(0).into_owned());
        let least_rank = p.div_ceil(count);
        let mut matrices: Vec<_> = (0..n)
            .map(|_| {
                let rank = rng.gen_range(least_rank..=p);
                let size = rng.gen_range(-1.0..1.0f64).exp();
                &units * semidefinite(rng, p, rank) * &units * size
            })
            .collect();
        if rng.gen_bool(0.3) {
            matrices[1] = matrices[0].clone();
        }
        let prior = rng.gen_bool(0.5).then(|| {
            let rank = rng.gen_range(1..=p);
            &units * semidefinite(rng, p, rank) * &units * 0.5
        });
        let prior = if nuisance == 0 {
            prior
        } else {
            let own = DMatrix::from_fn(p, p, |i, j| if i.max(j) == 0 { units[(0, 0)].powi(2) } else { 0.0 });
            Some(prior.map_or(own.clone(), |prior| prior + own))
        };
        let units = units.view((nuisance, nuisance), (asked, asked));
        let mut weight = |rank: usize| units * semidefinite(rng, asked, rank) * units;
        let function = match kind {
            0 => InformationFunction::Determinant,
            1 => InformationFunction::variance(&weight(asked)),
            2 => InformationFunction::variance(&weight(1)),
            3 => InformationFunction::min_eigenvalue(),
            _ => InformationFunction::worst_variance(&[weight(1), weight(asked), weight(1)]),
        };
        let function = function.beside(nuisance);
        Self { candidates: InformationSet::from_matrices(p, &matrices).unwrap(), prior, function, share }
    }
}

/// Constraints that the selection `keeps` satisfies, so that there is one that does.
fn constraints(rng: &mut impl Rng, n: usize, keeps: &[usize]) -> Constraints {
    let is_kept = |i: &usize| keeps.contains(i);
    let required = keeps.iter().copied().filter(|_| rng.gen_bool(0.2)).collect();
    let forbidden = (0..n).filter(|i| !is_kept(i) && rng.gen_bool(0.15)).collect();
    let cap = |members: Vec<usize>| Cap { most: members.iter().filter(|&i| is_kept(i)).count().max(1), members };
    let caps = (0..2).map(|_| cap((0..n).filter(|_| rng.gen_bool(0.5)).collect())).collect();
    let points: Vec<Vec<f64>> = (0..n).map(|_| vec![rng.gen_range(0.0..1.0), rng.gen_range(0.0..1.0)]).collect();
    let distance = |i: usize, j: usize| (points[i][0] - points[j][0]).hypot(points[i][1] - points[j][1]);
    let pairs = keeps.iter().flat_map(|&i| keeps.iter().map(move |&j| (i, j))).filter(|(i, j)| i < j);
    let least = pairs.map(|(i, j)| distance(i, j)).fold(0.7, f64::min) * 0.999; // off the boundary, where the last digit decides
    Constraints { required, forbidden, caps, separations: vec![Separation::of(&points, least)] }
}

impl Case {
    /// Case `seed`: every kind of function, two terms, several scenarios, and every kind of constraint in turn.
    fn random(seed: u64) -> Self {
        let mut rng = Xoshiro256Plus::seed_from_u64(seed);
        let n = rng.gen_range(4..=14);
        let count = rng.gen_range(1..=4);
        let mut term = |kind, share| OwnedTerm::random(&mut rng, kind, n, count, share);
        let kind = match seed {
            ..ONE_SCENARIO => seed % 7,
            ONE_SCENARIO..NUISANCE => 7 + seed % 3,
            _ => BESIDE + seed % 5,
        };
        let scenarios = match kind {
            5 => vec![vec![term(1, 0.7), term(0, 0.3)]],
            6 => vec![vec![term(3, 0.5), term(4, 0.5)]],
            7 => vec![vec![term(1, 1.0)], vec![term(1, 1.0)], vec![term(0, 1.0)]],
            8 => vec![vec![term(1, 0.7), term(0, 0.3)], vec![term(2, 0.7), term(0, 0.3)]],
            9 => vec![vec![term(4, 1.0)], vec![term(4, 1.0)], vec![term(3, 1.0)]],
            kind => vec![vec![term(kind, 1.0)]],
        };
        let mut constraints_of = |constrained: bool| {
            let keeps = rand::seq::index::sample(&mut rng, n, count).into_vec();
            if constrained { constraints(&mut rng, n, &keeps) } else { Constraints::default() }
        };
        let constraints = constraints_of(seed / 7 % 2 == 1);
        Self { scenarios, count, constraints }
    }

    /// As many candidates of rank one as there are parameters, along few directions: most sets are singular, under constraints
    /// perhaps all.
    fn of_few_directions(seed: u64) -> Self {
        let mut rng = Xoshiro256Plus::seed_from_u64(seed);
        let (n, p) = (rng.gen_range(6..=11), rng.gen_range(3..=4));
        let direction = |rng: &mut Xoshiro256Plus| {
            let (i, j) = (rng.gen_range(0..p), rng.gen_range(0..p));
            let size = rng.gen_range(-2.0..2.0f64).exp();
            DMatrix::from_fn(p, 1, |r, _| {
                if r == i {
                    size
                } else if r == j {
                    0.3 * size
                } else {
                    0.0
                }
            })
        };
        let matrices: Vec<_> = (0..n).map(|_| direction(&mut rng)).map(|a| &a * a.transpose()).collect();
        let weight = DMatrix::identity(p, p);
        let function = match seed % 4 {
            0 => InformationFunction::Determinant,
            1 => InformationFunction::variance(&weight),
            2 => InformationFunction::min_eigenvalue(),
            _ => InformationFunction::worst_variance(&[weight.clone(), semidefinite(&mut rng, p, 1)]),
        };
        let candidates = InformationSet::from_matrices(p, &matrices).unwrap();
        let keeps = rand::seq::index::sample(&mut rng, n, p).into_vec();
        let constraints = constraints(&mut rng, n, &keeps);
        let term = OwnedTerm { candidates, prior: None, function, share: 1.0 };
        Self { scenarios: vec![vec![term]], count: p, constraints }
    }

    fn scenarios(&self) -> Vec<Vec<Term<'_>>> {
        fn term(OwnedTerm { candidates, prior, function, share }: &OwnedTerm) -> Term<'_> {
            Term { candidates, prior: prior.as_ref(), function, share: *share }
        }
        self.scenarios.iter().map(|terms| terms.iter().map(term).collect()).collect()
    }

    /// Whether the least counts of several scenarios whose functions are least values too: a relaxation may come to rest early there.
    fn has_kinks_in_kinks(&self) -> bool {
        let smooth = |function: &InformationFunction| {
            matches!(function, InformationFunction::Determinant | InformationFunction::Variance(_))
        };
        self.scenarios.len() > 1 && !self.scenarios.iter().flatten().all(|term| smooth(&term.function))
    }

    /// The instance; none if the allowed candidates leave something undetermined.
    fn instance(&self) -> Option<Instance<'_>> {
        match Instance::of_scenarios(&self.scenarios(), self.count, self.constraints.clone()) {
            Err(SelectionError::Unobservable { .. }) => None,
            instance => Some(instance.unwrap()),
        }
    }

    fn allows(&self, selected: &[usize]) -> bool {
        let Constraints { required, forbidden, caps, separations } = &self.constraints;
        let apart = |s: &Separation, i: usize, j: usize| {
            let squared = |axis: usize| (s.points[2 * i + axis] - s.points[2 * j + axis]).powi(2);
            squared(0) + squared(1) >= s.least.powi(2)
        };
        required.iter().all(|i| selected.contains(i))
            && !selected.iter().any(|i| forbidden.contains(i))
            && caps.iter().all(|cap| selected.iter().filter(|i| cap.members.contains(i)).count() <= cap.most)
            && separations.iter().all(|s| selected.iter().all(|&i| selected.iter().all(|&j| i == j || apart(s, i, j))))
    }

    /// All allowed selections with their log Φ.
    fn selections(&self, instance: &Instance) -> impl Iterator<Item = (f64, Vec<usize>)> {
        let n = instance.len();
        let subsets = (0u32..1 << n).filter(|subset| subset.count_ones() as usize == self.count);
        let selections = subsets.map(move |subset| (0..n).filter(|i| subset >> i & 1 == 1).collect::<Vec<_>>());
        selections.filter(|selected| self.allows(selected)).map(|selected| (value(instance, &selected), selected))
    }

    /// The greatest log Φ of all allowed selections.
    fn optimum(&self, instance: &Instance) -> f64 {
        self.selections(instance).map(|(value, _)| value).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The worst of the allowed selections that determine everything, with its log Φ.
    fn worst(&self, instance: &Instance) -> Option<(f64, Vec<usize>)> {
        self.selections(instance).filter(|(value, _)| value.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

fn value(instance: &Instance, selected: &[usize]) -> f64 {
    let mut ascending = selected.to_vec();
    ascending.sort_unstable();
    instance.log_value(&ascending).unwrap()
}

#[test]
fn no_selection_beats_the_bound_and_the_methods_are_in_order() {
    let (mut unsolved, mut singular) = (0, 0);
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let optimum = case.optimum(&instance);
        // Never a dead end: the constraints allow a set.
        let first = match greedy(&instance) {
            // Of several scenarios it may leave one undetermined.
            Err(SelectionError::Unobservable { .. }) if case.scenarios.len() > 1 => {
                singular += 1;
                continue;
            }
            first => first.unwrap(),
        };
        let swapped = exchange(&instance, first.clone()).unwrap();
        let settings = RelaxationSettings::default();
        let relaxation = relax(&instance, &swapped, &settings).unwrap();
        let best = best(&instance, &settings, seed).unwrap();

        // Every selection is among those that the search has seen: no tolerance.
        for selected in [&first, &swapped, &best.selected] {
            assert!(case.allows(selected), "seed {seed}: {selected:?}");
            assert!(value(&instance, selected) <= optimum, "seed {seed}");
        }
        // Each improves on the one before; sums in another order may differ in the last digits.
        assert!(value(&instance, &first) <= value(&instance, &swapped) + 1e-12, "seed {seed}");
        assert!(value(&instance, &swapped) <= value(&instance, &best.selected) + 1e-12, "seed {seed}");
        assert!((value(&instance, &best.selected) - best.log_value).abs() <= 1e-12, "seed {seed}");

        let smooth = instance.is_smooth();
        let tolerance = if smooth { settings.tolerance } else { RelaxationSettings::KINK_TOLERANCE };
        for relaxation in [&relaxation, &best.relaxation] {
            let bound = relaxation.certificate.log_bound;
            assert!(bound >= optimum, "seed {seed}: the bound {bound} is {:e} too low", optimum - bound);
            let tolerance = if case.has_kinks_in_kinks() && !relaxation.solved {
                unsolved += 1;
                1e-3
            } else {
                assert!(relaxation.solved, "seed {seed}: gap {:e}", bound - relaxation.log_value);
                tolerance
            };
            assert!(bound - relaxation.log_value <= tolerance, "seed {seed}");
            assert!(relaxation.log_value >= optimum - tolerance, "seed {seed}");
            let total: f64 = relaxation.weights.iter().map(|(_, weight)| weight).sum();
            assert!((total - case.count as f64).abs() < 1e-6, "seed {seed}");
            assert!(relaxation.weights.iter().all(|(_, weight)| (0.0..=1.0).contains(weight)), "seed {seed}");
        }
        let efficiency = best.relaxation.certificate.efficiency(best.log_value);
        assert!(efficiency > 0.0 && efficiency <= 1.0, "seed {seed}: {efficiency}");
    }
    // Of 60 cases, each solved twice.
    assert!(unsolved <= 12 && singular <= 9, "{unsolved} {singular}");
}

/// Exchange ends where no swap gains, be the set that it starts from the worst.
#[test]
fn no_swap_improves_what_exchange_ends_with() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let Some((_, worst)) = case.worst(&instance) else { continue };
        let ended = exchange(&instance, worst).unwrap();
        let reached = value(&instance, &ended);
        for place in 0..ended.len() {
            for j in (0..instance.len()).filter(|j| !ended.contains(j)) {
                let mut swapped = ended.clone();
                swapped[place] = j;
                let gain = value(&instance, &swapped) - reached;
                assert!(!case.allows(&swapped) || gain < 1e-9, "seed {seed}: {ended:?} {swapped:?} {gain:e}");
            }
        }
    }
}

/// A relaxation that is given no time has a bound that holds, and does not say that it is solved.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn a_relaxation_that_is_not_solved_has_a_bound() {
    let mut unsolved = 0;
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let Some((_, worst)) = case.worst(&instance) else { continue };
        let optimum = case.optimum(&instance);
        for max_rounds in 0..3 {
            let settings = RelaxationSettings { max_rounds, ..RelaxationSettings::default() };
            let relaxation = relax(&instance, &worst, &settings).unwrap();
            let gap = relaxation.certificate.log_bound - relaxation.log_value;
            assert!(relaxation.rounds <= max_rounds && relaxation.certificate.log_bound >= optimum, "seed {seed}");
            assert!(!relaxation.solved || gap <= RelaxationSettings::KINK_TOLERANCE, "seed {seed}: {gap:e}");
            unsolved += usize::from(!relaxation.solved);
        }
    }
    assert!(unsolved > 100, "{unsolved}");
}

/// Branch and bound ends with the optimum and its proof.
#[test]
fn the_search_finds_what_exhaustion_finds() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let Ok(start) = best(&instance, &RelaxationSettings::default(), seed) else { continue };
        let optimum = case.optimum(&instance);
        let mut bounds = vec![];
        let found = search(&instance, &start, f64::NEG_INFINITY, 100_000, &mut |progress| {
            bounds.push(progress.log_bound);
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(found.end, SearchEnd::Optimal, "seed {seed}: {found:?}");
        assert!(case.allows(&found.selected), "seed {seed}: {found:?} {case:?}");
        assert!((found.log_value - optimum).abs() <= 2e-9, "seed {seed}: {} {optimum}", found.log_value);
        assert!(found.log_bound >= optimum && found.log_bound <= found.log_value + 2e-9, "seed {seed}");
        // At any time the bound holds.
        assert!(bounds.iter().all(|&bound| bound >= optimum - 1e-9), "seed {seed}: {bounds:?} {optimum}");
    }
}

/// From the worst set on, or the second best, it finds the best; what is below a level it proves to be so.
#[test]
fn a_search_prunes_nothing_that_it_should_find() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let Ok(good) = best(&instance, &RelaxationSettings::default(), seed) else { continue };
        let Some(worst) = case.worst(&instance) else { continue };
        let optimum = case.optimum(&instance);
        let below = case.selections(&instance).filter(|(value, _)| *value < optimum - 1e-8);
        let second = below.max_by(|a, b| a.0.total_cmp(&b.0));
        let from = |(log_value, selected): (f64, Vec<usize>)| Best { selected, log_value, ..good.clone() };
        let ended = |start: &Best, wanted: f64, limit: usize| {
            search(&instance, start, wanted, limit, &mut |_| ControlFlow::Continue(())).unwrap()
        };
        for start in [Some(worst.clone()), second].into_iter().flatten().map(from) {
            let found = ended(&start, f64::NEG_INFINITY, 100_000);
            assert_eq!(found.end, SearchEnd::Optimal, "seed {seed}: {found:?}");
            assert!((found.log_value - optimum).abs() <= 2e-9, "seed {seed}: {} {optimum}", found.log_value);
        }
        let worst = from(worst);
        let level = optimum + 0.1;
        let refuted = ended(&worst, level, 100_000);
        assert_eq!(refuted.end, SearchEnd::Optimal, "seed {seed}: {refuted:?}");
        assert!((optimum..=level + 2e-9).contains(&refuted.log_bound), "seed {seed}: {refuted:?} {optimum}");
        for limit in 1..4 {
            let limited = ended(&worst, f64::NEG_INFINITY, limit);
            assert!(limited.nodes <= limit && limited.log_bound >= optimum, "seed {seed}: {limited:?} {optimum}");
        }
    }
}

/// A set is found wherever there is one that the constraints allow and that determines everything.
#[test]
fn a_regular_set_is_found_where_there_is_one() {
    let (mut found, mut repaired, mut missed) = (0, 0, 0);
    for seed in 0..SEEDS {
        let case = Case::of_few_directions(seed);
        let Some(instance) = case.instance() else { continue };
        match improved_greedy(&instance) {
            Ok(selected) => {
                assert!(case.allows(&selected) && value(&instance, &selected).is_finite(), "seed {seed}");
                found += 1;
                repaired += usize::from(greedy(&instance).is_err());
            }
            Err(SelectionError::Unobservable { .. }) => missed += u64::from(case.optimum(&instance).is_finite()),
            Err(error) => panic!("seed {seed}: {error}"),
        }
    }
    assert!(found > SEEDS / 8 && repaired > 5, "{found} {repaired}");
    // Swaps may end at a singular set; a search does not.
    assert!(missed <= found / 20, "{missed} of {found}");
}

/// With nothing but a singular set at hand the search still finds the best, or that all are singular.
#[test]
fn a_search_finds_its_way_out_of_singular_sets() {
    let (mut regular, mut singular) = (0, 0);
    for seed in 0..NUISANCE {
        let case = Case::of_few_directions(seed);
        let Some(instance) = case.instance() else { continue };
        let optimum = case.optimum(&instance);
        let start = start_of_search(&instance, &RelaxationSettings::default(), seed).unwrap();
        let start = Best { log_value: f64::NEG_INFINITY, ..start };
        let found = search(&instance, &start, f64::NEG_INFINITY, 100_000, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(found.end, SearchEnd::Optimal, "seed {seed}: {found:?}");
        if optimum == f64::NEG_INFINITY {
            assert_eq!(found.log_value, optimum, "seed {seed}");
            singular += 1;
        } else {
            assert!((found.log_value - optimum).abs() <= 2e-9, "seed {seed}: {} {optimum}", found.log_value);
            assert!(found.log_bound >= optimum, "seed {seed}: {:e} too low", optimum - found.log_bound);
            assert!(case.allows(&found.selected), "seed {seed}");
            regular += 1;
        }
    }
    assert!(regular > 20 && singular > 20, "{regular} {singular}");
}

/// A search that is stopped returns what it has, with a bound that holds.
#[test]
fn a_search_that_is_stopped_has_a_bound() {
    let mut stopped = 0;
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let Ok(start) = best(&instance, &RelaxationSettings::default(), seed) else { continue };
        let optimum = case.optimum(&instance);
        let by_observer =
            search(&instance, &start, f64::NEG_INFINITY, 100_000, &mut |_| ControlFlow::Break(())).unwrap();
        let by_limit = search(&instance, &start, f64::NEG_INFINITY, 0, &mut |_| ControlFlow::Continue(())).unwrap();
        for (found, end) in [(by_observer, SearchEnd::Stopped), (by_limit, SearchEnd::NodeLimit)] {
            assert!(found.end == end || found.end == SearchEnd::Optimal, "seed {seed}: {found:?}");
            assert_eq!(found.selected, start.selected, "seed {seed}");
            assert!(found.log_bound >= optimum, "seed {seed}: {} {optimum}", found.log_bound);
            stopped += usize::from(found.end == end);
        }
    }
    assert!(stopped > 100, "{stopped}");
}

/// Greedy scores lazily and evaluates what bounds leave; its picks are those of trying every candidate in every step.
#[test]
fn greedy_picks_what_a_full_search_picks() {
    for seed in 0..60 {
        let mut rng = Xoshiro256Plus::seed_from_u64(seed);
        let mut term = OwnedTerm::random(&mut rng, seed % 3, 80, 12, 1.0);
        // From the first pick on the sets are regular, so that there is no ridge to imitate.
        let p = term.candidates.order();
        let mean =
            DMatrix::from_fn(p, p, |i, j| (0..80).map(|c| term.candidates.matrix(c).unwrap()[(i, j)]).sum::<f64>());
        term.prior = Some(mean);
        let instance = Instance::new(&term.candidates, term.prior.as_ref(), &term.function, 12).unwrap();
        let mut picked: Vec<usize> = vec![];
        while picked.len() < 12 {
            let with = |i: usize| value(&instance, &[picked.as_slice(), &[i]].concat());
            let others = (0..80).filter(|i| !picked.contains(i));
            picked.push(others.max_by(|&a, &b| with(a).total_cmp(&with(b)).then(b.cmp(&a))).unwrap());
        }
        let found = greedy(&instance).unwrap();
        // Ties, and the ridge's last digits, may turn the order of two picks.
        let difference = value(&instance, &found) - value(&instance, &picked);
        assert!(found == picked || difference.abs() < 1e-6, "seed {seed}: {found:?} {picked:?} {difference:e}");
    }
}

/// A view that informs evenly gains more than any of many whose scores are higher, be it by little.
#[test]
fn greedy_looks_beyond_the_highest_scores() {
    let prior = DMatrix::identity(4, 4);
    let mut along = DMatrix::zeros(4, 4);
    along[(0, 0)] = 4.0;
    // Of log det^(1/4) the one gains ¼ ln 5, the other ln(1 + c).
    let even = &prior * (0.25 * 5f64.ln() + 5e-4).exp_m1();
    let views = [vec![&along; 200], vec![&even]].concat();
    let candidates = InformationSet::from_matrices(4, views).unwrap();
    let function = InformationFunction::Determinant;
    let instance = Instance::new(&candidates, Some(&prior), &function, 1).unwrap();
    assert_eq!(greedy(&instance).unwrap(), [200]);
}

/// The fewest candidates that reach a level, against exhaustion over every number; with no search at all, what is proven is
/// true all the same.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn no_fewer_reach_the_level() {
    for seed in 0..SEEDS {
        let mut case = Case::random(seed);
        case.constraints = Constraints::default();
        let mut reached = vec![];
        for count in 1..=4 {
            case.count = count;
            reached.push(case.optimum(&case.instance().unwrap()));
        }
        let instance = case.instance().unwrap();
        if !reached[2].is_finite() {
            continue;
        }
        let n = instance.len();
        let settings = RelaxationSettings::default();
        // A little below what three reach, just that, and a little above what two do, where bounds alone prove nothing.
        for level in [reached[2] - 0.01, reached[2], reached[1] + 1e-3] {
            if !(level.is_finite() && level <= reached[2]) {
                continue;
            }
            let least = 1 + reached.iter().position(|&value| value >= level).unwrap();
            let sought = |nodes: usize| {
                fewest(&instance, level, n, &settings, seed, nodes, &mut |_| ControlFlow::Continue(())).unwrap()
            };
            let found = sought(100_000);
            assert_eq!(found.best.selected.len(), least, "seed {seed}");
            // The proof ends at a number of which only singular sets were found; elsewhere it is complete.
            let nothing_found = |count: usize| best(&instance.with_count(count).unwrap(), &settings, seed).is_err();
            assert!(found.least == least || nothing_found(found.least), "seed {seed}: {found:?}");
            for found in [found, sought(0)] {
                assert!(found.best.log_value >= level, "seed {seed}");
                assert!(found.least <= least, "seed {seed}");
                let Some(refutation) = found.refutation else { continue };
                let fewer = instance.with_count(found.least - 1).unwrap();
                let Certificate { y, mixture, prices, log_bound } = refutation.certificate;
                assert_eq!(Certificate::new(&fewer, Gradient { y, mixture }, prices).unwrap().log_bound, log_bound);
                assert!(refutation.nodes > 0 || log_bound < level, "seed {seed}: no proof");
            }
        }
    }
}

/// Under constraints a larger number may not fit; that too few suffice is proven, or nothing is said.
#[test]
#[ignore = "slow: in the full set, `cargo test -- --ignored`"]
fn no_fewer_reach_the_level_under_constraints() {
    let (mut exact, mut never) = (0, 0);
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        if case.constraints.caps.is_empty() {
            continue;
        }
        let n = instance.len();
        let of = |count: usize| Case { count, ..case.clone() }.optimum(&instance);
        let reached: Vec<f64> = (1..=n).map(of).collect();
        let most = reached.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let settings = RelaxationSettings::default();
        let sought =
            |level: f64| fewest(&instance, level, n, &settings, seed, 100_000, &mut |_| ControlFlow::Continue(()));
        let levels = reached.iter().flat_map(|value| [value - 0.01, value + 1e-3]);
        for level in levels.filter(|level| level.is_finite() && *level <= most) {
            let least = 1 + reached.iter().position(|&value| value >= level).unwrap();
            let Ok(found) = sought(level) else { continue };
            assert!(found.best.log_value >= level && found.least <= least, "seed {seed}: {found:?}");
            exact += usize::from(found.best.selected.len() == least);
        }
        if let Err(NotEnough::Never { log_bound, .. }) = sought(most + 0.1) {
            assert!(log_bound >= most, "seed {seed}: {log_bound} {most}");
            never += usize::from(log_bound.is_finite());
        }
    }
    assert!(exact > 100 && never > 10, "{exact} {never}");
}

/// Of candidates that are all close to one of them the bound counts one, wherever on their line they are.
#[test]
fn the_bound_counts_one_of_those_too_close_to_each_other() {
    for offset in [0.0, 0.3, 0.77] {
        let places: Vec<[f64; 1]> = (0..30).map(|i| [offset + 0.2 * f64::from(i)]).collect();
        // Those from 2.0 to 2.8 know ten times as much as the others.
        let known = |i: usize| if (10..15).contains(&i) { 10.0 } else { 1.0 };
        let matrices: Vec<_> = (0..30).map(|i| DMatrix::from_element(1, 1, known(i))).collect();
        let candidates = InformationSet::from_matrices(1, &matrices).unwrap();
        let term =
            Term { candidates: &candidates, prior: None, function: &InformationFunction::Determinant, share: 1.0 };
        let constraints = Constraints { separations: vec![Separation::of(&places, 1.0)], ..Default::default() };
        let instance = Instance::constrained(&[term], 3, constraints).unwrap();
        let Best { selected, log_value, relaxation } = best(&instance, &RelaxationSettings::default(), 0).unwrap();
        assert!((log_value.exp() - 12.0).abs() < 1e-9, "{selected:?}");
        assert!((relaxation.certificate.log_bound.exp() - 12.0).abs() < 1e-6);
        assert!(relaxation.solved && !relaxation.certificate.prices.is_empty());
    }
}

/// A bound does not depend on where Y, the mixture and the prices came from: near the optimum's, far from it, or of deficient
/// rank.
#[test]
fn any_semidefinite_matrix_proves_a_bound() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let Some(instance) = case.instance() else { continue };
        let optimum = case.optimum(&instance);
        let mut rng = Xoshiro256Plus::seed_from_u64(seed ^ 0x5EED);
        for rank in 1..=8 {
            let y = instance.orders().map(|p| semidefinite(&mut rng, p, rank)).collect::<Vec<_>>();
            let mixture = (0..3).map(|_| rng.gen_range(0.0..1.0)).collect();
            let mut prices = vec![];
            if !case.constraints.caps.is_empty() {
                prices.push((Group::Cap(0), rng.gen_range(0.0..0.5)));
            }
            for separation in 0..case.constraints.separations.len() {
                let between = [0; 2].map(|_| rng.gen_range(0..instance.len()));
                prices.push((Group::Ball { separation, between }, rng.gen_range(0.0..0.5)));
            }
            let bound = Certificate::new(&instance, Gradient::new(&y, mixture), prices).unwrap().log_bound;
            assert!(bound >= optimum, "seed {seed}, rank {rank}: {bound} < {optimum}");
        }
        let zeros: Vec<_> = instance.orders().map(|p| DMatrix::zeros(p, p)).collect();
        let nothing = Gradient::new(&zeros, vec![1.0; 3]);
        assert_eq!(Certificate::new(&instance, nothing, vec![]).unwrap().log_bound, f64::INFINITY);
        // No mixture is one of negative parts, or of none.
        if seed < ONE_SCENARIO && seed % 7 == 4 {
            let y: Vec<_> = instance.orders().map(|p| DMatrix::identity(p, p)).collect();
            for mixture in [vec![-0.2, 0.6, 0.6], vec![0.0; 3], vec![]] {
                let gradient = Gradient::new(&y, mixture);
                assert_eq!(Certificate::new(&instance, gradient, vec![]).unwrap().log_bound, f64::INFINITY);
            }
        }
    }
}

/// Where all but one direction of a weight matter little, the bound does not gain from the roots of rounding.
#[test]
fn a_bound_holds_for_weights_of_little_rank() {
    for seed in 0..100 {
        let mut rng = Xoshiro256Plus::seed_from_u64(seed);
        let Q = normal(&mut rng, 3, 3).qr().q();
        let weight = &Q * DMatrix::from_diagonal(&vec![1.0, 1e-13, 1e-14].into()) * Q.transpose();
        let candidates = InformationSet::from_matrices(3, [&DMatrix::identity(3, 3)]).unwrap();
        let function = InformationFunction::variance(&weight);
        let instance = Instance::new(&candidates, None, &function, 1).unwrap();
        let gradient = instance.gradient(&[0]).unwrap();
        let slack = Certificate::new(&instance, gradient, vec![]).unwrap().log_bound - value(&instance, &[0]);
        assert!((0.0..1e-6).contains(&slack), "seed {seed}: {slack:e}");
    }
}

/// The terms of a score may be so large that what is left of them is rounding: the bound allows for that.
#[test]
fn a_bound_holds_though_its_terms_cancel() {
    for seed in 0..100 {
        let mut rng = Xoshiro256Plus::seed_from_u64(seed);
        let Q = normal(&mut rng, 3, 3).qr().q();
        let view = &Q * DMatrix::from_diagonal(&vec![1.0, 1e5, 1e9].into()) * Q.transpose();
        let candidates = InformationSet::from_matrices(3, [&view]).unwrap();
        let function = InformationFunction::min_eigenvalue();
        let instance = Instance::new(&candidates, None, &function, 1).unwrap();
        let gradient = instance.gradient(&[0]).unwrap();
        let slack = Certificate::new(&instance, gradient, vec![]).unwrap().log_bound - value(&instance, &[0]);
        assert!((0.0..1e-4).contains(&slack), "seed {seed}: {slack:e}");
    }
}

/// Intrinsics in unlike units: what is small of a weight is not drowned by what is large.
#[test]
fn a_weight_is_that_of_its_factor_in_any_units() {
    let mut rng = Xoshiro256Plus::seed_from_u64(0);
    let units = DMatrix::from_diagonal(&vec![1.0, 1e9, 1e-9].into());
    let weight = &units * semidefinite(&mut rng, 3, 2) * &units;
    let InformationFunction::Variance(L) = InformationFunction::variance(&weight) else { unreachable!() };
    assert_eq!(L.ncols(), 2);
    let product = &L * L.transpose();
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let scale = (weight[(i, i)] * weight[(j, j)]).sqrt();
        assert!((product[(i, j)] - weight[(i, j)]).abs() < 1e-12 * scale, "{i} {j}: {product} {weight}");
    }
}

/// With all candidates selected there is nothing to choose, so bound, relaxation and selection are one.
#[test]
fn the_bound_is_tight_where_there_is_no_choice() {
    for seed in 0..SEEDS {
        let case = Case::random(seed);
        let scenarios = case.scenarios();
        let n = scenarios[0][0].candidates.len();
        let instance = Instance::of_scenarios(&scenarios, n, Constraints::default()).unwrap();
        let best = best(&instance, &RelaxationSettings::default(), seed).unwrap();
        assert_eq!(best.selected, (0..n).collect::<Vec<_>>());
        let slack = best.relaxation.certificate.log_bound - value(&instance, &best.selected);
        let tolerance = if instance.is_smooth() { 1e-9 } else { RelaxationSettings::KINK_TOLERANCE };
        assert!((0.0..=tolerance).contains(&slack), "seed {seed}: {slack:e}");
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

/// Its price is taken off once.
#[test]
fn a_candidate_named_twice_in_a_group_counts_once() {
    let view = DMatrix::identity(1, 1);
    let candidates = InformationSet::from_matrices(1, [&view; 3]).unwrap();
    let function = InformationFunction::Determinant;
    let term = Term { candidates: &candidates, prior: None, function: &function, share: 1.0 };
    let bound = |members: &[usize]| {
        let caps = vec![Cap { members: members.to_vec(), most: 1 }];
        let instance = Instance::constrained(&[term], 3, Constraints { caps, ..Default::default() }).unwrap();
        Certificate::new(&instance, Gradient { y: vec![1.0], mixture: vec![] }, vec![(Group::Cap(0), 0.25)])
            .unwrap()
            .log_bound
    };
    // 1 + 2 (1 − ¼) + ¼
    assert!((bound(&[1, 0]) - 2.75f64.ln()).abs() < 1e-9);
    assert_eq!(bound(&[1, 0, 1]), bound(&[1, 0]));
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

#[test]
fn constraints_that_contradict_themselves_are_refused() {
    let view = DMatrix::identity(1, 1);
    let candidates = InformationSet::from_matrices(1, [&view; 4]).unwrap();
    let function = InformationFunction::Determinant;
    let term = Term { candidates: &candidates, prior: None, function: &function, share: 1.0 };
    let instance = |count, constraints| Instance::constrained(&[term], count, constraints);
    let required = |required: &[usize]| Constraints { required: required.to_vec(), ..Default::default() };
    let cap = |members: &[usize], most: usize| vec![Cap { members: members.to_vec(), most }];
    let apart =
        |least: f64, points: &[f64]| vec![Separation::of(&points.iter().map(|&x| [x]).collect::<Vec<_>>(), least)];
    let line = [0.0, 1.0, 2.0, 3.0];

    // As much as is allowed; of equal ones the first.
    for (selected, allowed) in [
        (vec![0, 1], Constraints::default()),
        (vec![0, 3], required(&[3, 0, 3])),
        (vec![0, 1, 2, 3], required(&[0, 1, 2, 3])),
        (vec![0, 1, 2], Constraints { forbidden: vec![3], ..Default::default() }),
        (vec![0, 1, 2], Constraints { caps: cap(&[0, 1, 1], 2), ..required(&[0, 1]) }),
        (vec![0, 1, 2], Constraints { separations: apart(1.0, &line), ..required(&[0, 1]) }),
        (vec![0, 1, 2, 3], Constraints { separations: apart(1.0, &line), ..Default::default() }),
        (vec![0, 1, 2, 3], Constraints { separations: apart(0.0, &[5.0; 4]), ..Default::default() }),
    ] {
        assert_eq!(greedy(&instance(selected.len(), allowed).unwrap()).unwrap(), selected);
    }

    // And a little more.
    let refused = |count, constraints| instance(count, constraints).unwrap_err();
    assert_eq!(refused(1, required(&[4])), SelectionError::NoSuchCandidate { candidate: 4, candidates: 4 });
    assert_eq!(
        refused(1, Constraints { forbidden: vec![1], ..required(&[1]) }),
        SelectionError::RequiredAndForbidden { candidate: 1 }
    );
    assert_eq!(refused(1, required(&[0, 1])), SelectionError::Allowed { count: 1, required: 2, available: 4 });
    assert_eq!(
        refused(4, Constraints { forbidden: vec![3], ..Default::default() }),
        SelectionError::Allowed { count: 4, required: 0, available: 3 }
    );
    assert_eq!(
        refused(2, Constraints { caps: cap(&[0, 1], 1), ..required(&[0, 1]) }),
        SelectionError::RequiredAboveCap { group: 0, required: 2, most: 1 }
    );
    assert_eq!(
        refused(2, Constraints { separations: apart(1.1, &line), ..required(&[0, 1]) }),
        SelectionError::RequiredTooClose { first: 0, second: 1, distance: 1.0, least: 1.1 }
    );
    let two = instance(2, required(&[0, 1])).unwrap();
    for count in [0, 1, 5] {
        assert_eq!(two.with_count(count).unwrap_err(), SelectionError::Allowed { count, required: 2, available: 4 });
    }
    assert!(instance(2, Constraints::default()).unwrap().with_count(0).is_err());
    for (points, least) in [(&line[..3], 1.0), (&[0.0, 1.0, 2.0, f64::NAN], 1.0), (&line, -1.0), (&line, f64::NAN)] {
        let refused = refused(1, Constraints { separations: apart(least, points), ..Default::default() });
        assert_eq!(refused, SelectionError::Separation { coordinates: points.len(), dimension: 1, candidates: 4 });
    }
    let mut uneven = apart(1.0, &line);
    uneven[0].dimension = 2;
    let refused = refused(1, Constraints { separations: uneven, ..Default::default() });
    assert_eq!(refused, SelectionError::Separation { coordinates: 4, dimension: 2, candidates: 4 });
    for shares in [&[0.5, 0.6], &[1.5, -0.5]] {
        let terms = shares.map(|share| Term { share, ..term });
        let refused = Instance::constrained(&terms, 1, Constraints::default()).unwrap_err();
        assert!(matches!(refused, SelectionError::Terms { .. }), "{refused:?}");
    }
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
            let SelectionError::Unobservable { count: 2, combination, .. } = refused else { panic!("{refused:?}") };
            assert_eq!(combination.iter().filter(|c| c.abs() > 1e-9).count(), 1, "{combination:?}");
            assert_eq!(combination.iter().copied().fold(0.0, f64::max), 1.0);
        }
        let refused = relax(&instance, &[0, 1], &RelaxationSettings::default()).unwrap_err();
        assert!(matches!(refused, SelectionError::Unobservable { count: 2, .. }), "{refused:?}");

        // Never seen by anyone: parameters 1 and 2 only as their sum.
        let blind = [along([1.0, 0.0, 0.0]), along([0.0, 1.0, 1.0]), along([1.0, 2.0, 2.0])];
        let candidates = InformationSet::from_matrices(3, &blind).unwrap();
        let refused = Instance::new(&candidates, None, &function, 3).unwrap_err();
        let SelectionError::Unobservable { count: 3, combination, .. } = refused else { panic!("{refused:?}") };
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

#[test]
fn priors_and_weights_that_mean_nothing_are_refused() {
    let matrices = [DMatrix::identity(2, 2), DMatrix::identity(2, 2)];
    let set = InformationSet::from_matrices(2, &matrices).unwrap();
    let d = InformationFunction::Determinant;
    let with_prior = |prior: DMatrix<f64>| Instance::new(&set, Some(&prior), &d, 1).err();
    assert!(matches!(with_prior(DMatrix::from_element(2, 2, f64::NAN)), Some(SelectionError::Prior(_))));
    assert!(matches!(with_prior(-DMatrix::identity(2, 2)), Some(SelectionError::Prior(_))));
    assert!(matches!(with_prior(DMatrix::zeros(2, 3)), Some(SelectionError::Order { .. })));
    for weight in [DMatrix::zeros(2, 2), DMatrix::from_element(2, 2, f64::NAN)] {
        let v = InformationFunction::variance(&weight);
        assert_eq!(Instance::new(&set, None, &v, 1).err(), Some(SelectionError::Weight));
    }
}

#[test]
fn what_is_no_selection_and_no_certificate_is_refused() {
    let set = InformationSet::from_matrices(1, &vec![DMatrix::identity(1, 1); 3]).unwrap();
    let instance = Instance::new(&set, None, &InformationFunction::Determinant, 2).unwrap();
    let settings = RelaxationSettings::default();
    let beyond = SelectionError::OutOfRange { candidate: 3, candidates: 3 };
    assert_eq!(exchange(&instance, vec![0, 3]).unwrap_err(), beyond);
    assert_eq!(relax(&instance, &[3, 1], &settings).unwrap_err(), beyond);
    assert_eq!(spares(&instance, &[0, 3], 1, &|_, _| true).unwrap_err(), beyond);
    assert_eq!(instance.log_value(&[3]).unwrap_err(), beyond);
    assert_eq!(instance.gradient(&[0, 0]).unwrap_err(), SelectionError::Twice { candidate: 0 });
    let start = best(&instance, &settings, 0).unwrap();
    let other = |start: &Best| search(&instance, start, f64::NEG_INFINITY, 1, &mut |_| ControlFlow::Continue(()));
    assert_eq!(other(&Best { selected: vec![0, 3], ..start.clone() }).unwrap_err(), beyond);
    let mut heavy = start.clone();
    heavy.relaxation.weights.push((3, 0.5));
    assert_eq!(other(&heavy).unwrap_err(), beyond);
    heavy = start;
    heavy.relaxation.certificate.y.clear();
    assert_eq!(other(&heavy).unwrap_err(), SelectionError::Length { what: "matrix Y", expected: 1, found: 0 });
    assert_eq!(without_each(&instance, &[1, 1]).unwrap_err(), SelectionError::Twice { candidate: 1 });
    assert_eq!(relax(&instance, &[1], &settings).unwrap_err(), SelectionError::TooFew { count: 2, found: 1 });
    let certificate = |y: Vec<f64>, prices| Certificate::new(&instance, Gradient { y, mixture: vec![] }, prices);
    let long = SelectionError::Length { what: "matrix Y", expected: 1, found: 2 };
    assert_eq!(certificate(vec![1.0, 1.0], vec![]).unwrap_err(), long);
    for group in [Group::Cap(0), Group::Ball { separation: 0, between: [0, 0] }] {
        let priced = SelectionError::NoSuchGroup { group };
        assert_eq!(certificate(vec![1.0], vec![(group, 1.0)]).unwrap_err(), priced);
    }
}
