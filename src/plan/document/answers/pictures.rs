//! The pictures that `calipose render` wrote.

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};

/// What was rendered.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PicturesDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// Standard deviation of the blur.
    pub blur_px: f64,
    /// Change of the light from left to right, as a share.
    pub gradient: f64,
    /// Standard deviation of the noise, in grey values of 255.
    pub noise_grey: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// The pictures, in the plan's order.
    pub pictures: Vec<PictureFile>,
}

/// One picture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct PictureFile {
    /// Id of the pose.
    pub pose: usize,
    /// Name of the file in the folder.
    pub file: String,
}

impl Document for PicturesDocument {
    const FORMAT: &'static str = "calipose.pictures";
    const VERSION: u32 = 1;
}
