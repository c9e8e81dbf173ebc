//! From the text of a file to its schema, and from serde's complaints to faults.

use serde::de::DeserializeOwned;

use super::document::Document;
use super::path::KeyPath;
use super::source::{Place, Source};
use crate::problem::fault::{Fault, Reason};
use crate::problem::schema::Vocabulary;

/// The document of `source`, and what it says as `T`, whose keys are in the vocabulary.
pub(crate) fn read<T: DeserializeOwned>(source: &Source, words: Vocabulary) -> Result<(Document<'_>, T), Box<Fault>> {
    let document = Document::parse(source, words).map_err(|error| {
        let Place { given, span, line, column } = source.place(&error.span);
        let reason = Reason::Syntax { message: error.message };
        Box::new(Fault { key: String::new(), written: true, given, line, column, span, reason, meaning: None })
    })?;
    match document.read() {
        Ok(file) => Ok((document, file)),
        Err(error) => Err(Box::new(translate(&document, &error))),
    }
}

/// A fault at `path`, pointing at its value.
pub(crate) fn fault(document: &Document, path: &KeyPath, reason: Reason) -> Fault {
    let (span, written) = document.locate(path);
    let Place { given, span, line, column } = document.place(&span);
    Fault {
        key: path.to_string(),
        written,
        given,
        line,
        column,
        span,
        reason,
        meaning: document.words.meaning(path.keys()),
    }
}

/// Serde reports in text only; its wording is stable, and snapshots of the messages hold it.
fn translate(document: &Document, error: &toml::de::Error) -> Fault {
    let message = error.message();
    let span = error.span().unwrap_or(0..0);
    let path = document.path_at(&span);
    let names: Vec<String> = message.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    if message.starts_with("missing field")
        && let [name] = &names[..]
    {
        // Serde points at the whole section; its header is the better place.
        return fault(document, &path.key(name), Reason::Missing { allowed: Vec::new() });
    }
    let reason = if message.starts_with("unknown field") {
        Reason::UnknownKey { allowed: names.get(1..).unwrap_or_default().to_vec() }
    } else if let (true, [name, allowed @ ..]) = (message.starts_with("unknown variant"), &names[..]) {
        Reason::UnknownName { name: name.clone(), allowed: allowed.to_vec() }
    } else if let Some((found, expected)) = message.rsplit_once(", expected ") {
        Reason::Type {
            found: plain_found(found),
            expected: plain_expected(expected, document.words.bounds(path.keys())),
        }
    } else {
        Reason::Syntax { message: message.to_owned() }
    };
    let Place { given, span, line, column } = document.place(&span);
    Fault {
        key: path.to_string(),
        written: true,
        given,
        line,
        column,
        span,
        reason,
        meaning: document.words.meaning(path.keys()),
    }
}

fn plain_found(serde: &str) -> String {
    let found = serde.trim_start_matches("invalid type: ").trim_start_matches("invalid value: ");
    match found.split_once(' ') {
        Some(("integer" | "boolean", value)) => value.trim_matches('`').to_owned(),
        Some(("floating", value)) => value.trim_start_matches("point ").trim_matches('`').to_owned(),
        Some(("string", value)) => format!("the string {value}"),
        Some(("invalid", length)) => length.replace("length ", "a list of length "),
        _ => match found {
            "sequence" => "a list".into(),
            "map" => "a table".into(),
            other => other.to_owned(),
        },
    }
}

/// `min` and `max` are the bounds of a whole number, where the schema has them.
fn plain_expected(serde: &str, (min, max): (Option<u64>, Option<u64>)) -> String {
    match serde {
        "f64" => "a number".into(),
        "u32" | "u64" | "usize" => {
            let min = min.unwrap_or(0);
            max.map_or(format!("a whole number, at least {min}"), |max| format!("a whole number from {min} to {max}"))
        }
        "a string" => "a string in quotes".into(),
        "a sequence" => "a list".into(),
        "a map" => "a table".into(),
        _ if serde.starts_with("struct ") => "a table".into(),
        _ => serde.to_owned(),
    }
}
