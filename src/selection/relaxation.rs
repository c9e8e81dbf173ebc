//! The convex relaxation, by column generation, with Clarabel.
//!
//! ```text
//! maximise  log Φ(M₀ + Σ wᵢ Mᵢ)   over   0 ≤ wᵢ ≤ 1,  Σ wᵢ = k
//! ```
//!
//! Two loops. The outer one keeps a working set of columns: it scores **all** candidates with the gradient Y of log Φ,
//! evaluates the certificate, and adds the best that are outside. The inner one is Newton's method on
//! the working set: with `B = [map(M_i)]` the square root of the curvature (see [`Curvature`]), each step is the quadratic
//! program
//!
//! ```text
//! minimise  ½‖y‖² − gᵀw   subject to   B(w − w₀) = y,  Σ w = k,  0 ≤ w ≤ 1,     gᵢ = ⟨Y, Mᵢ⟩
//! ```
//!
//! which Clarabel solves; a line search on log Φ follows. Compared with one semidefinite program this needs only linear
//! cones, takes every information function in the same form, is scaled by B at every step, so that units do not matter, and
//! starts where it left off when columns join.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use super::certificate::{Certificate, sum_of_largest};
use super::function::Curvature;
use super::greedy::best_scores;
use super::instance::Instance;
use crate::information::packed::dual;

/// When to stop, and how many columns to carry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationSettings {
    /// Gap in log Φ between bound and relaxed value at which the relaxation counts as solved.
    pub tolerance: f64,
    /// Most rounds of column generation.
    pub max_rounds: usize,
    /// Most columns that join the working set in one round; never fewer than k.
    pub columns_per_round: usize,
}

impl Default for RelaxationSettings {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_rounds: 30, columns_per_round: 40 }
    }
}

/// A solution of the relaxation.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    /// Candidates of positive weight in ascending order, with their weights.
    pub weights: Vec<(usize, f64)>,
    /// log Φ at the weights.
    pub log_value: f64,
    /// The best bound found; holds whether or not the relaxation was solved.
    pub certificate: Certificate,
    /// Whether the gap between bound and value is within the tolerance.
    pub solved: bool,
    /// Rounds of column generation.
    pub rounds: usize,
    /// Quadratic programs solved.
    pub newton_steps: usize,
}

/// Most Newton steps in one round; some ten are common, fewer after the first round.
const MAX_NEWTON_STEPS: usize = 100;

/// Weights below this are zero.
const ZERO_WEIGHT: f64 = 1e-8;

/// Solves the relaxation of `instance`, starting at the selection `start`; `None` if that is singular.
pub fn relax(instance: &Instance, start: &[usize], settings: &RelaxationSettings) -> Option<Relaxation> {
    let n = instance.candidates().len();
    let mut columns = start.to_vec();
    let mut weights = vec![1.0; columns.len()];
    let mut master = Master { instance, newton_steps: 0 };
    let y = master.gradient(&columns, &weights)?;
    let mut scores = instance.scores(&y);
    let mut certificate = Certificate::from_scores(instance, y, &scores);
    let mut log_value = instance.log_value(&master.total(&columns, &weights));
    let mut rounds = 0;
    while certificate.log_bound - log_value > settings.tolerance && rounds < settings.max_rounds {
        rounds += 1;
        // Columns of weight zero that have fallen behind leave, the best of the others join.
        let mut outside = vec![true; n];
        let kept: Vec<usize> = (0..columns.len()).filter(|&c| weights[c] > ZERO_WEIGHT).collect();
        (columns, weights) = kept.into_iter().map(|c| (columns[c], weights[c])).unzip();
        for &i in &columns {
            outside[i] = false;
        }
        columns.extend(best_scores(&scores, &outside, settings.columns_per_round.max(instance.count())));
        weights.resize(columns.len(), 0.0);
        let order = sorted_by(&columns);
        columns = order.iter().map(|&c| columns[c]).collect();
        weights = order.iter().map(|&c| weights[c]).collect();

        let solved = master.solve(&columns, &mut weights, 0.5 * settings.tolerance);
        let total = master.total(&columns, &weights);
        let reached = instance.log_value(&total);
        // A certificate in hand holds whatever becomes of the weights.
        let Some(y) = master.gradient(&columns, &weights) else { break };
        scores = instance.scores(&y);
        let found = Certificate::from_scores(instance, y, &scores);
        let bound_before = certificate.log_bound;
        if found.log_bound < bound_before {
            certificate = found;
        }
        let progress = (reached - log_value).max(bound_before - certificate.log_bound);
        log_value = reached;
        if !solved && progress <= settings.tolerance {
            break;
        }
    }
    let mut weights: Vec<(usize, f64)> =
        columns.into_iter().zip(weights).filter(|&(_, weight)| weight > ZERO_WEIGHT).collect();
    weights.sort_unstable_by_key(|&(i, _)| i);
    let solved = certificate.log_bound - log_value <= settings.tolerance;
    Some(Relaxation { weights, log_value, certificate, solved, rounds, newton_steps: master.newton_steps })
}

fn sorted_by(columns: &[usize]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_unstable_by_key(|&c| columns[c]);
    order
}

/// The relaxation on a working set.
struct Master<'a> {
    instance: &'a Instance<'a>,
    newton_steps: usize,
}

impl Master<'_> {
    fn total(&self, columns: &[usize], weights: &[f64]) -> Vec<f64> {
        let mut total = self.instance.prior().to_vec();
        for (&i, &weight) in columns.iter().zip(weights) {
            self.instance.candidates().add_to(&mut total, i, weight);
        }
        total
    }

    fn gradient(&self, columns: &[usize], weights: &[f64]) -> Option<Vec<f64>> {
        self.instance.function().gradient(&self.total(columns, weights), self.instance.order())
    }

    /// Newton's method from `weights` until no weights on the working set promise more than `tolerance`, to first order;
    /// whether it got there.
    fn solve(&mut self, columns: &[usize], weights: &mut Vec<f64>, tolerance: f64) -> bool {
        let p = self.instance.order();
        let mut least_gap = f64::INFINITY;
        for _ in 0..MAX_NEWTON_STEPS {
            let total = self.total(columns, weights);
            let (Some(y), Some(curvature)) =
                (self.instance.function().gradient(&total, p), self.instance.function().curvature(&total, p))
            else {
                return false;
            };
            let dual = dual(y, p);
            let score = |&i: &usize| -> f64 {
                self.instance.candidates().packed(i).iter().zip(&dual).map(|(m, y)| m * y).sum()
            };
            let gradient: Vec<f64> = columns.iter().map(score).collect();
            let gap = sum_of_largest(gradient.clone(), self.instance.count()) - inner(&gradient, weights);
            if gap <= tolerance {
                return true;
            }
            // Close to the optimum rounding hides the gain in log Φ; there the gap must fall instead.
            let hidden = gap < 1e-5;
            if hidden && gap > 0.5 * least_gap {
                return false;
            }
            least_gap = gap;
            let Some(target) = newton_target(self.instance, columns, weights, &gradient, &curvature) else {
                return false;
            };
            self.newton_steps += 1;
            let direction: Vec<f64> = target.iter().zip(weights.iter()).map(|(t, w)| t - w).collect();
            let slope = inner(&direction, &gradient);
            let before = self.instance.log_value(&total);
            let moved =
                |length: f64| -> Vec<f64> { weights.iter().zip(&direction).map(|(w, d)| w + length * d).collect() };
            let gains = |length: f64| {
                let gain = self.instance.log_value(&self.total(columns, &moved(length))) - before;
                gain >= 0.1 * length * slope
            };
            let Some(length) = (0..20).map(|halvings| 0.5f64.powi(halvings)).find(|&length| hidden || gains(length))
            else {
                return false;
            };
            *weights = moved(length);
        }
        false
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The minimiser of the quadratic model over the working set's weights.
fn newton_target(
    instance: &Instance,
    columns: &[usize],
    weights: &[f64],
    gradient: &[f64],
    curvature: &Curvature,
) -> Option<Vec<f64>> {
    let n = columns.len();
    let B: Vec<Vec<f64>> = columns.iter().map(|&i| curvature.map(instance.candidates().packed(i))).collect();
    let m = B[0].len();

    // Unknowns (w, y). Rows: B w − y = B w₀ (m), Σ w = k (1), w ≤ 1 (n), −w ≤ 0 (n).
    let mut Bw = vec![0.0; m];
    for (column, &weight) in B.iter().zip(weights) {
        for (sum, b) in Bw.iter_mut().zip(column) {
            *sum += weight * b;
        }
    }
    let mut column_starts = vec![0];
    let (mut rows, mut entries) = (Vec::new(), Vec::new());
    for (c, column) in B.iter().enumerate() {
        for (r, &b) in column.iter().enumerate() {
            rows.push(r);
            entries.push(b);
        }
        rows.extend([m, m + 1 + c, m + 1 + n + c]);
        entries.extend([1.0, 1.0, -1.0]);
        column_starts.push(rows.len());
    }
    for r in 0..m {
        rows.push(r);
        entries.push(-1.0);
        column_starts.push(rows.len());
    }
    let A = CscMatrix::new(m + 1 + 2 * n, n + m, column_starts, rows, entries);
    let mut b = Bw;
    b.push(instance.count() as f64);
    b.extend(std::iter::repeat_n(1.0, n));
    b.extend(std::iter::repeat_n(0.0, n));
    let P = CscMatrix::new(
        n + m,
        n + m,
        (0..=n + m).map(|c| c.saturating_sub(n)).collect(),
        (n..n + m).collect(),
        vec![1.0; m],
    );
    let q: Vec<f64> = gradient.iter().map(|g| -g).chain(std::iter::repeat_n(0.0, m)).collect();
    let cones = [SupportedConeT::ZeroConeT(m + 1), SupportedConeT::NonnegativeConeT(2 * n)];
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-10,
        tol_gap_rel: 1e-10,
        tol_feas: 1e-10,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(&P, &q, &A, &b, &cones, settings).ok()?;
    solver.solve();
    match solver.solution.status {
        // At this tolerance the solver often stops short of it, at a point good enough for the line search.
        SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress => {
            Some(solver.solution.x[..n].iter().map(|w| w.clamp(0.0, 1.0)).collect())
        }
        _ => None,
    }
}
