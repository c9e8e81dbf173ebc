//! The fewest candidates whose Φ reaches a level.

use std::ops::ControlFlow;

use super::{SearchEnd, SearchProgress, search};
use crate::selection::best::{Best, best};
use crate::selection::certificate::Certificate;
use crate::selection::error::SelectionError;
use crate::selection::exchange::improved;
use crate::selection::function::Gradient;
use crate::selection::greedy::greedy;
use crate::selection::instance::Instance;
use crate::selection::relaxation::{RelaxationSettings, relax};

/// The smallest selection found, and why there is no smaller one.
#[derive(Debug, Clone, PartialEq)]
pub struct Fewest {
    /// The best selection found of the smallest number that suffices.
    pub best: Best,
    /// Fewer than this are proven not to suffice; the number selected, where the proof is complete.
    pub least: usize,
    /// What proves that `least − 1` do not suffice; `None` if they are fewer than the constraints require.
    pub refutation: Option<Refutation>,
}

/// A proof that so many do not suffice.
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// Certificate for `least − 1`.
    pub certificate: Certificate,
    /// Nodes of the search that was needed beside it; 0 if the certificate's bound alone is below the level.
    pub nodes: usize,
}

/// Why no selection suffices.
#[derive(Debug, Clone, PartialEq)]
pub enum NotEnough {
    /// Nothing can be selected.
    Selection(SelectionError),
    /// No selection that reaches the level was found.
    Never {
        /// The best selection that was found, ascending: of the most that may be selected, unless constraints were in the way.
        selected: Vec<usize>,
        /// No selection has a greater log Φ; ∞ where constraints were in the way, so that it is not known.
        log_bound: f64,
    },
}

impl From<SelectionError> for NotEnough {
    fn from(error: SelectionError) -> Self {
        NotEnough::Selection(error)
    }
}

/// Finds the fewest candidates, at most `most`, with `log Φ ≥ level`. The count of `instance` does not matter.
///
/// From below by the relaxation: a number whose bound is under the level does not suffice, nor do fewer. From above by
/// selecting. Between the two by a search for each number that is open, `node_limit` nodes in all, or until `observe` breaks.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use calipose::selection::{InformationFunction, InformationSet, Instance, RelaxationSettings, fewest};
/// use nalgebra::DMatrix;
///
/// // How many unit measurements of one number make its variance a third?
/// let views = InformationSet::from_matrices(1, &vec![DMatrix::identity(1, 1); 5])?;
/// let variance = InformationFunction::variance(&DMatrix::identity(1, 1));
/// let instance = Instance::new(&views, None, &variance, 1)?;
/// let (level, observe) = (2.999f64.ln(), &mut |_: &_| ControlFlow::Continue(()));
/// let found = fewest(&instance, level, 5, &RelaxationSettings::default(), 0, 1000, observe).expect("five suffice");
/// assert_eq!((found.best.selected.len(), found.least), (3, 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When not even `most` suffice, or nothing can be selected.
pub fn fewest(
    instance: &Instance,
    level: f64,
    most: usize,
    settings: &RelaxationSettings,
    seed: u64,
    node_limit: usize,
    observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
) -> Result<Fewest, NotEnough> {
    let quest = Quest { instance, level, settings, seed };
    let enough = quest.first_enough(most)?;
    let (least, refutation) = quest.least_by_bounds(&enough)?;
    let (best, open) = quest.first_from(least, enough.len())?;
    quest.close(Fewest { best, least, refutation }, open, node_limit, observe)
}

/// How far below the level a search still looks: it prunes what exceeds its goal by no more than rounding.
const MARGIN: f64 = 1e-8;

/// What is sought.
struct Quest<'a> {
    instance: &'a Instance<'a>,
    level: f64,
    settings: &'a RelaxationSettings,
    seed: u64,
}

impl Quest<'_> {
    /// The fewest that the constraints allow.
    fn fewest_allowed(&self) -> usize {
        self.instance.required().len().max(1)
    }

    fn best(&self, count: usize) -> Result<Best, SelectionError> {
        best(&self.instance.with_count(count)?, self.settings, self.seed)
    }

    /// A selection of at most `most` that suffices, its size not far from the least.
    fn first_enough(&self, most: usize) -> Result<Vec<usize>, NotEnough> {
        let open = (0..self.instance.len()).filter(|&i| self.instance.is_open(i)).count();
        let most = most.min(self.instance.required().len() + open).max(self.fewest_allowed());
        let mut count = self.fewest_allowed();
        loop {
            let larger = self.instance.with_count(count)?;
            let reaches = |selected: &[usize]| larger.log_value_at(&larger.total(selected)) >= self.level;
            match greedy(&larger) {
                Ok(selected) if reaches(&selected) => return Ok(selected),
                Ok(selected) if count == most => {
                    let improved = improved(&larger, selected);
                    if reaches(&improved) {
                        return Ok(improved);
                    }
                    let bounded = relax(&larger, &improved, self.settings);
                    let log_bound =
                        bounded.map_or(f64::INFINITY, |relaxed| self.bound_of_all(count, &relaxed.certificate));
                    return Err(NotEnough::Never { selected: improved, log_bound });
                }
                Err(SelectionError::NoRoom { found, at_most, .. })
                    if (self.fewest_allowed()..count).contains(&found) =>
                {
                    return self.in_narrow_room(found, at_most);
                }
                Err(SelectionError::Unobservable { .. }) if count < most => {}
                Err(error) => return Err(error.into()),
                Ok(_) => {}
            }
            count = (count + count.div_ceil(2)).min(most);
        }
    }

    /// The same where no more than `found` were found to be allowed together, and no more than `at_most` are.
    fn in_narrow_room(&self, found: usize, at_most: usize) -> Result<Vec<usize>, NotEnough> {
        let mut closest: Option<Best> = None;
        let mut log_bound = f64::INFINITY;
        for count in (self.fewest_allowed()..=found).rev() {
            let Ok(best) = self.best(count) else { continue };
            if best.log_value >= self.level {
                return Ok(best.selected);
            }
            if count == at_most {
                log_bound = self.bound_of_all(count, &best.relaxation.certificate);
            }
            if closest.as_ref().is_none_or(|closest| best.log_value > closest.log_value) {
                closest = Some(best);
            }
        }
        match closest {
            Some(closest) => Err(NotEnough::Never { selected: closest.selected, log_bound }),
            None => Err(SelectionError::NoRoom { count: found + 1, found, at_most }.into()),
        }
    }

    /// What the certificate of the largest sets, of `most`, proves of all: its matrix and prices bound the smaller ones too, which
    /// the constraints may keep from growing into those.
    fn bound_of_all(&self, most: usize, certificate: &Certificate) -> f64 {
        let Certificate { y, mixture, prices, log_bound } = certificate;
        // Without prices the bound grows with the number.
        if prices.is_empty() {
            return *log_bound;
        }
        let of = |count: usize| {
            let gradient = Gradient { y: y.clone(), mixture: mixture.clone() };
            let fewer = self.instance.with_count(count).ok()?;
            Some(Certificate::new(&fewer, gradient, prices.clone()).ok()?.log_bound)
        };
        (self.fewest_allowed()..most).filter_map(of).fold(*log_bound, f64::max)
    }

    /// The least number whose bound reaches the level, and the proof that one less does not; by bisection below the size of
    /// `enough`, where the relaxation starts from. Fewer than these do not either, whatever the constraints: the relaxed value is
    /// concave in the number, and `enough` reach the level.
    fn least_by_bounds(&self, enough: &[usize]) -> Result<(usize, Option<Refutation>), SelectionError> {
        let (mut short, mut least) = (self.fewest_allowed() - 1, enough.len());
        let mut refutation = None;
        while least - short > 1 {
            let middle = usize::midpoint(short, least);
            let relaxed = relax(&self.instance.with_count(middle)?, enough, self.settings);
            match relaxed.map(|relaxed| relaxed.certificate) {
                Ok(certificate) if certificate.log_bound < self.level => {
                    short = middle;
                    refutation = Some(Refutation { certificate, nodes: 0 });
                }
                _ => least = middle,
            }
        }
        Ok((least, refutation))
    }

    /// The first selection that suffices, from `least` upwards, and the best selections of the numbers before it; `enough` do.
    fn first_from(&self, least: usize, enough: usize) -> Result<(Best, Vec<Best>), SelectionError> {
        let mut open = vec![];
        let mut count = least;
        loop {
            match self.best(count) {
                Ok(best) if best.log_value >= self.level => return Ok((best, open)),
                Ok(best) => open.push(best),
                // Singular sets, or constraints in the way: a greater number may do.
                Err(_) if count < enough => {}
                Err(error) => return Err(error),
            }
            count += 1;
        }
    }

    /// Searches the numbers in between, given by their best selections: proves them not to suffice, or finds that one does.
    fn close(
        &self,
        mut fewest: Fewest,
        open: Vec<Best>,
        node_limit: usize,
        observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
    ) -> Result<Fewest, NotEnough> {
        let mut nodes_left = node_limit;
        for best in open {
            let smaller = self.instance.with_count(best.selected.len())?;
            let outcome = search(&smaller, &best, self.level - MARGIN, nodes_left, observe)?;
            nodes_left -= outcome.nodes.min(nodes_left);
            let Best { selected, relaxation, .. } = best;
            if outcome.log_value >= self.level {
                fewest.best = Best { selected: outcome.selected, log_value: outcome.log_value, relaxation };
                break;
            }
            if outcome.end != SearchEnd::Optimal || selected.len() != fewest.least {
                break;
            }
            fewest.least += 1;
            fewest.refutation = Some(Refutation { certificate: relaxation.certificate, nodes: outcome.nodes });
        }
        Ok(fewest)
    }
}
