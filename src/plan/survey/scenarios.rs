//! What views are where the set-up is not quite as stated.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::SurveyError;
use crate::feasibility::{Checks, View};
use crate::information::Measurement;
use crate::problem::{Problem, Robustness};
use crate::selection::InformationSet;
use crate::selection::packed::{packed_len, unpack};

/// A set-up as it may be, and what the views of the stated one would teach there.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// The set-up.
    pub problem: Problem,
    /// The views' information on the estimated intrinsics, in their order; nothing of those that are none here.
    pub information: InformationSet,
    /// The p×p weight of the map error.
    pub map_weight: DMatrix<f64>,
}

/// Draws that are tried together, after which views that cannot be seen often enough are given up.
const TOGETHER: usize = 16;

/// Those of `views` that are views in the share of the drawn set-ups that the problem demands.
pub(super) fn certain(problem: &Problem, mut views: Vec<View>) -> Vec<View> {
    let Some(Robustness { draws, seen_share, .. }) = problem.robust else { return views };
    let most_missed = draws - (seen_share * draws as f64 - 1e-9).ceil() as usize;
    let stated = Scene::new(problem);
    let mut missed = vec![0; views.len()];
    // The stated set-up is the first draw.
    let mut draw = 1;
    while draw < draws {
        let together = draw..(draw + TOGETHER).min(draws);
        let misses: Vec<Vec<bool>> = together
            .clone()
            .into_par_iter()
            .map(|draw| {
                let drawn = problem.drawn(problem.selection.seed, draw);
                let scene = stated.of_drawn(&drawn);
                views.par_iter().map(|view| scene.view(view).is_none()).collect()
            })
            .collect();
        for misses in misses {
            for (count, is_missed) in missed.iter_mut().zip(misses) {
                *count += usize::from(is_missed);
            }
        }
        let mut counts = missed.iter();
        views.retain(|_| counts.next().is_some_and(|&count| count <= most_missed));
        missed.retain(|&count| count <= most_missed);
        draw = together.end;
    }
    views
}

impl Scenario {
    /// The scenarios that the problem demands beside the set-up as stated.
    ///
    /// # Errors
    /// When a view's pose is not determined by its own corners.
    pub(super) fn all(problem: &Problem, views: &[View]) -> Result<Vec<Self>, SurveyError> {
        let scenarios = problem.scenarios();
        if scenarios.is_empty() {
            return Ok(vec![]);
        }
        let stated = Scene::new(problem);
        scenarios.into_iter().map(|scenario| Self::new(&stated, scenario, views)).collect()
    }

    fn new(stated: &Scene, problem: Problem, views: &[View]) -> Result<Self, SurveyError> {
        let scene = stated.of_drawn(&problem);
        let order = scene.measurement.order();
        let length = packed_len(order);
        let mut table = vec![0.0; views.len() * length];
        let found = table.par_chunks_exact_mut(length).zip(views).try_for_each(|(row, view)| {
            if let Some(view) = scene.view(view) {
                row.copy_from_slice(&scene.measurement.information(&view.X_CT, &view.seen)?);
            }
            Some(())
        });
        found.ok_or_else(|| SurveyError::undetermined(&problem))?;
        let information = InformationSet::from_packed_trusted(order, table);
        let map_weight = problem.unknowns().map_error_weight();
        Ok(Self { problem, information, map_weight })
    }
}

/// A set-up, ready to look at views of another.
#[derive(Debug, Clone)]
pub(crate) struct Scene<'a> {
    checks: Checks<'a>,
    pub(crate) measurement: Measurement<'a>,
}

impl<'a> Scene<'a> {
    /// The set-up as stated.
    pub(crate) fn new(problem: &'a Problem) -> Self {
        Self { checks: problem.checks(), measurement: problem.measurement() }
    }

    /// One that was [drawn](Problem::drawn) from it.
    pub(crate) fn of_drawn<'b>(&self, drawn: &'b Problem) -> Scene<'b>
    where
        'a: 'b,
    {
        let Problem { robot, camera, target, .. } = drawn;
        Scene { checks: self.checks.of_moved(robot, camera, target), measurement: drawn.measurement() }
    }

    /// What the configuration of a view shows here; `None` if it is no view.
    pub(crate) fn view(&self, view: &View) -> Option<View> {
        self.look(view.id, &view.q)
    }

    /// Predicted map error of what is seen, px, beside the information known already; infinite where that does not determine
    /// the intrinsics.
    pub(crate) fn map_error(&self, seen: &[Option<View>], known: &DMatrix<f64>) -> f64 {
        let told = seen.iter().flatten().filter_map(|view| self.measurement.information(&view.X_CT, &view.seen));
        let total = told.fold(known.clone(), |total, told| total + unpack(&told, known.nrows()));
        let weight = || self.measurement.unknowns.map_error_weight();
        self.measurement.covariance(&total).map_or(f64::INFINITY, |covariance| (weight() * covariance).trace().sqrt())
    }

    /// What the joint values `q` of configuration `id` show here; `None` if that is no view.
    pub(crate) fn look(&self, id: usize, q: &[f64]) -> Option<View> {
        self.checks.view(id, q).ok()
    }
}
