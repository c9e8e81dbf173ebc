//! Failures as JSON, for programs that ask for it with `--json`.

use std::error::Error;
use std::path::Path;

use miette::Diagnostic;
use serde_json::{Value, json};

use super::failure::Failure;
use crate::formats::{DiskError, FileReadError};
use crate::problem::{Fault, ProblemError, Reason};

/// The document that stands on stderr in place of the drawn error.
pub(crate) fn document(failure: &Failure) -> Value {
    let causes = std::iter::successors(failure.source(), |&error| error.source());
    let message = std::iter::once(failure.to_string()).chain(causes.map(ToString::to_string));
    let help = failure.help().map(|help| help.to_string());
    error(
        failure.kind(),
        failure.exit_code(),
        &message.collect::<Vec<_>>().join(": "),
        help.as_deref(),
        &faults(failure),
    )
}

/// A failure outside a command: of the command line, or a bug.
pub(crate) fn error(kind: &str, exit_code: u8, message: &str, help: Option<&str>, faults: &[Value]) -> Value {
    json!({
        "format": "calipose.error",
        "version": 1,
        "calipose": env!("CARGO_PKG_VERSION"),
        "kind": kind,
        "exit_code": exit_code,
        "message": message,
        "help": help,
        "faults": faults,
    })
}

/// What is wrong with a file of the user's, with the places.
fn faults(failure: &Failure) -> Vec<Value> {
    match failure {
        Failure::Problem(ProblemError::Invalid { file, faults }) => {
            faults.iter().map(|found| fault(Path::new(file.name()), found)).collect()
        }
        Failure::Problem(ProblemError::Encoding { path, line }) => vec![json!({ "file": path, "line": line })],
        Failure::Problem(ProblemError::Read { path, .. }) | Failure::PlanFile { path, .. } => {
            vec![json!({ "file": path })]
        }
        Failure::Observations { path, error } => {
            vec![json!({ "file": path, "line": line(error), "message": error.to_string() })]
        }
        _ => Vec::new(),
    }
}

fn fault(file: &Path, fault: &Fault) -> Value {
    let (value, allowed) = value_and_allowed(&fault.reason);
    let requirement = fault.labels().and_then(|mut labels| labels.next()?.label().map(str::to_owned));
    let mut document = json!({
        "file": file,
        "line": fault.line,
        "column": fault.column,
        "key": fault.key,
        "message": fault.to_string(),
        "value": value,
        "allowed": allowed,
        "requirement": requirement,
        "hint": fault.help().map(|hint| hint.to_string()),
    });
    if let Reason::CameraFile { path, error } | Reason::RobotFile { path, error } = &fault.reason {
        document["in_file"] = json!({ "file": path, "line": line(error), "message": error.to_string() });
    }
    document
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
