//! A polished plan as it is written: `polished.json` and `polished.csv`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::pose::{PlannedPose, poses_csv};
use super::proof::CertificateDocument;
use super::tour::{TourDocument, in_order};
use super::{Intrinsics, RobustnessDocument, UnweightedAccuracy, is_one, one};
use crate::plan::document::header::{Document, Header, ProblemReference};
use crate::robot::Joint;

/// Value of the key `proven`.
pub const PROVEN: &str = "the certificate is of the grid; off the grid nothing is proven";

/// A plan whose poses were moved off the grid, key by key as in `polished.json`. SI units, angles in rad unless the key says
/// otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PolishedPlan {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// What is optimised, as in the plan.
    pub criterion: String,
    /// Number of poses.
    pub count: usize,
    /// Pictures to take at each pose; 1 where it is not said.
    #[serde(skip_serializing_if = "is_one", default = "one")]
    pub pictures: usize,
    /// The criterion's value, as in plans.
    pub value: f64,
    /// What the polished poses gain over those of the grid: Φ / Φ(grid) − 1, at least 0.
    pub gain: f64,
    /// Φ as a share of the bound that holds on the grid; off it the share may exceed 1.
    pub efficiency_by_grid_bound: f64,
    /// Predicted standard deviations.
    pub intrinsics: Intrinsics,
    /// Predicted RMS error of the calibrated projection over the image, in px.
    pub map_error_px: f64,
    /// What plain least squares would make of the poses, where the corners scatter unequally.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unweighted: Option<UnweightedAccuracy>,
    /// What the poses are worth where the set-up is not quite as stated, if that was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub robust: Option<RobustnessDocument>,
    /// Cycles over all poses.
    pub cycles: usize,
    /// Whether the last cycle gained next to nothing.
    pub converged: bool,
    /// What is proven of the polished poses: [`PROVEN`].
    pub proven: String,
    /// The plan on the grid.
    pub grid: GridPlan,
    /// Names of the joints, in the order of the poses' joint values.
    pub joints: Vec<String>,
    /// The poses; `id` is that of the pose of the grid which each started from.
    pub poses: Vec<PlannedPose>,
    /// The order in which to take them, and the moves from one to the next.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub tour: Option<TourDocument>,
}

/// The plan on the grid, and what is proven of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GridPlan {
    /// Its value.
    pub value: f64,
    /// What no other set of the grid can surpass.
    pub bound: f64,
    /// Its certified efficiency.
    pub efficiency: f64,
    /// Its map error in px.
    pub map_error_px: f64,
    /// The proof of the bound.
    pub certificate: CertificateDocument,
}

impl Document for PolishedPlan {
    const FORMAT: &'static str = "calipose.polished";
    const VERSION: u32 = 2;
}

impl PolishedPlan {
    /// The poses in the order in which to take them: that of the tour, as they are listed where there is none.
    pub fn in_order(&self) -> Vec<&PlannedPose> {
        in_order(&self.poses, self.tour.as_ref())
    }

    /// The bytes of `polished.csv`, as those of `plan.csv`.
    ///
    /// # Errors
    /// Never in practice: the writer writes to memory.
    pub fn to_csv(&self, joints: &[Joint]) -> Result<Vec<u8>, csv::Error> {
        poses_csv(joints, self.in_order())
    }
}
