//! All that can be looked at of a plan: the robot and its surroundings, what was swept, what each pose shows, and how well the
//! camera will be known over its image. With the plan it is what a report is made of.

mod accuracy;
mod picture;
mod scene;
mod space;
mod timeline;

pub use accuracy::{BoundPoint, OtherChoice};
pub(crate) use picture::image_share;
pub use picture::{Picture, Silhouette};
pub use scene::{Scene, SceneBoard, SceneCamera, SceneJoint, SceneLink, SceneMotion, SceneShape, SceneSolid};
pub(crate) use space::Space;
pub use timeline::{MarginCurve, PictureTime, TimedLeg, TimedMove, Timeline};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error_grid::ErrorGrid;
use super::header::{Document, Header, ProblemReference};
use super::plan::Pose;

/// What can be looked at of a plan. Lengths in m, angles in rad unless the key says otherwise; poses in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Review {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// The robot, the board and what stands around them.
    #[serde(flatten)]
    pub scene: Scene,
    /// The views that the plan was chosen from.
    pub views: SurveyedViews,
    /// The plan's poses, in the order in which to take them.
    pub poses: Vec<ReviewedPose>,
    /// The tour in time; left out of plans of older versions, which have none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub timeline: Option<Timeline>,
    /// As many poses chosen otherwise.
    pub others: Vec<OtherChoice>,
    /// What fewer and more poses give.
    pub curve: Vec<BoundPoint>,
    /// Correlation of the estimated intrinsics by the plan, row by row in the order of the plan's names; empty where the plan leaves
    /// one undetermined.
    pub correlation: Vec<Vec<f64>>,
    /// The map error over the image; `null` where the plan leaves something undetermined.
    pub error_map: Option<ErrorGrid>,
    /// The same before the plan, by what is known without it; `null` where that leaves something undetermined.
    pub error_map_before: Option<ErrorGrid>,
}

impl Document for Review {
    const FORMAT: &'static str = "calipose.review";
    const VERSION: u32 = 1;
}

/// Views, one an entry of each list; where there are very many, evenly spaced ones of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurveyedViews {
    /// How many there are in all.
    pub all: usize,
    /// Numbers of the configurations, ascending.
    pub ids: Vec<usize>,
    /// Positions of the camera, x y z of each, rounded to 0.1 mm.
    pub positions_m: Vec<f64>,
    /// Angles between optical axis and the board's normal.
    pub tilt_deg: Vec<f64>,
    /// Directions of the camera about the board's normal, from the board's x towards its y.
    pub azimuth_deg: Vec<f64>,
    /// Distances from the camera to the board's centre.
    pub distance_m: Vec<f64>,
    /// Shares of the picture that the board's corners span.
    pub image_share: Vec<f64>,
}

/// One pose of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReviewedPose {
    /// Number of the configuration.
    pub id: usize,
    /// Its number in that order, from 1.
    pub label: String,
    /// Joint values, rad (m for prismatic joints).
    pub joints: Vec<f64>,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_display: Vec<f64>,
    /// Pose of the camera.
    pub camera: Pose,
    /// Angle between the optical axis and the board's normal.
    pub tilt_deg: f64,
    /// Distance from the camera to the board's centre.
    pub distance_m: f64,
    /// Share of the information at hand.
    pub share: f64,
    /// The two tested links that come nearest to each other; `null` where none are tested.
    pub nearest: Option<NearestLinks>,
    /// What the camera sees from there.
    pub picture: Picture,
}

/// Two links, and how near they come to each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NearestLinks {
    /// Their names.
    pub links: [String; 2],
    /// Distance between their nearest bodies.
    pub distance_m: f64,
}
