//! Puts a value in its place in a parsed document.

use std::borrow::Cow;
use std::ops::Range;

use serde::Deserialize;
use toml::de::{DeArray, DeTable, DeValue, ValueDeserializer};
use toml::{Spanned, Value};

use super::overrides::Override;
use super::path::{KeyPath, Segment};
use super::source::Unreadable;

/// Keys of which one excludes the others: that which is given in place of the file's removes these.
const INSTEAD: [(&str, &[&str]); 10] = [
    ("sweep.sample", &["sweep.step_deg", "sweep.step_mm"]),
    ("sweep.step_deg", &["sweep.sample"]),
    ("sweep.step_mm", &["sweep.sample"]),
    ("selection.criterion", &["selection.accuracy", "selection.least"]),
    ("selection.accuracy", &["selection.criterion", "selection.count", "selection.method", "selection.time"]),
    ("selection.count", &["selection.time"]),
    ("selection.method", &["selection.time"]),
    (
        "selection.time",
        &["selection.accuracy", "selection.least", "selection.count", "selection.method", "selection.tour_tolerance"],
    ),
    ("target.pose.rpy_deg", &["target.pose.quaternion_xyzw"]),
    ("target.pose.quaternion_xyzw", &["target.pose.rpy_deg"]),
];

/// The keys that give way to `key` where it is given in place of the file's.
pub(crate) fn excluded_by(key: &str) -> impl Iterator<Item = &'static str> + use<'_> {
    // A key below one counts as that one.
    let is_of = move |one: &str| key.strip_prefix(one).is_some_and(|below| below.is_empty() || below.starts_with('.'));
    INSTEAD.iter().filter(move |(one, _)| is_of(one)).flat_map(|(_, others)| *others).copied()
}

/// Puts the value of `given`, which stands in the `line` of `text`, into `root`; whether that says anything else than before.
///
/// # Errors
/// When the way there leads through something that is no section or list, or beyond a list's end.
pub(super) fn put<'t>(
    root: &mut DeTable<'t>,
    given: &Override,
    text: &'t str,
    line: &Range<usize>,
) -> Result<bool, Unreadable> {
    let key = given.path.to_string();
    let mut changes = false;
    for excluded in excluded_by(&key) {
        changes |= remove(root, excluded);
    }
    let start = line.end - given.value.len();
    let mut value = DeValue::parse(&text[start..line.end])?;
    shift(&mut value, start);
    let key = line.start..start - " = ".len();
    let (last, sections) = given.path.0.split_last().ok_or_else(|| refused("is empty", &key))?;
    let mut children = Children::Table(root);
    for (depth, segment) in sections.iter().enumerate() {
        let then_list = matches!(given.path.0[depth + 1], Segment::Index(_));
        let so_far = KeyPath(given.path.0[..=depth].to_vec()).to_string();
        children = children.below(segment, then_list, &(line.start..line.start + so_far.len()))?;
    }
    let after = meaning_of(&value);
    let before = children.put(last, value, &key)?;
    Ok(changes || before.as_ref().map(meaning_of) != Some(after))
}

/// What a value says, wherever it stands.
fn meaning_of(value: &Spanned<DeValue>) -> Option<Value> {
    Value::deserialize(ValueDeserializer::from(value.clone())).ok()
}

/// What a key can be put into.
enum Children<'d, 't> {
    Table(&'d mut DeTable<'t>),
    List(&'d mut DeArray<'t>),
}

impl<'t> Children<'_, 't> {
    /// What stands below `segment`; a section that the file leaves out is added.
    fn below(self, segment: &Segment, then_list: bool, key: &Range<usize>) -> Result<Self, Unreadable> {
        let value = match (self, segment) {
            (Self::Table(table), Segment::Key(name)) => {
                let empty = if then_list { DeValue::Array(DeArray::new()) } else { DeValue::Table(DeTable::new()) };
                let name = Spanned::new(key.clone(), Cow::Owned(name.clone()));
                table.entry(name).or_insert_with(|| Spanned::new(key.clone(), empty))
            }
            (Self::List(list), Segment::Index(index)) => {
                let len = list.len();
                list.get_mut(*index).ok_or_else(|| beyond(*index, len, key))?
            }
            (Self::Table(_), Segment::Index(_)) => return Err(no_list(key)),
            (Self::List(_), Segment::Key(name)) => return Err(no_section(name, key)),
        };
        match value.get_mut() {
            DeValue::Table(table) => Ok(Self::Table(table)),
            DeValue::Array(list) => Ok(Self::List(list)),
            _ => Err(refused("leads through a value that is neither a section nor a list", key)),
        }
    }

    /// What stood there before.
    fn put(
        self,
        segment: &Segment,
        value: Spanned<DeValue<'t>>,
        key: &Range<usize>,
    ) -> Result<Option<Spanned<DeValue<'t>>>, Unreadable> {
        match (self, segment) {
            (Self::Table(table), Segment::Key(name)) => {
                let name = Spanned::new(key.clone(), Cow::Owned(name.clone()));
                // Anew, for the file's key keeps its place otherwise.
                let before = table.remove(&name);
                table.insert(name, value);
                Ok(before)
            }
            (Self::List(list), Segment::Index(index)) => {
                let len = list.len();
                let place = list.get_mut(*index).ok_or_else(|| beyond(*index, len, key))?;
                Ok(Some(std::mem::replace(place, value)))
            }
            (Self::Table(_), Segment::Index(_)) => Err(no_list(key)),
            (Self::List(_), Segment::Key(name)) => Err(no_section(name, key)),
        }
    }
}

fn refused(why: &str, key: &Range<usize>) -> Unreadable {
    Unreadable { message: format!("the key {why}"), span: key.clone() }
}

fn beyond(index: usize, len: usize, key: &Range<usize>) -> Unreadable {
    refused(&format!("asks for element {index} of a list that has {len}; they count from 0"), key)
}

fn no_list(key: &Range<usize>) -> Unreadable {
    refused("asks for an element of a value that is not a list", key)
}

fn no_section(name: &str, key: &Range<usize>) -> Unreadable {
    refused(&format!("asks a list for \"{name}\"; name an element first, as in [0]"), key)
}

/// Moves the bytes of a value and all below it.
fn shift(value: &mut Spanned<DeValue>, by: usize) {
    let span = value.span();
    match value.get_mut() {
        DeValue::Array(list) => list.iter_mut().for_each(|element| shift(element, by)),
        DeValue::Table(table) => {
            let entries = std::mem::take(table).into_iter().map(|(key, mut value)| {
                let span = key.span();
                shift(&mut value, by);
                (Spanned::new(span.start + by..span.end + by, key.into_inner()), value)
            });
            *table = entries.collect();
        }
        _ => {}
    }
    let inner = std::mem::replace(value.get_mut(), DeValue::Boolean(false));
    *value = Spanned::new(span.start + by..span.end + by, inner);
}

/// Removes the key at a dotted path; whether it was there.
fn remove(root: &mut DeTable, path: &str) -> bool {
    let Some(path) = KeyPath::parse(path) else { return false };
    let mut table = root;
    let mut keys = path.keys().peekable();
    while let Some(key) = keys.next() {
        let name = Spanned::new(0..0, Cow::Owned(key.to_owned()));
        if keys.peek().is_none() {
            return table.remove(&name).is_some();
        }
        match table.get_mut(&name).map(Spanned::get_mut) {
            Some(DeValue::Table(below)) => table = below,
            _ => return false,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::schema::Vocabulary;

    #[test]
    fn keys_that_exclude_others_are_of_the_schema() {
        for key in INSTEAD.iter().flat_map(|(one, others)| others.iter().chain([one])) {
            let path = KeyPath::parse(key).unwrap();
            assert!(Vocabulary::of_problems().meaning(path.keys()).is_some(), "{key}");
        }
    }
}
