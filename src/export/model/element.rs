//! XML as it is written: elements with attributes, one a line, indented.

use crate::export::text::wrapped;

/// Characters of a comment's line.
const WIDTH: usize = 100;

/// An element, and what it holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    content: Content,
}

#[derive(Debug, Clone, PartialEq)]
enum Content {
    Children(Vec<Element>),
    Text(String),
}

impl Element {
    /// An element that holds nothing.
    pub(super) fn new(tag: &'static str) -> Self {
        Self { tag, attributes: Vec::new(), content: Content::Children(Vec::new()) }
    }

    /// An element that holds text.
    pub(super) fn text(tag: &'static str, text: impl Into<String>) -> Self {
        Self { tag, attributes: Vec::new(), content: Content::Text(text.into()) }
    }

    /// The element with one more attribute.
    #[must_use]
    pub(super) fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    /// The element with one more child.
    #[must_use]
    pub(super) fn holding(self, child: Self) -> Self {
        self.holding_all([child])
    }

    /// The element with more children.
    #[must_use]
    pub(super) fn holding_all(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        self.extend(children);
        self
    }

    /// Adds children; an element that holds text takes none.
    pub(super) fn extend(&mut self, children: impl IntoIterator<Item = Self>) {
        if let Content::Children(own) = &mut self.content {
            own.extend(children);
        }
    }

    /// The document of this element, with comments before it.
    pub(super) fn document(&self, sentences: &[String]) -> String {
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
        // Two hyphens end a comment.
        for line in sentences.iter().flat_map(|sentence| wrapped(&sentence.replace("--", "\u{2010}\u{2010}"), WIDTH)) {
            text += &format!("<!-- {line} -->\n");
        }
        self.write(0, &mut text);
        text
    }

    fn write(&self, depth: usize, text: &mut String) {
        let Self { tag, attributes, content } = self;
        let indent = "  ".repeat(depth);
        let attributes: String =
            attributes.iter().map(|(name, value)| format!(" {name}=\"{}\"", escaped(value))).collect();
        *text += &format!("{indent}<{tag}{attributes}");
        match content {
            Content::Text(inside) => *text += &format!(">{}</{tag}>\n", escaped(inside)),
            Content::Children(children) if children.is_empty() => *text += "/>\n",
            Content::Children(children) => {
                *text += ">\n";
                for child in children {
                    child.write(depth + 1, text);
                }
                *text += &format!("{indent}</{tag}>\n");
            }
        }
    }
}

/// `text` between quotes or tags; what XML cannot hold is a replacement character.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\t' | '\n' | '\r' => escaped += &format!("&#{};", u32::from(c)),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_breaks_out_of_quotes_tags_and_comments() {
        let odd = "a \"b\" <c> & 'd'\n\té日\u{7f}";
        let safe = "a &quot;b&quot; &lt;c&gt; &amp; 'd'&#10;&#9;é日\u{7f}";
        assert_eq!(escaped(odd), safe);
        assert_eq!(escaped("\0\u{1b}"), "\u{fffd}\u{fffd}");
        let text = Element::text("a", odd).with("b", odd).document(&["a --> b ---".to_owned(), "--".to_owned()]);
        assert!(text.ends_with(&format!("<a b=\"{safe}\">{safe}</a>\n")), "{text}");
        let comments = text.lines().filter(|line| line.starts_with("<!--"));
        let inside: Vec<&str> = comments.map(|line| &line[4..line.len() - 3]).collect();
        assert!(
            inside.len() == 2 && inside.iter().all(|inside| !inside.contains("--") && !inside.ends_with('-')),
            "{text}"
        );
    }

    #[test]
    fn elements_are_indented() {
        let text = Element::new("a").holding(Element::new("b").with("c", "1")).document(&[]);
        assert_eq!(text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a>\n  <b c=\"1\"/>\n</a>\n");
    }
}
