//! `calipose init` and `schema`.

use std::path::Path;

use crate::cli::interrupt::writing;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::experiment::{Codesign, Study};
use crate::plan::document::{InitDocument, Kind};
use crate::plan::results::write_atomically;
use crate::problem::{STARTER, draft, schema_json};

pub(crate) fn run(file: Option<&Path>, urdf: Option<&Path>, screen: &mut Screen) -> Result<(), Failure> {
    // A draft is called as the robot that it is of.
    let named = urdf.map(|urdf| Path::new(urdf.file_name().unwrap_or_default()).with_extension("toml"));
    let file = file.or(named.as_deref()).unwrap_or(Path::new("problem.toml"));
    if file.exists() {
        return Err(Failure::Exists(file.to_owned()));
    }
    let text = match urdf {
        None => STARTER.to_owned(),
        Some(urdf) => draft(urdf, file).map_err(|error| Failure::Draft { path: urdf.to_owned(), error })?,
    };
    writing(|| write_atomically(file, text.as_bytes()))?;
    screen.document(&InitDocument::new(file))?;
    let edit =
        if urdf.is_some() { "Check the lines that say GUESS, replace those that say FILL IN" } else { "Edit it" };
    screen.text(&format!("Wrote {0}. {edit}, then run:\n  calipose check {0}\n  calipose plan {0}", file.display()))
}

/// Prints the JSON Schema of that name.
pub(crate) fn schema(name: &str) -> Result<(), Failure> {
    let file = FILES.iter().find(|(file, _)| *file == name).map(|(_, schema)| schema());
    let document = || Kind::named(name).map(Kind::schema);
    Screen::print(&format!("{:#}", file.or_else(document).unwrap_or_default()))
}

/// Names that [`schema`] knows: those of files that users write, and those of the documents.
pub(crate) fn schema_names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(name, _)| *name).chain(Kind::ALL.into_iter().map(Kind::name))
}

/// Name of the schema of problem files.
pub(crate) const PROBLEM: &str = "problem";

/// Makes a schema.
type Describe = fn() -> serde_json::Value;

/// Files that users write, each with its schema.
const FILES: [(&str, Describe); 3] =
    [(PROBLEM, schema_json), ("study-file", Study::schema_json), ("design-file", Codesign::schema_json)];
