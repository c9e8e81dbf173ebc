//! Selection without robots and cameras: random instances of the optimal-design literature, solved and certified.
//!
//! ```text
//! cargo run --release --example optimal_design            # the table of docs/src/validation.md
//! cargo run --release --example optimal_design -- 1000000 # one instance of so many candidates, timed
//! cargo run --release --example optimal_design -- published # classes of which exact times are published
//! ```

#![allow(non_snake_case, clippy::print_stdout, clippy::expect_used, reason = "an example that prints")]

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use calipose::selection::{
    Best, InformationFunction, InformationSet, Instance, RelaxationSettings, Search, SearchEnd, SearchProgress, best,
    exchange, greedy, relax, search,
};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256Plus;

/// Order of the matrices.
const P: usize = 9;

/// Time that a search for the proven best set may take.
const PATIENCE: Duration = Duration::from_mins(1);

/// Published classes: instances of each.
const SEEDS: u64 = 5;

/// How a candidate's matrix is drawn.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// `JᵀJ`, J (6×p) standard normal, columns two decades of units apart and of a size drawn for each candidate.
    Hetero,
    /// The same without the size.
    Wishart,
    /// `g gᵀ`, g standard normal.
    RankOne,
}

/// n candidates, whitened by the inverse root of k of their mean: numbers of order one.
fn instance(kind: Kind, n: usize, k: usize) -> InformationSet {
    let mut rng = Xoshiro256Plus::seed_from_u64(9);
    let mut normal = || -> f64 { rng.sample(StandardNormal) };
    let rows = if matches!(kind, Kind::RankOne) { 1 } else { 6 };
    let mut drawn = || {
        let mut J = DMatrix::zeros(rows, P);
        for j in 0..P {
            let size = if matches!(kind, Kind::Hetero) { (0.5 * normal()).exp() } else { 1.0 };
            let unit = if rows == 1 { 1.0 } else { 10f64.powf(-1.0 + 2.0 * j as f64 / (P - 1) as f64) };
            for r in 0..rows {
                J[(r, j)] = normal() * size * unit;
            }
        }
        J
    };
    let Js: Vec<DMatrix<f64>> = (0..n).map(|_| drawn()).collect();
    let sum = Js.iter().fold(DMatrix::zeros(P, P), |sum, J| sum + J.transpose() * J);
    let L = (sum * (k as f64 / n as f64)).cholesky().expect("the candidates determine every parameter").l();
    let mut table = Vec::with_capacity(n * P * (P + 1) / 2);
    for J in Js {
        let white = L.solve_lower_triangular(&J.transpose()).expect("a regular factor");
        let M = &white * white.transpose();
        table.extend((0..P).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|place| M[place]));
    }
    InformationSet::from_packed(P, table).expect("JᵀJ is semidefinite")
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed().as_secs_f64())
}

/// Searches until the best set is proven or patience ends.
fn searched(instance: &Instance, start: &Best) -> Search {
    let began = Instant::now();
    let mut observe = |_: &SearchProgress| {
        if began.elapsed() > PATIENCE { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    search(instance, start, f64::NEG_INFINITY, usize::MAX, &mut observe).expect("a start of the instance")
}

fn solve(kind: Kind, criterion: &str, function: &InformationFunction, n: usize, k: usize) {
    let candidates = instance(kind, n, k);
    let instance = Instance::new(&candidates, None, function, k).expect("a regular instance");
    let settings = RelaxationSettings::default();
    let (start, best_time) = timed(|| best(&instance, &settings, 0).expect("regular sets"));
    let (found, search_time) = timed(|| searched(&instance, &start));
    let before = start.relaxation.certificate.efficiency(start.log_value);
    let after = (found.log_value - found.log_bound).exp();
    let end = if found.end == SearchEnd::Optimal { "proven optimal" } else { "gap left" };
    println!(
        "| {kind:?} | {criterion} | {n} | {k} | {before:.4} | {best_time:.2} | {end}, {after:.4} | {:.2} | {} |",
        search_time, found.nodes
    );
}

/// Times greedy and the relaxation alone.
fn time(n: usize) {
    let candidates = instance(Kind::Hetero, n, 20);
    let (instance, checked) =
        timed(|| Instance::new(&candidates, None, &InformationFunction::Determinant, 20).expect("a regular instance"));
    let (picked, greedy_time) = timed(|| greedy(&instance).expect("regular sets"));
    let (swapped, exchange_time) = timed(|| exchange(&instance, picked.clone()).expect("a selection"));
    let settings = RelaxationSettings { tolerance: 1e-6, ..RelaxationSettings::default() };
    let (relaxed, relaxed_time) = timed(|| relax(&instance, &picked, &settings).expect("regular start"));
    let value = instance.log_value(&swapped).expect("a selection");
    println!(
        "n = {n}, p = {P}, k = 20, d: check {checked:.3} s, greedy {greedy_time:.3} s, exchange {exchange_time:.3} s, relaxation \
         {relaxed_time:.3} s, gap {:.1e} in {} rounds, certified efficiency {:.4}",
        relaxed.certificate.log_bound - relaxed.log_value,
        relaxed.rounds,
        relaxed.certificate.efficiency(value),
    );
}

/// How the rows of a class of published instances are drawn.
#[derive(Debug, Clone, Copy)]
enum Rows {
    /// Entries uniform in [0, 1].
    Independent,
    /// Normal with the covariance `BᵀB`, entries of B uniform in [0, 1].
    Correlated,
}

/// `a aᵀ` of m rows a of length p.
fn of_rows(rows: Rows, m: usize, p: usize, seed: u64) -> InformationSet {
    let mut rng = Xoshiro256Plus::seed_from_u64(seed);
    let B = DMatrix::from_fn(p, p, |_, _| rng.gen_range(0.0..1.0));
    let matrices: Vec<DMatrix<f64>> = (0..m)
        .map(|_| {
            let row = match rows {
                Rows::Independent => DMatrix::from_fn(p, 1, |_, _| rng.gen_range(0.0..1.0)),
                Rows::Correlated => B.transpose() * DMatrix::from_fn(p, 1, |_, _| rng.sample::<f64, _>(StandardNormal)),
            };
            &row * row.transpose()
        })
        .collect();
    InformationSet::from_matrices(p, &matrices).expect("a aᵀ is semidefinite")
}

/// Instances of the classes of which exact times are published: m candidates of rank one, m/10 parameters, of which 1.5 times as many
/// candidates are chosen, here each at most once.
fn published() {
    let m = 120;
    let (p, k) = (m / 10, m * 3 / 20);
    println!("| rows | criterion | proven optimal | s | efficiency before the search | after |");
    println!("|---|---|---|---|---|---|");
    for rows in [Rows::Independent, Rows::Correlated] {
        let a = InformationFunction::variance(&DMatrix::identity(p, p));
        for (criterion, function) in [("d", InformationFunction::Determinant), ("a", a)] {
            let (mut proven, mut seconds, mut before, mut after) = (0, vec![], 1f64, 1f64);
            for seed in 0..SEEDS {
                let candidates = of_rows(rows, m, p, seed);
                let instance = Instance::new(&candidates, None, &function, k).expect("a regular instance");
                let settings = RelaxationSettings::default();
                let (start, best_time) = timed(|| best(&instance, &settings, 0).expect("regular sets"));
                let (found, search_time) = timed(|| searched(&instance, &start));
                seconds.push(best_time + search_time);
                proven += u64::from(found.end == SearchEnd::Optimal);
                before = before.min(start.relaxation.certificate.efficiency(start.log_value));
                after = after.min((found.log_value - found.log_bound).exp());
            }
            seconds.sort_by(f64::total_cmp);
            println!(
                "| {rows:?} | {criterion} | {proven} of {SEEDS} | {:.1}–{:.1} | {before:.4} | {after:.4} |",
                seconds[0],
                seconds[seconds.len() - 1]
            );
        }
    }
}

fn main() {
    if let Some(argument) = std::env::args().nth(1) {
        match argument.as_str() {
            "published" => published(),
            n => time(n.parse().expect("a number of candidates")),
        }
        return;
    }
    let identity = DMatrix::identity(P, P);
    let functions = [
        ("d", InformationFunction::Determinant),
        ("a", InformationFunction::variance(&identity)),
        ("e", InformationFunction::min_eigenvalue()),
    ];
    println!("| instance | criterion | n | k | efficiency of `best` | s | after the search | s | nodes |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for kind in [Kind::Hetero, Kind::Wishart, Kind::RankOne] {
        for (criterion, function) in &functions {
            for k in [10, 20, 50] {
                solve(kind, criterion, function, 4525, k);
            }
        }
    }
}
