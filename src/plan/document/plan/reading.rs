//! Plans read back from their text.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use thiserror::Error;

use super::tour::in_order;
use super::{Intrinsics, Plan, PlannedPose, PolishedPlan, TourDocument};
use crate::plan::document::header::{Document, ProblemReference};

/// Why a text is not a plan.
#[derive(Debug, Error)]
pub enum PlanReadError {
    /// It is not JSON, or a key is missing or of the wrong type.
    #[error("not a plan: {0}")]
    Json(serde_json::Error),
    /// It is another kind of document.
    #[error("the key `format` is \"{found}\"; in a plan it is {allowed}")]
    Format {
        /// What it says.
        found: String,
        /// What it may say.
        allowed: String,
    },
    /// It is of an older version.
    #[error("the plan has version {found}, made by an older calipose; this one reads version {read}: make a new plan")]
    Older {
        /// What it says.
        found: u64,
        /// The version that is read.
        read: u32,
    },
    /// It is of no version that is known.
    #[error("the plan has version {found}; this calipose reads version {read}")]
    Version {
        /// What it says.
        found: String,
        /// The version that is read.
        read: u32,
    },
}

/// What `text` says, a document of one of the `kinds`: the values of its keys `format` and `version`.
pub(in crate::plan::document) fn read<T: DeserializeOwned>(
    text: &str,
    kinds: &[(&str, u32)],
) -> Result<T, PlanReadError> {
    let value: Value = serde_json::from_str(text).map_err(PlanReadError::Json)?;
    let found = value["format"].as_str().unwrap_or_default();
    let Some(&(_, read)) = kinds.iter().find(|(format, _)| *format == found) else {
        let allowed = kinds.iter().map(|(format, _)| format!("\"{format}\"")).collect::<Vec<_>>().join(" or ");
        return Err(PlanReadError::Format { found: found.to_owned(), allowed });
    };
    match &value["version"] {
        version if *version == read => serde_json::from_value(value).map_err(PlanReadError::Json),
        version => {
            let older = version.as_u64().filter(|&found| found < read.into());
            let unknown = PlanReadError::Version { found: version.to_string(), read };
            Err(older.map_or(unknown, |found| PlanReadError::Older { found, read }))
        }
    }
}

impl Plan {
    /// The plan that `text`, the content of a `plan.json`, holds.
    ///
    /// # Errors
    /// When it is not JSON, not a plan, or of a version that this program does not know.
    pub fn from_json(text: &str) -> Result<Self, PlanReadError> {
        read(text, &[(Self::FORMAT, Self::VERSION)])
    }
}

/// What plans on the grid and polished ones have in common: their poses, and what these are poses of.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct PlannedPoses {
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// The estimated intrinsics.
    pub intrinsics: Intrinsics,
    /// Names of the joints, in the order of the poses' joint values.
    pub joints: Vec<String>,
    /// The poses.
    pub poses: Vec<PlannedPose>,
    /// The order in which to take them, if there is one.
    #[serde(default)]
    pub tour: Option<TourDocument>,
}

impl PlannedPoses {
    /// The poses of `text`, the content of a `plan.json` or a `polished.json`.
    ///
    /// # Errors
    /// When it is not JSON, no plan of either kind, or of a version that this program does not know.
    pub fn from_json(text: &str) -> Result<Self, PlanReadError> {
        read(text, &[(Plan::FORMAT, Plan::VERSION), (PolishedPlan::FORMAT, PolishedPlan::VERSION)])
    }

    /// The poses in the order in which to take them: that of the tour, as they are listed where there is none.
    pub fn in_order(&self) -> Vec<&PlannedPose> {
        in_order(&self.poses, self.tour.as_ref())
    }
}

impl From<&Plan> for PlannedPoses {
    fn from(plan: &Plan) -> Self {
        let Plan { problem, intrinsics, joints, poses, tour, .. } = plan.clone();
        Self { problem, intrinsics, joints, poses, tour }
    }
}
