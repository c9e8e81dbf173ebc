//! What fewer and more poses give, from the plan's own certificate: at once, where `explain` solves a relaxation for each number.

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::information::Criterion;
use crate::plan::choose::{Chooser, PlanError};
use crate::plan::document::{BoundPoint, Plan, finite};
use crate::selection::{Certificate, Gradient, Instance, SelectionError, improved_sample};

/// Quarters of an octave on either side of the plan's number of poses.
const QUARTERS: i32 = 4;

/// Good choices of half to twice as many poses, with the bound on the map error that the plan's matrix proves for each number if the map
/// error is what the plan optimises.
pub(super) fn curve(plan: &Plan, chooser: &Chooser) -> Result<Vec<BoundPoint>, PlanError> {
    let instance = chooser.instance(plan.count)?;
    let most = chooser.survey().views.len();
    let octave = |quarter: i32| plan.count as f64 * (f64::from(quarter) / f64::from(QUARTERS)).exp2();
    let mut counts: Vec<usize> =
        (-QUARTERS..=QUARTERS).map(|quarter| (octave(quarter).round() as usize).clamp(1, most)).collect();
    counts.dedup();
    let points: Result<Vec<Option<BoundPoint>>, PlanError> =
        counts.into_par_iter().map(|count| point(plan, chooser, &instance, count)).collect();
    Ok(points?.into_iter().flatten().collect())
}

/// `None` where the constraints do not allow so many.
fn point(plan: &Plan, chooser: &Chooser, instance: &Instance, count: usize) -> Result<Option<BoundPoint>, PlanError> {
    let Ok(instance) = instance.with_count(count) else { return Ok(None) };
    let map_error = if count == plan.count {
        Some(plan.map_error_px)
    } else {
        match improved_sample(&instance) {
            Ok(found) => finite(chooser.assess(found).map_error),
            Err(SelectionError::Unobservable { .. } | SelectionError::NoRoom { .. }) => None,
            Err(error) => return Err(chooser.explain(error)),
        }
    };
    Ok(Some(BoundPoint { count, map_error_px: map_error, bound_px: bound(plan, chooser, &instance)? }))
}

/// The least map error that the plan's matrix allows; `None` where the plan optimises something else.
fn bound(plan: &Plan, chooser: &Chooser, instance: &Instance) -> Result<Option<f64>, PlanError> {
    let [term] = plan.certificate.grid.terms.as_slice() else { return Ok(None) };
    if term.criterion != Criterion::V.name() {
        return Ok(None);
    }
    if instance.count() == plan.count {
        return Ok(finite(plan.bound.sqrt()));
    }
    let p = term.matrix.len();
    let Y = DMatrix::from_row_iterator(p, p, term.matrix.iter().flatten().copied());
    let Some(prices) = plan.certificate.grid.group_prices(chooser.survey()) else { return Ok(None) };
    let certificate = Certificate::new(instance, Gradient::new(&[Y], vec![]), prices).map_err(PlanError::Selection)?;
    Ok(finite(chooser.natural(certificate.log_bound).sqrt()))
}
