//! Where in the text of a problem file a key stands.

use std::fmt;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

/// The way from the root of a document to a key: `robot.joints[2].a_mm`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct KeyPath(Vec<Segment>);

#[derive(Debug, Clone, PartialEq, Eq)]
enum Segment {
    Key(String),
    Index(usize),
}

impl KeyPath {
    /// The path of a section.
    pub(crate) fn section(name: &str) -> Self {
        Self::default().key(name)
    }

    /// The key `name` below this one.
    pub(crate) fn key(&self, name: &str) -> Self {
        self.then(Segment::Key(name.to_owned()))
    }

    /// Element `index` of this list.
    pub(crate) fn at(&self, index: usize) -> Self {
        self.then(Segment::Index(index))
    }

    /// The names of the keys on the way, indices left out.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|segment| match segment {
            Segment::Key(name) => Some(name.as_str()),
            Segment::Index(_) => None,
        })
    }

    fn then(&self, segment: Segment) -> Self {
        let mut path = self.clone();
        path.0.push(segment);
        path
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Key(name) => write!(f, "{}{name}", if i == 0 { "" } else { "." })?,
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// The text of a problem file with the place of every key and value.
pub(crate) struct Document<'a> {
    text: &'a str,
    /// First byte of every line.
    lines: Vec<usize>,
    root: Spanned<DeTable<'a>>,
}

impl<'a> Document<'a> {
    pub(crate) fn parse(text: &'a str) -> Result<Self, Error> {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(newline, _)| newline + 1)).collect();
        Ok(Self { text, lines, root: DeTable::parse(text)? })
    }

    /// The bytes of the value at `path`, of the key if it is a section; of the nearest key above where the file leaves
    /// it out. And whether the file has it.
    pub(crate) fn locate(&self, path: &KeyPath) -> (Range<usize>, bool) {
        let mut nearest = 0..0;
        let mut children = Children::Table(self.root.get_ref());
        for segment in &path.0 {
            let Some((key, value)) = children.get(segment) else {
                return (nearest, false);
            };
            nearest = key.unwrap_or_else(|| value.span());
            children = Children::of(value.get_ref());
            let header = self.text[value.span()].starts_with("[[");
            if !(header || matches!(children, Children::Table(_))) {
                nearest = value.span();
            }
        }
        (nearest, true)
    }

    /// The path whose key or value stands at exactly `span`.
    pub(crate) fn path_at(&self, span: &Range<usize>) -> KeyPath {
        find(self.root.get_ref(), &KeyPath::default(), span).unwrap_or_default()
    }

    /// Line and column of a byte, both from 1; columns count characters.
    pub(crate) fn line_and_column(&self, byte: usize) -> (usize, usize) {
        let line = self.lines.partition_point(|&start| start <= byte);
        let start = self.lines.get(line.saturating_sub(1)).copied().unwrap_or_default();
        (line, self.text.get(start..byte).unwrap_or_default().chars().count() + 1)
    }
}

/// Line and column of a byte of `text`, both from 1; columns count characters.
pub(crate) fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// What may stand below a value.
enum Children<'d, 'a> {
    Table(&'d DeTable<'a>),
    List(&'d [Spanned<DeValue<'a>>]),
    None,
}

impl<'d, 'a> Children<'d, 'a> {
    fn of(value: &'d DeValue<'a>) -> Self {
        match value {
            DeValue::Table(table) => Self::Table(table),
            DeValue::Array(list) => Self::List(list),
            _ => Self::None,
        }
    }

    /// The value below, with the bytes of its key if it has one.
    fn get(&self, segment: &Segment) -> Option<(Option<Range<usize>>, &'d Spanned<DeValue<'a>>)> {
        match (self, segment) {
            (Self::Table(table), Segment::Key(name)) => {
                let (key, value) = table.iter().find(|(key, _)| key.get_ref() == name.as_str())?;
                Some((Some(key.span()), value))
            }
            (Self::List(list), Segment::Index(index)) => Some((None, list.get(*index)?)),
            _ => None,
        }
    }
}

fn find(table: &DeTable, above: &KeyPath, span: &Range<usize>) -> Option<KeyPath> {
    table.iter().find_map(|(key, value)| {
        let path = above.key(key.get_ref());
        find_below(value, &path, span).or_else(|| (key.span() == *span || value.span() == *span).then(|| path.clone()))
    })
}

fn find_below(value: &Spanned<DeValue>, path: &KeyPath, span: &Range<usize>) -> Option<KeyPath> {
    match value.get_ref() {
        DeValue::Table(table) => find(table, path, span),
        DeValue::Array(list) => list.iter().enumerate().find_map(|(i, element)| {
            let path = path.at(i);
            find_below(element, &path, span).or_else(|| (element.span() == *span).then(|| path.clone()))
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"ä\"\n[robot]\nflange = { position_mm = [1, 2, 3] }\n[[robot.joints]]\na_mm = 7\n[[robot.joints]]\nb = 8\n";

    fn at(path: &KeyPath) -> &str {
        &TEXT[Document::parse(TEXT).unwrap().locate(path).0]
    }

    #[test]
    fn values_are_found_and_missing_ones_fall_back_to_the_key_above() {
        let robot = KeyPath::section("robot");
        let joints = robot.key("joints");
        assert_eq!(at(&joints.at(0).key("a_mm")), "7");
        assert_eq!(at(&robot.key("flange").key("position_mm").at(1)), "2");
        assert_eq!(at(&robot.key("flange").key("rpy_deg")), "flange");
        assert_eq!(at(&joints.at(1).key("a_mm")), "[[robot.joints]]");
        assert_eq!(at(&KeyPath::section("camera")), "");
        assert_eq!(at(&robot), "robot");
        assert_eq!(at(&robot.key("flange").key("position_mm")), "[1, 2, 3]");
        assert_eq!(at(&joints), "joints");
    }

    #[test]
    fn paths_are_found_by_place() {
        let document = Document::parse(TEXT).unwrap();
        let path = KeyPath::section("robot").key("joints").at(1).key("b");
        let (value, written) = document.locate(&path);
        assert!(written && !document.locate(&path.key("c")).1);
        assert_eq!(document.path_at(&value), path);
        assert_eq!(path.to_string(), "robot.joints[1].b");
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(line_and_column(TEXT, TEXT.find("\n[").unwrap()), (1, 11));
        assert_eq!(line_and_column("", 0), (1, 1));
    }
}
