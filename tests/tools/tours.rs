//! How long tours take to find and how close they are to the best, for random configurations.
//!
//! ```text
//! cargo run --release --example tours
//! ```

#![allow(clippy::print_stdout, reason = "an example that prints")]

use std::time::Instant;

use calipose::motion::tour::{Costs, Ends, cost, lower_bound, tour};
use calipose::motion::{JointLimits, duration};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Instances that each line is the mean of.
const INSTANCES: u64 = 5;

/// Steps of the quick bound.
const FEW_STEPS: usize = 30;

fn main() {
    println!("joints stops ends      ms    gap %  worst   of order by id   quick bound: ms   short by %");
    for joints in [4, 7] {
        for stops in [10, 16, 20, 50, 200, 750] {
            for (name, ends) in [("open", Ends::Open), ("from", Ends::From(0)), ("round", Ends::Round(0))] {
                let measured: Vec<_> =
                    (0..INSTANCES).map(|seed| measure(&moves(stops, joints, seed), stops, ends)).collect();
                let [ms, gap, of_listed, quick_ms, short] =
                    std::array::from_fn(|i| measured.iter().map(|row| row[i]).sum::<f64>() / INSTANCES as f64);
                let worst = measured.iter().map(|row| row[1]).fold(0.0, f64::max);
                println!(
                    "{joints:6} {stops:5} {name:5} {ms:8.3} {gap:8.4} {worst:6.3} {of_listed:16.2} {quick_ms:17.3} {short:12.3}"
                );
            }
        }
    }
}

/// Time for the tour in ms, its gap in %, its share of the cost of the stops as listed, time for the quick bound in ms, and
/// what it lacks of the tour's in %.
fn measure(costs: &Costs, stops: usize, ends: Ends) -> [f64; 5] {
    let (ms, tour) = timed(|| tour(costs, ends, 0));
    let (quick_ms, quick) = timed(|| lower_bound(costs, ends, FEW_STEPS));
    let listed: Vec<usize> = (0..stops).collect();
    let of_listed = tour.cost / cost(costs, ends, &listed);
    [ms, 100.0 * tour.gap(), of_listed, quick_ms, 100.0 * (1.0 - quick / tour.bound)]
}

/// What `work` returns and how long it takes in ms: the mean of as many runs as fit into 20 ms, one at least.
fn timed<T>(work: impl Fn() -> T) -> (f64, T) {
    let start = Instant::now();
    for runs in 1.. {
        let result = work();
        let ms = start.elapsed().as_secs_f64() * 1e3;
        if ms > 20.0 {
            return (ms / f64::from(runs), result);
        }
    }
    unreachable!("time goes by")
}

/// Times of moves between random configurations, with random limits.
fn moves(stops: usize, joints: usize, seed: u64) -> Costs {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut random = |from: f64, to: f64| rng.gen_range(from..to);
    let limits: Vec<_> = (0..joints).map(|_| JointLimits::new(random(1.0, 3.0), random(2.0, 10.0))).collect();
    let configurations: Vec<Vec<_>> = (0..stops).map(|_| (0..joints).map(|_| random(-2.5, 2.5)).collect()).collect();
    Costs::from_fn(stops, |i, j| duration(&configurations[i], &configurations[j], &limits))
}
