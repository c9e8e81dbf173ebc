//! What stands first in every document.

use schemars::JsonSchema;
use serde::de::{Deserializer, Error};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use crate::problem::{OverrideError, Overrides, Problem};

/// A document that leaves the program.
pub trait Document: Serialize + JsonSchema {
    /// Value of its key `format`: `calipose.` and what it is.
    const FORMAT: &'static str;

    /// Value of its key `version`; rises when a reader of the older version would misread the document.
    const VERSION: u32;

    /// The header of a document that this program makes.
    fn header() -> Header {
        Header { format: Self::FORMAT.into(), version: Self::VERSION, calipose: env!("CARGO_PKG_VERSION").into() }
    }

    /// The document as it is printed and written: JSON over several lines, the last one ended.
    fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// The document on one line, as other files hold it.
    fn to_line(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// What a document is and what made it. The problem that it is about follows under `problem`, in all that are about one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Header {
    /// What the document is.
    pub format: String,
    /// Version of its format; rises when a reader of the older version would misread the document.
    pub version: u32,
    /// Version of calipose that made it.
    pub calipose: String,
}

/// The problem file that a document is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ProblemReference {
    /// Its name.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Values given in place of the file's, `KEY = VALUE` each.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub set: Vec<String>,
}

impl ProblemReference {
    /// The reference to `problem`.
    pub fn new(problem: &Problem) -> Self {
        Self { name: problem.name.clone(), sha256: problem.sha256.clone(), set: problem.overrides.of_results() }
    }

    /// The values given in place of the file's.
    ///
    /// # Errors
    /// When one is no `KEY = VALUE`.
    pub fn overrides(&self) -> Result<Overrides, OverrideError> {
        self.set.iter().try_fold(Overrides::new(), |overrides, text| overrides.set(text))
    }
}

/// A number as JSON can say it: `null` where it is infinite or undefined.
pub(crate) fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

/// An object with the numbers under their names, in this order.
pub(crate) fn by_name<S: Serializer>(numbers: &[(String, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut object = serializer.serialize_map(Some(numbers.len()))?;
    for (name, number) in numbers {
        object.serialize_entry(name, number)?;
    }
    object.end()
}

/// The numbers of an object, by their names.
pub(crate) fn from_names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<(String, f64)>, D::Error> {
    let object = serde_json::Map::deserialize(deserializer)?;
    let number = |(name, value): (String, serde_json::Value)| match value.as_f64() {
        Some(number) => Ok((name, number)),
        None => Err(D::Error::custom(format!("the sigma of {name} is no number"))),
    };
    object.into_iter().map(number).collect()
}
