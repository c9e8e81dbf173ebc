//! Greedy selection: the best marginal gain, k times.

use rayon::prelude::*;

use super::error::SelectionError;
use super::highest::highest;
use super::instance::{EFFORT, Instance, Part, packing};

/// Information assumed before the first pick, as a share of k average views: keeps log Φ finite until the picks
/// determine every parameter, and too little to weigh once they do.
const RIDGE: f64 = 1e-4;

/// Softness of functions with kinks, whose own gain is zero wherever two views are needed to raise the least value.
const SOFTNESS: f64 = 0.5;

/// Growth of the scores' bounds since they were scored, above which they are scored anew.
const MOST_GROWTH: f64 = 2.0;

/// Candidates evaluated first in each step, so that the bound can spare the rest.
const PROBES: usize = 64;

/// Candidates of an even sample, at least; of twice as many one is drawn.
const SAMPLE: usize = 50_000;

/// Candidates evaluated by one task.
pub(super) const EVALUATED_PER_TASK: usize = 128;

/// Picks `instance.count()` candidates, first the required ones, then each the one that raises log Φ most; ties go to the
/// lower index.
///
/// With the gradient Y at hand, adding candidate i gains at most `log(1 + s_i)`, `s_i = ⟨Y, M_i⟩`. Scores are not computed
/// anew in every step either: if `Y ⪯ c·Y'` then `s_i ≤ c·s'_i`, so a score of an earlier step bounds that of this one, and
/// only candidates whose bound reaches the best gain found are scored and evaluated. The picks are those of a full search.
///
/// Where the constraints allow no further pick, as many of the first picks are kept as a search can complete.
///
/// # Errors
/// When the picks leave a combination of the parameters undetermined, or no allowed set was found.
pub fn greedy(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let selected = start(instance)?;
    if instance.is_singular(&selected) {
        return Err(instance.unobservable(&selected));
    }
    Ok(selected)
}

/// As [`greedy`], be the picks singular or not.
pub(super) fn start(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let picked = picks(instance)?;
    if picked.len() == instance.count() { Ok(picked) } else { completed(instance, &picked) }
}

/// An even sample of the candidates, where they are many: to begin in, for what looks at all of them afterwards.
pub(super) fn sample<'a>(instance: &'a Instance<'a>) -> Option<Part<'a>> {
    (instance.len() > 2 * SAMPLE).then(|| Part::new(instance, (0..instance.len()).step_by(instance.len() / SAMPLE)))
}

/// As [`start`], among a [`sample`] where there is one and it does.
pub(super) fn start_of_sample(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    if let Some(part) = sample(instance) {
        let of_part = part.instance();
        if let Ok(picked) = start(&of_part)
            && !of_part.is_singular(&picked)
        {
            return Ok(part.members(&picked));
        }
    }
    start(instance)
}

/// An allowed set with as many of the first `picked` as a search finds one for; the required ones come first among them.
fn completed(instance: &Instance, picked: &[usize]) -> Result<Vec<usize>, SelectionError> {
    let required = instance.required();
    for kept in (required.len() + 1..=picked.len()).rev() {
        let found = packing(instance, &picked[..kept], EFFORT / 16);
        if found.selected.len() == instance.count() {
            return Ok(found.selected);
        }
    }
    let found = packing(instance, required, EFFORT);
    if found.selected.len() == instance.count() {
        return Ok(found.selected);
    }
    let most = found.selected.len().max(picked.len());
    Err(SelectionError::NoRoom { count: instance.count(), found: most, at_most: found.at_most })
}

/// The picks, fewer than wanted if the constraints allow no other.
fn picks(instance: &Instance) -> Result<Vec<usize>, SelectionError> {
    let softened = instance.softened(SOFTNESS);
    let mut total = softened.with_mean(RIDGE * instance.count() as f64);
    let mut selected = Vec::with_capacity(instance.count());
    for &i in instance.required() {
        instance.add_to(&mut total, i, 1.0);
        selected.push(i);
    }
    let mut scoreboard = Scoreboard::new(&softened);
    while selected.len() < instance.count() {
        let Some(i) = scoreboard.best_addition(&total, &selected)? else { break };
        instance.add_to(&mut total, i, 1.0);
        selected.push(i);
    }
    Ok(selected)
}

/// Upper bounds of all candidates' scores, from step to step.
struct Scoreboard<'a> {
    instance: &'a Instance<'a>,
    /// The gradient of the last step.
    y: Option<Vec<f64>>,
    /// Bounds, to be multiplied by `factor`; −∞ once a candidate is out of question.
    bounds: Vec<f64>,
    factor: f64,
}

impl<'a> Scoreboard<'a> {
    fn new(instance: &'a Instance<'a>) -> Self {
        Self { instance, y: None, bounds: vec![], factor: 1.0 }
    }

    /// Brings the bounds to the gradient `y`: from the last step's if that bounds it, or anew.
    fn bring_to(&mut self, y: Vec<f64>) {
        let growth = self.y.as_ref().map_or(f64::INFINITY, |before| self.instance.growth(before, &y));
        if growth * self.factor <= MOST_GROWTH {
            self.factor *= growth;
        } else {
            self.rescore(&y);
        }
        self.y = Some(y);
    }

    fn rescore(&mut self, y: &[f64]) {
        let out = std::mem::replace(&mut self.bounds, self.instance.scores(y));
        let is_out = |i: usize| out.get(i).map_or(!self.instance.is_open(i), |&bound| bound == f64::NEG_INFINITY);
        for i in (0..self.bounds.len()).filter(|&i| is_out(i)) {
            self.bounds[i] = f64::NEG_INFINITY;
        }
        self.factor = 1.0;
    }

    /// The open candidate, allowed beside `selected`, that raises log Φ of `total` most; `None` if none is allowed.
    fn best_addition(&mut self, total: &[f64], selected: &[usize]) -> Result<Option<usize>, SelectionError> {
        let instance = self.instance;
        let Some(gradient) = instance.gradient_at(total) else {
            return Err(instance.least_known(total, selected.len()));
        };
        let before = instance.log_value_at(total);
        self.bring_to(gradient.y.clone());
        let rules = instance.rules();
        let allowed = |i: usize| rules.is_free() || rules.allows(selected, None, i);
        let better = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a };
        let best_of = |candidates: &[usize]| {
            let values = instance
                .log_values_with(total, candidates, f64::NEG_INFINITY)
                .into_iter()
                .zip(candidates.iter().copied());
            values.fold((f64::NEG_INFINITY, usize::MAX), better)
        };
        let probes = highest(
            &self.bounds,
            (0..self.bounds.len()).filter(|&i| self.bounds[i] > f64::NEG_INFINITY && allowed(i)),
            PROBES,
        );
        let probed = best_of(&probes);
        let least_score = (probed.0 - before - 1e-12).exp_m1();
        // Bounds that reach the best gain are replaced by scores; all of them at once where they are many.
        let mut reaching = self.reaching(least_score);
        if reaching.len() > self.bounds.len() / 8 && self.factor != 1.0 {
            self.rescore(&gradient.y);
            reaching = self.reaching(least_score);
        } else {
            for (&i, score) in reaching.iter().zip(instance.scores_of(&gradient.y, &reaching)) {
                self.bounds[i] = score / self.factor;
            }
        }
        reaching.retain(|&i| self.bounds[i] * self.factor >= least_score && allowed(i));
        let best = reaching.par_chunks(EVALUATED_PER_TASK).map(best_of).reduce(|| probed, better);
        match best.1 {
            usize::MAX if (0..self.bounds.len()).any(|i| self.bounds[i] > f64::NEG_INFINITY && allowed(i)) => {
                Err(instance.least_known(total, selected.len()))
            }
            usize::MAX => Ok(None),
            i => {
                self.bounds[i] = f64::NEG_INFINITY;
                Ok(Some(i))
            }
        }
    }

    fn reaching(&self, least_score: f64) -> Vec<usize> {
        let least = least_score / self.factor * (1.0 - 1e-12);
        (0..self.bounds.len()).filter(|&i| self.bounds[i] > f64::NEG_INFINITY && self.bounds[i] >= least).collect()
    }
}
