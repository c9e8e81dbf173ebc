//! A plan checked from its own numbers.
//!
//! Every field of the plan is proven, or recomputed and compared, or handed back as not checked. It uses none of the code that
//! chose the poses and proved the bound, neither `selection` nor `plan::choose`; boxes of joint values alone are bounded by the same
//! code, in another order: `evidence` and `rules` derive what the
//! numbers mean from the problem's models and definitions once more.

mod bound;
mod compare;
mod continuum;
mod error;
mod evidence;
mod fields;
mod function;
mod rules;
mod tour;
mod unchecked;

pub use error::{BrokenConstraint, CertifyError};
pub use unchecked::Unchecked;

use crate::feasibility::View;
use crate::plan::document::{
    AccuracyDocument, CertificateDocument, Certificates, Certified, CollisionDocument, ContinuumDocument, Document,
    FewestDocument, Header, NotChecked, Plan, PlannedPose, ProblemReference, RobustnessDocument, ScenarioDocument,
    SearchDocument, SurveyCounts, TrialDocument, WorstLoss,
};
use crate::plan::survey::{Survey, Trial};
use crate::problem::{Accuracy, Problem};
use compare::{alike, different, near, number, other, same};
use evidence::{Accuracies, Evidence, Rounded};
use fields::{
    are_those_counts, are_those_in_scenario, are_those_intrinsics, are_those_unweighted, is_by_that_method,
    is_that_pose,
};
use tour::takes_that_time;
use unchecked::{BY_SEARCH, EFFORT, MADE_BY, UNBOUNDED};

/// Numbers that are the same agree to this share, and to what rounding may have moved them beyond.
const SAME: f64 = 1e-8;

/// Where rounding may have moved a number by more than this share it is none.
const SINGULAR: f64 = 1.0;

/// Map errors of the set-ups tried agree to this share: some may be all but singular.
const TRIED: f64 = 1e-6;

/// Where rounding may have moved a number by more than this share nothing is confirmed.
const MOST_ROUNDING: f64 = 1e-2;

/// What was confirmed.
#[derive(Debug, Clone, PartialEq)]
pub struct Confirmed {
    /// Views that were scored.
    pub views: usize,
    /// The plan's value in the criterion's own unit.
    pub value: f64,
    /// The bound that its certificate proves.
    pub bound: f64,
    /// The efficiency that these two prove.
    pub efficiency: f64,
    /// The bound over all joint values, in the same unit, and the efficiency by it, if the plan states them.
    pub continuum: Option<[f64; 2]>,
    /// Fewer poses than this are proven not to reach the accuracies, if some were requested and a matrix alone proves it.
    pub least: Option<usize>,
    /// The plan's numbers agree to this share: 10⁻⁸, and what rounding may have moved them by where the poses' information is
    /// all but singular.
    pub tolerance: f64,
    /// The fields of the plan that are not checked.
    pub unchecked: Vec<Unchecked>,
}

impl Confirmed {
    /// What is written of the `plan` that was confirmed.
    pub fn document(&self, plan: &Plan) -> Certified {
        let not_checked =
            |Unchecked { field, reason }: &Unchecked| NotChecked { field: field.clone(), reason: (*reason).into() };
        Certified {
            header: Certified::header(),
            problem: plan.problem.clone(),
            criterion: plan.criterion.clone(),
            count: plan.count,
            views: self.views,
            value: self.value,
            bound: self.bound,
            efficiency: self.efficiency,
            continuum_bound: self.continuum.map(|[bound, _]| bound),
            continuum_efficiency: self.continuum.map(|[_, efficiency]| efficiency),
            least_count: self.least,
            tolerance: self.tolerance,
            not_checked: self.unchecked.iter().map(not_checked).collect(),
        }
    }
}

/// Recomputes all that `plan` claims, from its poses' joint values and its certificate's matrices, on `problem`, surveyed: the file's,
/// with the values that the plan says were given in place of the file's.
///
/// # Errors
/// When anything is not as the plan says.
pub fn certify(plan: &Plan, problem: &Problem, survey: &Survey) -> Result<Confirmed, CertifyError> {
    // Here and below documents are taken apart whole, so that a new field cannot go by unnoticed.
    let Plan {
        header,
        problem: reference,
        criterion: _, // by `fit`
        method,
        count,
        seed,
        pictures,
        value: stated_value,
        bound: stated_bound,
        efficiency: stated_efficiency,
        survey: counts,
        collision,
        intrinsics,
        map_error_px,
        unweighted,
        worst_loss,
        robust,
        certificate,
        search,
        fewest,
        joints: _, // by `fit`
        poses,
        tour,
        off_grid,
    } = plan;
    let mut unchecked = Unchecked::all(&["calipose"], MADE_BY);

    is_of_that_problem(header, reference, problem)?;
    plan.fit(problem)?;
    same("the number of pictures at each pose", pictures, &problem.selection.pictures)?;
    let selected = plan.places(survey)?;
    let goal = &problem.selection.goal;
    is_by_that_method(method, search.is_some(), fewest.is_some(), goal)?;
    same("the seed", seed, &problem.selection.seed)?;
    same("the number of poses asked for", &goal.count().unwrap_or(*count), count)?;
    same("the number of poses", count, &selected.len())?;
    if !poses.is_sorted_by_key(|pose| pose.id) {
        return Err(other("the order of the poses", "another", "by ascending id"));
    }
    are_those_counts(counts, &SurveyCounts::new(survey))?;
    let found: Vec<&Vec<f64>> = survey.off_grid_views().iter().map(|view| &view.q).collect();
    alike("the views off the grid", &off_grid.iter().collect(), &found)?;
    let tested = Some(CollisionDocument::new(problem, &survey.links));
    alike("what was tested for collision", collision, &tested)?;
    let moving = takes_that_time(tour.as_ref(), problem, poses, &mut unchecked)?;

    let evidence = Evidence::new(problem, survey)?;
    evidence.rules.allow(&selected, problem, survey)?;
    let value = evidence.log_value(&selected)?;
    trusted("the value", value.uncertainty)?;
    evidence.equal("the value", *stated_value, value.log, SAME + value.uncertainty)?;
    for ((pose, &place), share) in poses.iter().zip(&selected).zip(evidence.shares(&selected)?) {
        is_that_pose(pose, &PlannedPose::new(problem, &survey.views[place], share))?;
        // A gradient is known to less than the value: its own change with M comes in.
        near(&format!("the share of pose {}", pose.id), pose.share, share, SAME + 10.0 * value.uncertainty)?;
    }
    let accuracies = evidence.accuracies(0, &selected)?;
    trusted("the predicted accuracy", accuracies.uncertainty)?;
    are_those_intrinsics(intrinsics, problem, &accuracies, SAME + accuracies.uncertainty)?;
    number("the map error", *map_error_px, accuracies.map_error, SAME + accuracies.uncertainty)?;
    are_those_unweighted(unweighted.as_ref(), problem, evidence.unweighted(&selected)?, SAME + accuracies.uncertainty)?;

    evidence.loses(worst_loss.as_ref(), survey, &selected)?;
    let Certificates { grid, continuum } = certificate;
    let bounded = match tour {
        Some(tour) => evidence.traded(tour, survey, moving, &mut unchecked)?,
        None => selected.len(),
    };
    let bound = evidence.bound(grid, bounded)?;
    let tolerance = SAME + value.uncertainty + bound.uncertainty;
    match search {
        None => evidence.equal("the bound", *stated_bound, bound.log, tolerance)?,
        Some(search) => {
            unchecked.extend(Unchecked::all(&["search.nodes", "search.open_views"], EFFORT));
            unchecked.extend(Unchecked::all(&["bound", "efficiency", "search.end"], BY_SEARCH));
            evidence.searched(search, *stated_bound, [value.log, bound.log], tolerance)?;
        }
    }
    let efficiency = (value.log - evidence.log_of(*stated_bound)).exp();
    number("the efficiency", *stated_efficiency, efficiency, tolerance)?;

    let least = match fewest {
        Some(fewest) => evidence.enough(fewest, survey, &selected, value, &mut unchecked)?,
        None => None,
    };
    // What takes longest comes last.
    evidence.withstands(robust.as_ref(), problem, survey, &selected)?;
    let count = selected.len() - usize::from(fewest.is_some());
    let bounded = evidence.anywhere(continuum.as_ref(), survey, count, value.log, &mut unchecked)?;
    Ok(Confirmed {
        views: survey.views.len(),
        value: evidence.natural(value.log),
        bound: evidence.natural(bound.log),
        efficiency: (value.log - bound.log).exp(),
        continuum: bounded,
        least,
        tolerance: tolerance.max(SAME + accuracies.uncertainty).max(SAME + 10.0 * value.uncertainty),
        unchecked,
    })
}

/// Whether it is a plan, and of that problem.
fn is_of_that_problem(
    Header { format, version, calipose: _ }: &Header,
    ProblemReference { name, sha256, set }: &ProblemReference,
    problem: &Problem,
) -> Result<(), CertifyError> {
    same("the format", format.as_str(), Plan::FORMAT)?;
    same("the version", version, &Plan::VERSION)?;
    same("the problem's name", name, &problem.name)?;
    same("the problem's hash", sha256, &problem.sha256)?;
    alike("the list of values that replace the problem file's", set, &problem.overrides.of_results())
}

impl Evidence<'_> {
    /// Checks a value or bound, stated in the criterion's own unit, against log Φ.
    fn equal(&self, what: &str, stated: f64, found: f64, tolerance: f64) -> Result<(), CertifyError> {
        let is_same = (self.log_of(stated) - found).abs() <= tolerance;
        if is_same { Ok(()) } else { Err(different(what, stated, self.natural(found))) }
    }

    /// Checks the bound that a search claims, from log Φ of the poses and what the matrix proves: between the two lies what it may
    /// claim, and the most it may claim is that they are one.
    fn searched(
        &self,
        SearchDocument { end, nodes: _, open_views: _ }: &SearchDocument,
        stated: f64,
        [value, bound]: [f64; 2],
        tolerance: f64,
    ) -> Result<(), CertifyError> {
        let claimed = self.log_of(stated);
        if !(claimed >= value - tolerance && claimed <= bound + tolerance) {
            return Err(different("the bound", stated, self.natural(bound)));
        }
        if !SearchDocument::ENDS.contains(&end.as_str()) {
            return Err(other("the end of the search", end, &SearchDocument::ENDS.join(" or ")));
        }
        if end == SearchDocument::OPTIMAL {
            self.equal("the bound of a proven optimum", stated, value, tolerance)?;
        }
        Ok(())
    }

    /// The bound over all joint values on `count` poses and the efficiency by it, from log Φ of the poses, if it is stated.
    fn anywhere(
        &self,
        stated: Option<&ContinuumDocument>,
        survey: &Survey,
        count: usize,
        value: f64,
        unchecked: &mut Vec<Unchecked>,
    ) -> Result<Option<[f64; 2]>, CertifyError> {
        if let Some(stated) = stated {
            unchecked.extend(Unchecked::all(&["certificate.continuum.boxes", "certificate.continuum.end"], EFFORT));
            let bound = self.continuum(stated, survey, count, value)?.log;
            return Ok(Some([self.natural(bound), (value - bound).exp()]));
        }
        if self.problem.selection.leaves_grid() && self.problem.selection.continuum.most_boxes > 0 {
            unchecked.extend(Unchecked::all(&["certificate.continuum"], UNBOUNDED));
        }
        Ok(None)
    }

    /// Checks which pose is said to be missed most.
    fn loses(&self, stated: Option<&WorstLoss>, survey: &Survey, selected: &[usize]) -> Result<(), CertifyError> {
        same("whether the worst loss of a pose is stated", &stated.is_some(), &(selected.len() > 1))?;
        let Some(WorstLoss { id, map_error_px }) = stated else { return Ok(()) };
        let without = |&leaving: &usize| -> Result<_, CertifyError> {
            let others: Vec<usize> = selected.iter().copied().filter(|&i| i != leaving).collect();
            Ok((survey.views[leaving].id, self.accuracies(0, &others)?))
        };
        let without: Vec<(usize, Accuracies)> = selected.iter().map(without).collect::<Result<_, _>>()?;
        let is_stated = |other: &&(usize, Accuracies)| other.0 == *id;
        let Some((_, worst)) = without.iter().find(is_stated) else {
            return Err(other("the pose whose loss is the worst", id, "one of the plan"));
        };
        map_error_of("the map error without a pose", *map_error_px, worst)?;
        let stated = map_error_px.unwrap_or(f64::INFINITY);
        let greater = without.iter().find(|(_, accuracies)| {
            let Accuracies { map_error, uncertainty, .. } = *accuracies;
            let least = if uncertainty < SINGULAR { map_error * (1.0 - SAME - uncertainty) } else { f64::INFINITY };
            least > stated
        });
        greater.map_or(Ok(()), |(greater, _)| Err(other("the pose whose loss is the worst", id, greater)))
    }

    /// Checks what the poses are said to be worth where the set-up is not quite as stated.
    fn withstands(
        &self,
        stated: Option<&RobustnessDocument>,
        problem: &Problem,
        survey: &Survey,
        selected: &[usize],
    ) -> Result<(), CertifyError> {
        let (stated, robust) = match (stated, &problem.robust) {
            (Some(stated), Some(robust)) => (stated, robust),
            (None, None) => return Ok(()),
            (stated, _) => {
                let said = |is: bool| if is { "stated" } else { "not stated" };
                return Err(other("what the plan withstands", said(stated.is_some()), said(stated.is_none())));
            }
        };
        let views: Vec<View> = selected.iter().map(|&i| survey.views[i].clone()).collect();
        let RobustnessDocument { goal, scenarios: stated_scenarios, trial: stated } = stated;
        same("what counts of the scenarios", goal.as_str(), robust.goal.name())?;
        let scenes = survey.scenes(problem);
        same("the number of scenarios", &stated_scenarios.len(), &scenes.len())?;
        for (scenario, (stated, scene)) in stated_scenarios.iter().zip(&scenes).enumerate() {
            map_error_of("the map error of a scenario", stated.map_error_px, &self.accuracies(scenario, selected)?)?;
            let seen: Vec<_> = views.iter().map(|view| scene.view(view)).collect();
            are_those_in_scenario(stated, &ScenarioDocument::new(scene, &seen, None))?;
        }
        let TrialDocument { set_ups, seen, median_map_error_px, map_error_of_99_percent_px, worst_map_error_px } =
            stated;
        let Some(trial) = Trial::of(problem, &views, self.known()).map(TrialDocument::new) else { return Ok(()) };
        same("the number of set-ups tried", set_ups, &trial.set_ups)?;
        alike("the shares of the set-ups in which the poses are views", seen, &trial.seen)?;
        let close = |what: &str, stated: f64, found: f64| number(what, stated, found, TRIED);
        let found = [trial.median_map_error_px, trial.map_error_of_99_percent_px, trial.worst_map_error_px];
        let stated = [median_map_error_px, map_error_of_99_percent_px, worst_map_error_px];
        for (stated, found) in stated.into_iter().zip(found) {
            alike("whether a map error of the set-ups tried is known", &stated.is_some(), &found.is_some())?;
            if let (Some(stated), Some(found)) = (stated, found) {
                close("a map error of the set-ups tried", *stated, found)?;
            }
        }
        Ok(())
    }

    /// What the certificate proves of `count` poses; it must say the same.
    fn bound(&self, certificate: &CertificateDocument, count: usize) -> Result<Rounded, CertifyError> {
        let bound = self.log_bound(certificate, count)?;
        trusted("the bound", bound.uncertainty)?;
        self.equal("the certificate's bound", certificate.bound, bound.log, SAME + bound.uncertainty)?;
        Ok(bound)
    }

    /// Checks what is stated of how few poses suffice; the least number that may, where a matrix alone proves it.
    fn enough(
        &self,
        stated: &FewestDocument,
        survey: &Survey,
        selected: &[usize],
        value: Rounded,
        unchecked: &mut Vec<Unchecked>,
    ) -> Result<Option<usize>, CertifyError> {
        let everywhere = (0..=survey.scenarios.len()).map(|scenario| self.accuracies(scenario, selected));
        let everywhere = everywhere.collect::<Result<Vec<_>, _>>()?;
        let least = self.least(stated, self.problem, &everywhere, selected.len(), value)?;
        if stated.found.is_some() {
            unchecked.extend(Unchecked::all(&["fewest.found"], BY_SEARCH));
        }
        if stated.nodes > 0 {
            unchecked.extend(Unchecked::all(&["fewest.nodes"], EFFORT));
        }
        if stated.refutation.is_some() && least.is_none() {
            unchecked.extend(Unchecked::all(&["fewest.least"], BY_SEARCH));
        }
        Ok(least)
    }

    /// Checks that the poses reach the accuracies that the problem requests, stated as they are in the worst scenario, and that
    /// fewer are proven not to; the least number that may, where a matrix alone proves it.
    fn least(
        &self,
        stated: &FewestDocument,
        problem: &Problem,
        accuracies: &[Accuracies],
        poses: usize,
        value: Rounded,
    ) -> Result<Option<usize>, CertifyError> {
        let FewestDocument { accuracies: stated, least, found, refutation, nodes } = stated;
        let asked = problem.selection.goal.accuracies();
        if stated.len() != asked.len() {
            return Err(CertifyError::Requests);
        }
        let names = problem.unknowns().names();
        for (AccuracyDocument { name, requested, reached }, (accuracy, asked)) in stated.iter().zip(asked) {
            let asked_name = match *accuracy {
                Accuracy::MapError => Accuracy::MAP_ERROR,
                Accuracy::Intrinsic(j) => names[j],
            };
            let of = |accuracies: &Accuracies| match *accuracy {
                Accuracy::MapError => accuracies.map_error,
                Accuracy::Intrinsic(j) => accuracies.sigma[j],
            };
            let found = accuracies.iter().map(of).fold(0.0, f64::max);
            let uncertainty = accuracies.iter().map(|accuracies| accuracies.uncertainty).fold(0.0, f64::max);
            if name != asked_name || requested != asked {
                return Err(CertifyError::Requests);
            }
            number(&format!("the accuracy reached of {name}"), *reached, found, SAME + uncertainty)?;
        }
        if value.log < -SAME - value.uncertainty {
            return Err(CertifyError::Accuracy { value: self.natural(value.log) });
        }
        if let Some(found) = found
            && !(*least..poses).contains(found)
        {
            return Err(CertifyError::Refutation { count: *found });
        }
        let Some(refutation) = refutation else {
            // Without a proof only those are out that cannot be chosen.
            let fewest_allowed = self.rules.required.len().max(1);
            same("the least number of poses that may be chosen", least, &fewest_allowed)?;
            same("the number of nodes without a refutation", nodes, &0)?;
            return Ok(None);
        };
        let count = least.saturating_sub(1);
        if *least > poses || count < self.rules.required.len().max(1) {
            return Err(CertifyError::Refutation { count });
        }
        let bound = self.bound(refutation, count)?;
        let refutes = bound.log < SAME + bound.uncertainty;
        if !refutes && *nodes == 0 {
            return Err(CertifyError::Refutation { count });
        }
        Ok(refutes.then_some(*least))
    }
}

/// Checks a map error that a plan gives as none where the intrinsics are undetermined.
fn map_error_of(what: &str, stated: Option<f64>, found: &Accuracies) -> Result<(), CertifyError> {
    let Accuracies { map_error, uncertainty, .. } = *found;
    match stated {
        Some(stated) if uncertainty < SINGULAR => number(what, stated, map_error, SAME + uncertainty),
        None if uncertainty > MOST_ROUNDING => Ok(()),
        stated => {
            let said = |is: bool| if is { "a number" } else { "none" };
            Err(other(what, said(stated.is_some()), said(stated.is_none())))
        }
    }
}

/// Refuses what rounding leaves too little of.
fn trusted(what: &'static str, uncertainty: f64) -> Result<(), CertifyError> {
    if uncertainty <= MOST_ROUNDING { Ok(()) } else { Err(CertifyError::Rounding { what, share: uncertainty }) }
}
