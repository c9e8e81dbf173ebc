//! The file that tells how far a plan was carried out.

use std::path::PathBuf;

use crate::cli::interrupt::writing;
use crate::cli::output::failure::Failure;
use crate::formats::read_at_most;
use crate::plan::document::{Document, FollowState};
use crate::plan::results::{FOLLOW_FILE, keep_beside};

/// Bytes of the file; a larger one is something else.
const LARGEST: u64 = 1_000_000_000;

/// `follow.json` beside a plan.
pub(super) struct StateFile {
    /// The plan's file.
    plan: PathBuf,
    /// Its text.
    text: String,
    /// What was read or written last.
    last: Option<Vec<u8>>,
}

impl StateFile {
    /// Beside the plan of that file and text.
    pub(super) fn new(plan: &std::path::Path, text: &str) -> Self {
        Self { plan: plan.to_owned(), text: text.to_owned(), last: None }
    }

    /// What it says; nothing where there is no such file.
    pub(super) fn read(&mut self) -> Result<Option<FollowState>, Failure> {
        let bytes = match read_at_most(&self.path(), LARGEST) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            bytes => bytes.map_err(|error| self.refused(&error.to_string()))?,
        };
        let state = FollowState::from_json(&String::from_utf8_lossy(&bytes))
            .map_err(|error| self.refused(&format!("{error}; begin anew with --restart")))?;
        self.last = Some(bytes);
        Ok(Some(state))
    }

    /// Writes it, unless the plan or the file was replaced meanwhile.
    pub(super) fn write(&mut self, state: &FollowState) -> Result<(), Failure> {
        let bytes = state.to_json().into_bytes();
        let before = self.last.as_deref();
        writing(|| keep_beside(&self.plan, self.text.as_bytes(), FOLLOW_FILE, before, &bytes))?;
        self.last = Some(bytes);
        Ok(())
    }

    /// That it cannot be used.
    pub(super) fn refused(&self, reason: &str) -> Failure {
        Failure::Document { path: self.path(), reason: reason.to_owned() }
    }

    fn path(&self) -> PathBuf {
        self.plan.with_file_name(FOLLOW_FILE)
    }
}
