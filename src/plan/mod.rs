//! From a problem to a plan: the pipeline, and the plan as it is written.

mod allowed;
mod candidates;
mod certify;
mod choice;
mod collision;
mod comparison;
mod document;
mod explain;
mod explanation;
mod files;
mod make;
mod next;
mod objective;
mod polish;
mod polished;
mod proof;
mod reach;
mod recall;
mod refine;
mod rehearsal;
mod retaken;
mod survey;
mod verify;

pub use allowed::ConstraintError;
pub use candidates::{candidates_csv, candidates_parquet};
pub use certify::{BrokenConstraint, CertifyError, Confirmed, Unchecked, certify};
pub use choice::{Choice, Chooser, PlanError};
pub use collision::{CollisionDocument, Contact};
pub use comparison::{Comparison, Equivalent, Row, compare, equivalent_kmeans};
pub use document::{
    Candidates, Intrinsics, PLAN_FORMAT, PLAN_VERSION, Plan, PlanReadError, PlannedPose, Pose, ProblemReference,
    joints_deg,
};
pub use explain::{ExplainSettings, explain};
pub use explanation::{
    CombinationTerm, CurvePoint, EXPLANATION_FORMAT, EXPLANATION_VERSION, Explanation, LeastKnown, PoseExplanation,
    SparePose, Suffering,
};
pub use files::{FileError, write_atomically, write_together};
pub use make::{FewestProof, Made, SearchSummary, make};
pub use next::{Proposal, Wish, next};
pub use polish::{PolishSettings, Polished, polish};
pub use polished::{GridPlan, POLISHED_FORMAT, POLISHED_VERSION, PROVEN, PolishedPlan};
pub use proof::{AccuracyDocument, CertificateDocument, CertificateTerm, FewestDocument, Price, SearchDocument};
pub use reach::reach_starts;
pub use recall::RecallError;
pub use refine::candidates;
pub use rehearsal::Rehearsal;
pub use survey::{Survey, SurveyError, survey};
pub use verify::{VerifyError, verify};
