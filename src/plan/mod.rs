//! From a problem to a plan: the pipeline, and the plan as it is written.

mod candidates;
mod choice;
mod comparison;
mod document;
mod files;
mod next;
mod reach;
mod survey;
mod verify;

pub use candidates::{candidates_csv, candidates_parquet};
pub use choice::{Choice, Chooser, PlanError};
pub use comparison::{Comparison, Equivalent, Row, compare, equivalent_kmeans};
pub use document::{
    Candidates, CertificateDocument, Intrinsics, PLAN_FORMAT, PLAN_VERSION, Plan, PlanReadError, PlannedPose, Pose,
    ProblemReference,
};
pub use files::{FileError, write_atomically, write_together};
pub use next::{Proposal, Wish, next};
pub use reach::reach_starts;
pub use survey::{Survey, SurveyError, survey};
pub use verify::{VerifyError, verify};
