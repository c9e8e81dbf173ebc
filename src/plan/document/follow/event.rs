//! What `follow --json` tells, one document a line.

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::answers::{EstimatedIntrinsics, RequestedAccuracy};
use crate::plan::document::header::{Document, Header};
use crate::plan::document::plan::{MoveDocument, PlannedPose};

/// What happens while a plan is carried out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FollowEvent {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// What happens; which of the keys after `message` is there depends on it.
    pub event: EventKind,
    /// The same in a sentence for people.
    pub message: String,
    /// The pose to go to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<AnnouncedPose>,
    /// A picture that came.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<CountedPicture>,
    /// What the pictures so far tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub known: Option<KnownSoFar>,
    /// How the tour ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<FollowEnd>,
}

/// What happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EventKind {
    /// `pose` is to be gone to.
    Pose,
    /// `picture` counts.
    Picture,
    /// `picture` is in doubt: the answer `done` lets it count, `again` or another picture takes its place.
    Doubt,
    /// What the pictures so far tell is in `known`.
    Known,
    /// They do not tell enough yet, as `message` says.
    Unknown,
    /// The last answer changes nothing.
    Refused,
    /// A file cannot be read; it is waited on.
    Unreadable,
    /// Pictures do not count: they were there before the pose was announced.
    Early,
    /// Poses are added to the tour.
    More,
    /// The tour ends, as `end` says.
    End,
}

/// A pose to go to.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct AnnouncedPose {
    /// Its number in the tour, from 1.
    pub visit: usize,
    /// Number of poses in the tour, added ones included.
    pub visits: usize,
    /// Where the arm is to stand before: the number of a visit, 0 for home, that of the pose itself where it need not move; `null` where
    /// the way is not known.
    pub from: Option<usize>,
    /// Joint values, rad (m for prismatic joints), at which the way turns, one after the other: from `from` by these to the pose, each move
    /// straight in joint space, is what is known of below.
    pub turns_rad: Vec<Vec<f64>>,
    /// What is known of the way; `null` where it is not known or there is none.
    pub way: Option<MoveDocument>,
    /// Names of the joints, in the order of their values.
    pub joints: Vec<String>,
    /// Pictures to take there.
    pub pictures: usize,
    /// Those that it has already.
    pub taken: usize,
    /// Whether pictures are waited for, else the answer `done`.
    pub watches: bool,
    /// The pose, as in plans.
    #[serde(flatten)]
    pub pose: PlannedPose,
}

/// A picture of the pose that was announced last.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CountedPicture {
    /// Name of the file of detections, without its folder.
    pub file: String,
    /// Name of the image in that file.
    pub name: String,
    /// Number of corners that were detected.
    pub corners: usize,
    /// What is wrong with it, in a sentence each; none of one that counts.
    pub doubts: Vec<String>,
}

/// What the pictures so far tell.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KnownSoFar {
    /// Their number.
    pub views: usize,
    /// The estimated intrinsics.
    pub intrinsics: EstimatedIntrinsics,
    /// RMS length of the residuals, px.
    pub rms_px: f64,
    /// Standard deviation of one pixel coordinate of a corner.
    pub sigma_px: f64,
    /// Map error predicted if the tour ended now, px.
    pub map_error_px: Option<f64>,
    /// Map error predicted after all poses that are left, px; `null` where there are none, or one is no view of the camera found.
    pub expected_map_error_px: Option<f64>,
    /// The accuracies at which the tour ends.
    pub requested: Vec<RequestedAccuracy>,
    /// Whether they are reached by a calibration that nothing speaks against.
    pub reached: bool,
    /// What the calibration is worth, as in calibration.json.
    pub judgement: String,
}

/// Why a tour ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WhyEnded {
    /// The accuracy is reached.
    Accuracy,
    /// All poses are done.
    Poses,
    /// By the answer `quit`; the tour can be resumed.
    Quit,
    /// No more answers can come; the tour can be resumed.
    Closed,
}

/// How the tour ended.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FollowEnd {
    /// Why.
    pub why: WhyEnded,
    /// Whether nothing is left to do: exit code 0, else 4.
    pub good: bool,
    /// Poses taken.
    pub taken: usize,
    /// Poses left out.
    pub skipped: usize,
    /// Poses that were not gone to.
    pub left: usize,
    /// Time that the tour took, pauses between two runs of the program not counted.
    pub seconds: f64,
    /// Time of all moves and pictures by the plan; `null` of plans without a tour.
    pub planned_s: Option<f64>,
    /// Joint values of the home to return to, rad (m for prismatic joints); `null` where the tour does not return.
    pub home_rad: Option<Vec<f64>>,
    /// Joint values at which the way there turns.
    pub turns_rad: Vec<Vec<f64>>,
    /// What is known of that way.
    pub way: Option<MoveDocument>,
    /// Folder to which the calibration was written.
    pub output: Option<String>,
}

impl Document for FollowEvent {
    const FORMAT: &'static str = "calipose.follow-event";
    const VERSION: u32 = 1;
}
