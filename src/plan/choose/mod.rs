//! From a survey to a choice of poses with its proof.

mod baseline;
mod choice;
mod chooser;
mod constraints;
mod continuum;
mod decide;
mod dual;
mod error;
mod home;
mod objective;
mod off_grid;
mod plan_survey;
mod refined_survey;
mod tours;

pub use baseline::{Clustering, ClusteringError, KMeans, Points, lloyd, random};
pub use choice::{Choice, Reached};
pub use chooser::Chooser;
pub use constraints::ConstraintError;
pub use continuum::ContinuumCertificate;

pub use decide::{Decision, FewestProof, SearchSummary, decide};
pub use error::PlanError;
pub use home::home_is_safe;
pub(crate) use objective::Objective;
pub use off_grid::PolishSettings;
pub(crate) use off_grid::{Moved, Poses, SAMPLED as SAMPLED_OFF_GRID, leave_grid, moved};
pub use plan_survey::plan_survey;
pub(crate) use refined_survey::PICKS;
pub use refined_survey::refined_survey;
pub(crate) use tours::journey;
pub use tours::{GaveWay, Led, Toured, Trade};
