//! What varies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::problem::{Choice, Named, Numbers};

/// What varies: a key of the problem file with its values, or several keys that change together.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Factor {
    /// Path of a key of the problem file, as in `camera.fx_px` or `robot.joints[1].limits_deg`, or of `simulate`.
    pub(crate) key: Option<String>,
    /// What it is called in tables and figures; the key when left out.
    pub(crate) name: Option<String>,
    /// The values of the key.
    pub(crate) values: Option<Vec<Value>>,
    /// Evenly spaced values.
    pub(crate) range: Option<Range>,
    /// Least and greatest value of a uniform distribution, from which a sampled design draws.
    pub(crate) uniform: Option<Numbers<2>>,
    /// Least and greatest value of a distribution that is uniform in the logarithm.
    pub(crate) log_uniform: Option<Numbers<2>>,
    /// A normal distribution.
    pub(crate) normal: Option<Normal>,
    /// Values drawn are rounded to multiples of this.
    pub(crate) round_to: Option<f64>,
    /// Levels of several keys, in place of `key`.
    #[serde(default)]
    pub(crate) levels: Vec<LevelTable>,
}

/// A level of a factor that sets several keys.
#[derive(Debug, Clone, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LevelTable {
    /// What it is called.
    pub(crate) name: String,
    /// Values in place of the problem file's, each `KEY=VALUE`, as `--set` takes them.
    #[serde(default)]
    pub(crate) set: Vec<String>,
}

/// Evenly spaced values: `from` and on by `step`, or `count` of them, up to `to`.
#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Range {
    /// First value.
    pub(crate) from: f64,
    /// Last value, or the end that is not passed.
    pub(crate) to: f64,
    /// From one to the next.
    pub(crate) step: Option<f64>,
    /// How many.
    pub(crate) count: Option<u32>,
    /// Whether differences or ratios are even: "linear" (default) or "logarithmic", which goes with `count`.
    #[serde(default)]
    pub(crate) scale: Named<Scale>,
}

/// A normal distribution.
#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Normal {
    /// Its mean.
    pub(crate) mean: f64,
    /// Its standard deviation.
    pub(crate) sigma: f64,
}

/// What is even in a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Scale {
    #[default]
    Linear,
    Logarithmic,
}

impl Choice for Scale {
    fn all() -> &'static [Self] {
        &[Self::Linear, Self::Logarithmic]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Logarithmic => "logarithmic",
        }
    }
}

impl Default for Named<Scale> {
    fn default() -> Self {
        Self(Scale::default())
    }
}
