//! The problem file that `calipose init --json` wrote.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::document::header::{Document, Header};

/// Where the new problem file is. It is about no problem yet: the file has still to be filled in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct InitDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The file.
    pub file: PathBuf,
}

impl Document for InitDocument {
    const FORMAT: &'static str = "calipose.init";
    const VERSION: u32 = 2;
}

impl InitDocument {
    /// The document of `file`.
    pub fn new(file: &Path) -> Self {
        Self { header: Self::header(), file: file.to_owned() }
    }
}
