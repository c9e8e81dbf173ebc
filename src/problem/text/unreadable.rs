//! Why a text is no document.

use std::ops::Range;

use toml::de::Error;

/// Why a text is no document.
#[derive(Debug)]
pub(crate) struct Unreadable {
    pub(crate) message: String,
    pub(crate) span: Range<usize>,
}

impl From<Error> for Unreadable {
    fn from(error: Error) -> Self {
        Self { message: error.message().to_owned(), span: error.span().unwrap_or(0..0) }
    }
}
