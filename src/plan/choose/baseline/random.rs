//! Random selection, the baseline of baselines.

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256Plus;

/// `count` of `candidates` indices, uniformly at random without repetition, in ascending order.
pub fn random(candidates: usize, count: usize, seed: u64) -> Vec<usize> {
    let mut rng = Xoshiro256Plus::seed_from_u64(seed);
    let mut selected = rand::seq::index::sample(&mut rng, candidates, count.min(candidates)).into_vec();
    selected.sort_unstable();
    selected
}
