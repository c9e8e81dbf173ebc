//! Why a problem file cannot be used.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::fault::Fault;

/// Faults that are drawn at most.
pub(super) const MOST_DRAWN: usize = 50;

/// Why a problem file cannot be used. With the feature `cli` it is a diagnostic of miette, which draws every fault under its line.
#[derive(Debug, Error)]
pub enum ProblemError {
    /// The file could not be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The file is not UTF-8 text.
    #[error("{} is not UTF-8 text: line {line} has an invalid byte", path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// Line of the first such byte, from 1.
        line: usize,
    },
    /// The file says something impossible.
    #[error("{}", summary(faults, &file.name))]
    Invalid {
        /// The file's name and text.
        file: SourceFile,
        /// What is wrong, at least one thing, in the order found.
        faults: Vec<Fault>,
    },
}

/// A file's name and text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Its name in messages.
    pub name: String,
    /// What it says.
    pub text: String,
}

fn summary(faults: &[Fault], file: &str) -> String {
    match faults {
        [fault] => fault.to_string(),
        _ if faults.len() > MOST_DRAWN => {
            format!(
                "{file} has {} errors; the first {MOST_DRAWN} are shown, and {} more",
                faults.len(),
                faults.len() - MOST_DRAWN
            )
        }
        _ => format!("{file} has {} errors", faults.len()),
    }
}

impl ProblemError {
    /// What is wrong with the file's contents; empty if they could not be read.
    pub fn faults(&self) -> &[Fault] {
        match self {
            Self::Invalid { faults, .. } => faults,
            Self::Read { .. } | Self::Encoding { .. } => &[],
        }
    }
}
