//! Why a command failed, as it is written to stderr with `--json`.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::header::{Document, Header};

/// Why a command failed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ErrorDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// What is wrong, in a word: `problem-file`, `command-line`, `bug`.
    pub kind: String,
    /// Exit code of the process.
    pub exit_code: u8,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
    /// What is wrong with a file of the user's, with the places.
    pub faults: Vec<FaultDocument>,
}

/// A place in a file, and what is wrong there; `null` is what is not known.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct FaultDocument {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
    /// Key of the problem file, with those above it.
    pub key: Option<String>,
    /// What is wrong.
    pub message: Option<String>,
    /// The value that is refused, as it stands in the file.
    pub value: Value,
    /// What may stand in its place: names in a list, else in words.
    pub allowed: Value,
    /// What the value must be, as it is drawn under the line.
    pub requirement: Option<String>,
    /// What may have been meant.
    pub hint: Option<String>,
    /// Where the key names a file that is wrong: that file, and what is wrong in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub in_file: Option<FaultInFile>,
}

/// What is wrong in a file that a problem file names.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FaultInFile {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1, where its reader tells.
    pub line: Option<usize>,
    /// What is wrong.
    pub message: String,
}

impl Document for ErrorDocument {
    const FORMAT: &'static str = "calipose.error";
    const VERSION: u32 = 1;
}

impl ErrorDocument {
    /// The document of a failure that ends the process with `exit_code`.
    pub fn new(kind: &str, exit_code: u8, message: &str, help: Option<String>, faults: Vec<FaultDocument>) -> Self {
        Self { header: Self::header(), kind: kind.into(), exit_code, message: message.into(), help, faults }
    }
}
