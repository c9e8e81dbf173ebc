//! From a survey to a choice of poses with its proof.

mod baseline;
mod chooser;
mod constraints;
mod decide;
mod objective;

pub use baseline::{Clustering, ClusteringError, kmeans, lloyd, random};
pub use chooser::{Choice, Chooser, PlanError, ReachedAccuracy};
pub use constraints::ConstraintError;
pub(crate) use constraints::{allows, captured, known};
pub use decide::{FewestProof, Made, SearchSummary, make};
pub(crate) use objective::{ACCURACY, Objective, TermDefinition};
