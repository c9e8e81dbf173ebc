//! The explanation of a plan as it is written by `calipose explain --json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::plan::document::plan::TrialDocument;

/// Why a plan is as it is. Numbers that are infinite or undefined are `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Explanation {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// What the plan optimises, as in the plan.
    pub criterion: String,
    /// Number of poses of the plan.
    pub count: usize,
    /// The plan's value, in the criterion's own unit as in the plan.
    pub value: f64,
    /// The plan's map error in px.
    pub map_error_px: Option<f64>,
    /// What other numbers of poses would give.
    pub curve: Vec<CurvePoint>,
    /// The plan's poses, by ascending id.
    pub poses: Vec<PoseExplanation>,
    /// The combination of the intrinsics that the plan knows least.
    pub least_known: LeastKnown,
    /// What it costs and brings to withstand a set-up that is not quite as stated, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub robust: Option<RobustnessPrice>,
    /// Names of the joints, in the order of the poses' joint values.
    pub joints: Vec<String>,
}

/// The plan beside the best one, of as many poses, for the set-up as stated alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RobustnessPrice {
    /// Map error of the best plan for the set-up as stated, px, there.
    pub map_error_as_stated_px: Option<f64>,
    /// Ids of its poses.
    pub ids: Vec<usize>,
    /// The plan's poses in set-ups drawn anew.
    pub plan: TrialDocument,
    /// Those of the best plan for the set-up as stated, in the same ones.
    pub as_stated: TrialDocument,
}

impl Document for Explanation {
    const FORMAT: &'static str = "calipose.explanation";
    const VERSION: u32 = 1;
}

/// What the best sets of one number of poses give.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurvePoint {
    /// Number of poses.
    pub count: usize,
    /// The value of the best set found, in the criterion's own unit; `null` where none that determines everything was.
    pub value: Option<f64>,
    /// What no set of so many can surpass; `null` where none is proven.
    pub bound: Option<f64>,
    /// Certified efficiency of the best set found.
    pub efficiency: Option<f64>,
    /// Map error of the best set found, px.
    pub map_error_px: Option<f64>,
}

/// What one pose is worth to the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseExplanation {
    /// Number of the configuration.
    pub id: usize,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_deg: Vec<f64>,
    /// Share of the plan's information that is lost without the pose: 1 − Φ(without)/Φ; 1 where the others leave something
    /// open.
    pub loss: f64,
    /// The map error without it, px.
    pub map_error_px: Option<f64>,
    /// The intrinsic whose standard deviation grows most without it.
    pub suffers_most: Option<Suffering>,
    /// The combination of parameters that the other poses leave undetermined; empty if they determine all.
    pub leaves_open: Vec<CombinationTerm>,
    /// The views that lose least in its place, the best first; none for a pose that must be in the plan.
    pub spares: Vec<SparePose>,
}

/// An intrinsic and its standard deviations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Suffering {
    /// Name of the intrinsic.
    pub name: String,
    /// Its standard deviation by the plan.
    pub sigma: f64,
    /// Its standard deviation without the pose.
    pub sigma_without: f64,
}

/// A view that can take a pose's place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SparePose {
    /// Number of the configuration.
    pub id: usize,
    /// Joint values, degrees (mm for prismatic joints).
    pub joints_deg: Vec<f64>,
    /// Share of the plan's information that is lost by the replacement; negative where it gains.
    pub loss: f64,
    /// The map error after the replacement, px.
    pub map_error_px: Option<f64>,
}

/// The combination `Σ c_j θ_j / u_j` of the intrinsics that is known least, with `u_j` the change of `θ_j` alone that moves the
/// image by 1 px RMS and `Σ c_j² = 1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeastKnown {
    /// The coefficients `c_j`, in the order of the intrinsics; the largest is positive.
    pub combination: Vec<CombinationTerm>,
    /// Its standard deviation, in the same units; `null` if the plan leaves it undetermined.
    pub sigma: Option<f64>,
    /// How far one standard deviation of it, the intrinsics following as they are correlated, moves the image, px RMS, after
    /// the best rotation of the camera.
    pub moves_image_px: Option<f64>,
}

/// A parameter and its coefficient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CombinationTerm {
    /// Name of the parameter.
    pub name: String,
    /// Its coefficient.
    pub coefficient: f64,
}
