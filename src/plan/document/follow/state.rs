//! How far a plan was carried out: `follow.json`.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::calibration::{Corner, View};
use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::plan::document::plan::{MoveDocument, PlannedPose};

/// How far a plan was carried out, key by key as in `follow.json`: what a run that goes on needs, pictures' corners included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FollowState {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// SHA-256 of the plan's bytes, in hexadecimal.
    pub plan_sha256: String,
    /// The poses one after the other: those of the plan in the order of its tour, then those that were added.
    pub visits: Vec<Visit>,
    /// Which visit is on, from 0; their number where all are done.
    pub place: usize,
    /// Time that the tour took so far; pauses between two runs of the program do not count.
    pub seconds: f64,
}

/// A pose and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Visit {
    /// Id of the pose; one that was added may have the id of another.
    pub id: usize,
    /// What became of it.
    pub outcome: Outcome,
    /// Its pictures, where detections are watched.
    pub pictures: Vec<TakenPicture>,
    /// The pose, where it is none of the plan's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub added: Option<AddedPose>,
}

/// What became of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Nothing yet.
    Open,
    /// It was taken.
    Taken,
    /// It was left out.
    Skipped,
}

/// A picture, and the corners that were detected in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TakenPicture {
    /// Name of the file of detections, without its folder.
    pub file: String,
    /// Name of the image in that file.
    pub name: String,
    /// The corners.
    pub corners: Vec<SeenCorner>,
}

/// A corner that was detected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeenCorner {
    /// Its index on the board, row by row.
    pub index: usize,
    /// Where it was detected [u, v].
    pub corner_px: [f64; 2],
    /// How sure that is, against other corners.
    pub weight: f64,
}

/// A pose that was added to those of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AddedPose {
    /// The pose.
    pub pose: PlannedPose,
    /// The move to it from the pose before.
    pub way: MoveDocument,
}

impl TakenPicture {
    /// The picture `name` of the file `file` with the corners detected in it, which need not be usable.
    pub fn new(file: &str, name: &str, corners: &[Corner]) -> Self {
        let kept = |&Corner { index, pixel, weight }: &Corner| SeenCorner { index, corner_px: pixel.into(), weight };
        Self { file: file.into(), name: name.into(), corners: corners.iter().map(kept).collect() }
    }

    /// Its corners as a calibration takes them.
    pub fn view(&self) -> View {
        let corner = |&SeenCorner { index, corner_px, weight }: &SeenCorner| Corner {
            index,
            pixel: Vector2::from(corner_px),
            weight,
        };
        self.corners.iter().map(corner).collect()
    }
}

impl Document for FollowState {
    const FORMAT: &'static str = "calipose.follow";
    const VERSION: u32 = 1;
}

/// Why a text does not tell how far a plan was carried out.
#[derive(Debug, Error)]
pub enum FollowReadError {
    /// It is not JSON, or a key is missing or of the wrong type.
    #[error("it does not tell how far a plan was carried out: {0}")]
    Json(serde_json::Error),
    /// It is another kind of document, or of another version.
    #[error(
        "the keys `format` and `version` are {format} and {version}; they must be \"{}\" and {}",
        FollowState::FORMAT,
        FollowState::VERSION
    )]
    Kind {
        /// The value of its key `format`, as it stands there.
        format: String,
        /// That of its key `version`.
        version: String,
    },
}

impl FollowState {
    /// What `text`, the content of a `follow.json`, says.
    ///
    /// # Errors
    /// When it is not JSON, another kind of document, or of a version that this program does not know.
    pub fn from_json(text: &str) -> Result<Self, FollowReadError> {
        let value: serde_json::Value = serde_json::from_str(text).map_err(FollowReadError::Json)?;
        if value["format"] == Self::FORMAT && value["version"] == Self::VERSION {
            return serde_json::from_value(value).map_err(FollowReadError::Json);
        }
        Err(FollowReadError::Kind { format: value["format"].to_string(), version: value["version"].to_string() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_state_is_named() {
        let refused = |text: &str| FollowState::from_json(text).unwrap_err().to_string();
        assert!(refused("{").contains("does not tell how far"));
        let other = refused("{\"format\": \"calipose.plan\", \"version\": 4}");
        assert_eq!(
            other,
            "the keys `format` and `version` are \"calipose.plan\" and 4; they must be \"calipose.follow\" and 1"
        );
        assert!(refused("{\"format\": \"calipose.follow\", \"version\": 2}").contains("\"calipose.follow\" and 2;"));
        assert!(refused("{\"format\": \"calipose.follow\", \"version\": 1}").contains("missing field"));
    }
}
