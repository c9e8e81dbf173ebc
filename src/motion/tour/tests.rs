use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;
use crate::motion::{JointLimits, duration};

/// The kinds of ends that n stops allow.
fn kinds_of_ends(n: usize) -> Vec<Ends> {
    let homes = [0, n / 2, n.saturating_sub(1)];
    let with_home = homes.into_iter().filter(|_| n > 0).flat_map(|home| [Ends::From(home), Ends::Round(home)]);
    std::iter::once(Ends::Open).chain(with_home).collect()
}

/// Costs without any order in them, even the triangle inequality; many are equal, some are zero.
fn arbitrary(n: usize, seed: u64) -> Costs {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let steps = [3.0, 10.0, 1e6][seed as usize % 3];
    Costs::from_fn(n, |_, _| (rng.gen_range(0.0..1.0_f64) * steps).floor() / steps)
}

/// Times of moves between random configurations.
fn moves(n: usize, joints: usize, seed: u64) -> Costs {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut random = |from: f64, to: f64| rng.gen_range(from..to);
    let limits: Vec<_> = (0..joints).map(|_| JointLimits::new(random(1.0, 3.0), random(2.0, 10.0))).collect();
    let configurations: Vec<Vec<_>> = (0..n).map(|_| (0..joints).map(|_| random(-2.5, 2.5)).collect()).collect();
    Costs::from_fn(n, |i, j| duration(&configurations[i], &configurations[j], &limits))
}

/// The least cost of all orders.
fn least_cost(costs: &Costs, ends: Ends) -> f64 {
    let mut order: Vec<usize> = ends.home().into_iter().collect();
    order.extend((0..costs.len()).filter(|&i| Some(i) != ends.home()));
    let fixed = usize::from(ends.home().is_some());
    let mut least = f64::INFINITY;
    for_each_permutation(&mut order, fixed, &mut |order| least = least.min(cost(costs, ends, order)));
    least
}

fn for_each_permutation(order: &mut [usize], fixed: usize, visit: &mut impl FnMut(&[usize])) {
    if fixed == order.len() {
        return visit(order);
    }
    for i in fixed..order.len() {
        order.swap(fixed, i);
        for_each_permutation(order, fixed + 1, visit);
        order.swap(fixed, i);
    }
}

fn assert_valid(tour: &Tour, costs: &Costs, ends: Ends) {
    let mut stops = tour.order.clone();
    stops.sort_unstable();
    assert!(stops.into_iter().eq(0..costs.len()), "{tour:?}");
    assert!(ends.home().is_none_or(|home| tour.order[0] == home), "{ends:?} {tour:?}");
    assert_eq!(tour.cost, cost(costs, ends, &tour.order));
    assert!(0.0 <= tour.bound && tour.bound <= tour.cost, "{tour:?}");
}

/// Of as few stops as dynamic programming orders.
fn searched(costs: &Costs, ends: Ends, seed: u64) -> Tour {
    let circuit = Circuit::new(costs, ends);
    let proof = Proof::of(&circuit.costs, STEPS);
    let order = circuit.order(search::improved(&circuit.costs, &proof, seed));
    Tour::new(costs, ends, order, Some(circuit.bound(&proof)))
}

#[test]
fn few_stops_are_ordered_as_well_as_by_trying_every_order() {
    for n in 0..=8 {
        for ends in kinds_of_ends(n) {
            for seed in 0..6 {
                let costs = arbitrary(n, seed);
                let (tour, least) = (tour(&costs, ends, 0), least_cost(&costs, ends));
                assert_valid(&tour, &costs, ends);
                assert!((tour.cost - least).abs() <= 1e-12, "{n} {ends:?} {seed}: {} {least}", tour.cost);
                assert_eq!(tour.gap(), 0.0);
            }
        }
    }
}

#[test]
fn no_bound_exceeds_the_least_cost() {
    for n in 0..=8 {
        for ends in kinds_of_ends(n) {
            for seed in 0..6 {
                let costs = arbitrary(n, seed);
                let least = least_cost(&costs, ends);
                for steps in [0, 1, 7, 50, 500] {
                    let bound = lower_bound(&costs, ends, steps);
                    assert!((0.0..=least).contains(&bound), "{n} {ends:?} {seed} {steps}: {bound} {least}");
                }
            }
        }
    }
}

#[test]
fn the_search_finds_what_dynamic_programming_proves() {
    for ends in kinds_of_ends(12) {
        for seed in 0..6 {
            for costs in [arbitrary(12, seed), moves(12, 6, seed)] {
                let (tour, searched) = (tour(&costs, ends, seed), searched(&costs, ends, seed));
                assert_valid(&searched, &costs, ends);
                assert!((searched.cost - tour.cost).abs() <= 1e-9, "{ends:?} {seed}: {searched:?} {tour:?}");
                assert!(searched.bound <= tour.cost && searched.gap() < 0.1, "{ends:?} {seed}: {searched:?}");
            }
        }
    }
}

#[test]
fn tours_of_many_moves_are_close_to_their_bound() {
    for (joints, ends) in [(4, Ends::Open), (5, Ends::From(0)), (6, Ends::Round(100)), (7, Ends::Open)] {
        let costs = moves(200, joints, 1);
        let tour = tour(&costs, ends, 0);
        assert_valid(&tour, &costs, ends);
        assert!(tour.gap() < 0.005, "{joints} {ends:?}: {}", tour.gap());
        let quick = lower_bound(&costs, ends, 30);
        assert!((0.98 * tour.cost..tour.cost).contains(&quick), "{joints} {ends:?}: {quick} {}", tour.cost);
    }
}

#[test]
fn the_same_seed_gives_the_same_tour() {
    let costs = moves(40, 4, 2);
    for ends in kinds_of_ends(40) {
        assert_eq!(tour(&costs, ends, 5), tour(&costs, ends, 5));
    }
}

#[test]
fn tours_that_cost_the_same_both_ways_go_the_way_with_the_lower_number_early() {
    let line = |n: usize| Costs::from_fn(n, |i, j| (j - i) as f64);
    for n in [5, 30] {
        assert!(tour(&line(n), Ends::Open, 0).order.into_iter().eq(0..n));
        assert!(tour(&line(n), Ends::From(n - 1), 0).order.into_iter().eq((0..n).rev()));
        let round = tour(&line(n), Ends::Round(1), 0);
        assert!(round.order[1] < round.order[n - 1]);
        assert_eq!(round.cost, 2.0 * (n - 1) as f64);
    }
}

#[test]
fn stops_at_one_place_cost_nothing() {
    for n in [2, 9, 30] {
        for ends in kinds_of_ends(n) {
            let costs = Costs::from_fn(n, |_, _| 0.0);
            let tour = tour(&costs, ends, 0);
            assert_valid(&tour, &costs, ends);
            assert_eq!((tour.cost, tour.bound, tour.gap()), (0.0, 0.0, 0.0));
        }
    }
}

#[test]
fn costs_of_any_scale_are_met() {
    for scale in [1e-9, 1e9] {
        let (plain, scaled) = (moves(30, 5, 3), moves(30, 5, 3));
        let scaled = Costs::from_fn(30, |i, j| scale * scaled.between(i, j));
        let (plain, scaled) = (tour(&plain, Ends::From(3), 0), tour(&scaled, Ends::From(3), 0));
        assert!((scaled.cost / plain.cost / scale - 1.0).abs() < 1e-9);
        assert!((scaled.bound / plain.bound / scale - 1.0).abs() < 1e-4);
    }
}

#[test]
#[should_panic(expected = "From(3) of 3 stops")]
fn home_is_a_stop() {
    tour(&arbitrary(3, 0), Ends::From(3), 0);
}
