//! Studies: what was found in each cell, and what it comes to.

mod cell;
mod summary;
mod work;

pub use cell::{CellDocument, CellOutcome, CellRow, CellSeconds, SimulatedOutcome};
pub use summary::{AxisMeans, ComparedLevels, Difference, Mean, OutcomeSummary, ReasonCount, StudyAxis, StudyDocument};
pub use work::{CellsDocument, JobDocument, StudyCheckDocument};
