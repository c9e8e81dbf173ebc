//! Faults as miette draws them.

use std::{fmt, io};

use miette::{Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

use super::error::MOST_DRAWN;
use super::{Fault, ProblemError, SourceFile};

impl Diagnostic for Fault {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(Some(self.label()), self.span.clone()))))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        // The file's own text is the error's that holds the fault.
        self.given.as_ref().map(|line| line as &dyn SourceCode)
    }
}

impl ProblemError {
    /// The only fault, which is then drawn as the error itself.
    fn single(&self) -> Option<&Fault> {
        match self.faults() {
            [fault] => Some(fault),
            _ => None,
        }
    }
}

impl Diagnostic for ProblemError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::Read { source, .. } if source.kind() == io::ErrorKind::NotFound => {
                Some(Box::new("`calipose init` writes a problem file to start from"))
            }
            Self::Read { source, .. } if source.kind() == io::ErrorKind::IsADirectory => {
                Some(Box::new("this is a folder; name the problem file in it"))
            }
            Self::Read { .. } => None,
            Self::Encoding { .. } => Some(Box::new("save the file as UTF-8")),
            Self::Invalid { .. } => self.single().and_then(Fault::help),
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.single().and_then(Fault::labels)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        match self {
            Self::Invalid { file, .. } => self.single().and_then(Fault::source_code).or(Some(file)),
            Self::Read { .. } | Self::Encoding { .. } => None,
        }
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        match self.faults() {
            [] | [_] => None,
            faults => Some(Box::new(faults.iter().take(MOST_DRAWN).map(|fault| fault as &dyn Diagnostic))),
        }
    }
}

impl SourceCode for SourceFile {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let part = self.text.read_span(span, lines_before, lines_after)?;
        let (line, column, lines) = (part.line(), part.column(), part.line_count());
        let named = MietteSpanContents::new_named(self.name.clone(), part.data(), *part.span(), line, column, lines);
        Ok(Box::new(named))
    }
}
