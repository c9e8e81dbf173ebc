//! The choice that a problem asks for, with all that is proven of it.

use std::ops::ControlFlow;

use super::choice::Choice;
use super::chooser::Chooser;
use super::error::PlanError;
use super::tours::{GaveWay, Led, Numbers, Toured, Trade};
use crate::motion::journey::Journey;
use crate::problem::{Goal, Least, Method, SelectionSettings};
use crate::selection::{Certificate, Refutation, SearchEnd, SearchProgress};

/// Most times that straight moves are given less time, because safe ones go round about.
const DETOURS: usize = 6;

/// Share of a time by which rounding may exceed it.
const ON_TIME: f64 = 1e-12;

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
    /// What it was made for beside its information, if its tour counted.
    pub trade: Option<Trade>,
    /// The moves through its poses, stops numbered as the choice's views, home after them.
    pub journey: Journey,
    /// Poses that gave way to others because no safe move leads to them.
    pub gave_way: Vec<GaveWay>,
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
    /// Fewest poses found that suffice.
    pub found: usize,
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
    let SelectionSettings { goal, seed, tour_tolerance, .. } = &chooser.problem().selection;
    let given_up = (1.0 - tour_tolerance).ln();
    let (count, method) = match goal {
        Goal::Best { count, method, .. } => (*count, *method),
        Goal::Within { seconds, .. } => return within(chooser, *seconds),
        Goal::Fewest { least, .. } => {
            let (choice, found) = chooser.fewest(*seed, observe)?;
            let fewest = FewestProof { least: found.least, found: choice.selected.len(), refutation: found.refutation };
            let certificate = found.best.relaxation.certificate;
            let (choice, certificate, trade) = match least {
                Least::Poses if *tour_tolerance == 0.0 => (choice, certificate, None),
                Least::Poses => {
                    let floor = (choice.log_value + given_up).max(0.0);
                    let (choice, trade) = chooser.shorter(choice, &certificate, floor)?;
                    (choice, certificate, Some(trade))
                }
                Least::Time => soonest(chooser, &choice, fewest.least)?,
            };
            let log_bound = certificate.log_bound;
            let mut led = chooser.led_to(choice.clone(), &certificate)?;
            if led.choice.log_value < 0.0 {
                // With spares the accuracies are missed.
                led = Led { journey: chooser.journey(&choice), choice, gave_way: vec![] };
            }
            let Led { choice, journey, gave_way } = led;
            let trade = trade.map(|trade| trade.after(&gave_way));
            let fewest = Some(fewest);
            return Ok(Decision { choice, certificate, log_bound, search: None, fewest, trade, journey, gave_way });
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
    let (choice, trade) = if *tour_tolerance == 0.0 {
        (choice, None)
    } else {
        let floor = choice.log_value + given_up;
        let (choice, trade) = chooser.shorter(choice, &certificate, floor)?;
        (choice, Some(trade))
    };
    let Led { choice, journey, gave_way } = chooser.led_to(choice, &certificate)?;
    let trade = trade.map(|trade| trade.after(&gave_way));
    Ok(Decision { choice, certificate, log_bound, search, fewest: None, trade, journey, gave_way })
}

/// As many poses as serve, whose tour keeps a time; the certificate is of the most that might.
fn within(chooser: &Chooser, seconds: f64) -> Result<Decision, PlanError> {
    let numbers = Numbers::new(chooser)?;
    let mut straight = seconds;
    for _ in 0..DETOURS {
        let Toured { choice, .. } = numbers.within(straight)?;
        let most = numbers.most(seconds).max(choice.selected.len());
        let certificate = chooser.certificate(most)?;
        let log_bound = certificate.log_bound;
        chooser.require_efficient(&choice, log_bound)?;
        let Led { choice, journey, gave_way } = chooser.led_to(choice, &certificate)?;
        let moving = journey.moves.iter().map(|found| found.seconds).sum();
        let late = numbers.total(moving, choice.selected.len()) - seconds;
        if late <= ON_TIME * seconds {
            let trade = Some(Trade { best: None, least_seconds: None, most_poses: Some(most) });
            return Ok(Decision {
                choice,
                certificate,
                log_bound,
                search: None,
                fewest: None,
                trade,
                journey,
                gave_way,
            });
        }
        straight -= late;
    }
    Err(PlanError::NoTime { seconds, shortest: f64::INFINITY })
}

/// The fastest choice that reaches the accuracies, as `choice` does, of which `least` poses are needed at least.
fn soonest(
    chooser: &Chooser,
    choice: &Choice,
    least: usize,
) -> Result<(Choice, Certificate, Option<Trade>), PlanError> {
    let numbers = Numbers::new(chooser)?;
    let (first, (found, bound)) = (numbers.toured(choice.clone())?, numbers.soonest(choice, least)?);
    let certificate = chooser.certificate(found.choice.selected.len())?;
    let best = (found.seconds < first.seconds).then_some(first);
    Ok((found.choice, certificate, Some(Trade { best, least_seconds: Some(bound), most_poses: None })))
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
