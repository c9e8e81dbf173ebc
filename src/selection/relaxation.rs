//! The convex relaxation, by column generation, with Clarabel.
//!
//! ```text
//! maximise  log Φ(M₀ + Σ wᵢ Mᵢ)   over   0 ≤ wᵢ ≤ 1,  Σ wᵢ = k,  and Σ wᵢ ≤ m within each group
//! ```
//!
//! Groups are the caps, and of the separations balls: cutting planes, which join where the weights hold more than one of a ball.
//!
//! Two loops. The outer one keeps a working set of columns: it scores **all** candidates with the gradient Y of log Φ,
//! evaluates the certificate, and adds the best that are outside. The inner one is Newton's method on
//! the working set: with `B = [map(M_i)]` the square root of the curvature (see `Curvature`), each step is the quadratic
//! program
//!
//! ```text
//! minimise  ½‖y‖² − gᵀw   subject to   B(w − w₀) = y  and the constraints on w,     gᵢ = ⟨Y, Mᵢ⟩
//! ```
//!
//! which Clarabel solves; a line search on log Φ follows. Compared with one semidefinite program this needs only linear
//! cones, takes every information function in the same form, is scaled by B at every step, so that units do not matter, and
//! starts where it left off when columns join. The multipliers of the groups are the certificate's prices.
//!
//! A function with kinks is approached through its [softened](crate::selection::InformationFunction::softened) stand-ins, ever less
//! soft: the central path of an interior-point method. The certificate is always that of the function itself.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use super::certificate::Certificate;
use super::error::SelectionError;
use super::function::Gradient;
use super::group::Group;
use super::highest::highest;
use super::instance::{Instance, InstanceCurvature};
use super::packed::dot;

/// When to stop, and how many columns to carry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationSettings {
    /// Gap in log Φ between bound and relaxed value at which the relaxation counts as solved. For functions with kinks at
    /// least [`RelaxationSettings::KINK_TOLERANCE`].
    pub tolerance: f64,
    /// Most rounds of column generation.
    pub max_rounds: usize,
    /// Most columns that join the working set in one round; never fewer than k.
    pub columns_per_round: usize,
}

impl RelaxationSettings {
    /// The finest gap asked of functions with kinks: below, the stand-in's curvature exceeds what doubles resolve.
    pub const KINK_TOLERANCE: f64 = 1e-5;
}

impl Default for RelaxationSettings {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_rounds: 60, columns_per_round: 40 }
    }
}

/// A solution of the relaxation.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    /// Candidates of positive weight in ascending order, with their weights.
    pub weights: Vec<(usize, f64)>,
    /// log Φ at the weights; −∞ where none were found within the groups.
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

/// By how much weights may exceed a group before it is held against them.
const EXCESS: f64 = 1e-4;

/// Prices that are no more than this share of the greatest are zero.
const NO_PRICE: f64 = 1e-10;

/// Weights below this are zero.
const ZERO_WEIGHT: f64 = 1e-8;

/// The first softness of a function with kinks, and the factor to the next.
const SOFTNESS: f64 = 0.3;
const SOFTNESS_FACTOR: f64 = 0.1;

/// Solves the relaxation of `instance`, starting with equal weights on the candidates `start`, at least as many as are to be
/// selected.
///
/// ```
/// use calipose::selection::{InformationFunction, InformationSet, Instance, RelaxationSettings, improved_greedy, relax};
/// use nalgebra::DMatrix;
///
/// let along = |x: f64, y: f64| DMatrix::from_row_slice(2, 2, &[x * x, x * y, x * y, y * y]);
/// let views = InformationSet::from_matrices(2, &[along(1.0, 0.0), along(0.0, 1.0), along(1.0, 1.0)])?;
/// let instance = Instance::new(&views, None, &InformationFunction::Determinant, 2)?;
/// let start = improved_greedy(&instance)?;
/// let relaxation = relax(&instance, &start, &RelaxationSettings::default())?;
/// let weights: f64 = relaxation.weights.iter().map(|(_, weight)| weight).sum();
/// assert!((weights - 2.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the start is too few, no candidates, or leaves a combination of the parameters undetermined.
pub fn relax(
    instance: &Instance,
    start: &[usize],
    settings: &RelaxationSettings,
) -> Result<Relaxation, SelectionError> {
    instance.check(start)?;
    if start.len() < instance.count() {
        return Err(SelectionError::TooFew { count: instance.count(), found: start.len() });
    }
    relaxed(instance, start, settings, None).ok_or_else(|| instance.unobservable(start))
}

/// As [`relax`], but ended as soon as the bound is below `floor` or the value is not.
///
/// # Errors
/// When the start leaves a combination of the parameters undetermined.
pub(crate) fn relax_until(
    instance: &Instance,
    start: &[usize],
    settings: &RelaxationSettings,
    floor: f64,
) -> Result<Relaxation, SelectionError> {
    relaxed(instance, start, settings, Some(floor)).ok_or_else(|| instance.unobservable(start))
}

/// The relaxation; `None` if the start is singular. With a `floor` it ends once it is known on which side of it the optimum is.
fn relaxed(
    instance: &Instance,
    start: &[usize],
    settings: &RelaxationSettings,
    floor: Option<f64>,
) -> Option<Relaxation> {
    let smooth = instance.is_smooth();
    let tolerance =
        if smooth { settings.tolerance } else { settings.tolerance.max(RelaxationSettings::KINK_TOLERANCE) };
    let mut softness = SOFTNESS;
    let mut master = Master::new(instance.softened(softness), start);
    let total = master.total();
    let gradient = master.instance.gradient_at(&total)?;
    let mut reduced = instance.scores(&gradient.y);
    let mut certificate = Certificate::from_reduced(instance, gradient, vec![], &reduced);
    let mut log_value = if master.cut() { f64::NEG_INFINITY } else { instance.log_value_at(&total) };
    let mut best_weights = master.weighted();
    let mut rounds = 0;
    let is_open = |value: f64, bound: f64| floor.is_none_or(|floor| value < floor && bound >= floor);
    while certificate.log_bound - log_value > tolerance
        && is_open(log_value, certificate.log_bound)
        && rounds < settings.max_rounds
    {
        rounds += 1;
        master.drop_unused();
        master.add_columns(&reduced, settings.columns_per_round.max(instance.count()));
        let goal = if smooth { 0.5 * tolerance } else { (0.01 * softness).max(0.1 * tolerance) };
        let solved = master.solve(goal, if smooth { floor } else { None });
        let total = master.total();
        // A certificate in hand holds whatever becomes of the weights.
        let Some(gradient) = master.instance.gradient_at(&total) else { break };
        reduced = master.reduced(&instance.scores(&gradient.y));
        let gap = master.gap_over_all(&gradient, &reduced);
        let found = Certificate::from_reduced(instance, gradient, master.prices(), &reduced);
        let reached = instance.log_value_at(&total);
        let progress = (reached - log_value).max(certificate.log_bound - found.log_bound);
        if found.log_bound < certificate.log_bound {
            certificate = found;
        }
        if master.cut() {
            // These weights are none any more.
            log_value = f64::NEG_INFINITY;
            continue;
        }
        if !master.is_within(&master.rows()) {
            // The working set has no weights within the groups, or none were found.
            break;
        }
        if smooth || reached > log_value {
            log_value = reached;
            best_weights = master.weighted();
        }
        if smooth {
            if !solved && progress <= tolerance {
                break;
            }
        } else if gap <= 0.1 * softness.max(tolerance) || !solved {
            if softness < 1e-3 * tolerance {
                break;
            }
            softness *= SOFTNESS_FACTOR;
            master.instance = instance.softened(softness);
        }
    }
    let solved = certificate.log_bound - log_value <= tolerance;
    Some(Relaxation {
        weights: best_weights,
        log_value,
        certificate,
        solved,
        rounds,
        newton_steps: master.newton_steps,
    })
}

/// The relaxation on a working set.
struct Master<'a> {
    /// The problem with a smooth objective.
    instance: Instance<'a>,
    /// `M₀ +` the information of the required candidates.
    known: Vec<f64>,
    /// The working set, ascending, without the required candidates.
    columns: Vec<usize>,
    weights: Vec<f64>,
    /// Candidates that stay in the working set: with separations weights on few others may not add up to k.
    kept: Vec<usize>,
    groups: Vec<PricedGroup>,
    newton_steps: usize,
}

/// A group that weights are held to.
struct PricedGroup {
    group: Group,
    /// All candidates that count, ascending.
    members: Vec<usize>,
    /// What the required candidates leave of it.
    most: f64,
    price: f64,
}

/// A group that some columns could exceed.
struct GroupRow {
    /// Its place among the groups.
    group: usize,
    /// Places in the working set.
    places: Vec<usize>,
}

impl<'a> Master<'a> {
    fn new(instance: Instance<'a>, start: &[usize]) -> Self {
        let mut columns: Vec<usize> = start.iter().copied().filter(|&i| instance.is_open(i)).collect();
        columns.sort_unstable();
        let free = instance.count() - instance.required().len();
        let weights = vec![free as f64 / columns.len().max(1) as f64; columns.len()];
        let known = instance.total(instance.required());
        let kept = if instance.rules().is_free() { vec![] } else { columns.clone() };
        let caps = (0..instance.caps().len()).map(Group::Cap).collect();
        let mut master = Self { instance, known, columns, weights, kept, groups: vec![], newton_steps: 0 };
        master.hold(caps);
        master
    }

    /// Holds weights to more groups.
    fn hold(&mut self, groups: Vec<Group>) {
        let rules = self.instance.rules();
        self.groups.extend(groups.into_iter().map(|group| {
            let required = rules.counted(&rules.required, group).len();
            let members = rules.members(group).into_owned();
            PricedGroup { group, members, most: (rules.most(group) - required) as f64, price: 0.0 }
        }));
    }

    /// Holds weights to the balls that they exceed; whether there are any.
    fn cut(&mut self) -> bool {
        let mut balls = self.instance.rules().overfull(&self.weighted(), EXCESS);
        balls.retain(|ball| self.groups.iter().all(|held| held.group != *ball));
        let is_cut = !balls.is_empty();
        self.hold(balls);
        is_cut
    }

    /// The groups that bind, with their prices.
    fn prices(&self) -> Vec<(Group, f64)> {
        let priced = self.groups.iter().filter(|group| group.price > 0.0);
        priced.map(|&PricedGroup { group, price, .. }| (group, price)).collect()
    }

    /// Scores of all candidates less the prices of their groups.
    fn reduced(&self, scores: &[f64]) -> Vec<f64> {
        let mut reduced = scores.to_vec();
        for PricedGroup { members, price, .. } in self.groups.iter().filter(|group| group.price > 0.0) {
            for &i in members {
                reduced[i] -= price;
            }
        }
        reduced
    }

    fn total(&self) -> Vec<f64> {
        self.total_at(&self.weights)
    }

    fn total_at(&self, weights: &[f64]) -> Vec<f64> {
        let mut total = self.known.clone();
        for (&i, &weight) in self.columns.iter().zip(weights) {
            self.instance.add_to(&mut total, i, weight);
        }
        total
    }

    /// Candidates of positive weight with their weights, ascending.
    fn weighted(&self) -> Vec<(usize, f64)> {
        let columns = self.columns.iter().copied().zip(self.weights.iter().copied());
        let required = self.instance.required().iter().map(|&i| (i, 1.0));
        let mut weighted: Vec<_> = columns.filter(|&(_, weight)| weight > ZERO_WEIGHT).chain(required).collect();
        weighted.sort_unstable_by_key(|&(i, _)| i);
        weighted
    }

    /// Columns of weight zero leave.
    fn drop_unused(&mut self) {
        let is_kept = |c: &usize| self.weights[*c] > ZERO_WEIGHT || self.kept.binary_search(&self.columns[*c]).is_ok();
        let kept: Vec<usize> = (0..self.columns.len()).filter(is_kept).collect();
        self.weights = kept.iter().map(|&c| self.weights[c]).collect();
        self.columns = kept.iter().map(|&c| self.columns[c]).collect();
    }

    /// The best `most` of the candidates outside join, by their scores less the prices.
    fn add_columns(&mut self, reduced: &[f64], most: usize) {
        let mut outside: Vec<bool> = (0..reduced.len()).map(|i| self.instance.is_open(i)).collect();
        for &i in &self.columns {
            outside[i] = false;
        }
        let weights = self.weights.iter().copied().chain(std::iter::repeat(0.0));
        let joining = highest(reduced, (0..reduced.len()).filter(|&i| outside[i]), most);
        let mut weighted: Vec<(usize, f64)> = self.columns.iter().copied().chain(joining).zip(weights).collect();
        weighted.sort_unstable_by_key(|&(i, _)| i);
        (self.columns, self.weights) = weighted.into_iter().unzip();
    }

    /// The groups that the working set could exceed.
    fn rows(&self) -> Vec<GroupRow> {
        let row = |(group, held): (usize, &PricedGroup)| {
            let counts = |place: &usize| held.members.binary_search(&self.columns[*place]).is_ok();
            let places: Vec<usize> = (0..self.columns.len()).filter(counts).collect();
            (places.len() as f64 > held.most).then_some(GroupRow { group, places })
        };
        self.groups.iter().enumerate().filter_map(row).collect()
    }

    /// Whether the weights are within the groups.
    fn is_within(&self, rows: &[GroupRow]) -> bool {
        let held = |row: &GroupRow| row.places.iter().map(|&place| self.weights[place]).sum::<f64>();
        rows.iter().all(|row| held(row) <= self.groups[row.group].most + EXCESS)
    }

    /// How much more any weights promise, to first order: `max ⟨g, w'⟩ − ⟨g, w⟩` over the working set at the current prices.
    fn gap(&self, gradient: &[f64], rows: &[GroupRow]) -> f64 {
        let mut reduced = gradient.to_vec();
        let mut held = 0.0;
        for row in rows {
            let PricedGroup { price, most, .. } = self.groups[row.group];
            held += price * most;
            for &place in &row.places {
                reduced[place] -= price;
            }
        }
        let free = self.instance.count() - self.instance.required().len();
        held + greatest(&reduced, free).iter().map(|&c| reduced[c]).sum::<f64>() - dot(gradient, &self.weights)
    }

    /// The same over all candidates, by their scores less the prices, which tells whether columns are missing.
    fn gap_over_all(&self, gradient: &Gradient, reduced: &[f64]) -> f64 {
        let rules = self.instance.rules();
        let (greatest, _) = rules.greatest(reduced, self.instance.count());
        let held: f64 = self.groups.iter().map(|held| held.price * rules.most(held.group) as f64).sum();
        let own = self.instance.scores_of(&gradient.y, &self.columns);
        let required: f64 = self.instance.scores_of(&gradient.y, self.instance.required()).iter().sum();
        held + greatest.iter().map(|&i| reduced[i]).sum::<f64>() - dot(&own, &self.weights) - required
    }

    /// Newton's method until no weights on the working set promise more than `tolerance`, to first order, or log Φ is at least
    /// `enough`; whether it got there.
    fn solve(&mut self, tolerance: f64, enough: Option<f64>) -> bool {
        let rows = self.rows();
        let mut is_within = self.is_within(&rows);
        let mut least_gap = f64::INFINITY;
        for _ in 0..MAX_NEWTON_STEPS {
            let total = self.total();
            let (Some(y), Some(curvature)) = (self.instance.gradient_at(&total), self.instance.curvature(&total))
            else {
                return false;
            };
            let gradient = self.instance.scores_of(&y.y, &self.columns);
            let gap = if is_within { self.gap(&gradient, &rows) } else { f64::INFINITY };
            let before = self.instance.log_value_at(&total);
            if is_within && (gap <= tolerance || enough.is_some_and(|enough| before >= enough)) {
                return true;
            }
            // Close to the optimum rounding hides the gain in log Φ; there the gap must fall instead.
            let hidden = gap < 1e-5;
            if hidden && gap > 0.5 * least_gap {
                return false;
            }
            least_gap = gap;
            let Some(target) = self.newton_target(&gradient, &curvature, &rows) else { return false };
            self.newton_steps += 1;
            let direction: Vec<f64> = target.iter().zip(&self.weights).map(|(t, w)| t - w).collect();
            let slope = dot(&direction, &gradient);
            let moved = |length: f64| -> Vec<f64> {
                self.weights.iter().zip(&direction).map(|(w, d)| w + length * d).collect()
            };
            let gains = |length: f64| {
                let gain = self.instance.log_value_at(&self.total_at(&moved(length))) - before;
                gain >= 0.1 * length * slope
            };
            // Into the groups leads the whole step alone, whatever it costs.
            let whole = hidden || !is_within;
            let Some(length) = (0..20).map(|halvings| 0.5f64.powi(halvings)).find(|&length| whole || gains(length))
            else {
                return false;
            };
            self.weights = moved(length);
            is_within = true;
        }
        false
    }

    /// The minimiser of the quadratic model over the working set's weights; sets the prices to its multipliers.
    fn newton_target(
        &mut self,
        gradient: &[f64],
        curvature: &InstanceCurvature,
        rows: &[GroupRow],
    ) -> Option<Vec<f64>> {
        let n = self.columns.len();
        let B: Vec<Vec<f64>> = self.columns.iter().map(|&i| self.instance.curve(curvature, i)).collect();
        let m = B[0].len();

        // Unknowns (w, y). Rows: B w − y = B w₀ (m), Σ w = k (1), w ≤ 1 (n), −w ≤ 0 (n), groups.
        let mut Bw = vec![0.0; m];
        for (column, &weight) in B.iter().zip(&self.weights) {
            for (sum, b) in Bw.iter_mut().zip(column) {
                *sum += weight * b;
            }
        }
        let mut groups_at = vec![vec![]; n];
        for (r, row) in rows.iter().enumerate() {
            for &place in &row.places {
                groups_at[place].push(m + 1 + 2 * n + r);
            }
        }
        let mut column_starts = vec![0];
        let (mut places, mut entries) = (Vec::new(), Vec::new());
        for (c, column) in B.iter().enumerate() {
            places.extend(0..m);
            entries.extend(column);
            places.extend([m, m + 1 + c, m + 1 + n + c]);
            entries.extend([1.0, 1.0, -1.0]);
            places.extend(&groups_at[c]);
            entries.extend(std::iter::repeat_n(1.0, groups_at[c].len()));
            column_starts.push(places.len());
        }
        for r in 0..m {
            places.push(r);
            entries.push(-1.0);
            column_starts.push(places.len());
        }
        let A = CscMatrix::new(m + 1 + 2 * n + rows.len(), n + m, column_starts, places, entries);
        let mut b = Bw;
        b.push((self.instance.count() - self.instance.required().len()) as f64);
        b.extend(std::iter::repeat_n(1.0, n));
        b.extend(std::iter::repeat_n(0.0, n));
        b.extend(rows.iter().map(|row| self.groups[row.group].most));
        let P = CscMatrix::new(
            n + m,
            n + m,
            (0..=n + m).map(|c| c.saturating_sub(n)).collect(),
            (n..n + m).collect(),
            vec![1.0; m],
        );
        let q: Vec<f64> = gradient.iter().map(|g| -g).chain(std::iter::repeat_n(0.0, m)).collect();
        let cones = [SupportedConeT::ZeroConeT(m + 1), SupportedConeT::NonnegativeConeT(2 * n + rows.len())];
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
                let multipliers = &solver.solution.z[m + 1 + 2 * n..];
                for group in &mut self.groups {
                    group.price = 0.0;
                }
                let greatest = multipliers.iter().copied().fold(0.0, f64::max);
                for (row, &price) in rows.iter().zip(multipliers).filter(|&(_, &price)| price > NO_PRICE * greatest) {
                    self.groups[row.group].price = price;
                }
                Some(solver.solution.x[..n].iter().map(|w| w.clamp(0.0, 1.0)).collect())
            }
            _ => None,
        }
    }
}

/// Places of the `count` greatest numbers, in no particular order.
pub(super) fn greatest(numbers: &[f64], count: usize) -> Vec<usize> {
    let mut places: Vec<usize> = (0..numbers.len()).collect();
    if count < places.len() {
        places.select_nth_unstable_by(count, |&a, &b| numbers[b].total_cmp(&numbers[a]).then(a.cmp(&b)));
        places.truncate(count);
    }
    places
}
