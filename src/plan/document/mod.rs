//! The documents that leave the program, typed and versioned.

mod explanation;
mod plan;
mod polished;
mod proof;
mod views_table;

pub use explanation::{
    CombinationTerm, CurvePoint, EXPLANATION_FORMAT, EXPLANATION_VERSION, Explanation, LeastKnown, PoseExplanation,
    SparePose, Suffering,
};
pub(crate) use plan::poses_csv;
pub use plan::{
    Candidates, Intrinsics, PLAN_FORMAT, PLAN_VERSION, Plan, PlanReadError, PlannedPose, Pose, ProblemReference,
    joints_deg,
};
pub use polished::{GridPlan, POLISHED_FORMAT, POLISHED_VERSION, PROVEN, PolishedPlan};
pub use proof::{AccuracyDocument, CertificateDocument, CertificateTerm, FewestDocument, Price, SearchDocument};
pub use views_table::{candidates_csv, candidates_parquet};
