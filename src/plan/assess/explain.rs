//! Why a plan is as it is: what more poses would bring, what each pose pins down, what could take its place.

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::plan::choose::{Choice, Chooser, PlanError, plan_survey};
use crate::plan::document::{
    CombinationTerm, CurvePoint, Document, Explanation, LeastKnown, PoseExplanation, ProblemReference, RobustnessPrice,
    SparePose, Suffering, TrialDocument, finite, joints_deg,
};
use crate::plan::survey::{Survey, Trial};
use crate::problem::Problem;
use crate::selection::packed::inverse;
use crate::selection::{RelaxationSettings, SelectionError, Spare, improved_greedy, relax, spares};

/// How much to explain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExplainSettings {
    /// The greatest number of poses on the curve.
    pub most: usize,
    /// Spares listed for each pose.
    pub spares: usize,
}

/// Gap at which a point of the curve counts as solved: finer than any table shows.
const CURVE_TOLERANCE: f64 = 1e-6;

/// Explains the poses `selected` (indices into the survey's views) by the criteria of `chooser`. `observe` is told, from any
/// thread, how many points of the curve were added since it was last called.
///
/// # Errors
/// When the poses leave a combination of the parameters undetermined.
pub fn explain(
    problem: &Problem,
    chooser: &Chooser,
    selected: &[usize],
    settings: &ExplainSettings,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<Explanation, PlanError> {
    let plan = chooser.assess(selected.to_vec());
    chooser.require_observable(&plan)?;
    Ok(Explanation {
        header: Explanation::header(),
        problem: ProblemReference::new(problem),
        criterion: chooser.criterion(),
        count: plan.selected.len(),
        value: chooser.natural(plan.log_value),
        map_error_px: finite(plan.map_error),
        curve: curve(chooser, &plan, settings.most, observe)?,
        poses: poses(problem, chooser, &plan, settings.spares)?,
        least_known: least_known(problem, chooser, &plan),
        robust: price(problem, chooser, &plan)?,
        joints: problem.robot.chain.joints.iter().map(|joint| joint.name.clone()).collect(),
    })
}

/// The best sets found and the bounds, for as many poses as the constraints and the views allow, at most `most`.
fn curve(
    chooser: &Chooser,
    plan: &Choice,
    most: usize,
    observe: &(dyn Fn(usize) + Sync),
) -> Result<Vec<CurvePoint>, PlanError> {
    let most = most.min(chooser.survey().views.len());
    let points: Result<Vec<Option<CurvePoint>>, PlanError> = (1..=most)
        .into_par_iter()
        .map(|count| {
            let point = curve_point(chooser, plan, count);
            observe(1);
            point
        })
        .collect();
    Ok(points?.into_iter().flatten().collect())
}

/// `None` where the constraints do not allow so many.
fn curve_point(chooser: &Chooser, plan: &Choice, count: usize) -> Result<Option<CurvePoint>, PlanError> {
    let instance = match chooser.instance(count) {
        Err(PlanError::Selection(SelectionError::Allowed { .. })) => return Ok(None),
        instance => instance?,
    };
    let found = match improved_greedy(&instance) {
        Ok(found) => Some(found),
        Err(SelectionError::Unobservable { .. } | SelectionError::NoRoom { .. }) => None,
        Err(error) => return Err(chooser.explain(error)),
    };
    // The relaxation may start anywhere that determines everything, with more poses than it is to choose.
    let start = found.as_ref().or_else(|| (plan.selected.len() >= count).then_some(&plan.selected));
    let settings = RelaxationSettings { tolerance: CURVE_TOLERANCE, ..RelaxationSettings::default() };
    let relaxation = start.and_then(|start| relax(&instance, start, &settings).ok());
    let mut best = found.map(|selected| chooser.assess(selected));
    if plan.selected.len() == count && best.as_ref().is_none_or(|best| best.log_value < plan.log_value) {
        best = Some(plan.clone());
    }
    Ok(Some(CurvePoint {
        count,
        value: best.as_ref().map(|best| chooser.natural(best.log_value)),
        bound: relaxation.as_ref().and_then(|found| finite(chooser.natural(found.certificate.log_bound))),
        efficiency: best
            .as_ref()
            .and_then(|best| relaxation.as_ref().map(|found| found.certificate.efficiency(best.log_value))),
        map_error_px: best.as_ref().and_then(|best| finite(best.map_error)),
    }))
}

/// What each pose pins down, and its spares.
fn poses(
    problem: &Problem,
    chooser: &Chooser,
    plan: &Choice,
    spare_count: usize,
) -> Result<Vec<PoseExplanation>, PlanError> {
    let instance = chooser.instance(plan.selected.len())?;
    let views = &chooser.survey().views;
    let names = problem.unknowns().names();
    let in_degrees = |i: usize| joints_deg(&problem.robot.chain, &views[i].q);
    let loss = |log_value: f64| -(log_value - plan.log_value).exp_m1();
    let replaced = |leaving: usize, incoming: Option<usize>| {
        let others = plan.selected.iter().copied().filter(|&i| i != leaving);
        chooser.assess(others.chain(incoming).collect())
    };
    let explain_pose = |(&leaving, found): (&usize, Vec<Spare>)| {
        let without = replaced(leaving, None);
        let grown = plan.sigma.iter().zip(&without.sigma).zip(&names);
        let most = grown.max_by(|((a, b), _), ((c, d), _)| (*b / *a).total_cmp(&(*d / *c)));
        let spare = |candidate: usize| {
            let choice = replaced(leaving, Some(candidate));
            SparePose {
                id: views[candidate].id,
                joints_deg: in_degrees(candidate),
                loss: loss(choice.log_value),
                map_error_px: finite(choice.map_error),
            }
        };
        PoseExplanation {
            id: views[leaving].id,
            joints_deg: in_degrees(leaving),
            loss: loss(without.log_value),
            map_error_px: finite(without.map_error),
            suffers_most: most.map(|((&sigma, &sigma_without), name)| Suffering {
                name: (*name).into(),
                sigma,
                sigma_without,
            }),
            leaves_open: if without.log_value > f64::NEG_INFINITY {
                vec![]
            } else {
                match chooser.explain(instance.unobservable(&without.selected)) {
                    PlanError::Unobservable { combination, .. } => terms(combination),
                    _ => vec![],
                }
            },
            spares: found.into_iter().map(|found| spare(found.candidate)).collect(),
        }
    };
    // What keeps the arm from a pose may keep it from what is beside it.
    let apart = |leaving: usize, candidate: usize| !instance.rules().conflict(leaving, candidate);
    let found = spares(&instance, &plan.selected, spare_count, &apart).map_err(PlanError::Selection)?;
    Ok(plan.selected.par_iter().zip(found).map(explain_pose).collect())
}

/// The best plan for the set-up as stated, of as many poses, and how both fare where it is not.
fn price(problem: &Problem, chooser: &Chooser, plan: &Choice) -> Result<Option<RobustnessPrice>, PlanError> {
    if problem.robust.is_none() {
        return Ok(None);
    }
    let stated = Problem { robust: None, ..problem.clone() };
    let survey = plan_survey(&stated, &|_| {})?;
    let (best, _) = Chooser::new(&stated, &survey)?.best(plan.selected.len(), problem.selection.seed)?;
    let known = chooser.information(&[]);
    let tried = |survey: &Survey, selected: &[usize]| {
        let views: Vec<_> = selected.iter().map(|&i| survey.views[i].clone()).collect();
        Trial::of(problem, &views, &known).map(TrialDocument::new)
    };
    let (Some(plan), Some(as_stated)) = (tried(chooser.survey(), &plan.selected), tried(&survey, &best.selected))
    else {
        return Ok(None);
    };
    Ok(Some(RobustnessPrice {
        map_error_as_stated_px: finite(best.map_error),
        ids: best.selected.iter().map(|&i| survey.views[i].id).collect(),
        plan,
        as_stated,
    }))
}

/// The eigenvector of the covariance's greatest eigenvalue, with the intrinsics in their pixel units. It is found as that of
/// the information's least, which exists for a singular plan too.
fn least_known(problem: &Problem, chooser: &Chooser, plan: &Choice) -> LeastKnown {
    let survey = chooser.survey();
    let M = on_intrinsics(problem, chooser.information(&plan.selected));
    // An intrinsic that does not move the image has no such unit.
    let units = problem.unknowns().pixel_units();
    let unit = |j: usize| if units[j].is_finite() { units[j] } else { 0.0 };
    let scaled = DMatrix::from_fn(M.nrows(), M.ncols(), |i, j| M[(i, j)] * unit(i) * unit(j));
    let eigen = scaled.symmetric_eigen();
    let mut c = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    if c[c.iamax()] < 0.0 {
        c.neg_mut();
    }
    let names = problem.unknowns().names().into_iter().map(String::from);
    let combination = terms(names.zip(c.iter().copied()));
    let Some(covariance) = inverse(&M) else {
        return LeastKnown { combination, sigma: None, moves_image_px: None };
    };
    // The combination is aᵀθ with a = c/u; its variance aᵀ C a, and θ follows it by C a / σ.
    let a = nalgebra::DVector::from_fn(c.len(), |j, _| if unit(j) > 0.0 { c[j] / unit(j) } else { 0.0 });
    let Ca = covariance * &a;
    let sigma = a.dot(&Ca).sqrt();
    let δ = Ca / sigma;
    let moves = δ.dot(&(&survey.map_weight * &δ)).sqrt();
    LeastKnown { combination, sigma: finite(sigma), moves_image_px: finite(moves) }
}

/// The information that is left on the intrinsics where a board's heights, of which something is always known, are estimated
/// beside them.
fn on_intrinsics(problem: &Problem, M: DMatrix<f64>) -> DMatrix<f64> {
    let nuisance = problem.measurement().nuisance();
    let (p, before) = (M.nrows() - nuisance, M.columns(0, nuisance));
    let Some(heights) = M.view((0, 0), (nuisance, nuisance)).into_owned().try_inverse() else { return M };
    let beside = before.rows(nuisance, p);
    M.view((nuisance, nuisance), (p, p)) - beside * heights * beside.transpose()
}

fn terms(combination: impl IntoIterator<Item = (String, f64)>) -> Vec<CombinationTerm> {
    combination.into_iter().map(|(name, coefficient)| CombinationTerm { name, coefficient }).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;
    use std::path::Path;

    use super::*;
    use crate::information::Criterion;
    use crate::plan::choose::decide;
    use crate::plan::document::Plan;
    use crate::plan::survey::survey;
    use crate::problem::{Accuracy, Goal, Least, Method, Overrides};

    fn coarse() -> Problem {
        let step = Overrides::new().set("sweep.step_deg=20").unwrap().set("selection.off_grid=false").unwrap();
        Problem::read_with(Path::new("problems/servosila-engineer.toml"), &step).unwrap()
    }

    fn planned<'a>(problem: &'a Problem, survey: &'a Survey) -> (Chooser<'a>, Choice) {
        let chooser = Chooser::new(problem, survey).unwrap();
        let decision = decide(&chooser, &mut |_| ControlFlow::Continue(())).unwrap();
        let plan = Plan::new(&chooser, &decision).unwrap();
        let read = Plan::from_json(&plan.to_json()).unwrap();
        let (located, selected) = read.locate(problem, survey).unwrap();
        assert_eq!(located.criterion(), chooser.criterion());
        assert_eq!(selected, decision.choice.selected);
        assert_eq!(located.assess(selected), decision.choice);
        (located, decision.choice)
    }

    fn best_ten(criteria: &[(Criterion, f64)]) -> Goal {
        Goal::Best { criteria: criteria.to_vec(), count: 10, method: Method::Best }
    }

    const SETTINGS: ExplainSettings = ExplainSettings { most: 12, spares: 4 };

    /// By the definitions of `d` and `v` alone.
    #[test]
    fn losses_and_sigmas_are_those_of_the_plan_without_the_pose() {
        let mut problem = coarse();
        let survey = survey(&problem, &|_| {}).unwrap();
        for criterion in [Criterion::V, Criterion::D] {
            problem.selection.goal = best_ten(&[(criterion, 1.0)]);
            let (chooser, plan) = planned(&problem, &survey);
            let explained = explain(&problem, &chooser, &plan.selected, &SETTINGS, &|_| {}).unwrap();
            let covariance = |left_out: Option<usize>| {
                let kept = plan.selected.iter().filter(|&&i| Some(i) != left_out);
                let M = kept.fold(DMatrix::zeros(9, 9), |M, &i| M + survey.information.matrix(i).unwrap());
                M.try_inverse().unwrap()
            };
            let variance = |C: &DMatrix<f64>| (&survey.map_weight * C).trace();
            let value = |C: &DMatrix<f64>| match criterion {
                Criterion::D => C.determinant().powf(-1.0 / 9.0),
                _ => variance(C).recip(),
            };
            let all = covariance(None);
            for (&i, pose) in plan.selected.iter().zip(&explained.poses) {
                let C = covariance(Some(i));
                assert_eq!(pose.id, survey.views[i].id);
                assert!((pose.loss - (1.0 - value(&C) / value(&all))).abs() < 1e-6, "{pose:?}");
                assert!((pose.map_error_px.unwrap() - variance(&C).sqrt()).abs() < 1e-6);
                let grown: Vec<f64> = (0..9).map(|j| (C[(j, j)] / all[(j, j)]).sqrt()).collect();
                let most = pose.suffers_most.as_ref().unwrap();
                let largest = grown.iter().copied().fold(0.0, f64::max);
                assert!((most.sigma_without / most.sigma / largest - 1.0).abs() < 1e-6);
                assert!(pose.leaves_open.is_empty());
            }
        }
    }

    /// Every view tried in every pose's place that is apart from it and the others, whatever is optimised.
    #[test]
    fn spares_are_those_of_an_exhaustive_search() {
        let mut problem = coarse();
        problem.constraints.view_separation = 4f64.to_radians();
        let survey = survey(&problem, &|_| {}).unwrap();
        let problems = [
            best_ten(&[(Criterion::V, 0.8), (Criterion::Diversity, 0.2)]),
            best_ten(&[(Criterion::E, 1.0)]),
            Goal::Fewest {
                accuracies: vec![(Accuracy::MapError, 3.0), (Accuracy::Intrinsic(0), 4.0)],
                least: Least::Poses,
            },
        ]
        .map(|goal| {
            let mut problem = problem.clone();
            problem.selection.goal = goal;
            problem
        });
        for problem in &problems {
            let (chooser, plan) = planned(problem, &survey);
            let explained = explain(problem, &chooser, &plan.selected, &SETTINGS, &|_| {}).unwrap();
            let direction = |i: usize| survey.views[i].X_CT.inverse().translation.vector.normalize();
            let least = 2.0 * (0.5 * problem.constraints.view_separation).sin();
            for (&i, pose) in plan.selected.iter().zip(&explained.poses) {
                let others: Vec<usize> = plan.selected.iter().copied().filter(|&other| other != i).collect();
                let mut tried: Vec<(f64, usize)> = (0..survey.views.len())
                    .filter(|j| !plan.selected.contains(j))
                    .filter(|&j| plan.selected.iter().all(|&i| (direction(j) - direction(i)).norm() >= least))
                    .map(|j| {
                        let value = chooser.assess(others.iter().copied().chain([j]).collect()).log_value;
                        (1.0 - (value - plan.log_value).exp(), survey.views[j].id)
                    })
                    .collect();
                tried.sort_by(|a, b| a.0.total_cmp(&b.0));
                assert_eq!(pose.spares.len(), 4);
                for (spare, (loss, _)) in pose.spares.iter().zip(&tried) {
                    // Equal ones may swap.
                    assert!((spare.loss - loss).abs() < 1e-9, "{}: {spare:?} {loss}", explained.criterion);
                    assert!(tried.iter().any(|(loss, id)| *id == spare.id && (loss - spare.loss).abs() < 1e-9));
                }
            }
        }
    }

    #[test]
    fn the_curve_holds_the_plan_and_its_bounds() {
        let problem = coarse();
        let survey = survey(&problem, &|_| {}).unwrap();
        let (chooser, plan) = planned(&problem, &survey);
        let explained = explain(&problem, &chooser, &plan.selected, &SETTINGS, &|_| {}).unwrap();
        let counts: Vec<usize> = explained.curve.iter().map(|point| point.count).collect();
        assert_eq!(counts, (1..=12).collect::<Vec<_>>());
        for point in &explained.curve {
            // A variance: none is below its bound.
            assert!(point.value.is_none_or(|value| value >= point.bound.unwrap()), "{point:?}");
        }
        for pair in explained.curve.windows(2) {
            assert!(pair[1].bound < pair[0].bound);
            assert!(pair[0].value.is_none_or(|before| pair[1].value.unwrap() < before));
        }
        assert!(explained.curve[9].value.unwrap() <= chooser.natural(plan.log_value));
    }

    /// The combination of greatest variance: no other has more, and its own is what is said.
    #[test]
    fn no_combination_is_known_less_than_the_least_known() {
        let problem = coarse();
        let survey = survey(&problem, &|_| {}).unwrap();
        let (chooser, plan) = planned(&problem, &survey);
        let settings = ExplainSettings { most: 1, spares: 0 };
        let least = explain(&problem, &chooser, &plan.selected, &settings, &|_| {}).unwrap().least_known;
        let C = chooser.information(&plan.selected).try_inverse().unwrap();
        let units = problem.unknowns().pixel_units();
        let scaled = DMatrix::from_fn(9, 9, |i, j| C[(i, j)] / (units[i] * units[j]));
        let c = nalgebra::DVector::from_iterator(9, least.combination.iter().map(|term| term.coefficient));
        assert!((c.norm() - 1.0).abs() < 1e-9);
        let variance = least.sigma.unwrap().powi(2);
        assert!(((&scaled * &c).dot(&c) / variance - 1.0).abs() < 1e-6);
        assert!((scaled.symmetric_eigenvalues().max() / variance - 1.0).abs() < 1e-6);
        // A part of the whole map error.
        assert!(least.moves_image_px.unwrap() < plan.map_error);
    }

    #[test]
    fn poses_that_leave_something_open_are_refused_and_named() {
        // Without distortion one view of a plane gives two constraints: two of the four intrinsics stay open.
        let path = Path::new("problems/servosila-engineer.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let text = text.replace("model = \"brown-conrady\"\nk1 = -0.2\nk2 = 0.05", "model = \"none\"");
        let text = text.replace(", \"k1\", \"k2\", \"p1\", \"p2\", \"k3\"", "");
        let step = Overrides::new().set("sweep.step_deg=20").unwrap();
        let problem = Problem::parse_with(&text, path, &step).unwrap();
        let survey = survey(&problem, &|_| {}).unwrap();
        let chooser = Chooser::new(&problem, &survey).unwrap();
        let few = chooser.choose(crate::problem::Method::Exchange, 3, 0).unwrap();
        let explained = explain(&problem, &chooser, &few.selected, &SETTINGS, &|_| {}).unwrap();
        let (open, closed): (Vec<_>, Vec<_>) = explained.poses.iter().partition(|pose| !pose.leaves_open.is_empty());
        assert!(!open.is_empty());
        for pose in open {
            assert_eq!(pose.loss, 1.0);
            assert_eq!((pose.map_error_px, &pose.suffers_most), (None, &None));
            assert_eq!(pose.leaves_open.len(), 4);
        }
        assert!(closed.iter().all(|pose| pose.loss < 1.0 && pose.suffers_most.is_some()));
        assert_eq!(explained.curve[0].value, None);
        let refused = explain(&problem, &chooser, &few.selected[..1], &SETTINGS, &|_| {});
        assert!(matches!(refused, Err(PlanError::Unobservable { count: 1, .. })), "{refused:?}");
    }
}
