//! XML, parsed in time that grows with the text alone.

use roxmltree::{Document, Error};
use thiserror::Error as ThisError;

/// Most attributes of one element. The parser compares each with all before it.
const MOST_ATTRIBUTES: usize = 1000;

/// Why a text is not XML that is read.
#[derive(Debug, ThisError)]
pub(super) enum XmlError {
    /// The parser refuses it.
    #[error("{}", without_place(&.0.to_string()))]
    Syntax(#[from] Error),
    /// An element is no part of a robot or a mesh.
    #[error("an element has more than {MOST_ATTRIBUTES} attributes")]
    Attributes {
        /// Line, from 1, in which the limit is passed.
        line: usize,
    },
}

impl XmlError {
    /// Line, from 1.
    pub(super) fn line(&self) -> usize {
        match self {
            Self::Syntax(error) => error.pos().row as usize,
            Self::Attributes { line } => *line,
        }
    }
}

/// The document of `text`.
///
/// # Errors
/// When the text is not XML, or an element has thousands of attributes.
pub(super) fn parse(text: &str) -> Result<Document<'_>, XmlError> {
    if let Some(byte) = crowded(text.as_bytes()) {
        let line = text[..byte].lines().count();
        return Err(XmlError::Attributes { line });
    }
    Ok(Document::parse(text)?)
}

/// Where an element has more attributes than allowed: the equals signs between `<` and `>`, outside of quotes.
fn crowded(text: &[u8]) -> Option<usize> {
    let (mut quote, mut in_tag, mut attributes) = (None, false, 0);
    let mut i = 0;
    while i < text.len() {
        let byte = text[i];
        match (quote, byte) {
            (Some(open), _) => quote = Some(open).filter(|&open| open != byte),
            (None, b'<') => {
                // What comments and the like hold are no attributes, and their quotes need not match.
                let skipped = [(&b"<!--"[..], &b"-->"[..]), (b"<![CDATA[", b"]]>"), (b"<?", b"?>")];
                if let Some((_, end)) = skipped.into_iter().find(|(start, _)| text[i..].starts_with(start)) {
                    // An end that is missing is the parser's to tell.
                    i += text[i..].windows(end.len()).position(|window| window == end)? + end.len();
                    continue;
                }
                (in_tag, attributes) = (true, 0);
            }
            (None, b'>') => in_tag = false,
            (None, b'"' | b'\'') if in_tag => quote = Some(byte),
            (None, b'=') if in_tag => {
                attributes += 1;
                if attributes > MOST_ATTRIBUTES {
                    return Some(i);
                }
            }
            _ => {}
        }
        i += 1;
    }
    None
}

/// The parser's message without the line and column at its end; the line is told apart.
fn without_place(message: &str) -> String {
    message.rsplit_once(" at ").map_or(message, |(what, _)| what).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(attributes: usize) -> String {
        let attributes: String = (0..attributes).map(|i| format!(" a{i}='>=\"'")).collect();
        format!("<?x a=\"?><!-- ' = -->\n<a b='1'>'=\"=\n<b{attributes}/>{}</a>", "=".repeat(2000))
    }

    #[test]
    fn attributes_are_counted_element_by_element() {
        assert!(parse(&element(MOST_ATTRIBUTES)).is_ok());
        let error = parse(&element(MOST_ATTRIBUTES + 1)).unwrap_err();
        assert_eq!((error.line(), error.to_string().as_str()), (3, "an element has more than 1000 attributes"));
        assert_eq!(parse("<a>\n</b>").unwrap_err().to_string(), "expected 'a' tag, not 'b'");
    }
}
