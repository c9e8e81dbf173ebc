//! What a study takes, and how much of it is done.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header};

/// What a run of a study would take.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyCheckDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Name of the study.
    pub name: String,
    /// SHA-256 of the study file's bytes, in hexadecimal.
    pub sha256: String,
    /// Cells.
    pub cells: usize,
    /// About how many surveys they share.
    pub surveys: usize,
    /// About how many rows they have.
    pub rows: usize,
    /// Seconds that a run takes on this machine, about.
    pub seconds: f64,
    /// Bytes of the results on the disk, about.
    pub bytes: f64,
    /// Folder for the results.
    pub output: PathBuf,
}

/// Cells that are done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CellsDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Name of the study.
    pub name: String,
    /// Cells asked for.
    pub cells: usize,
    /// Those of them that were not there and had to be computed.
    pub computed: usize,
}

/// A job that computes a study's cells in shards and merges them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct JobDocument {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// Name of the study.
    pub name: String,
    /// What runs the job: "local", "slurm" or "hyperqueue".
    pub engine: String,
    /// Cells of the study.
    pub cells: usize,
    /// Shards of them, each a task.
    pub shards: usize,
    /// Cores that a shard works on.
    pub cores: usize,
    /// Folder for the results.
    pub output: PathBuf,
    /// Folder with the job's files.
    pub folder: PathBuf,
    /// Names of the files.
    pub files: Vec<String>,
    /// Whether the job was started, or only written. One that is local is done by then.
    pub started: bool,
    /// Command lines that start the job in its folder, one after the other; none of one that is local.
    pub start: Vec<Vec<String>>,
    /// What the engine calls what it started, one name for each of the command lines.
    pub jobs: Vec<String>,
    /// Command line that merges the cells again.
    pub merge: Vec<String>,
}

impl Document for JobDocument {
    const FORMAT: &'static str = "calipose.job";
    const VERSION: u32 = 1;
}

impl Document for StudyCheckDocument {
    const FORMAT: &'static str = "calipose.study-check";
    const VERSION: u32 = 1;
}

impl Document for CellsDocument {
    const FORMAT: &'static str = "calipose.cells";
    const VERSION: u32 = 1;
}
