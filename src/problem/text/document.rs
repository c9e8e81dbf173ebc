//! Where in the text of a file a key stands.

use std::ops::Range;

use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error};

use super::merge;
use super::overrides::Overrides;
use super::path::{KeyPath, Segment};
use super::source::{Place, Source, Unreadable};
use crate::problem::schema::Vocabulary;

/// A file with the place of every key and value, those given in place of the file's among them.
pub(crate) struct Document<'a> {
    source: &'a Source,
    root: Spanned<DeTable<'a>>,
    /// What its keys mean.
    pub(super) words: Vocabulary,
    /// The values given in place of the file's that say anything else.
    pub(crate) overrides: Overrides,
}

impl<'a> Document<'a> {
    /// # Errors
    /// When the file is not TOML, or a value has no place in it.
    pub(crate) fn parse(source: &'a Source, words: Vocabulary) -> Result<Self, Unreadable> {
        let mut root = DeTable::parse(source.file())?;
        let mut overrides = Overrides::new();
        for (line, given) in &source.overrides {
            if merge::put(root.get_mut(), given, &source.text, line)? {
                overrides.push(given.clone());
            }
        }
        Ok(Self { source, root, words, overrides })
    }

    /// What the document says, as `T`.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, Error> {
        T::deserialize(Deserializer::from(self.root.clone()))
    }

    /// SHA-256 of the file's bytes, in lower-case hexadecimal.
    pub(crate) fn sha256(&self) -> String {
        Sha256::digest(self.source.file()).iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"))
    }

    /// Where the bytes are.
    pub(crate) fn place(&self, span: &Range<usize>) -> Place {
        self.source.place(span)
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
            let header = self.source.text[value.span()].starts_with("[[");
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
    use crate::problem::Overrides;

    const TEXT: &str = "name = \"ä\"\n[robot]\nflange = { position_mm = [1, 2, 3] }\n[[robot.joints]]\na_mm = 7\n[[robot.joints]]\nb = 8\n";

    fn source() -> Source {
        Source::new(TEXT, &Overrides::new())
    }

    fn at(path: &KeyPath) -> &str {
        &TEXT[Document::parse(&source(), Vocabulary::of_problems()).unwrap().locate(path).0]
    }

    #[test]
    fn values_are_found_and_missing_ones_fall_back_to_the_key_above() {
        let robot = KeyPath::default().key("robot");
        let joints = robot.key("joints");
        assert_eq!(at(&joints.at(0).key("a_mm")), "7");
        assert_eq!(at(&robot.key("flange").key("position_mm").at(1)), "2");
        assert_eq!(at(&robot.key("flange").key("rpy_deg")), "flange");
        assert_eq!(at(&joints.at(1).key("a_mm")), "[[robot.joints]]");
        assert_eq!(at(&KeyPath::default().key("camera")), "");
        assert_eq!(at(&robot), "robot");
        assert_eq!(at(&robot.key("flange").key("position_mm")), "[1, 2, 3]");
        assert_eq!(at(&joints), "joints");
    }

    #[test]
    fn paths_are_found_by_place() {
        let source = source();
        let document = Document::parse(&source, Vocabulary::of_problems()).unwrap();
        let path = KeyPath::default().key("robot").key("joints").at(1).key("b");
        let (value, written) = document.locate(&path);
        assert!(written && !document.locate(&path.key("c")).1);
        assert_eq!(document.path_at(&value), path);
        assert_eq!(path.to_string(), "robot.joints[1].b");
    }
}
