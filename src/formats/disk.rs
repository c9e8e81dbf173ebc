//! The bytes and the text of a file on disk.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use thiserror::Error;

/// Larger files are of something else: 1000 images of 10 000 corners stay below.
const LARGEST: u64 = 1_000_000_000;

/// Why a file gives no text, or no bytes at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum DiskError {
    /// It could not be read.
    #[error("cannot be read: {}", match kind { io::ErrorKind::NotFound => "there is no such file".into(), kind => kind.to_string() })]
    Read {
        /// Why not.
        kind: io::ErrorKind,
    },
    /// It is too large to be one of these files.
    #[error("is larger than {LARGEST} bytes")]
    TooLarge,
    /// It is not UTF-8 text.
    #[error("is not UTF-8 text: line {line} has an invalid byte")]
    Encoding {
        /// Line of the first such byte, from 1.
        line: usize,
    },
}

/// The file at `path`.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, DiskError> {
    read_at_most(path, LARGEST).map_err(|error| match error.kind() {
        io::ErrorKind::FileTooLarge => DiskError::TooLarge,
        kind => DiskError::Read { kind },
    })
}

/// The file at `path`, at most `most` bytes of it. Pipes are read as files are; what has no end is given up there.
pub(crate) fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let mut bytes = Vec::new();
    if file.metadata()?.len() <= most {
        file.take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 <= most {
            return Ok(bytes);
        }
    }
    Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it is larger than {most} bytes")))
}

/// The text of the file at `path`.
pub(super) fn text(path: &Path) -> Result<String, DiskError> {
    String::from_utf8(bytes(path)?).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        DiskError::Encoding { line: String::from_utf8_lossy(valid).matches('\n').count() + 1 }
    })
}
