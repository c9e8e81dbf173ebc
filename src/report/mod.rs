//! What is shown to people: plots and pages, made from documents alone.
//!
//! `plots` knows what is plotted and from which document, `drawing` draws it, `page` puts it on a page.

mod drawing;
mod figure;
mod outcome;
mod page;
mod plots;

pub use drawing::{DrawingError, Style, png, svg};
pub use figure::{Content, Figure, Hue, Interval, Line, Mark, Series};
pub use outcome::{family, gain, outcome, strongest};
pub use page::{PAGE_MARK, calibration_page, comparison_page, design_page, plan_page, study_page, verification_page};
pub use plots::{design_figures, plan_drawings, plan_figures, study_figures};

use crate::plan::document::{Explanation, Plan, Review, Verification};

/// The documents that the report of a plan is made of.
#[derive(Debug, Clone, Copy)]
pub struct PlanDocuments<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// What can be looked at of it.
    pub review: &'a Review,
    /// Why it is as it is.
    pub explanation: &'a Explanation,
    /// Its simulated calibrations, if there were any.
    pub verification: Option<&'a Verification>,
}
