//! How long each stage takes: `cargo bench`.

#![allow(missing_docs, non_snake_case, clippy::expect_used, reason = "a benchmark")]

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use calipose::feasibility::Occlusion;
use calipose::plan::choose::{KMeans, Points};
use calipose::plan::survey::survey;
use calipose::problem::{Overrides, Problem};
use calipose::selection::InformationSet;
use calipose::selection::{InformationFunction, Instance, RelaxationSettings, best, exchange, greedy, relax};
use calipose::spatial::Pose;
use calipose::sweep::{AxisRule, sweep};
use criterion::{Criterion as Bench, Throughput, criterion_group, criterion_main};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256Plus;
use rayon::prelude::*;

const SERVOSILA: &str = "problems/servosila-engineer.toml";

fn servosila() -> Problem {
    Problem::read(Path::new(SERVOSILA)).expect("the shipped problem is valid")
}

/// The grid that the sweep is timed on: 57 million configurations.
const GRID: &str = "sweep.step_deg=2.4";

/// The grid that the selection among many views is timed on.
const FINE_GRID: &str = "sweep.step_deg=4";

fn sweeping(bench: &mut Bench) {
    let grid = Overrides::new().set(GRID).expect("a key and its value");
    let problem = Problem::read_with(Path::new(SERVOSILA), &grid).expect("the step fits");
    let mut group = bench.benchmark_group("sweep");
    group.throughput(Throughput::Elements(problem.space.len() as u64)).sample_size(10);
    let run = || sweep(&problem.robot, &problem.target, &problem.space, AxisRule::Zone, &|_| {});
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be made");
    group.bench_function("one core", |b| b.iter(|| one.install(|| black_box(run()))));
    group.bench_function("all cores", |b| b.iter(|| black_box(run())));
    group.finish();
}

/// Every test of every candidate, as if all were visible and none had failed another test.
fn feasibility(bench: &mut Bench) {
    let problem =
        Problem::read(Path::new("problems/servosila-engineer-bodies.toml")).expect("the shipped problem is valid");
    let Problem { robot, target, space, stability, .. } = &problem;
    let stability = stability.as_ref().expect("the problem tests stability");
    let candidates: Vec<usize> = sweep(robot, target, space, problem.axis, &|_| {}).candidates.iter().collect();
    let checks = problem.checks();
    let occlusion = Occlusion::new(&robot.tree, robot.camera_link);
    let corners: Vec<_> = target.board.corners().collect();
    let poses: Vec<_> = candidates
        .iter()
        .map(|&id| {
            let q = space.configuration(id);
            (robot.tree.link_poses(&q), robot.camera_pose(&q))
        })
        .collect();
    let mut group = bench.benchmark_group("feasibility");
    group.throughput(Throughput::Elements(candidates.len() as u64)).sample_size(10);
    let prepare = || problem.checks();
    group.bench_function("prepare", |b| b.iter(prepare));
    let stable = |(X_BL, _): &(Vec<Pose>, Pose)| stability.margin_at(&robot.tree, X_BL) >= Some(stability.margin);
    let collides = |(X_BL, _): &(Vec<Pose>, Pose)| checks.collision().collides(X_BL);
    let hidden =
        |(X_BL, X_BC): &(Vec<Pose>, Pose)| occlusion.hidden(X_BL, X_BC, &target.X_BT, &corners).contains(&true);
    group.bench_function("stability", |b| b.iter(|| poses.par_iter().filter(|p| stable(p)).count()));
    group.bench_function("collision", |b| b.iter(|| poses.par_iter().filter(|p| collides(p)).count()));
    group.bench_function("occlusion", |b| b.iter(|| poses.par_iter().filter(|p| hidden(p)).count()));
    let all = |id: &usize| {
        let q = space.configuration(*id);
        let pose = (robot.tree.link_poses(&q), robot.camera_pose(&q));
        [stable(&pose), collides(&pose), hidden(&pose)]
    };
    group.bench_function("all", |b| b.iter(|| candidates.par_iter().map(all).collect::<Vec<_>>()));
    group.finish();
}

fn information(bench: &mut Bench) {
    let problem = servosila();
    let survey = survey(&problem, &|_| {}).expect("the shipped problem has views");
    let views: Vec<_> = survey.views.iter().map(|view| (&view.X_CT, &view.seen)).collect();
    let measurement = problem.measurement();
    let mut group = bench.benchmark_group("information");
    group.throughput(Throughput::Elements(views.len() as u64));
    group.bench_function("servosila", |b| b.iter(|| measurement.information_set(black_box(views.clone()))));
    group.finish();
}

/// Greedy, exchange from greedy, and the relaxation from there.
fn stages(bench: &mut Bench, name: &str, instance: &Instance) {
    let mut group = bench.benchmark_group(name);
    group.sample_size(20).measurement_time(Duration::from_secs(4));
    let settings = RelaxationSettings::default();
    let picked = greedy(instance).expect("the views determine the parameters");
    let swapped = exchange(instance, picked.clone()).expect("a selection");
    group.bench_function("greedy", |b| b.iter(|| greedy(black_box(instance))));
    group.bench_function("exchange", |b| b.iter(|| exchange(black_box(instance), picked.clone())));
    group.bench_function("relaxation", |b| b.iter(|| relax(black_box(instance), &swapped, &settings)));
    group.bench_function("best", |b| b.iter(|| best(black_box(instance), &settings, 0)));
    group.finish();
}

/// The survey of a million views, and what clusters them for comparison.
fn many_views(bench: &mut Bench) {
    let grid = Overrides::new().set("sweep.step_deg=2").expect("a key and its value");
    let problem = Problem::read_with(Path::new(SERVOSILA), &grid).expect("the step fits");
    let mut group = bench.benchmark_group("many views");
    group.throughput(Throughput::Elements(problem.space.len() as u64)).sample_size(10);
    group.bench_function("survey", |b| b.iter(|| survey(black_box(&problem), &|_| {})));
    let survey = survey(&problem, &|_| {}).expect("the problem has views");
    let joints = Points::new(survey.views.iter().map(|view| &view.q)).expect("joint values are finite");
    group.throughput(Throughput::Elements(joints.len() as u64));
    group.bench_function("k-means k=10", |b| b.iter(|| KMeans::new(black_box(&joints), 0).members(10)));
    group.finish();
}

/// k-means into few clusters and into as many as do what a plan does.
fn clustering(bench: &mut Bench) {
    let survey = survey(&servosila(), &|_| {}).expect("the shipped problem has views");
    let joints = Points::new(survey.views.iter().map(|view| &view.q)).expect("joint values are finite");
    let mut group = bench.benchmark_group("k-means");
    group.throughput(Throughput::Elements(joints.len() as u64)).sample_size(10);
    for count in [10, 120, 400] {
        group.bench_function(format!("k={count}"), |b| b.iter(|| KMeans::new(black_box(&joints), 0).members(count)));
    }
    group.finish();
}

fn selection(bench: &mut Bench) {
    let survey = survey(&servosila(), &|_| {}).expect("the shipped problem has views");
    let variance = InformationFunction::variance(&survey.map_weight);
    for (criterion, function) in [("d", InformationFunction::Determinant), ("v", variance)] {
        let instance = Instance::new(&survey.information, None, &function, 10).expect("the views suffice");
        stages(bench, &format!("servosila {criterion} k=10"), &instance);
    }
}

fn selection_among_many(bench: &mut Bench) {
    let grid = Overrides::new().set(FINE_GRID).expect("a key and its value");
    let problem = Problem::read_with(Path::new(SERVOSILA), &grid).expect("the step fits");
    let survey = survey(&problem, &|_| {}).expect("the shipped problem has views");
    let variance = InformationFunction::variance(&survey.map_weight);
    let instance = Instance::new(&survey.information, None, &variance, 10).expect("the views suffice");
    stages(bench, "servosila v k=10, 64 225 views", &instance);
}

/// Views of rank six in nine parameters, two decades of units apart and of unequal size.
fn hetero(n: usize, p: usize) -> InformationSet {
    let mut rng = Xoshiro256Plus::seed_from_u64(9);
    let mut normal = move || -> f64 { rng.sample(StandardNormal) };
    let mut matrices = Vec::new();
    for _ in 0..n {
        let size: Vec<f64> = (0..p).map(|_| (0.5 * normal()).exp()).collect();
        let unit = |j: usize| 10f64.powf(-1.0 + 2.0 * j as f64 / (p - 1) as f64);
        let J = DMatrix::from_fn(6, p, |_, j| normal() * size[j] * unit(j));
        matrices.push(J.transpose() * J);
    }
    InformationSet::from_matrices(p, &matrices).expect("JᵀJ is semidefinite")
}

fn random_instances(bench: &mut Bench) {
    let candidates = hetero(10_735, 9);
    let function = InformationFunction::Determinant;
    let instance = Instance::new(&candidates, None, &function, 20).expect("the views suffice");
    stages(bench, "hetero d n=10735 p=9 k=20", &instance);
    let candidates = hetero(4525, 9);
    let function = InformationFunction::min_eigenvalue();
    let instance = Instance::new(&candidates, None, &function, 20).expect("the views suffice");
    stages(bench, "hetero e n=4525 p=9 k=20", &instance);
}

criterion_group!(
    benches,
    sweeping,
    feasibility,
    information,
    many_views,
    clustering,
    selection,
    selection_among_many,
    random_instances
);
criterion_main!(benches);
