//! Why a problem file cannot be used.

use std::fmt;
use std::io;
use std::path::PathBuf;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use thiserror::Error;

use super::fault::Fault;

/// Faults that are drawn at most.
const MOST_DRAWN: usize = 50;

/// Why a problem file cannot be used. As a [`Diagnostic`] it draws every fault under its line of the file.
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
    #[error("{} is not UTF-8 text: line {line} has a byte that belongs to no character", path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// Line of the first such byte, from 1.
        line: usize,
    },
    /// The file says something impossible.
    #[error("{}", summary(faults, file.name()))]
    Invalid {
        /// The file's name and text.
        file: NamedSource<String>,
        /// What is wrong, at least one thing, in the order found.
        faults: Vec<Fault>,
    },
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

    /// The only fault, which is then drawn as the error itself.
    fn single(&self) -> Option<&Fault> {
        match self.faults() {
            [fault] => Some(fault),
            _ => None,
        }
    }
}

impl Diagnostic for ProblemError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::Read { source, .. } if source.kind() == io::ErrorKind::NotFound => {
                Some(Box::new("`calipose init` writes a problem file to start from"))
            }
            Self::Read { source, .. } if source.kind() == io::ErrorKind::IsADirectory => {
                Some(Box::new("name the problem file in it"))
            }
            Self::Read { .. } => None,
            Self::Encoding { .. } => Some(Box::new("save the file as UTF-8")),
            Self::Invalid { .. } => self.single().and_then(Fault::help),
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.single().and_then(Fault::labels)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        match self {
            Self::Invalid { file, .. } => self.single().and_then(Fault::source_code).or(Some(file)),
            Self::Read { .. } | Self::Encoding { .. } => None,
        }
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        match self.faults() {
            [] | [_] => None,
            faults => Some(Box::new(faults.iter().take(MOST_DRAWN).map(|fault| fault as &dyn Diagnostic))),
        }
    }
}
