//! What can be wrong with a problem file, and where.

mod allowed;
mod reason;
mod suggestion;

pub use allowed::Allowed;
pub use reason::Reason;

use std::fmt;
use std::ops::Range;

use miette::{Diagnostic, LabeledSpan, SourceCode};
use thiserror::Error;

/// One thing wrong with a problem file, and where.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}", reason.sentence(key, *written))]
pub struct Fault {
    /// The key, from the root: `robot.joints[2].a_mm`. Empty for a syntax error.
    pub key: String,
    /// Whether the file has the key. Where it does not, the value at fault is the default.
    pub written: bool,
    /// The line that gives the value in place of the file's: line, column and bytes are its own then.
    pub given: Option<String>,
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in the line, in characters from 1.
    pub column: usize,
    /// Bytes of the file to point at.
    pub span: Range<usize>,
    /// What is wrong.
    pub reason: Reason,
    /// What the key means, where known.
    pub meaning: Option<String>,
}

impl Diagnostic for Fault {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let hint = self.reason.hint(&self.key, self.meaning.as_deref());
        hint.map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = self.reason.label(&self.key, self.written);
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(Some(label), self.span.clone()))))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        // The file's own text is the error's that holds the fault.
        self.given.as_ref().map(|line| line as &dyn SourceCode)
    }
}
