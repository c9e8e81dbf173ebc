//! Files for other programs.

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};

/// What was exported.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ExportDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// Folder of the files.
    pub folder: String,
    /// Time at each pose.
    pub dwell_s: f64,
    /// Share of the joints' greatest speeds in percent.
    pub speed_percent: f64,
    /// The files; of a model first the model, then those that it names, which several models may share.
    pub files: Vec<ExportedFile>,
}

/// One file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ExportedFile {
    /// Name of the format.
    pub format: String,
    /// Name of the file in the folder.
    pub file: String,
}

impl Document for ExportDocument {
    const FORMAT: &'static str = "calipose.export";
    const VERSION: u32 = 1;
}
