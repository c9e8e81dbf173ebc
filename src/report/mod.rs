//! What is shown to people: plots and pages, made from documents alone.
//!
//! `plots` knows what is plotted and from which document, `drawing` draws it, `page` puts it on a page.

mod documents;
mod drawing;
mod figure;
mod outcome;
mod page;
mod plots;

pub use documents::{Disagreement, PlanDocuments};
pub use drawing::{DrawingError, Style, png, svg};
pub use figure::{Band, BandKind, Content, Figure, Hue, Interval, Line, Mark, Series, Strip};
pub use outcome::{family, gain, on_the_way, outcome, strongest};
pub use page::{
    PAGE_MARK, calibration_page, comparison_page, design_page, diff_page, plan_page, study_page, verification_page,
};
pub use plots::{design_figures, plan_drawings, plan_figures, study_figures, tour_figure};
