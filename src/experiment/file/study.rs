//! A study file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Factor;
use crate::information::Criterion;
use crate::problem::{Choice, Method, Named, StatedDisturbance};

/// An experiment: problems, what is varied, and what is wanted to be known of the plans.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "calipose study")]
pub(crate) struct StudyFile {
    /// Name of the study; the file's name without its extension when left out.
    pub(crate) name: Option<String>,
    /// Problem files, relative to the study file's folder.
    pub(crate) problems: Vec<String>,
    /// Values in place of the problem files', in all cells, each `KEY=VALUE`, as `--set` takes them.
    #[serde(default)]
    pub(crate) set: Vec<String>,
    /// What is varied.
    #[serde(default)]
    pub(crate) factors: Vec<Factor>,
    /// How the factors are combined.
    #[serde(default)]
    pub(crate) design: Design,
    /// What is chosen in each cell.
    #[serde(default)]
    pub(crate) choose: Choose,
    /// Calibrations simulated for each row; none when left out.
    #[serde(default)]
    pub(crate) simulate: Simulate,
    /// Columns of the table that are summarised and drawn; the map error when left out.
    #[serde(default)]
    pub(crate) outcomes: Vec<String>,
    /// Where results go.
    #[serde(default)]
    pub(crate) output: Output,
}

/// How the factors are combined.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Design {
    /// "full" (default): every combination of the factors' levels; "paired": the first levels together, the second together, and so
    /// on; "sampled": settings drawn from the factors' distributions, or from among their levels.
    #[serde(default)]
    pub(crate) kind: Named<DesignKind>,
    /// Settings of a sampled design.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub(crate) draws: Option<u32>,
    /// "sobol" (default): a scrambled Sobol sequence, which fills the space evenly; "random": independent draws.
    #[serde(default)]
    pub(crate) sequence: Named<Sequence>,
    /// Seed of the draws.
    #[serde(default)]
    pub(crate) seed: u32,
}

/// What is chosen in each cell. What is left out is as the cell's problem file says.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Choose {
    /// The methods.
    #[serde(default)]
    pub(crate) methods: Vec<Named<Method>>,
    /// The criteria.
    #[serde(default)]
    pub(crate) criteria: Vec<Named<Criterion>>,
    /// The numbers of poses.
    #[serde(default)]
    pub(crate) counts: Vec<u32>,
    /// Seeds that methods which depend on one are run with: the problem's and those that follow; 1 when left out.
    #[schemars(range(min = 1, max = 1000))]
    pub(crate) seeds: Option<u32>,
}

/// Calibrations simulated for each row, and what the prediction leaves out. Its keys can be factors too, as in
/// `simulate.joint_noise_deg`.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Simulate {
    /// How many; none when left out.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(crate) trials: u32,
    /// Standard deviation of the error of the nominal focal lengths and principal point, in percent.
    pub(crate) intrinsics_off_percent: f64,
    /// Standard deviation of the error of every revolute joint, in degrees.
    pub(crate) joint_noise_deg: f64,
    /// Error of the camera mount's orientation, in degrees about each axis.
    pub(crate) mount_rotation_deg: f64,
    /// Error of the camera mount's position, in mm along each axis.
    pub(crate) mount_translation_mm: f64,
    /// Growth of the noise with tilt: by this factor times (1/cos(tilt) - 1).
    pub(crate) noise_with_tilt: f64,
    /// Growth of the noise with distance: by this factor times (distance / distance of the nearest view - 1).
    pub(crate) noise_with_distance: f64,
    /// Share of the corners that are not detected, in percent.
    pub(crate) missing_percent: f64,
}

impl Simulate {
    /// What the prediction leaves out.
    pub(crate) fn stated(&self) -> StatedDisturbance {
        let Self {
            trials: _,
            intrinsics_off_percent,
            joint_noise_deg,
            mount_rotation_deg,
            mount_translation_mm,
            noise_with_tilt,
            noise_with_distance,
            missing_percent,
        } = *self;
        StatedDisturbance {
            intrinsics_off_percent,
            joint_noise_deg,
            mount_rotation_deg,
            mount_translation_mm,
            noise_with_tilt,
            noise_with_distance,
            missing_percent,
        }
    }
}

/// Where results go.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Output {
    /// Folder for the results, relative to the working directory; "studies/" and the name in lower case when left out.
    pub(crate) folder: Option<String>,
}

/// How factors are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum DesignKind {
    #[default]
    Full,
    Paired,
    Sampled,
}

/// How settings are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Sequence {
    #[default]
    Sobol,
    Random,
}

impl Choice for DesignKind {
    fn all() -> &'static [Self] {
        &[Self::Full, Self::Paired, Self::Sampled]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Paired => "paired",
            Self::Sampled => "sampled",
        }
    }
}

impl Choice for Sequence {
    fn all() -> &'static [Self] {
        &[Self::Sobol, Self::Random]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::Random => "random",
        }
    }
}

impl Default for Named<DesignKind> {
    fn default() -> Self {
        Self(DesignKind::default())
    }
}

impl Default for Named<Sequence> {
    fn default() -> Self {
        Self(Sequence::default())
    }
}
