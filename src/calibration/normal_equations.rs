//! The normal equations of a calibration: an arrow.
//!
//! With `r_i` the residuals of view i (px), `A_i` their derivative by the intrinsics (2m×p) and `B_i` by the view's own
//! pose (2m×6), all whitened by the corner's covariance and weight and times the loss's,
//!
//! ```text
//!     [ U    W_1 … W_k ] [δθ ]     [g_θ]      U   = Σ A_iᵀA_i   p×p
//!     [ W_1ᵀ V_1       ] [ξ_1]     [g_1]      W_i = A_iᵀB_i     p×6
//!     [  ⋮        ⋱    ] [ ⋮ ] = − [ ⋮ ]      V_i = B_iᵀB_i     6×6
//!     [ W_kᵀ       V_k ] [ξ_k]     [g_k]      g   = gradient of half the cost
//! ```
//!
//! Where the board may bulge, its heights are the last of θ, and their deviations one measurement each.
//!
//! so that `δθ` follows from the p×p Schur complement `S = U − Σ W_i V_i⁻¹ W_iᵀ` and each `ξ_i` from `δθ`.

use nalgebra::Vector2;

use super::factor::Factor;
use super::loss::Loss;
use super::observations::Observations;
use super::start::Start;
use super::ties::Ties;
use crate::camera::MAX_INTRINSICS;
use crate::information::{NoiseModel, Whitening};
use crate::spatial::Tangent;
use crate::target::Warp;

/// A corner as the equations need it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement {
    /// Position on the board, m.
    pub(super) point: Vector2<f64>,
    /// Where it was seen, px.
    pub(super) pixel: Vector2<f64>,
    /// Of its residual.
    pub(super) whitening: Whitening,
}

/// The measurements of all views in one row, with each view's end.
#[derive(Debug)]
pub(super) struct Measurements {
    pub(super) all: Vec<Measurement>,
    pub(super) ends: Vec<usize>,
    /// Standard deviation of a pixel coordinate of a corner of weight 1, px, against which the deviations of a board's heights
    /// are weighed.
    pub(super) sigma: f64,
}

/// The same before anything is known of it.
const FIRST_SIGMA: f64 = 1.0;

/// Where the board's heights are among what all views have in common: behind all intrinsics.
pub(super) const HEIGHTS: [usize; Warp::HEIGHTS] = [MAX_INTRINSICS, MAX_INTRINSICS + 1];

/// Most numbers that all views have in common.
pub(super) const MOST_SHARED: usize = MAX_INTRINSICS + Warp::HEIGHTS;

impl Measurements {
    /// The corners of all views, each by its weight alone.
    pub(super) fn new(observations: &Observations) -> Self {
        let mut all = Vec::with_capacity(observations.corner_count());
        let mut ends = Vec::with_capacity(observations.views().len());
        for view in observations.views() {
            all.extend(view.iter().map(|c| Measurement {
                point: observations.on_board(c),
                pixel: c.pixel,
                whitening: Whitening::NONE.weighted(c.weight),
            }));
            ends.push(all.len());
        }
        Self { all, ends, sigma: FIRST_SIGMA }
    }

    /// The same, each corner by its scatter as `model` has it where a camera sees it, and by its weight.
    pub(super) fn weighed(observations: &Observations, model: NoiseModel, seen: &Start) -> Self {
        let Start { camera, poses, surface } = seen;
        let model = model.through(camera);
        let mut measurements = Self::new(observations);
        let corners =
            observations.views().iter().zip(poses).flat_map(|(view, pose)| view.iter().map(move |c| (c, pose)));
        for (measurement, (corner, X_CT)) in measurements.all.iter_mut().zip(corners) {
            let R = X_CT.rotation.to_rotation_matrix().into_inner();
            let p_C = X_CT * surface.point(&measurement.point);
            // What has no image is told of elsewhere.
            let Some(projection) = camera.project_with_derivatives(&p_C) else { continue };
            let feature = observations.board().feature(corner.index);
            let whitening = model.whitening_in_view(&feature, &projection.by_point, &R, camera.vergence(&p_C));
            measurement.whitening = whitening.weighted(corner.weight);
        }
        measurements
    }

    pub(super) fn views(&self) -> impl Iterator<Item = &[Measurement]> {
        let mut start = 0;
        self.ends.iter().map(move |&end| &self.all[std::mem::replace(&mut start, end)..end])
    }
}

/// The blocks that one view adds, upper triangles of the symmetric ones; rows of `W` are intrinsics.
#[derive(Debug, Clone)]
struct ViewBlocks<const P: usize> {
    V: [[f64; 6]; 6],
    W: [[f64; 6]; P],
    g: [f64; 6],
}

/// The blocks of the arrow at one point.
#[derive(Debug, Clone)]
pub(super) struct NormalEquations<const P: usize> {
    U: [[f64; P]; P],
    g: [f64; P],
    views: Vec<ViewBlocks<P>>,
    is_free: [bool; P],
    /// Intrinsics that follow another one, with that.
    followers: Vec<(usize, usize)>,
}

/// A step from the equations' point, and the workspace to find it.
#[derive(Debug, Clone)]
pub(super) struct Step<const P: usize> {
    pub(super) δθ: [f64; P],
    pub(super) ξ: Vec<Tangent>,
    /// What the quadratic model says the step takes off the cost, px².
    pub(super) predicted: f64,
    /// `−gᵀδ`, px²: the squared length of the step in residuals where there is no damping.
    pub(super) decrement: f64,
    rhs: [f64; P],
    eliminated: Vec<Eliminated<P>>,
}

/// A view eliminated: `V = L Lᵀ`, `X = W L⁻ᵀ` (rows are intrinsics) and `y = −L⁻¹g`.
#[derive(Debug, Clone)]
struct Eliminated<const P: usize> {
    L: Factor<6>,
    X: [[f64; 6]; P],
    y: [f64; 6],
}

impl<const P: usize> NormalEquations<P> {
    pub(super) fn new(views: usize, estimated: &[usize], ties: &Ties, bulges: bool) -> Self {
        let blocks = ViewBlocks { V: [[0.0; 6]; 6], W: [[0.0; 6]; P], g: [0.0; 6] };
        let free = ties.free(estimated);
        let is_free = std::array::from_fn(|j| free.contains(&j) || bulges && HEIGHTS.contains(&j));
        let followers = ties.followers().filter(|(j, _)| estimated.contains(j)).collect();
        Self { U: [[0.0; P]; P], g: [0.0; P], views: vec![blocks; views], is_free, followers }
    }

    /// Sums the blocks at a point and returns the cost, px²; infinite where a corner has no image.
    #[allow(clippy::needless_range_loop, reason = "the indices are the algorithm")]
    pub(super) fn sum(&mut self, measurements: &Measurements, at: &Start, loss: Loss) -> f64 {
        let Start { camera, poses, surface } = at;
        self.U = [[0.0; P]; P];
        self.g = [0.0; P];
        let mut cost = 0.0;
        for ((blocks, view), X_CT) in self.views.iter_mut().zip(measurements.views()).zip(poses) {
            *blocks = ViewBlocks { V: [[0.0; 6]; 6], W: [[0.0; 6]; P], g: [0.0; 6] };
            let R = X_CT.rotation.to_rotation_matrix().into_inner();
            for measurement in view {
                // From the board's origin to the corner, in C.
                let place = &measurement.point;
                let rises = surface.warp().map(|warp| warp.rises(place));
                let mut arm = R.column(0) * place.x + R.column(1) * place.y;
                if let Some(rises) = &rises {
                    arm += R.column(2) * dot(rises, &surface.heights());
                }
                let Some(projection) = camera.project_with_derivatives(&(arm + X_CT.translation.vector).into()) else {
                    return f64::INFINITY;
                };
                let r = measurement.whitening.whitened((projection.pixel - measurement.pixel).into());
                let (ρ, slope) = loss.at(dot(&r, &r));
                cost += ρ;
                // Weighted equations: both sides whitened, and times the root of the loss's weight.
                let root = slope.sqrt();
                let by_intrinsics = measurement.whitening.of_rows(&projection.by_intrinsics);
                let by_point = measurement.whitening.of_rows(&projection.by_point);
                let mut a = [[0.0; P]; 2];
                let mut b = [[0.0; 6]; 2];
                for row in 0..2 {
                    for j in 0..P.min(MAX_INTRINSICS) {
                        a[row][j] = root * by_intrinsics[(row, j)];
                    }
                    for &(j, leader) in &self.followers {
                        a[row][leader] += a[row][j];
                    }
                    let J = by_point.row(row) * root;
                    for (j, rise) in HEIGHTS.into_iter().zip(rises.into_iter().flatten()) {
                        a[row][j] = rise * (J * R.column(2))[0];
                    }
                    // ∂p_C/∂ω = −[arm]× and ∂p_C/∂v = 1.
                    b[row] = [
                        arm.y * J[2] - arm.z * J[1],
                        arm.z * J[0] - arm.x * J[2],
                        arm.x * J[1] - arm.y * J[0],
                        J[0],
                        J[1],
                        J[2],
                    ];
                }
                accumulate((&mut self.U, &mut self.g), blocks, &a, &b, r.map(|r| root * r));
            }
        }
        if surface.warp().is_some() {
            let sigma = measurements.sigma;
            for (j, height) in HEIGHTS.into_iter().zip(surface.heights()) {
                cost += (sigma * height).powi(2);
                self.U[j][j] += sigma * sigma;
                self.g[j] += sigma * sigma * height;
            }
        }
        self.hold_fixed();
        if cost.is_finite() { cost } else { f64::INFINITY }
    }

    /// Makes the equations of the intrinsics that are not free read `δθ_j = 0`.
    fn hold_fixed(&mut self) {
        for j in (0..P).filter(|&j| !self.is_free[j]) {
            for i in 0..P {
                self.U[i][j] = 0.0;
                self.U[j][i] = 0.0;
            }
            self.U[j][j] = 1.0;
            self.g[j] = 0.0;
            for blocks in &mut self.views {
                blocks.W[j] = [0.0; 6];
            }
        }
    }

    /// Solves with every diagonal entry enlarged by the share `λ` (Marquardt 1963) into `step`; false where the damped
    /// matrix is not positive definite.
    pub(super) fn solve(&self, λ: f64, step: &mut Step<P>) -> bool {
        let Some(S) = self.eliminate(λ, step) else { return false };
        let Some(S) = Factor::of(&S, 0.0) else { return false };
        step.δθ = S.solve(step.rhs);
        let damping = |δ: f64, diagonal: f64| λ * δ * δ * diagonal;
        step.decrement = -dot(&self.g, &step.δθ);
        let mut damped: f64 = (0..P).map(|j| damping(step.δθ[j], self.U[j][j])).sum();
        for ((blocks, eliminated), ξ) in self.views.iter().zip(&step.eliminated).zip(&mut step.ξ) {
            // ξ = V⁻¹(−g − Wᵀδθ) = L⁻ᵀ(y − Xᵀδθ).
            let mut rest = eliminated.y;
            for (row, δ) in eliminated.X.iter().zip(&step.δθ) {
                for (rest, x) in rest.iter_mut().zip(row) {
                    *rest -= x * δ;
                }
            }
            let solved = eliminated.L.backward(rest);
            step.decrement -= dot(&blocks.g, &solved);
            damped += (0..6).map(|j| damping(solved[j], blocks.V[j][j])).sum::<f64>();
            *ξ = Tangent::from(solved);
        }
        for &(j, leader) in &self.followers {
            step.δθ[j] = step.δθ[leader];
        }
        step.predicted = step.decrement + damped;
        step.predicted.is_finite()
    }

    /// The upper triangle of the Schur complement `S` without damping, unit diagonal at intrinsics that are not free; `None`
    /// where a view does not fix its own pose.
    pub(super) fn information(&self) -> Option<[[f64; P]; P]> {
        self.eliminate(0.0, &mut Step::new(self.views.len()))
    }

    /// Eliminates the views: with `V = L Lᵀ`, `X = W L⁻ᵀ` and `y = −L⁻¹g`, `S = U − Σ X Xᵀ` (upper triangle, returned)
    /// and `rhs = −g_θ − Σ X y`.
    #[allow(clippy::needless_range_loop, reason = "the indices are the algorithm")]
    fn eliminate(&self, λ: f64, step: &mut Step<P>) -> Option<[[f64; P]; P]> {
        let mut S = self.U;
        for j in 0..P {
            S[j][j] *= 1.0 + λ;
            step.rhs[j] = -self.g[j];
        }
        for (blocks, eliminated) in self.views.iter().zip(&mut step.eliminated) {
            eliminated.L = Factor::of(&blocks.V, λ)?;
            eliminated.y = eliminated.L.forward(blocks.g.map(|g| -g));
            for j in 0..P {
                eliminated.X[j] = eliminated.L.forward(blocks.W[j]);
            }
            for i in 0..P {
                step.rhs[i] -= dot(&eliminated.X[i], &eliminated.y);
                for j in i..P {
                    S[i][j] -= dot(&eliminated.X[i], &eliminated.X[j]);
                }
            }
        }
        Some(S)
    }
}

impl<const P: usize> Step<P> {
    pub(super) fn new(views: usize) -> Self {
        let eliminated = Eliminated { L: Factor::ZERO, X: [[0.0; 6]; P], y: [0.0; 6] };
        Self {
            δθ: [0.0; P],
            ξ: vec![Tangent::zeros(); views],
            predicted: 0.0,
            decrement: 0.0,
            rhs: [0.0; P],
            eliminated: vec![eliminated; views],
        }
    }
}

/// Adds the two rows of a corner's Jacobians, `a` by the intrinsics and `b` by the pose, with their residuals `r`.
#[inline]
#[allow(clippy::needless_range_loop, reason = "the indices are the algorithm")]
fn accumulate<const P: usize>(
    (U, g): (&mut [[f64; P]; P], &mut [f64; P]),
    blocks: &mut ViewBlocks<P>,
    a: &[[f64; P]; 2],
    b: &[[f64; 6]; 2],
    r: [f64; 2],
) {
    for i in 0..P {
        let (u, v) = (a[0][i], a[1][i]);
        for j in i..P {
            U[i][j] += u * a[0][j] + v * a[1][j];
        }
        for j in 0..6 {
            blocks.W[i][j] += u * b[0][j] + v * b[1][j];
        }
        g[i] += u * r[0] + v * r[1];
    }
    for i in 0..6 {
        let (u, v) = (b[0][i], b[1][i]);
        for j in i..6 {
            blocks.V[i][j] += u * b[0][j] + v * b[1][j];
        }
        blocks.g[i] += u * r[0] + v * r[1];
    }
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
