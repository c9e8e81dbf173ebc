//! Levenberg–Marquardt over the intrinsics and all poses.

use super::loss::Loss;
use super::normal_equations::{HEIGHTS, MOST_SHARED, Measurements, NormalEquations, Step};
use super::start::Start;
use super::ties::Ties;
use crate::camera::{Camera, MAX_INTRINSICS};
use crate::spatial::perturb;

/// How to refine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefinementSettings {
    /// The loss of a corner's residual. Default: squared.
    pub loss: Loss,
    /// Most iterations, tried steps included; a rational lens, which creeps along a valley on ordinary views, may take ten
    /// times as many. Default: 500.
    pub max_iterations: usize,
    /// Iterates until a full Newton step is shorter than this share of the estimate's standard deviation, in every
    /// direction of parameter space. Default: 1e-7. Where rounding ends it before, it has converged all the same if the
    /// step that is left is shorter than a thousandth.
    pub tolerance: f64,
}

impl Default for RefinementSettings {
    fn default() -> Self {
        Self { loss: Loss::Squared, max_iterations: 500, tolerance: 1e-7 }
    }
}

/// How a refinement ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Whether what a Newton step from here would still change is negligible against the estimate's deviation; otherwise
    /// the iterations ran out or no step improved.
    pub converged: bool,
    /// Steps tried.
    pub iterations: usize,
    /// Sum of the corners' losses, px².
    pub cost: f64,
    /// The squared length, px², that a Newton step from here would move all the residuals; infinite where the equations
    /// are singular.
    pub decrement: f64,
}

/// A refined camera with its views and what is known about it.
#[derive(Debug, Clone)]
pub(super) struct Refined {
    pub(super) start: Start,
    pub(super) convergence: Convergence,
    /// `S`, of which the model's upper triangle is set; `None` where a view does not fix its own pose.
    pub(super) information: Option<[[f64; MOST_SHARED]; MOST_SHARED]>,
}

/// What is left is negligible below this share of the estimate's deviation. In the valley where a rational lens's numerator
/// and denominator nearly cancel, no step resolves 1e-5 of it.
const NEGLIGIBLE: f64 = 1e-3;

/// How many times the iterations a lens with a denominator may take.
const VALLEY: usize = 10;

/// Steps that move all the corners together by less than this, px, are rounding.
const ROUNDING: f64 = 1e-11;

/// Changes of the cost below this share of it drown in the rounding of its sum.
const COST_ROUNDING: f64 = 1e-13;

/// Damping of the first step, as a share of the diagonal.
const FIRST_DAMPING: f64 = 1e-6;

/// Damping to begin with when a step failed that had hardly any.
const LEAST_DAMPING: f64 = 1e-12;

/// Factor of the damping after a first failure; the second one multiplies by its square and so on, since from
/// hardly any to enough it may be ten orders.
const GROWTH: f64 = 10.0;

/// Damping beyond which there is no hope left.
const HOPELESS_DAMPING: f64 = 1e12;

/// What is sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sought<'a> {
    pub(super) estimated: &'a [usize],
    pub(super) ties: &'a Ties,
    /// Whether to keep to lenses that are one-to-one as far as the corners lie; else the model is continued past its fold.
    pub(super) one_to_one: bool,
}

pub(super) fn refine(
    measurements: &Measurements,
    start: Start,
    sought: Sought<'_>,
    settings: &RefinementSettings,
) -> Refined {
    match start.camera.intrinsics().len() {
        _ if start.surface.warp().is_some() => refine_sized::<MOST_SHARED>(measurements, start, sought, settings),
        4 => refine_sized::<4>(measurements, start, sought, settings),
        8 => refine_sized::<8>(measurements, start, sought, settings),
        9 => refine_sized::<9>(measurements, start, sought, settings),
        _ => refine_sized::<MAX_INTRINSICS>(measurements, start, sought, settings),
    }
}

fn refine_sized<const P: usize>(
    measurements: &Measurements,
    start: Start,
    Sought { estimated, ties, one_to_one }: Sought<'_>,
    settings: &RefinementSettings,
) -> Refined {
    let freedoms = ties.free(estimated).len() + 6 * start.poses.len();
    let excess = (2 * measurements.all.len()).saturating_sub(freedoms).max(1) as f64;
    let views = start.poses.len();
    let mut at = start;
    let mut equations = NormalEquations::<P>::new(views, estimated, ties, at.surface.warp().is_some());
    let mut trial_equations = equations.clone();
    let mut trial = at.clone();
    let mut step = Step::<P>::new(views);

    let mut cost = equations.sum(measurements, &at, settings.loss);
    let mut λ = FIRST_DAMPING;
    let mut growth = GROWTH;
    let mut last_decrement = f64::INFINITY;
    let mut convergence = Convergence { converged: false, iterations: 0, cost, decrement: f64::INFINITY };
    let most =
        if at.camera.lens().denominator().is_empty() { 1 } else { VALLEY }.saturating_mul(settings.max_iterations);
    while convergence.iterations < most && λ < HOPELESS_DAMPING && cost.is_finite() {
        // A step's length in residuals over their deviation is its length in deviations of the estimate.
        let negligible = (settings.tolerance.powi(2) * cost / excess).max(ROUNDING * ROUNDING);
        let mut solved = equations.solve(λ, &mut step);
        if solved && step.decrement <= negligible {
            // Damping shortens steps; only an undamped one that is short says that the end is here.
            solved = equations.solve(0.0, &mut step);
            convergence.decrement = step.decrement;
            if solved && step.decrement <= negligible {
                convergence.converged = true;
                break;
            }
        }
        convergence.iterations += 1;
        if solved {
            trial.camera = moved(&at.camera, &step, one_to_one);
            if at.surface.warp().is_some() {
                trial.surface = at.surface.moved(&HEIGHTS.map(|j| step.δθ[j]));
            }
            for ((trial, pose), ξ) in trial.poses.iter_mut().zip(&at.poses).zip(&step.ξ) {
                *trial = perturb(pose, ξ);
            }
            let trial_cost = match trial.camera.intrinsics() {
                [fx, fy, ..] if *fx > 0.0 && *fy > 0.0 => trial_equations.sum(measurements, &trial, settings.loss),
                _ => f64::INFINITY,
            };
            let resolved = step.predicted > COST_ROUNDING * cost;
            if trial_cost < cost || (!resolved && trial_cost <= cost * (1.0 + COST_ROUNDING)) {
                let gain = if resolved {
                    (cost - trial_cost) / step.predicted
                } else {
                    // Rounding hides what the step gained; that the next one is shorter must do.
                    1.0 - step.decrement / last_decrement
                };
                // A step that kept its promise may be bolder next time, and near the end Newton's.
                λ = if gain > 0.75 {
                    0.01 * λ
                } else if gain > 0.25 {
                    0.3 * λ
                } else {
                    3.0 * λ.max(LEAST_DAMPING)
                };
                growth = GROWTH;
                last_decrement = step.decrement;
                cost = trial_cost;
                std::mem::swap(&mut at, &mut trial);
                std::mem::swap(&mut equations, &mut trial_equations);
                continue;
            }
        }
        λ = λ.max(LEAST_DAMPING) * growth;
        growth *= GROWTH;
    }
    convergence.cost = cost;
    if !convergence.converged {
        let solved = cost.is_finite() && equations.solve(0.0, &mut step) && step.decrement >= 0.0;
        convergence.decrement = if solved { step.decrement } else { f64::INFINITY };
        convergence.converged = convergence.decrement <= NEGLIGIBLE.powi(2) * cost / excess;
    }
    let information = equations.information().map(|S| {
        let mut padded = [[0.0; MOST_SHARED]; MOST_SHARED];
        for (row, padded) in S.iter().zip(&mut padded) {
            padded[..P].copy_from_slice(row);
        }
        padded
    });
    Refined { start: at, convergence, information }
}

fn moved<const P: usize>(camera: &Camera, step: &Step<P>, one_to_one: bool) -> Camera {
    let mut θ = [0.0; MAX_INTRINSICS];
    for (j, (θ, value)) in θ.iter_mut().zip(camera.intrinsics()).enumerate() {
        *θ = value + step.δθ[j];
    }
    let extrapolated = camera.extrapolated(&θ);
    if !one_to_one {
        return extrapolated;
    }
    // What is no camera at all is for the caller to see by its focal lengths.
    extrapolated.with_intrinsics(extrapolated.intrinsics()).unwrap_or(extrapolated)
}
