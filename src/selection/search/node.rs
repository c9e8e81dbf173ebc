//! The relaxation at a node of the search tree: few candidates, a good start at hand, solved again and again.
//!
//! The same problem as [`relaxation`](crate::selection::relaxation) solves, without columns to generate. Newton's method on the face of
//! fractional weights needs no solver but a small linear system a step, and a node differs from its parent by one candidate,
//! so a few steps do.

use nalgebra::{DMatrix, DVector};

use crate::selection::function::Gradient;
use crate::selection::instance::{Instance, InstanceCurvature};
use crate::selection::packed::dot;
use crate::selection::relaxation::greatest;

/// Weights this close to 0 or 1 are there.
const BOUNDARY: f64 = 1e-9;

/// Candidates at a bound that join the fractional ones in one step, from either bound.
const JOINING: usize = 4;

/// Most Newton steps at one softness.
const MAX_STEPS: usize = 60;

/// Softnesses of functions with kinks, one after the other.
const SOFTNESSES: [f64; 4] = [0.1, 1e-2, 1e-3, 1e-4];

/// Allowance for rounding in a node's bound.
const ROUNDING: f64 = 1e-11;

/// A problem and its smooth stand-ins.
#[derive(Debug)]
pub(crate) struct Ladder<'a> {
    pub(crate) instance: &'a Instance<'a>,
    /// The problem itself if it is smooth; otherwise ever less soft.
    rungs: Vec<Instance<'a>>,
}

/// Weights on the open candidates of a node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Relaxed {
    /// Weights of the open candidates, in their order.
    pub(crate) weights: Vec<f64>,
    /// Scores `⟨Y, M_i⟩` of the open candidates at the best bound.
    pub(crate) scores: Vec<f64>,
    /// `⟨Y, M⟩` of what is known and included at the best bound.
    pub(crate) known_score: f64,
    /// log Φ° at the best bound.
    pub(crate) log_polar: f64,
    /// No selection of this node has a greater log Φ.
    pub(crate) log_bound: f64,
}

impl<'a> Ladder<'a> {
    pub(crate) fn new(instance: &'a Instance<'a>) -> Self {
        let rungs = if instance.is_smooth() {
            vec![instance.clone()]
        } else {
            SOFTNESSES.iter().map(|&softness| instance.softened(softness)).collect()
        };
        Self { instance, rungs }
    }

    /// Relaxes the choice of `count` of `open` beside what is `known`, from `weights` that add up to `count`; stops as soon as
    /// the bound is below `enough` or within `tolerance` of the relaxed value. `None` if the weights are singular.
    pub(crate) fn relax(
        &self,
        known: &[f64],
        open: &[usize],
        count: usize,
        weights: Vec<f64>,
        enough: f64,
        tolerance: f64,
    ) -> Option<Relaxed> {
        let nothing = vec![0.0; open.len()];
        let mut best = Relaxed {
            weights,
            scores: nothing,
            known_score: 0.0,
            log_polar: f64::NEG_INFINITY,
            log_bound: f64::INFINITY,
        };
        for rung in &self.rungs {
            let mut face = Face { instance: rung, known, open, count, weights: std::mem::take(&mut best.weights) };
            face.solve(&mut best, enough, tolerance)?;
            best.weights = face.weights;
            if best.log_bound <= enough {
                break;
            }
        }
        Some(best)
    }
}

/// Newton's method on weights between 0 and 1.
struct Face<'a> {
    instance: &'a Instance<'a>,
    known: &'a [f64],
    open: &'a [usize],
    count: usize,
    weights: Vec<f64>,
}

impl Face<'_> {
    fn total(&self, weights: &[f64]) -> Vec<f64> {
        let mut total = self.known.to_vec();
        for (&i, &weight) in self.open.iter().zip(weights) {
            if weight > 0.0 {
                self.instance.add_to(&mut total, i, weight);
            }
        }
        total
    }

    fn solve(&mut self, best: &mut Relaxed, enough: f64, tolerance: f64) -> Option<()> {
        let mut total = self.total(&self.weights);
        let mut value = self.instance.log_value_at(&total);
        for _ in 0..MAX_STEPS {
            let gradient = self.instance.gradient_at(&total)?;
            let scores = self.instance.scores_of(&gradient.y, self.open);
            let chosen = greatest(&scores, self.count);
            let greatest: f64 = chosen.iter().map(|&c| scores[c]).sum();
            let gap = greatest - dot(&scores, &self.weights);
            self.improve(best, &gradient, &scores, &chosen);
            if best.log_bound <= enough || gap <= tolerance {
                break;
            }
            let free = self.working_set(&scores);
            let Some(curvature) = self.instance.curvature(&total) else { break };
            let direction = self.direction(&free, &scores, &curvature);
            let slope: f64 = free.iter().zip(&direction).map(|(&c, d)| d * scores[c]).sum();
            if slope <= 0.1 * tolerance {
                break;
            }
            let mut length = 1.0;
            let moved = loop {
                let mut weights = self.weights.clone();
                for (&c, d) in free.iter().zip(&direction) {
                    weights[c] = snapped(weights[c] + length * d);
                }
                let total = self.total(&weights);
                let reached = self.instance.log_value_at(&total);
                if reached - value >= 0.1 * length * slope - 1e-14 {
                    break Some((weights, total, reached));
                }
                length *= 0.5;
                if length < 1e-4 {
                    break None;
                }
            };
            let Some((weights, new_total, reached)) = moved else { break };
            (self.weights, total, value) = (weights, new_total, reached);
        }
        Some(())
    }

    /// Keeps the bound that the gradient proves if it is the best.
    fn improve(&self, best: &mut Relaxed, gradient: &Gradient, scores: &[f64], chosen: &[usize]) {
        let dual = self.instance.dual(&gradient.y);
        // Rounding of the scores that count, as in the certificate.
        let terms = chosen.iter().flat_map(|&c| self.instance.products(&dual, self.open[c]).map(f64::abs));
        let rounding = dual.len() as f64 * f64::EPSILON * terms.sum::<f64>();
        let greatest = rounding + chosen.iter().map(|&c| scores[c]).sum::<f64>();
        let known_score: f64 = self.known.iter().zip(&dual).map(|(m, y)| m * y).sum();
        let log_polar = self.instance.log_polar(gradient);
        let log_bound = (known_score + greatest).ln() - log_polar + ROUNDING;
        if log_bound < best.log_bound {
            *best = Relaxed { weights: vec![], scores: scores.to_vec(), known_score, log_polar, log_bound };
        }
    }

    /// Places whose weights may change in this step: the fractional ones, the best at 0 and the worst at 1 that promise
    /// a gain.
    fn working_set(&self, scores: &[f64]) -> Vec<usize> {
        let place = |lower: bool| {
            (0..scores.len()).filter(move |&c| if lower { self.weights[c] > 0.0 } else { self.weights[c] < 1.0 })
        };
        let least_above = place(true).map(|c| scores[c]).fold(f64::INFINITY, f64::min);
        let greatest_below = place(false).map(|c| scores[c]).fold(f64::NEG_INFINITY, f64::max);
        let mut rising: Vec<usize> =
            (0..scores.len()).filter(|&c| self.weights[c] == 0.0 && scores[c] > least_above).collect();
        rising.sort_unstable_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
        let mut falling: Vec<usize> =
            (0..scores.len()).filter(|&c| self.weights[c] == 1.0 && scores[c] < greatest_below).collect();
        falling.sort_unstable_by(|&a, &b| scores[a].total_cmp(&scores[b]).then(a.cmp(&b)));
        let mut free: Vec<usize> =
            (0..scores.len()).filter(|&c| self.weights[c] > 0.0 && self.weights[c] < 1.0).collect();
        free.extend(rising.into_iter().take(JOINING));
        free.extend(falling.into_iter().take(JOINING));
        free.sort_unstable();
        free
    }

    /// The step that maximises the quadratic model over the free weights within their bounds: an active-set method.
    fn direction(&self, free: &[usize], scores: &[f64], curvature: &InstanceCurvature) -> Vec<f64> {
        let f = free.len();
        let images: Vec<DVector<f64>> =
            free.iter().map(|&c| DVector::from_vec(self.instance.curve(curvature, self.open[c]))).collect();
        let mut H = DMatrix::from_fn(f, f, |a, b| images[a].dot(&images[b]));
        let ridge = 1e-10 * H.diagonal().max().max(f64::MIN_POSITIVE);
        for a in 0..f {
            H[(a, a)] += ridge;
        }
        let g: Vec<f64> = free.iter().map(|&c| scores[c]).collect();
        let (low, high): (Vec<f64>, Vec<f64>) = free.iter().map(|&c| (-self.weights[c], 1.0 - self.weights[c])).unzip();
        let mut step = vec![0.0; f];
        let mut held: Vec<bool> = vec![false; f];
        // Weights at a bound start held where the model pushes against it.
        for _ in 0..4 * f + 8 {
            let loose: Vec<usize> = (0..f).filter(|&a| !held[a]).collect();
            let Some((target, multiplier)) = equality_step(&H, &g, &step, &loose) else { break };
            // The longest way towards the target that keeps all bounds.
            let mut length = 1.0;
            let mut blocking = None;
            for (&a, &x) in loose.iter().zip(&target) {
                let d = x - step[a];
                let room = if d > 0.0 { high[a] - step[a] } else { low[a] - step[a] };
                if d != 0.0 && room / d < length {
                    (length, blocking) = (room / d, Some(a));
                }
            }
            for (&a, &x) in loose.iter().zip(&target) {
                step[a] += length.max(0.0) * (x - step[a]);
            }
            if let Some(a) = blocking {
                step[a] = if step[a] > 0.5 * (low[a] + high[a]) { high[a] } else { low[a] };
                held[a] = true;
                continue;
            }
            // At the optimum of the loose ones: release the held one that most wants to move off its bound.
            let wants = |a: usize| {
                let pull: f64 = g[a] - (0..f).map(|b| H[(a, b)] * step[b]).sum::<f64>() - multiplier;
                if step[a] == low[a] { pull } else { -pull }
            };
            let release = (0..f).filter(|&a| held[a]).max_by(|&a, &b| wants(a).total_cmp(&wants(b)));
            match release {
                Some(a) if wants(a) > 1e-12 => held[a] = false,
                _ => break,
            }
        }
        step
    }
}

/// The maximiser of the model over the loose coordinates with the others held and the sum zero, and the multiplier of the
/// sum.
fn equality_step(H: &DMatrix<f64>, g: &[f64], step: &[f64], loose: &[usize]) -> Option<(Vec<f64>, f64)> {
    if loose.is_empty() {
        return None;
    }
    let held_sum: f64 = (0..step.len()).filter(|a| !loose.contains(a)).map(|a| step[a]).sum();
    let right = DVector::from_iterator(
        loose.len(),
        loose
            .iter()
            .map(|&a| g[a] - (0..step.len()).filter(|b| !loose.contains(b)).map(|b| H[(a, b)] * step[b]).sum::<f64>()),
    );
    let factor = H.select_rows(loose).select_columns(loose).cholesky()?;
    let unconstrained = factor.solve(&right);
    let ones = factor.solve(&DVector::from_element(loose.len(), 1.0));
    // x = H⁻¹(g − μ1) with Σx = −(what the held ones add).
    let multiplier = (unconstrained.sum() + held_sum) / ones.sum();
    Some(((unconstrained - ones * multiplier).as_slice().to_vec(), multiplier))
}

fn snapped(weight: f64) -> f64 {
    if weight < BOUNDARY {
        0.0
    } else if weight > 1.0 - BOUNDARY {
        1.0
    } else {
        weight
    }
}
