//! How well the camera will be known, by this plan and by others.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::ErrorGrid;

/// As many poses as the plan has, chosen otherwise; by k-means those with the median map error of five seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OtherChoice {
    /// Name of the method.
    pub method: String,
    /// Numbers of the configurations, ascending.
    pub ids: Vec<usize>,
    /// Their map error in px; `null` where they leave something undetermined.
    pub map_error_px: Option<f64>,
    /// The map error over the image; `null` where they leave something undetermined.
    pub error_map: Option<ErrorGrid>,
}

/// What so many poses give.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoundPoint {
    /// Number of poses.
    pub count: usize,
    /// Map error of a good choice of so many, px.
    pub map_error_px: Option<f64>,
    /// What no choice of so many can be below, px; `null` where the plan's certificate proves none.
    pub bound_px: Option<f64>,
}
