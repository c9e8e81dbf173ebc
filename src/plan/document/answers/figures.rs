//! The figures that `calipose figures` wrote.

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header, ProblemReference};

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FiguresDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem that the plan answers.
    pub problem: ProblemReference,
    /// The files.
    pub files: Vec<FigureFile>,
}

/// One file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FigureFile {
    /// Name of the figure.
    pub figure: String,
    /// Its title.
    pub title: String,
    /// Name of the file in the folder.
    pub file: String,
}

impl Document for FiguresDocument {
    const FORMAT: &'static str = "calipose.figures";
    const VERSION: u32 = 1;
}
