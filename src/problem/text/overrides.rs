//! Values given in place of those of a problem file.

use std::fmt;

use thiserror::Error;
use toml::de::DeValue;

use super::path::KeyPath;

/// Values in place of those of a problem file, by the dotted paths of their keys, in the order given; of two for one key the
/// later holds.
///
/// They join the file's before anything is checked, so that the same rules hold for both. A key that the file leaves out is
/// added. Where one key excludes another, as `sweep.sample` and `sweep.step_deg`, or `selection.accuracy` and
/// `selection.criterion`, the one given here takes the place of the file's.
///
/// ```
/// use calipose::problem::{Overrides, Problem};
///
/// let overrides = Overrides::new().set("camera.fx_px=900")?.set("robot.joints[1].limits_deg = [0, 45]")?;
/// let problem = Problem::read_with("problems/servosila-engineer.toml".as_ref(), &overrides)?;
/// assert_eq!(problem.camera.intrinsics()[0], 900.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overrides(Vec<Override>);

/// One of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Override {
    pub(super) path: KeyPath,
    /// As TOML.
    pub(super) value: String,
}

/// Why a text gives no key another value.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum OverrideError {
    /// There is no `=`, or nothing on one side of it.
    #[error("\"{text}\" is not KEY=VALUE, as in camera.fx_px=900")]
    Form {
        /// The text.
        text: String,
    },
    /// The key is no dotted path.
    #[error("\"{key}\" is not a path of keys, as in robot.joints[1].limits_deg")]
    Key {
        /// What stands before `=`.
        key: String,
    },
    /// The value is not TOML.
    #[error("the value of {key} cannot be read: {message}")]
    Value {
        /// The key.
        key: String,
        /// What the parser says.
        message: String,
    },
}

impl Overrides {
    /// None.
    pub fn new() -> Self {
        Self::default()
    }

    /// These and `text`, `KEY=VALUE`: the key from the file's root, `robot.joints[1].limits_deg` (elements count from 0), the value
    /// as TOML; the quotes of a text without spaces may be left out.
    ///
    /// # Errors
    /// When the text is of another form. Whether there is such a key, and may have the value, is found with all else when the
    /// problem is read.
    pub fn set(mut self, text: &str) -> Result<Self, OverrideError> {
        let (key, value) = text
            .split_once('=')
            .map(|(key, value)| (key.trim(), value.trim()))
            .filter(|(key, value)| !key.is_empty() && !value.is_empty())
            .ok_or_else(|| OverrideError::Form { text: text.to_owned() })?;
        let path = KeyPath::parse(key).ok_or_else(|| OverrideError::Key { key: key.to_owned() })?;
        let value = match DeValue::parse(value) {
            Ok(_) if !value.contains('\n') => value.to_owned(),
            _ if value.chars().all(is_of_bare_text) => format!("\"{value}\""),
            Ok(_) => return Err(OverrideError::Value { key: key.to_owned(), message: "it has several lines".into() }),
            Err(error) => {
                return Err(OverrideError::Value { key: key.to_owned(), message: error.message().to_owned() });
            }
        };
        self.0.push(Override { path, value });
        Ok(self)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Each as [`Overrides::set`] takes it, without those that only say where results go.
    pub fn of_results(&self) -> Vec<String> {
        let counts = |one: &&Override| one.path.keys().next() != Some("output");
        self.0.iter().filter(counts).map(Override::to_string).collect()
    }

    pub(super) fn push(&mut self, given: Override) {
        self.0.push(given);
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Override> {
        self.0.iter()
    }
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} = {}", self.path, self.value)
    }
}

/// Characters of a text that needs no quotes: names, paths and files.
fn is_of_bare_text(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | '/' | '~' | ':' | '@' | '+')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_toml_or_bare_text() {
        let overrides = Overrides::new()
            .set("a.b=1.5")
            .and_then(|o| o.set("c = d"))
            .and_then(|o| o.set("robot.joints[2].name=\"x y\""))
            .and_then(|o| o.set("e={ f = [1, 2] }"))
            .and_then(|o| o.set("output.folder=../plans/x"))
            .unwrap();
        assert_eq!(
            overrides.of_results(),
            ["a.b = 1.5", "c = \"d\"", "robot.joints[2].name = \"x y\"", "e = { f = [1, 2] }"]
        );
    }

    #[test]
    fn other_forms_are_refused() {
        let refused = |text: &str| Overrides::new().set(text).unwrap_err();
        for text in ["a", "=1", "a=", ""] {
            assert_eq!(refused(text), OverrideError::Form { text: text.into() });
        }
        for key in ["a..b", ".a", "a[", "a[x]", "[0]", "a b"] {
            assert_eq!(refused(&format!("{key}=1")), OverrideError::Key { key: key.into() });
        }
        assert!(matches!(refused("a=[1"), OverrideError::Value { .. }));
        assert!(matches!(refused("a=two words"), OverrideError::Value { .. }));
    }
}
