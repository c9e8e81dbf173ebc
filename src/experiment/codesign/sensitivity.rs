//! What it costs to change one thing, and the best set-up with the board elsewhere.

use rayon::prelude::*;

use super::evaluate::{Planned, Verdict};
use super::{Codesign, Place};
use crate::experiment::factor::Factor;
use crate::plan::document::{DesignMap, Sensitivity, SensitivityPoint};

/// Steps from the best set-up, in shares of the range; levels that are farther apart are stepped one by one.
pub(super) const STEPS: [f64; 4] = [-0.1, -0.05, 0.05, 0.1];

/// What the keys of the board's position begin with.
const POSITION: &str = "target.pose.position_mm[";

impl Codesign {
    /// The best set-up with one thing changed at a time.
    pub(super) fn sensitivity(&self, best: &Planned, observe: &(dyn Fn() + Sync)) -> Vec<Sensitivity> {
        let changes: Vec<(usize, Place)> = (0..self.free.len())
            .flat_map(|i| STEPS.into_iter().filter_map(move |step| Some((i, self.stepped(&best.place, i, step)?))))
            .collect();
        let map_errors: Vec<Option<f64>> = changes
            .par_iter()
            .map(|(_, place)| {
                let found = self.map_error_at(place);
                observe();
                found
            })
            .collect();
        let mut all: Vec<Sensitivity> = Vec::new();
        for (i, factor) in self.free.iter().enumerate() {
            let of_factor = changes.iter().zip(&map_errors).filter(|((of, _), _)| *of == i);
            let mut points: Vec<SensitivityPoint> =
                of_factor.map(|((_, place), map_error)| point(place, i, *map_error)).collect();
            points.push(point(&best.place, i, Some(best.map_error)));
            points.sort_by(|a, b| a.number.unwrap_or(0.0).total_cmp(&b.number.unwrap_or(0.0)));
            points.dedup_by(|a, b| a.value == b.value);
            all.push(Sensitivity { name: factor.name.clone(), points });
        }
        all
    }

    /// The set-up with the share of one range changed by `step`; none beyond the range.
    fn stepped(&self, place: &Place, i: usize, step: f64) -> Option<Place> {
        let by = match self.free[i].levels() {
            Some(levels) => {
                let level = 1.0 / levels.len() as f64;
                step.signum() * if step.abs() > 0.05 { 2.0 * level } else { level }
            }
            None => step,
        };
        let mut shares = place.shares.clone();
        shares[i] += by;
        (0.0..1.0).contains(&shares[i]).then(|| self.place(shares))
    }

    /// The first and the last share of a range at which the board is on the surface, all else as in `place`.
    fn possible(&self, place: &Place, i: usize) -> [f64; 2] {
        let is_possible = |share: &f64| {
            let mut shares = place.shares.clone();
            shares[i] = *share;
            self.problem_at(&self.place(shares)).is_some()
        };
        let all = || (0..LOOKED_AT).map(|step| (step as f64 + 0.5) / LOOKED_AT as f64);
        let (first, last) = (all().find(is_possible), all().rev().find(is_possible));
        [first.unwrap_or(place.shares[i]), last.unwrap_or(place.shares[i])]
    }

    fn map_error_at(&self, place: &Place) -> Option<f64> {
        match self.evaluate(place, None) {
            Verdict::Planned(planned) => Some(planned.map_error),
            Verdict::Refused | Verdict::NoPlan | Verdict::Undecided | Verdict::Discarded => None,
        }
    }

    /// The map error over the first two free coordinates of the board's position, if there are two.
    pub(super) fn map(&self, best: &Planned, observe: &(dyn Fn() + Sync)) -> Option<DesignMap> {
        let side = self.search.map as usize;
        let is_coordinate = |factor: &Factor| factor.key().is_some_and(|key| key.starts_with(POSITION));
        let coordinates: Vec<usize> = (0..self.free.len()).filter(|&i| is_coordinate(&self.free[i])).collect();
        let [x, y, ..] = coordinates[..] else { return None };
        if side == 0 {
            return None;
        }
        let [across, up] = [x, y].map(|i| self.possible(&best.place, i));
        let share = |[first, last]: [f64; 2], i: usize| first + (last - first) * i as f64 / (side.max(2) - 1) as f64;
        let place = |column: usize, row: usize| {
            let mut shares = best.place.shares.clone();
            (shares[x], shares[y]) = (share(across, column), share(up, row));
            self.place(shares)
        };
        let map_errors: Vec<Option<f64>> = (0..side * side)
            .into_par_iter()
            .map(|cell| {
                let found = self.map_error_at(&place(cell % side, cell / side));
                observe();
                found
            })
            .collect();
        let number = |level: &crate::experiment::Level| level.number.unwrap_or_default();
        Some(DesignMap {
            x: self.free[x].name.clone(),
            y: self.free[y].name.clone(),
            x_values: (0..side).map(|column| number(&place(column, 0).levels[x])).collect(),
            y_values: (0..side).map(|row| number(&place(0, row).levels[y])).collect(),
            map_error_px: map_errors.chunks(side).map(<[_]>::to_vec).collect(),
        })
    }
}

/// Places along a range that are looked at.
const LOOKED_AT: usize = 100;

fn point(place: &Place, i: usize, map_error_px: Option<f64>) -> SensitivityPoint {
    let level = &place.levels[i];
    SensitivityPoint { value: level.name.clone(), number: level.number, map_error_px }
}
