//! What a set-up is worth.

use super::{Codesign, Place};
use crate::experiment::factor::Level;
use crate::information::Criterion;
use crate::plan::choose::{Choice, Chooser};
use crate::plan::document::{FreeValue, SetUp, finite};
use crate::plan::survey::{Survey, quick_survey};
use crate::problem::Problem;
use crate::selection::{Certificate, Gradient};
use crate::sweep::JointSpace;

/// What was found out about a set-up.
#[derive(Debug, Clone)]
pub(super) enum Verdict {
    /// The problem refuses it, or the board is off the surface.
    Refused,
    /// No plan is possible: there are too few views, or all of them together leave an intrinsic undetermined.
    NoPlan,
    /// No plan was found, and it is not known that there is none.
    Undecided,
    /// A bound on all its plans is worse than the best plan known.
    Discarded,
    /// It has a plan.
    Planned(Box<Planned>),
}

/// A set-up with its plan.
#[derive(Debug, Clone)]
pub(super) struct Planned {
    pub(super) place: Place,
    pub(super) log_value: f64,
    pub(super) certificate: Certificate,
    pub(super) map_error: f64,
    pub(super) document: SetUp,
    /// The least map error that the bound allows, px.
    pub(super) map_error_bound: Option<f64>,
}

/// What is known when a set-up is evaluated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<'a> {
    /// The best log Φ so far.
    pub(super) log_value: f64,
    /// What proved the bound of that set-up, and may prove one of another.
    pub(super) certificate: &'a Certificate,
}

impl Codesign {
    /// The log Φ of a plan on a coarser sweep; −∞ where there is none.
    pub(super) fn screen(&self, place: &Place) -> f64 {
        let value = || {
            let mut problem = self.problem_at(place)?;
            problem.space = coarse(&problem.space);
            let (survey, count) = (quick_survey(&problem)?, problem.selection.goal.count()?);
            let chooser = Chooser::new(&problem, &survey).ok()?;
            let (choice, _) = chooser.best(count, problem.selection.seed).ok()?;
            Some(choice.log_value)
        };
        value().unwrap_or(f64::NEG_INFINITY)
    }

    /// What a set-up is worth on the problem's own sweep. With something `known`, one that cannot be better is discarded.
    pub(super) fn evaluate(&self, place: &Place, known: Option<Known>) -> Verdict {
        match self.problem_at(place) {
            Some(problem) => judge(place, &problem, known),
            None => Verdict::Refused,
        }
    }

    /// The set-up of the problem file by itself, without what the design sets.
    pub(super) fn as_given(&self) -> Option<Planned> {
        let place = Place { shares: Vec::new(), levels: Vec::new() };
        let problem = self.base.problem(std::iter::empty()).ok()?;
        match judge(&place, &problem, None) {
            Verdict::Planned(found) => Some(*found),
            Verdict::Refused | Verdict::NoPlan | Verdict::Undecided | Verdict::Discarded => None,
        }
    }
}

/// What a set-up is worth, by its problem.
pub(super) fn judge(place: &Place, problem: &Problem, known: Option<Known>) -> Verdict {
    let Some(survey) = quick_survey(problem) else { return Verdict::NoPlan };
    let Some(count) = problem.selection.goal.count().filter(|&count| count <= survey.views.len()) else {
        return Verdict::NoPlan;
    };
    let Ok(chooser) = Chooser::new(problem, &survey) else { return Verdict::Undecided };
    if let Some(Known { log_value, certificate }) = known {
        // A neighbour's matrix proves a bound here too, for the price of one score a view.
        if bound_by(&chooser, count, certificate) < log_value {
            return Verdict::Discarded;
        }
    }
    match chooser.best(count, problem.selection.seed) {
        Ok((choice, certificate)) if choice.log_value.is_finite() => {
            Verdict::Planned(Box::new(planned(place, &chooser, &survey, &choice, certificate)))
        }
        // Fewer views know less than all.
        _ if chooser.assess((0..survey.views.len()).collect()).log_value == f64::NEG_INFINITY => Verdict::NoPlan,
        _ => Verdict::Undecided,
    }
}

/// The coarser sweep has so many configurations, or a sixteenth of the problem's.
const COARSE: usize = 20_000;
const COARSER: usize = 16;

pub(super) fn coarse(space: &JointSpace) -> JointSpace {
    space.coarser(COARSE.max(space.len() / COARSER))
}

/// The bound on log Φ of sets of `count` views that the matrix of another set-up's certificate proves.
fn bound_by(chooser: &Chooser, count: usize, certificate: &Certificate) -> f64 {
    let bound = || {
        let instance = chooser.instance(count).ok()?;
        let gradient = Gradient { y: certificate.y.clone(), mixture: certificate.mixture.clone() };
        Some(Certificate::new(&instance, gradient, Vec::new()).ok()?.log_bound)
    };
    bound().unwrap_or(f64::INFINITY)
}

fn planned(place: &Place, chooser: &Chooser, survey: &Survey, choice: &Choice, certificate: Certificate) -> Planned {
    let nearest = choice.selected.iter().map(|&i| survey.views[i].distance()).fold(f64::INFINITY, f64::min);
    let criteria = chooser.problem().selection.goal.criteria();
    // Of several scenarios the bound is of their mean or of the worst.
    let is_of_map_error = matches!(criteria[..], [(Criterion::V, _)]) && chooser.problem().robust.is_none();
    let bound = chooser.natural(certificate.log_bound);
    Planned {
        place: place.clone(),
        log_value: choice.log_value,
        map_error: choice.map_error,
        map_error_bound: is_of_map_error.then(|| bound.sqrt()),
        document: SetUp {
            // Named by who knows the names.
            values: place.levels.iter().map(FreeValue::from).collect(),
            views: survey.views.len(),
            value: finite(chooser.natural(choice.log_value)),
            bound: finite(bound),
            efficiency: finite(certificate.efficiency(choice.log_value)),
            map_error_px: finite(choice.map_error),
            nearest_mm: 1e3 * nearest,
        },
        certificate,
    }
}

impl From<&Level> for FreeValue {
    fn from(level: &Level) -> Self {
        Self { name: String::new(), value: level.name.clone(), number: level.number, set: level.set.clone() }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rayon::prelude::*;

    use super::*;

    /// Set-ups over the ranges of the shipped design, on a coarse sweep.
    fn design() -> Codesign {
        let file = tempfile::NamedTempFile::with_suffix(".toml").unwrap();
        let text = std::fs::read_to_string("problems/designs/servosila-board.toml").unwrap();
        let base = Path::new("problems/servosila-engineer-bodies.toml").canonicalize().unwrap();
        let text = text.replace("../servosila-engineer-bodies.toml", base.to_str().unwrap());
        let text = text.replace("set = [", "set = [\n    \"sweep.step_deg=18\",\n    \"selection.count=8\",");
        let text = text + "\n[search]\nscreened = 80\n";
        std::fs::write(file.path(), text).unwrap();
        Codesign::read(file.path()).unwrap()
    }

    #[test]
    fn what_is_discarded_by_a_neighbours_matrix_is_worse() {
        let design = design();
        let places: Vec<Place> = design.screened().unwrap();
        let planned: Vec<Option<Planned>> = places
            .par_iter()
            .map(|place| match design.evaluate(place, None) {
                Verdict::Planned(planned) => Some(*planned),
                _ => None,
            })
            .collect();
        let all: Vec<&Planned> = planned.iter().flatten().collect();
        assert!(all.len() > 10, "{}", all.len());
        let (mut discarded, mut kept) = (0, 0);
        // By the matrix of the best, of one in the middle, and of the worst.
        let mut by_value = all.clone();
        by_value.sort_by(|a, b| b.log_value.total_cmp(&a.log_value));
        for known in [by_value[0], by_value[all.len() / 2], by_value[all.len() - 1]] {
            let known = Known { log_value: known.log_value, certificate: &known.certificate };
            for (place, planned) in places.iter().zip(&planned) {
                let Some(planned) = planned else { continue };
                match design.evaluate(place, Some(known)) {
                    Verdict::Discarded => {
                        assert!(planned.log_value < known.log_value);
                        discarded += 1;
                    }
                    Verdict::Planned(again) => {
                        assert_eq!(again.log_value, planned.log_value);
                        kept += 1;
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
        assert!(discarded > all.len() / 2 && kept > 3, "{discarded} {kept}");
    }

    #[test]
    fn a_bound_by_any_matrix_is_above_every_plan() {
        let design = design();
        let of = |share: f64| {
            let place = design.place(vec![0.6, share, 0.6, 0.6]);
            (design.problem_at(&place), place)
        };
        let (Some(one), place) = of(0.9) else { panic!("the board fits") };
        let Verdict::Planned(known) = judge(&place, &one, None) else { panic!("there is a plan") };
        let (Some(problem), _) = of(0.8) else { panic!("the board fits") };
        let survey = quick_survey(&problem).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let bound = bound_by(&chooser, 8, &known.certificate);
        for seed in 0..50 {
            let random = chooser.choose(crate::problem::Method::Random, 8, seed).unwrap();
            assert!(random.log_value <= bound);
        }
        let (best, own) = chooser.best(8, 0).unwrap();
        assert!(best.log_value <= own.log_bound && own.log_bound <= bound, "{} {bound}", own.log_bound);
    }
}
