//! Values of the problem file with the paths of their keys.

use std::collections::BTreeMap;

use super::path::KeyPath;
use crate::problem::schema::Numbers;

/// A value of the problem file with the path of its key, for what may be wrong with it.
#[derive(Debug)]
pub(crate) struct At<'f, T> {
    pub(crate) value: &'f T,
    pub(crate) path: KeyPath,
}

/// The key `$key` of a section, or of one below it: `key!(camera, fx_px)`, `key!(file, camera.fx_px)`. A key is called as its field
/// is, so that the compiler knows both.
macro_rules! key {
    ($section:expr, $($key:ident).+) => {
        $crate::problem::At {
            value: &$section.value.$($key).+,
            path: $section.path$(.key(stringify!($key)))+,
        }
    };
}
pub(crate) use key;

impl<'f, T> At<'f, T> {
    /// The whole file.
    pub(crate) fn root(file: &'f T) -> Self {
        Self { value: file, path: KeyPath::default() }
    }

    /// Another reading of the value, at the same place.
    pub(crate) fn with<'g, U>(&self, value: &'g U) -> At<'g, U> {
        At { value, path: self.path.clone() }
    }
}

impl<'f, T> At<'f, Option<T>> {
    /// The value, unless it is left out.
    pub(crate) fn given(self) -> Option<At<'f, T>> {
        self.value.as_ref().map(|value| At { value, path: self.path })
    }

    /// The value, or `default` where it is left out.
    pub(crate) fn or(self, default: &'f T) -> At<'f, T> {
        At { value: self.value.as_ref().unwrap_or(default), path: self.path }
    }
}

impl<'f, T> At<'f, Vec<T>> {
    /// The elements of the list.
    pub(crate) fn elements(&self) -> impl Iterator<Item = At<'f, T>> {
        self.value.iter().enumerate().map(|(i, value)| At { value, path: self.path.at(i) })
    }
}

impl<'f, T> At<'f, BTreeMap<String, T>> {
    /// The entries of the table, whose names the file makes up.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (&'f String, At<'f, T>)> {
        self.value.iter().map(|(name, value)| (name, At { value, path: self.path.key(name) }))
    }
}

impl<'f, const N: usize> At<'f, Numbers<N>> {
    /// Each of the numbers.
    pub(crate) fn numbers(&self) -> [At<'f, f64>; N] {
        std::array::from_fn(|i| At { value: &self.value.0[i], path: self.path.at(i) })
    }
}

/// A key that may be left out, whatever its value.
pub(crate) trait Optional {
    fn path(&self) -> &KeyPath;
    fn is_given(&self) -> bool;
}

impl<T> Optional for At<'_, Option<T>> {
    fn path(&self) -> &KeyPath {
        &self.path
    }

    fn is_given(&self) -> bool {
        self.value.is_some()
    }
}

impl<T> Optional for At<'_, Vec<T>> {
    fn path(&self) -> &KeyPath {
        &self.path
    }

    fn is_given(&self) -> bool {
        !self.value.is_empty()
    }
}

impl<T> Optional for At<'_, BTreeMap<String, T>> {
    fn path(&self) -> &KeyPath {
        &self.path
    }

    fn is_given(&self) -> bool {
        !self.value.is_empty()
    }
}
