//! The tables of docs/src/validation.md on the Servosila problem: every criterion's plan scored by every other, how closely
//! `zhang` follows the scatter of the closed form, and what the search for the proven best set reaches in a minute.
//!
//! ```text
//! cargo run --release --example criteria
//! ```

#![allow(non_snake_case, clippy::print_stdout, clippy::expect_used, reason = "an example that prints")]

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use calipose::calibration::{Pinhole, homography};
use calipose::camera::{Camera, Lens};
use calipose::information::Criterion;
use calipose::plan::choose::Chooser;
use calipose::plan::survey::{Survey, survey};
use calipose::problem::Problem;
use calipose::problem::{Method, Overrides};
use calipose::selection::SearchEnd;
use nalgebra::{Matrix3, Matrix5, Vector2, Vector5};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256Plus;

/// Time that a search for the proven best set may take.
const PATIENCE: Duration = Duration::from_mins(1);

/// Simulated closed forms per set of poses.
const TRIALS: usize = 300;

fn main() -> Result<(), Box<dyn Error>> {
    // The tables of the book are of constant noise.
    let constant = Overrides::new().set("noise={sigma_px=0.3,model=\"constant\"}")?;
    let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &constant)?;
    let survey = survey(&problem, &|_| {})?;
    let chooser = Chooser::new(&problem, &survey)?;
    scores(&chooser)?;
    closed_form(&problem)?;
    searches(&chooser)
}

/// Ten poses by each criterion; the share of the best possible information that they have by each.
fn scores(chooser: &Chooser) -> Result<(), Box<dyn Error>> {
    let choosers =
        Criterion::ALL.map(|criterion| chooser.by(&[(criterion, 1.0)]).expect("every view serves every criterion"));
    let mut bounds = vec![];
    let mut plans = vec![];
    for chooser in &choosers {
        let (choice, certificate) = chooser.best(10, 0)?;
        bounds.push(certificate);
        plans.push(choice);
    }
    println!("| plan by | {} | map error |", Criterion::ALL.map(Criterion::name).join(" | "));
    println!("|---{}|---|", "|---".repeat(Criterion::ALL.len()));
    for (criterion, plan) in Criterion::ALL.iter().zip(&plans) {
        let efficiency = |(chooser, bound): (&Chooser, &calipose::selection::Certificate)| {
            format!("{:.3}", bound.efficiency(chooser.assess(plan.selected.clone()).log_value))
        };
        let row: Vec<String> = choosers.iter().zip(&bounds).map(efficiency).collect();
        println!("| `{}` | {} | {:.2} px |", criterion.name(), row.join(" | "), plan.map_error);
    }
    println!();
    Ok(())
}

/// Sets of poses, random and planned; the predicted against the sampled standard deviation of the worst direction.
fn closed_form(problem: &Problem) -> Result<(), Box<dyn Error>> {
    // The closed form knows no distortion.
    let mut problem = problem.clone();
    problem.camera = Camera::new(Lens::Pinhole, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5])?;
    problem.estimated = vec![0, 1, 2, 3];
    let survey = survey(&problem, &|_| {})?;
    let chooser = Chooser::new(&problem, &survey)?.by(&[(Criterion::Zhang, 1.0)])?;
    let mut sets = vec![];
    for k in [4, 6, 8, 12, 20] {
        for seed in 0..6 {
            sets.push(chooser.choose(Method::Random, k, seed)?);
        }
        sets.push(chooser.choose(Method::KMeansJoints, k, 0)?);
        sets.push(chooser.choose(Method::Greedy, k, 0)?);
        sets.push(chooser.best(k, 0)?.0);
    }
    let mut rng = Xoshiro256Plus::seed_from_u64(1);
    let pairs: Vec<(f64, f64)> = sets
        .iter()
        .filter_map(|set| Some(((-0.5 * set.log_value).exp(), sampled(&problem, &survey, &set.selected, &mut rng)?)))
        .collect();
    let ranks = |values: Vec<f64>| -> Vec<f64> {
        values.iter().map(|value| values.iter().filter(|other| *other < value).count() as f64).collect()
    };
    let (predicted, sampled): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let mut ratios: Vec<f64> = pairs.iter().map(|(predicted, sampled)| sampled / predicted).collect();
    ratios.sort_by(f64::total_cmp);
    println!(
        "closed form: {} sets of poses, predicted worst sigma {:.2e} to {:.2e}; rank correlation with the sampled {:.3}; sampled / \
         predicted: median {:.2}, from {:.2} to {:.2}\n",
        pairs.len(),
        predicted.iter().copied().fold(f64::INFINITY, f64::min),
        predicted.iter().copied().fold(0.0, f64::max),
        correlation(&ranks(predicted), &ranks(sampled)),
        ratios[ratios.len() / 2],
        ratios[0],
        ratios[ratios.len() - 1],
    );
    Ok(())
}

/// Standard deviation of Zhang's b in its worst direction, in coordinates normalised by the nominal camera; `None` if the closed
/// form failed in more than one of a hundred trials.
fn sampled(problem: &Problem, survey: &Survey, selected: &[usize], rng: &mut impl Rng) -> Option<f64> {
    let corners: Vec<_> = problem.target.board.corners().collect();
    let board: Vec<Vector2<f64>> = corners.iter().map(|corner| Vector2::new(corner.x, corner.y)).collect();
    let centre = Vector2::new(639.5, 359.5);
    let nominal = Pinhole { fx: 1000.0, fy: 1000.0, cx: centre.x, cy: centre.y, skew: 0.0 };
    let mut deviations = vec![];
    for _ in 0..TRIALS {
        let homographies: Option<Vec<Matrix3<f64>>> = selected
            .iter()
            .map(|&i| {
                let noisy = |corner| {
                    let mut error = || problem.noise.sigma * rng.sample::<f64, _>(StandardNormal);
                    Some(problem.camera.project(&(survey.views[i].X_CT * corner))? + Vector2::new(error(), error()))
                };
                let seen: Option<Vec<_>> = corners.iter().map(noisy).collect();
                homography(&board, &seen?)
            })
            .collect();
        if let Some(found) = Pinhole::with_skew(&homographies?, centre, 1000.0) {
            // B = K⁻ᵀ K⁻¹ in coordinates in which the nominal K is the identity.
            let K_inverse = found.inverse_matrix() * nominal.inverse_matrix().try_inverse()?;
            let B = K_inverse.transpose() * K_inverse;
            let B = B * (3.0 / B.trace());
            let (half, sixth) = (0.5f64.sqrt(), 6f64.sqrt().recip());
            deviations.push(Vector5::new(
                B[(0, 1)],
                B[(0, 2)],
                B[(1, 2)],
                half * (B[(0, 0)] - B[(1, 1)]),
                sixth * (B[(0, 0)] + B[(1, 1)] - 2.0 * B[(2, 2)]),
            ));
        }
    }
    if deviations.len() * 100 < TRIALS * 99 {
        return None;
    }
    let n = deviations.len() as f64;
    let mean = deviations.iter().sum::<Vector5<f64>>() / n;
    let covariance =
        deviations.iter().fold(Matrix5::zeros(), |sum, d| sum + (d - mean) * (d - mean).transpose() / (n - 1.0));
    Some(covariance.symmetric_eigenvalues().max().sqrt())
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let product =
        |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 { x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum() };
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

/// The best set, proven or with the gap that is left after a minute.
fn searches(chooser: &Chooser) -> Result<(), Box<dyn Error>> {
    println!(
        "| criterion | k | efficiency of `best` | after the search | value | bound | candidates left | nodes | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for criterion in [Criterion::D, Criterion::V, Criterion::A, Criterion::E, Criterion::Zhang] {
        let chooser = chooser.by(&[(criterion, 1.0)])?;
        for k in [8, 10, 12, 15, 20] {
            let (best, certificate) = chooser.best(k, 0)?;
            let start = Instant::now();
            let (choice, _, found) = chooser.exact(k, 0, &mut |_| {
                if start.elapsed() > PATIENCE { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            let after = match found.end {
                SearchEnd::Optimal => "proven optimal".into(),
                _ => format!("{:.4}", (choice.log_value - found.log_bound).exp()),
            };
            println!(
                "| `{}` | {k} | {:.4} | {after} | {:.5} | {:.5} | {} | {} | {:.2} |",
                criterion.name(),
                certificate.efficiency(best.log_value),
                chooser.natural(choice.log_value),
                chooser.natural(found.log_bound),
                found.open_at_root,
                found.nodes,
                start.elapsed().as_secs_f64(),
            );
        }
    }
    Ok(())
}
