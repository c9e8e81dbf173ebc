use std::sync::atomic::{AtomicUsize, Ordering};

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::scout::Scout;
use super::super::*;
use super::worlds::*;
use crate::robot::Limits;

const UNIT: Limits = Limits { min: -1.0, max: 1.0 };

fn space<'a>(margins: &'a dyn Margins, limits: &'a [Limits]) -> Space<'a> {
    Space { margins, limits, cost: &euclidean }
}

/// The way joins the ends within the limits, costs what it says, and holds what it promises.
fn assert_valid(space: &Space, from: &[f64], to: &[f64], way: &Way) {
    assert_eq!((way.corners[0].as_slice(), way.corners[way.corners.len() - 1].as_slice()), (from, to));
    assert!(way.corners.iter().all(|q| q.iter().zip(space.limits).all(|(q, l)| (l.min..=l.max).contains(q))));
    let cost: f64 = way.corners.windows(2).map(|pair| (space.cost)(&pair[0], &pair[1])).sum();
    assert_eq!((way.cost, way.proofs.len()), (cost, way.corners.len() - 1));
    for (pair, proof) in way.corners.windows(2).zip(&way.proofs) {
        assert_holds(space.margins, &pair[0], &pair[1], &proof.bounds, 10_000);
        assert!(way.bounds().iter().zip(&proof.bounds).all(|(of_way, of_move)| of_way <= of_move));
    }
    assert_eq!(way.least(), way.bounds().into_iter().fold(f64::INFINITY, f64::min));
}

#[test]
fn a_safe_straight_move_is_the_way() {
    let maze = Maze::with_door(2, 0.2, 0.01);
    let way = find(&space(&maze, &[UNIT; 2]), &[-0.5, 0.7], &[0.5, 0.7], &Settings::default()).unwrap();
    assert_eq!((way.corners.len(), way.effort.nodes, way.cost), (2, 0, 1.0));
    assert!(way.least() > 0.089 && way.least() < 0.09, "{}", way.least());
}

#[test]
fn narrow_doors_are_found_and_passed_on_a_short_way() {
    for (dimensions, door, seed) in [(2, 0.1, 0), (2, 0.05, 1), (2, 0.04, 2), (3, 0.1, 3), (3, 0.05, 4)] {
        let maze = Maze::with_door(dimensions, door, 0.01);
        let limits = vec![UNIT; dimensions];
        let space = space(&maze, &limits);
        let (mut from, mut to) = (vec![-0.8, -0.5], vec![0.8, -0.5]);
        from.resize(dimensions, 0.0);
        to.resize(dimensions, 0.3);
        let settings = Settings { seed, ..Settings::default() };
        let way = find(&space, &from, &to, &settings).unwrap();
        assert_valid(&space, &from, &to, &way);
        // Taut about the door's edges, less what rounding them saves.
        let taut = 2.0 * (0.75_f64.hypot(1.2 - door / 2.0)).hypot(if dimensions == 3 { 0.14 } else { 0.0 }) + 0.1;
        assert!(way.cost > taut && way.cost < 1.1 * taut, "{dimensions} {door}: {} {taut}", way.cost);
        let back = find(&space, &to, &from, &settings).unwrap();
        assert_valid(&space, &to, &from, &back);
    }
}

#[test]
fn no_way_is_found_where_there_is_none() {
    let most = Effort { nodes: 2000, evaluations: 20_000 };
    // No door; one as wide as the clearance on both sides; one that is narrower.
    for door in [0.0, 0.02, 0.015] {
        let maze = Maze::with_door(2, door, 0.01);
        let settings = Settings { most, ..Settings::default() };
        let no_way = find(&space(&maze, &[UNIT; 2]), &[-0.8, 0.7], &[0.8, 0.7], &settings).unwrap_err();
        let NoWay::NotFound { effort, reached: [start, goal] } = no_way else { panic!("{no_way:?}") };
        assert!(effort.nodes >= most.nodes || effort.evaluations >= most.evaluations, "{effort:?}");
        assert_eq!(start + goal, effort.nodes + 2);
        assert!(no_way.to_string().contains("does not prove that there is none"));
    }
}

#[test]
fn arms_find_ways_about_discs() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let (mut tried, mut found) = (0, 0);
    while tried < 60 {
        let arm = Arm::random(&mut rng);
        let limits = vec![Limits { min: -3.0, max: 3.0 }; arm.lengths.len()];
        let space = space(&arm, &limits);
        let (from, to) = (arm.configuration(&mut rng), arm.configuration(&mut rng));
        // A joint alone has no way round.
        if arm.lengths.len() == 1 || prove(&arm, &from, &to, Precision::VERDICT).is_ok() {
            continue;
        }
        let most = Effort { nodes: 2000, evaluations: 20_000 };
        match find(&space, &from, &to, &Settings { most, ..Settings::default() }) {
            Ok(way) => {
                assert_valid(&space, &from, &to, &way);
                found += 1;
            }
            Err(NoWay::Unsafe { .. }) => continue,
            Err(no_way) => assert!(matches!(no_way, NoWay::NotFound { .. }), "{no_way:?}"),
        }
        tried += 1;
    }
    assert!(found >= 30, "{found}");
}

/// A metric by which a stop costs time.
fn with_stops(from: &[f64], to: &[f64]) -> f64 {
    euclidean(from, to).sqrt()
}

#[test]
fn shortening_never_lengthens_and_proves_what_it_makes() {
    let maze = Maze::with_door(2, 0.1, 0.01);
    for seed in 0..20 {
        for cost in [euclidean, with_stops] {
            let space = Space { cost: &cost, ..space(&maze, &[UNIT; 2]) };
            let settings = Settings { seed, ..Settings::default() };
            let mut scout = Scout::new(&space, &settings);
            let raw = connect::connect(&mut scout, &[-0.8, -0.5], &[0.8, 0.0]).unwrap();
            let short = shorten::shorten(&mut scout, raw.clone());
            let length = |corners: &[Vec<f64>]| corners.windows(2).map(|pair| cost(&pair[0], &pair[1])).sum::<f64>();
            let shorter = shorten::shorten(&mut scout, short.clone());
            let lengths = [&raw, &short, &shorter].map(|corners| length(corners));
            assert!(lengths.is_sorted_by(|a, b| *b <= a * (1.0 + 1e-9)), "{lengths:?}");
            assert_eq!((&short[0], short.last()), (&raw[0], raw.last()));
            for pair in short.windows(2) {
                assert!(prove(&maze, &pair[0], &pair[1], settings.precision).is_ok());
            }
        }
    }
}

#[test]
fn the_seed_decides() {
    let maze = Maze::with_door(2, 0.1, 0.01);
    let way = |seed| {
        let settings = Settings { seed, ..Settings::default() };
        find(&space(&maze, &[UNIT; 2]), &[-0.8, -0.5], &[0.8, 0.0], &settings).unwrap()
    };
    assert_eq!(way(1), way(1));
    assert_ne!(way(1), way(2));
}

#[test]
fn ends_that_are_not_allowed_are_told() {
    let maze = Maze::with_door(2, 0.1, 0.01);
    let find = |from: [f64; 2], to: [f64; 2]| find(&space(&maze, &[UNIT; 2]), &from, &to, &Settings::default());
    let no_way = find([-0.5, 0.0], [0.05, 0.0]).unwrap_err();
    assert_eq!(no_way, NoWay::Unsafe { end: End::Goal, margin: 0, value: -0.01 });
    assert_eq!(no_way.to_string(), "margin 0 is -0.01 m at the goal");
    for outside in [1.01, f64::NAN, f64::INFINITY] {
        assert_eq!(find([-0.5, outside], [0.5, 0.0]), Err(NoWay::Outside { end: End::Start, joint: 1 }));
    }
    assert!(find([-1.0, 1.0], [-1.0, -1.0]).is_ok());
}

#[test]
fn degenerate_spaces() {
    let none = Laws(vec![]);
    let way = find(&space(&none, &[]), &[], &[], &Settings::default()).unwrap();
    assert_eq!((way.corners.len(), way.cost, way.least(), way.bounds()), (2, 0.0, f64::INFINITY, vec![]));
    // One joint that cannot pass, within limits that leave nothing to try.
    let most = Effort { nodes: 100, evaluations: 1000 };
    let blocked = Laws::one(1.0, |q| q.abs() - 0.1);
    let settings = Settings { most, ..Settings::default() };
    let no_way = find(&space(&blocked, &[Limits { min: -0.2, max: 0.2 }]), &[-0.2], &[0.2], &settings);
    assert!(matches!(no_way, Err(NoWay::NotFound { .. })), "{no_way:?}");
}

/// Turns unsafe after so many measurements.
struct Fickle {
    maze: Maze,
    left: AtomicUsize,
}

impl Margins for Fickle {
    fn at<'a>(&'a self, q: &'a [f64]) -> Measure<'a> {
        let before = self.left.load(Ordering::Relaxed);
        self.left.store(before.saturating_sub(1), Ordering::Relaxed);
        if before == 0 { Box::new(|_, _| -1.0) } else { self.maze.at(q) }
    }

    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        self.maze.changes(from, to)
    }
}

#[test]
fn margins_that_break_their_word_are_found_out() {
    let fickle = |measurements| {
        let world = Fickle { maze: Maze::with_door(2, 0.1, 0.01), left: AtomicUsize::new(measurements) };
        find(&space(&world, &[UNIT; 2]), &[-0.8, -0.5], &[0.8, 0.0], &Settings::default())
    };
    let Effort { evaluations, .. } = fickle(usize::MAX).unwrap().effort;
    assert!(fickle(evaluations).is_ok());
    assert_eq!(fickle(evaluations - 1), Err(NoWay::Contradiction { margin: 0 }));
}
