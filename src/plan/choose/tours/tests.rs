//! Small cases, against all sets.

use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Times;
use super::bound::{Good, Scores, nearest};
use super::swaps::{Aim, Market};
use crate::motion::JointLimits;
use crate::problem::{Home, MotionSettings};
use crate::selection::{
    Certificate, Constraints, Gradient, InformationFunction, InformationSet, Instance, RelaxationSettings, Separation,
    Term, best,
};

/// Views of two parameters from two joints: what a view tells depends on where it is.
struct Small {
    joints: Vec<Vec<f64>>,
    candidates: InformationSet,
    motion: MotionSettings,
    constraints: Constraints,
}

const COUNT: usize = 4;

/// Random cases.
const RUNS: usize = 30;

impl Small {
    fn random(seed: u64) -> Self {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let joints: Vec<Vec<f64>> = (0..13).map(|_| vec![rng.gen_range(-1.0..1.0), rng.gen_range(-2.0..2.0)]).collect();
        let told = |q: &Vec<f64>| {
            let (s, c) = (1.5 * q[0] + 0.3 * q[1]).sin_cos();
            let strength = 1.0 + 0.3 * q[1].abs();
            let g = nalgebra::DVector::from_vec(vec![strength * c, strength * s, 0.5 * q[1]]);
            &g * g.transpose() + 0.01 * DMatrix::identity(3, 3)
        };
        let matrices: Vec<DMatrix<f64>> = joints.iter().map(told).collect();
        let home = match seed % 3 {
            0 => None,
            which => Some(Home { q: vec![rng.gen_range(-1.5..1.5), 0.5], returns: which == 1 }),
        };
        Self {
            candidates: InformationSet::from_matrices(3, &matrices).unwrap(),
            motion: MotionSettings {
                greatest: vec![JointLimits::new(0.5, 1.0), JointLimits::new(1.0, 0.7)],
                share: 1.0,
                assumed: vec![],
                home,
                dwell: 0.25,
            },
            constraints: Constraints {
                required: if seed.is_multiple_of(2) { vec![7] } else { vec![] },
                separations: vec![Separation::of(&joints, 0.3)],
                ..Constraints::default()
            },
            joints,
        }
    }

    fn joints(&self) -> Vec<&[f64]> {
        self.joints.iter().map(Vec::as_slice).collect()
    }

    /// All sets that are allowed, with log Φ and the least time of their moves.
    fn all(&self, instance: &Instance, times: &Times) -> Vec<(Vec<usize>, f64, f64)> {
        let mut all = Vec::new();
        for bits in 0..1_u32 << self.joints.len() {
            let set: Vec<usize> = (0..self.joints.len()).filter(|&i| bits >> i & 1 == 1).collect();
            let does_hold = self.constraints.required.iter().all(|i| set.contains(i));
            let apart = set.iter().enumerate().all(|(c, &i)| instance.rules().allows(&set[..c], None, i));
            if set.len() == COUNT && does_hold && apart {
                let log_value = instance.log_value(&set).unwrap();
                let moving = self.moving(times, &set);
                all.push((set, log_value, moving));
            }
        }
        all
    }

    /// The least time of all orders.
    fn moving(&self, times: &Times, set: &[usize]) -> f64 {
        let mut orders = vec![vec![]];
        for &i in set {
            let with = |order: &Vec<usize>| {
                (0..=order.len())
                    .map(|at| {
                        let mut order = order.clone();
                        order.insert(at, i);
                        order
                    })
                    .collect::<Vec<_>>()
            };
            orders = orders.iter().flat_map(with).collect();
        }
        let along = |order: &Vec<usize>| {
            let q = |c: usize| self.joints[order[c]].as_slice();
            let between: f64 = (1..order.len()).map(|c| times.between(q(c - 1), q(c))).sum();
            times.begin(q(0)) + between + times.end(q(order.len() - 1))
        };
        orders.iter().map(along).fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn trades_are_allowed_and_about_as_good_as_the_best_of_all_sets() {
    let (mut best_times, mut best_values) = (0, 0);
    for seed in 0..RUNS as u64 {
        let small = Small::random(seed);
        let function = InformationFunction::Determinant;
        let term = Term { candidates: &small.candidates, prior: None, function: &function, share: 1.0 };
        let instance = Instance::constrained(&[term], COUNT, small.constraints.clone()).unwrap();
        let times = Times::new(&small.motion);
        let joints = small.joints();
        let market = Market::new(&instance, &joints, &times, 0..joints.len(), 0);
        let all = small.all(&instance, &times);
        let first = best(&instance, &RelaxationSettings::default(), 0).unwrap();
        let certificate = &first.relaxation.certificate;

        let floor = first.log_value - 0.2;
        let found = market.trade(&first.selected, Aim::LeastTime { floor }, &mut |_| {}).unwrap();
        let mut set = found.order.clone();
        set.sort_unstable();
        let same = all.iter().find(|(other, ..)| *other == set).expect("the constraints allow it");
        assert!((same.1 - found.log_value).abs() < 1e-9 && (same.2 - found.moving).abs() < 1e-9);
        assert!(found.log_value >= floor);
        let good = || all.iter().filter(|(_, log_value, _)| *log_value >= floor);
        let least = good().map(|(.., moving)| *moving).fold(f64::INFINITY, f64::min);
        best_times += usize::from(found.moving < least + 1e-9);
        // All at once, and the best few first.
        for few in [joints.len(), COUNT + 2] {
            let good = Good { instance: &instance, certificate, floor, joints: &joints, times: &times, first: few };
            let bound = good.least_moving();
            assert!(bound <= least + 1e-9, "seed {seed}: {bound} {least}");
            assert!(bound > 0.2 * least, "seed {seed}: {bound} {least}");
        }

        let most = 0.8 * market.route(&first.selected).moving;
        let found = market.trade(&first.selected, Aim::MostInformation { most }, &mut |_| {});
        let Some(found) = found else { continue };
        assert!(found.moving <= most);
        let fast = all.iter().filter(|(.., moving)| *moving <= most).map(|(_, log_value, _)| *log_value);
        let greatest = fast.fold(f64::NEG_INFINITY, f64::max);
        best_values += usize::from(found.log_value > greatest - 1e-9);
        assert!(found.log_value > greatest - 0.5, "seed {seed}: {} {greatest}", found.log_value);
    }
    assert!(best_times > RUNS * 2 / 3 && best_values > RUNS * 2 / 3, "{best_times} {best_values} of {RUNS}");
}

/// Where views are said not to suffice none of their sets does, even if the best few of them do not and others do.
#[test]
fn views_that_fall_short_hold_no_good_set() {
    let mut short = 0;
    for seed in 0..RUNS as u64 {
        let small = Small::random(seed);
        let function = InformationFunction::Determinant;
        let term = Term { candidates: &small.candidates, prior: None, function: &function, share: 1.0 };
        let instance = Instance::constrained(&[term], COUNT, small.constraints.clone()).unwrap();
        let times = Times::new(&small.motion);
        let joints = small.joints();
        let all = small.all(&instance, &times);
        let first = best(&instance, &RelaxationSettings::default(), 0).unwrap();
        let certificate = &first.relaxation.certificate;
        let scores = Scores::new(&instance, certificate);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        for _ in 0..20 {
            let members: Vec<usize> = (0..joints.len()).filter(|_| rng.gen_bool(0.7)).collect();
            let holds = |set: &[usize]| set.iter().all(|i| members.contains(i));
            let of_members = all.iter().filter(|(set, ..)| holds(set)).map(|(_, log_value, _)| *log_value);
            let greatest = of_members.fold(f64::NEG_INFINITY, f64::max);
            if greatest == f64::NEG_INFINITY {
                continue;
            }
            // A little below what they reach, and much above it.
            for floor in [greatest - 1e-6, greatest + 3.0] {
                for few in COUNT..=joints.len() {
                    let good =
                        Good { instance: &instance, certificate, floor, joints: &joints, times: &times, first: few };
                    let found = good.falls_short(&members, &scores);
                    assert!(!found || greatest < floor, "seed {seed}: {greatest} {floor}");
                    short += usize::from(found);
                }
            }
        }
    }
    assert!(short > 10 * RUNS, "{short}");
}

/// The first two of four views are looked at, then the best two by their certificate, one of the first again among them: three in all,
/// and the fourth is one of the best pair.
#[test]
fn views_that_are_generated_again_are_no_others() {
    let views = [[1.0, 0.0, 16.0], [13.0, 0.0, 13.0], [17.0, -9.0, 5.0], [10.0, -7.0, 17.0]];
    let matrices = views.map(|[a, b, c]| DMatrix::from_row_slice(2, 2, &[a, b, b, c]));
    let candidates = InformationSet::from_matrices(2, &matrices).unwrap();
    let instance = Instance::new(&candidates, None, &InformationFunction::Determinant, 2).unwrap();
    // A poor certificate, by which the first two are best.
    let y = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.9, 1.0]);
    let certificate = &Certificate::new(&instance, Gradient::new(&[y], vec![]), vec![]).unwrap();
    let motion = Small::random(0).motion;
    let floor = instance.log_value(&[1, 3]).unwrap() - 1e-6;
    assert!([[0, 1], [1, 2], [0, 2]].iter().all(|pair| instance.log_value(pair).unwrap() < floor - 0.1));
    let (joints, times) = ([[0.0].as_slice(); 4], Times::new(&motion));
    let good = Good { instance: &instance, certificate, floor, joints: &joints, times: &times, first: 2 };
    let scores = Scores::new(&instance, certificate);
    assert!(good.falls_short(&[0, 1, 2], &scores));
    assert!(!good.falls_short(&[0, 1, 2, 3], &scores));
}

#[test]
fn sets_are_resized_by_what_they_tell_for_their_time() {
    let small = Small::random(2);
    let function = InformationFunction::Determinant;
    let term = Term { candidates: &small.candidates, prior: None, function: &function, share: 1.0 };
    let instance = Instance::constrained(&[term], COUNT, small.constraints.clone()).unwrap();
    let times = Times::new(&small.motion);
    let joints = small.joints();
    let market = Market::new(&instance, &joints, &times, 0..joints.len(), 0);
    let start = market.route(&best(&instance, &RelaxationSettings::default(), 0).unwrap().selected);
    for count in [3, 4, 6] {
        let resized = market.resized(&start, count).unwrap();
        assert_eq!(resized.len(), count);
        assert!(resized.contains(&7), "a required one stays");
        assert!(resized.iter().enumerate().all(|(c, &i)| instance.rules().allows(&resized[..c], None, i)));
        assert_eq!(resized.iter().filter(|i| start.order.contains(i)).count(), count.min(COUNT));
    }
}

/// Random walks that keep what the bound is of.
#[test]
fn no_tour_crosses_a_joint_faster_than_the_bound() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut tightest = f64::INFINITY;
    for seed in 0..2000 {
        let mut small = Small::random(seed);
        if seed % 2 == 0 {
            small.motion.greatest[0].jerk = rng.gen_range(0.3..6.0);
        }
        let times = Times::new(&small.motion);
        let poses = rng.gen_range(1..6);
        let q: Vec<Vec<f64>> = (0..poses).map(|_| vec![rng.gen_range(-1.0..1.0), rng.gen_range(-0.1..0.1)]).collect();
        let q: Vec<&[f64]> = q.iter().map(Vec::as_slice).collect();
        let [low, high] = [f64::min, f64::max].map(|of| q.iter().map(|q| q[0]).reduce(of).unwrap());
        let pairs = q.windows(2).map(|pair| times.between(pair[0], pair[1]));
        let nearest = pairs.clone().fold(f64::INFINITY, f64::min);
        let nearest = if nearest.is_finite() { nearest } else { 0.0 };
        let taken = times.begin(q[0]) + pairs.sum::<f64>() + times.end(q[q.len() - 1]);
        let bound = times.least_across(0, [low, high], q.len(), nearest);
        assert!(bound <= taken + 1e-12, "{bound} {taken}: {q:?} {:?}", small.motion.home);
        tightest = tightest.min(taken - bound);
    }
    assert!(tightest < 0.01, "{tightest}");
}

#[test]
fn the_nearest_views_are_those_that_may_be_chosen_together() {
    let small = Small::random(1);
    let function = InformationFunction::Determinant;
    let term = Term { candidates: &small.candidates, prior: None, function: &function, share: 1.0 };
    let of = |constraints| Instance::constrained(&[term], COUNT, constraints).unwrap();
    let (apart, free) = (of(small.constraints.clone()), of(Constraints::default()));
    let times = Times::new(&small.motion);
    let all: Vec<usize> = (0..small.joints.len()).collect();
    let least = |instance: &Instance| {
        let pairs = all.iter().flat_map(|&i| all[i + 1..].iter().map(move |&j| (i, j)));
        let allowed = pairs.filter(|&(i, j)| instance.rules().allows(&[i], None, j));
        allowed.map(|(i, j)| times.between(&small.joints[i], &small.joints[j])).fold(f64::INFINITY, f64::min)
    };
    for instance in [&apart, &free] {
        assert_eq!(nearest(instance, &small.joints(), &times, &all), least(instance));
    }
    assert!(least(&free) < least(&apart));
}
