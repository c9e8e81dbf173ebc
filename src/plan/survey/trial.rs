//! Poses tried in set-ups that may be.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::scenarios::Scene;
use crate::feasibility::View;
use crate::problem::{Problem, Robustness};

/// How poses fare in set-ups that were drawn anew, none of them a draw that they were chosen for.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Of each pose the share of the set-ups in which it is a view.
    pub seen: Vec<f64>,
    /// Map error in each set-up, px, ascending; infinite where what is seen does not determine the intrinsics.
    pub map_errors: Vec<f64>,
}

impl Trial {
    /// Number of set-ups.
    pub const SET_UPS: usize = 1000;

    /// The trial of `views` of the set-up as stated, with what is known of the intrinsics there, p×p, in all of them; `None`
    /// where no robustness is asked for.
    pub fn of(problem: &Problem, views: &[View], known: &DMatrix<f64>) -> Option<Self> {
        let Robustness { draws, .. } = problem.robust.as_ref()?;
        let stated = Scene::new(problem);
        let outcomes: Vec<(Vec<bool>, f64)> = (0..Self::SET_UPS)
            .into_par_iter()
            .map(|n| {
                let drawn = problem.drawn(problem.selection.seed, draws + n);
                let scene = stated.of_drawn(&drawn);
                let seen: Vec<Option<View>> = views.iter().map(|view| scene.view(view)).collect();
                let map_error = scene.map_error(&seen, known);
                (seen.iter().map(Option::is_some).collect(), map_error)
            })
            .collect();
        let share = |pose: usize| outcomes.iter().filter(|(seen, _)| seen[pose]).count() as f64 / Self::SET_UPS as f64;
        let mut map_errors: Vec<f64> = outcomes.iter().map(|&(_, map_error)| map_error).collect();
        map_errors.sort_unstable_by(f64::total_cmp);
        Some(Self { seen: (0..views.len()).map(share).collect(), map_errors })
    }

    /// The map error that a share of the set-ups does not exceed, px.
    pub fn map_error_of(&self, share: f64) -> f64 {
        let place = (share * self.map_errors.len() as f64).ceil() as usize;
        self.map_errors[place.clamp(1, self.map_errors.len()) - 1]
    }
}
