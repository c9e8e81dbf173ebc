//! `calipose init` and `schema`.

use std::path::Path;

use serde_json::json;

use super::WRITING;
use super::failure::Failure;
use super::screen::Screen;
use crate::plan::write_atomically;
use crate::problem::{STARTER, schema_json};

pub(super) fn run(file: &Path, screen: &mut Screen) -> Result<(), Failure> {
    if file.exists() {
        return Err(Failure::Exists(file.to_owned()));
    }
    let writing = WRITING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    write_atomically(file, STARTER.as_bytes())?;
    drop(writing);
    screen.document(&json!({ "format": "calipose.init", "version": 1, "file": file }).to_string())?;
    screen.text(&format!("Written {0}. Edit it, then:\n  calipose check {0}\n  calipose plan {0}", file.display()))
}

pub(super) fn schema(_screen: &mut Screen) -> Result<(), Failure> {
    Screen::print(&format!("{:#}", schema_json()))
}
