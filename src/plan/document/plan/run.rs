//! How a plan's files came about: `run.json`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::document::header::{Document, Header};
use crate::problem::Problem;

/// How the files came about, key by key as in `run.json`: what differs from run to run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Run {
    /// What it is and what made it.
    #[serde(flatten)]
    pub header: Header,
    /// The problem.
    pub problem: RunProblem,
    /// Threads that it ran on.
    pub threads: usize,
    /// How long it took.
    pub seconds: RunSeconds,
    /// SHA-256 of the files that were written with the plan or from it, by name.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
}

/// The problem of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunProblem {
    /// Its name.
    pub name: String,
    /// Hash of its file.
    pub sha256: String,
    /// Its file, from the root.
    pub file: Option<PathBuf>,
}

/// How long a run took, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunSeconds {
    /// Until the views were found.
    pub survey: f64,
    /// From then until the plan was.
    pub selection: f64,
    /// All in all.
    pub total: f64,
}

impl Document for Run {
    const FORMAT: &'static str = "calipose.run";
    const VERSION: u32 = 1;
}

impl Run {
    /// A run on the problem that `file` states.
    pub fn new(problem: &Problem, file: &Path, seconds: RunSeconds) -> Self {
        Self {
            header: Self::header(),
            problem: RunProblem {
                name: problem.name.clone(),
                sha256: problem.sha256.clone(),
                file: std::path::absolute(file).ok(),
            },
            threads: rayon::current_num_threads(),
            seconds,
            files: BTreeMap::new(),
        }
    }
}
