//! What can be wrong with a file.

use thiserror::Error;

use crate::calibration::ObservationError;

/// What is wrong with a file, and where.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {fault}")]
pub struct ReadError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub fault: ReadFault,
}

/// What is wrong with a file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReadFault {
    /// There is nothing in it.
    #[error("the file is empty")]
    Empty,
    /// The text is not of the format.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A key is left out.
    #[error("`{key}` is missing")]
    Missing {
        /// The key.
        key: String,
    },
    /// A key or an image's block of lines occurs twice.
    #[error("`{name}` occurs a second time")]
    Repeated {
        /// The key or the image.
        name: String,
    },
    /// A value has the wrong type.
    #[error("`{key}` is {found}; it must be {expected}")]
    Type {
        /// The key.
        key: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
    /// A number is not allowed.
    #[error("`{key}` is {}; it must be {}", plain(*value), interval(*min, *max))]
    OutOfRange {
        /// The key.
        key: String,
        /// The number.
        value: f64,
        /// The least allowed.
        min: f64,
        /// The greatest allowed.
        max: f64,
    },
    /// A list has the wrong number of entries.
    #[error("`{key}` has {found} entries; it must have {expected}")]
    Length {
        /// The key.
        key: String,
        /// Entries found.
        found: usize,
        /// Entries needed.
        expected: String,
    },
    /// A name of something that calipose does not know.
    #[error("`{key}` is \"{found}\", which is not supported; supported: {supported}")]
    Unsupported {
        /// The key.
        key: String,
        /// The name found.
        found: String,
        /// The names that are supported.
        supported: &'static str,
    },
    /// A line has the wrong number of columns.
    #[error("{found} columns where the header has {expected}")]
    Columns {
        /// Columns found.
        found: usize,
        /// Columns of the header.
        expected: usize,
    },
    /// An image does not have the board's corners.
    #[error("image \"{view}\" has {found} corners up to here; the {columns} x {rows} board has {}", columns * rows)]
    CornerCount {
        /// The image.
        view: String,
        /// Corners listed.
        found: usize,
        /// Corners along the board's x.
        columns: usize,
        /// Corners along the board's y.
        rows: usize,
    },
    /// The format does not state something, and nobody else has.
    #[error("this format does not state the {what}; it has to be given")]
    NotStated {
        /// What.
        what: &'static str,
    },
    /// The file contradicts what is known.
    #[error("the file states the {what} {found}, elsewhere it is {given}")]
    Mismatch {
        /// What.
        what: &'static str,
        /// As the file has it.
        found: String,
        /// As it is known.
        given: String,
    },
    /// The detections of a view cannot be calibrated from.
    #[error("image \"{view}\"{}", without_number(fault))]
    View {
        /// The image.
        view: String,
        /// Why not.
        fault: ObservationError,
    },
    /// The detections as a whole cannot be calibrated from.
    #[error(transparent)]
    Observations(ObservationError),
}

impl ReadFault {
    pub(super) fn at(self, line: usize) -> ReadError {
        ReadError { line, fault: self }
    }
}

/// A number as one would write it: very large and very small ones with an exponent.
fn plain(x: f64) -> String {
    let size = x.abs();
    if size >= 1e7 || (size > 0.0 && size < 1e-4) { format!("{x:e}") } else { x.to_string() }
}

fn interval(min: f64, max: f64) -> String {
    if min == max { plain(min) } else { format!("from {} to {}", plain(min), plain(max)) }
}

/// The fault of a view without the view's number, which counts neither lines nor images: ` has 3 corners`, `: corner 5 …`.
fn without_number(fault: &ObservationError) -> String {
    let text = fault.to_string();
    let unnumbered = text.strip_prefix("view ").map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    unnumbered.map_or_else(|| format!(": {text}"), str::to_owned)
}
