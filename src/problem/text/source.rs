//! What a problem is read from: a file's text, and values given in place of the file's.

use std::ops::Range;

use toml::de::Error;

use super::overrides::{Override, Overrides};

/// A problem file's text and below it a line for each value given in its place, so that every value has its bytes.
pub(crate) struct Source {
    pub(super) text: String,
    /// Bytes of the file.
    file: usize,
    /// The lines below it, and their keys and values.
    pub(super) overrides: Vec<(Range<usize>, Override)>,
}

impl Source {
    pub(crate) fn new(file: &str, overrides: &Overrides) -> Self {
        let mut source = Self { text: file.to_owned(), file: file.len(), overrides: Vec::new() };
        for given in overrides.iter() {
            source.text.push('\n');
            let start = source.text.len();
            source.text += &given.to_string();
            source.overrides.push((start..source.text.len(), given.clone()));
        }
        source
    }

    /// The file's own text.
    pub(crate) fn file(&self) -> &str {
        &self.text[..self.file]
    }

    /// Where the bytes are.
    pub(super) fn place(&self, span: &Range<usize>) -> Place {
        let Some(line) = self.line_below(span.start) else {
            let (line, column) = line_and_column(self.file(), span.start);
            return Place { given: None, span: span.clone(), line, column };
        };
        let text = &self.text[line.clone()];
        let span = span.start - line.start..span.end.min(line.end) - line.start;
        let (line, column) = line_and_column(text, span.start);
        Place { given: Some(text.to_owned()), span, line, column }
    }

    /// The line below the file that holds the byte.
    fn line_below(&self, byte: usize) -> Option<Range<usize>> {
        self.overrides.iter().map(|(line, _)| line).find(|line| line.start <= byte && byte <= line.end).cloned()
    }
}

/// Where something stands.
pub(crate) struct Place {
    /// The line that gives a value in place of the file's; none if the place is in the file.
    pub(crate) given: Option<String>,
    /// Bytes of the file or of that line.
    pub(crate) span: Range<usize>,
    /// From 1.
    pub(crate) line: usize,
    /// From 1, in characters.
    pub(crate) column: usize,
}

/// Why a source is no document.
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

/// Line and column of a byte of `text`, both from 1; columns count characters.
fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let text = "name = \"ä\"\n[robot]\n";
        assert_eq!(line_and_column(text, text.find("\n[").unwrap()), (1, 11));
        assert_eq!(line_and_column("", 0), (1, 1));
    }
}
