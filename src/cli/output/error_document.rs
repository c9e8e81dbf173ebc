//! Failures as JSON, for programs that ask for it with `--json`.

use std::error::Error;
use std::path::Path;

use miette::Diagnostic;
use serde_json::{Value, json};

use super::failure::Failure;
use crate::formats::{DiskError, FileReadError};
use crate::plan::document::{ErrorDocument, FaultDocument, FaultInFile};
use crate::problem::{Fault, ProblemError, Reason};

/// The document that stands on stderr in place of the drawn error.
pub(super) fn error_document(failure: &Failure) -> ErrorDocument {
    let causes = std::iter::successors(failure.source(), |&error| error.source());
    let message = std::iter::once(failure.to_string()).chain(causes.map(ToString::to_string));
    let message = message.collect::<Vec<_>>().join(": ");
    let help = failure.help().map(|help| help.to_string());
    ErrorDocument::new(failure.kind(), failure.exit_code(), &message, help, faults(failure))
}

/// What is wrong with a file of the user's, with the places.
fn faults(failure: &Failure) -> Vec<FaultDocument> {
    let place = |path: &Path, line: Option<usize>, message: Option<String>| {
        vec![FaultDocument { file: path.to_owned(), line, message, ..FaultDocument::default() }]
    };
    match failure {
        Failure::Problem(ProblemError::Invalid { file, faults }) => {
            faults.iter().map(|found| fault(Path::new(&file.name), found)).collect()
        }
        Failure::Problem(ProblemError::Encoding { path, line: at }) => place(path, Some(*at), None),
        Failure::Problem(ProblemError::Read { path, .. }) | Failure::PlanFile { path, .. } => place(path, None, None),
        Failure::Observations { path, error } | Failure::PoseList { path, error } => {
            place(path, line(error), Some(error.to_string()))
        }
        _ => Vec::new(),
    }
}

fn fault(file: &Path, fault: &Fault) -> FaultDocument {
    let (value, allowed) = value_and_allowed(&fault.reason);
    FaultDocument {
        file: file.to_owned(),
        line: Some(fault.line),
        column: Some(fault.column),
        key: Some(fault.key.clone()),
        message: Some(fault.to_string()),
        value,
        allowed,
        requirement: Some(fault.label()),
        hint: fault.hint(),
        in_file: match &fault.reason {
            Reason::CameraFile { path, error } | Reason::RobotFile { path, error } => {
                Some(FaultInFile { file: path.clone(), line: line(error), message: error.to_string() })
            }
            _ => None,
        },
    }
}

/// The value that is refused and what may stand in its place: names in a list, else in words.
fn value_and_allowed(reason: &Reason) -> (Value, Value) {
    match reason {
        Reason::UnknownKey { allowed } | Reason::Missing { allowed } | Reason::NoShape { allowed } => {
            (Value::Null, json!(allowed))
        }
        Reason::UnknownName { name, allowed } => (json!(name), json!(allowed)),
        Reason::Type { found, expected } => (json!(found), json!(expected)),
        Reason::OutOfRange { value, allowed } => (json!(value), json!(allowed.to_string())),
        Reason::Reversed { min, max } => (json!([min, max]), json!("[min, max]")),
        Reason::Length { found, expected, .. } => (json!(found), json!(expected)),
        Reason::Duplicate { name } | Reason::Ambiguous { name } | Reason::NoFolder { name } => {
            (json!(name), Value::Null)
        }
        Reason::NotUnit { norm } => (json!(norm), json!(1)),
        Reason::TooManyConfigurations { configurations, most } => {
            (json!(configurations), json!(format!("at most {most}")))
        }
        Reason::TooManyJoints { joints, most } => (json!(joints), json!(format!("at most {most}"))),
        _ => (Value::Null, Value::Null),
    }
}

/// Line in a file of another format, where its reader tells.
fn line(error: &FileReadError) -> Option<usize> {
    match error {
        FileReadError::Disk(DiskError::Encoding { line }) => Some(*line),
        FileReadError::Content(error) => Some(error.line),
        _ => None,
    }
}
