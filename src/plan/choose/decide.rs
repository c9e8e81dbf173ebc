//! The choice that a problem asks for, with all that is proven of it.

use std::ops::ControlFlow;

use super::choice::Choice;
use super::chooser::Chooser;
use super::error::PlanError;
use crate::problem::{Goal, Method, SelectionSettings};
use crate::selection::{Certificate, Refutation, SearchEnd, SearchProgress};

/// A choice and what is proven of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// The choice.
    pub choice: Choice,
    /// What proves that no other of as many poses is much better.
    pub certificate: Certificate,
    /// The best bound on log Φ: the certificate's, or that of the search.
    pub log_bound: f64,
    /// What the search for the proven best set did, if there was one.
    pub search: Option<SearchSummary>,
    /// Why there are no fewer poses, if as few as possible were asked for.
    pub fewest: Option<FewestProof>,
}

/// How a search went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchSummary {
    /// How it ended.
    pub end: SearchEnd,
    /// Nodes worked on.
    pub nodes: usize,
    /// Candidates that reduced costs left open at its root.
    pub open_at_root: usize,
}

/// Why no fewer poses reach the accuracies.
#[derive(Debug, Clone, PartialEq)]
pub struct FewestProof {
    /// Fewer than this are proven not to suffice.
    pub least: usize,
    /// The proof for one less.
    pub refutation: Option<Refutation>,
}

/// Chooses as the chooser's problem asks, and certifies. `observe` hears of searches and may end them; what is found by then is
/// returned.
///
/// # Errors
/// When no choice is possible, or it leaves a combination of the intrinsics undetermined or all but so.
pub fn decide(
    chooser: &Chooser,
    observe: &mut dyn FnMut(&SearchProgress) -> ControlFlow<()>,
) -> Result<Decision, PlanError> {
    let SelectionSettings { goal, seed, .. } = &chooser.problem().selection;
    let (count, method) = match goal {
        Goal::Best { count, method, .. } => (*count, *method),
        Goal::Fewest { .. } => {
            let (choice, found) = chooser.fewest(*seed, observe)?;
            let certificate = found.best.relaxation.certificate;
            let log_bound = certificate.log_bound;
            let fewest = Some(FewestProof { least: found.least, refutation: found.refutation });
            return Ok(Decision { choice, certificate, log_bound, search: None, fewest });
        }
    };
    let (choice, certificate, search) = match method {
        Method::Exact => {
            let (choice, certificate, search) = chooser.exact(count, *seed, observe)?;
            (choice, certificate, Some(search))
        }
        Method::Best => {
            let (choice, certificate) = chooser.best(count, *seed)?;
            (choice, certificate, None)
        }
        method => {
            let choice = chooser.choose(method, count, *seed)?;
            chooser.require_observable(&choice)?;
            (choice, chooser.certificate(count)?, None)
        }
    };
    let log_bound = search.as_ref().map_or(certificate.log_bound, |search| search.log_bound);
    chooser.require_efficient(&choice, log_bound)?;
    let search =
        search.map(|search| SearchSummary { end: search.end, nodes: search.nodes, open_at_root: search.open_at_root });
    Ok(Decision { choice, certificate, log_bound, search, fewest: None })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::plan::survey::survey;
    use crate::problem::{Overrides, Problem};

    #[test]
    fn hardly_any_of_the_possible_information_is_no_plan() {
        let on_grid = Overrides::new().set("selection.off_grid=false").unwrap();
        let mut problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &on_grid).unwrap();
        let criteria = problem.selection.goal.criteria().into_owned();
        problem.selection.goal = Goal::Best { criteria, count: 2, method: Method::KMeansJoints };
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        // Two views that determine all nine intrinsics by the book, and to thousands of pixels.
        let refused = decide(&chooser, &mut |_| ControlFlow::Continue(()));
        let Err(PlanError::HardlyObservable { count: 2, combination }) = refused else { panic!("{refused:?}") };
        assert_eq!(combination.len(), problem.estimated.len());
        // Just inside and just outside of the floor.
        let choice = chooser.choose(Method::Random, 8, 3).unwrap();
        let bound = |efficiency: f64| choice.log_value - efficiency.ln();
        chooser.require_efficient(&choice, bound(PlanError::LEAST_EFFICIENCY * 1.001)).unwrap();
        chooser.require_efficient(&choice, bound(PlanError::LEAST_EFFICIENCY * 0.999)).unwrap_err();
    }
}
