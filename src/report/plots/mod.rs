//! Which plots there are, and from which document each is made.

mod accuracy;
mod calibration;
mod comparison;
mod coverage;
mod design;
mod poses;
mod space;
mod study;
mod tour;

use super::PlanDocuments;
use super::figure::Figure;
use crate::plan::document::{CalibrationDocument, ComparisonDocument, DesignDocument, StudyDocument, Verification};

/// Views drawn at most; more would only hide each other.
const MOST_DOTS: usize = 600;

/// The plots of a plan, in the order of a report.
pub fn plan_figures(documents: &PlanDocuments) -> Vec<Figure> {
    let PlanDocuments { plan, review, verification, .. } = documents;
    let mut figures = vec![coverage::directions(review), coverage::pictures(review)];
    figures.push(accuracy::by_count(review));
    figures.extend(accuracy::over_image(review));
    figures.extend(verification.map(accuracy::sampled));
    figures.extend(accuracy::correlations(plan, review));
    figures.push(poses::rejections(plan));
    figures.push(poses::joints(review));
    figures
}

/// The tour of a plan in time: a page has it beside the view in space.
pub fn tour_figure(documents: &PlanDocuments) -> Option<Figure> {
    tour::tour(documents.review)
}

/// Drawings in space, for paper: a page has a view in space in their place.
pub fn plan_drawings(documents: &PlanDocuments) -> Vec<Figure> {
    space::drawings(documents.plan, documents.review)
}

/// The plots of a calibration.
pub(super) fn calibration_figures(calibration: &CalibrationDocument) -> Vec<Figure> {
    let mut figures: Vec<Figure> = calibration::residuals(calibration).into_iter().collect();
    figures.push(calibration::by_view(calibration));
    figures.extend(calibration::uncertainty(calibration));
    figures
}

/// The plots of simulated calibrations.
pub(super) fn verification_figures(verification: &Verification) -> Vec<Figure> {
    vec![accuracy::sampled(verification)]
}

/// The plots of a comparison.
pub(super) fn comparison_figures(comparison: &ComparisonDocument) -> Vec<Figure> {
    vec![comparison::map_errors(comparison)]
}

/// The plots of a study.
pub fn study_figures(study: &StudyDocument) -> Vec<Figure> {
    study::figures(study)
}

/// The plots of a design.
pub fn design_figures(design: &DesignDocument) -> Vec<Figure> {
    design::figures(design)
}
