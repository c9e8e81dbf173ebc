//! The problem file of a set-up: the base's text, with the set-up's values in it.

use std::path::Path;

use toml_edit::{DocumentMut, Item, Value};

use super::{Codesign, Place};
use crate::problem::{excluded_by, relative};

/// Keys that name files or folders, which are relative to the problem file's own.
const PATHS: [[&str; 2]; 4] = [["robot", "urdf"], ["robot", "srdf"], ["robot", "package_folders"], ["camera", "file"]];

impl Codesign {
    /// The text of the problem file of a set-up, to stand in `folder`: comments and order are the base's, and so is all that is not
    /// set.
    pub(super) fn problem_file(&self, place: &Place, folder: &Path) -> String {
        // The base was read before.
        let mut document: DocumentMut = self.base.text.parse().unwrap_or_default();
        let from = self.base.path.parent().unwrap_or(Path::new(""));
        for [section, key] in PATHS {
            if let Some(item) = document.get_mut(section).and_then(|section| section.get_mut(key)) {
                move_paths(item, from, folder);
            }
        }
        for text in self.set.iter().chain(place.levels.iter().flat_map(|level| &level.set)) {
            if let Some((key, value)) = text.split_once('=') {
                for excluded in excluded_by(key.trim()) {
                    remove(document.as_item_mut(), excluded);
                }
                put(document.as_item_mut(), key.trim(), value.trim());
            }
        }
        format!(
            "# The set-up that `calipose design` found best: \"{}\".\n# All else, comments included, is of {}.\n\n{document}",
            self.name,
            self.base.path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default(),
        )
    }
}

/// Paths relative to one folder as relative to another.
fn move_paths(item: &mut Item, from: &Path, to: &Path) {
    let moved = |path: &str| relative(to, &from.join(path));
    if let Some(path) = item.as_str() {
        *item = toml_edit::value(moved(path));
    } else if let Some(list) = item.as_array_mut() {
        for path in list.iter_mut() {
            if let Some(text) = path.as_str() {
                *path = moved(text).into();
            }
        }
    }
}

/// Puts a value at a path, `target.pose.position_mm[0]`; a section that is not there is added.
fn put(root: &mut Item, path: &str, value: &str) {
    // A text without quotes, as `--set` takes it, is a text.
    let value: Value = value.parse().unwrap_or_else(|_| Value::from(value));
    let (mut item, mut place) = (root, None);
    for part in path.split('.') {
        let (name, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
        let indices = indices.split_terminator(']').filter_map(|index| index.strip_prefix('[')?.parse().ok());
        for step in std::iter::once(Step::Key(name)).chain(indices.map(Step::Element)) {
            if let Some(step) = place.replace(step) {
                item = step.below(item);
            }
        }
    }
    let Some(last) = place else { return };
    match (last.below(item).as_value_mut(), last) {
        // What stands around the value, comments and blanks, stays.
        (Some(old), _) => {
            let decor = old.decor().clone();
            *old = value;
            *old.decor_mut() = decor;
        }
        (None, Step::Key(name)) => {
            if let Some(section) = item.as_table_like_mut() {
                section.remove(name);
                section.insert(name, Item::Value(value));
            }
        }
        (None, Step::Element(_)) => {}
    }
}

/// A step of a path.
#[derive(Clone, Copy)]
enum Step<'p> {
    Key(&'p str),
    Element(usize),
}

impl Step<'_> {
    /// What stands there; nothing yet, where it is a key that is not there.
    fn below(self, item: &mut Item) -> &mut Item {
        match self {
            Self::Key(name) => &mut item[name],
            Self::Element(index) => &mut item[index],
        }
    }
}

/// Removes the key at a path of sections.
fn remove(root: &mut Item, path: &str) {
    let (sections, key) = path.rsplit_once('.').unwrap_or(("", path));
    let section = sections.split('.').try_fold(root, |item, name| item.get_mut(name));
    if let Some(table) = section.and_then(Item::as_table_like_mut) {
        table.remove(key);
    }
}
