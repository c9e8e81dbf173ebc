//! What a plan says beside what is proven of it.

use serde_json::Value;

use crate::plan::document::Plan;

/// A field of a plan that is not checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unchecked {
    /// Its key, with those above it, as in `search.nodes`.
    pub field: String,
    /// Why not.
    pub reason: &'static str,
}

/// What made the plan: nothing depends on it.
pub(crate) const MADE_BY: &str =
    "names the version that made the plan; what is proven about the plan does not depend on it";
/// What a search says of itself.
pub(crate) const EFFORT: &str = "describes the effort of a search, which only the search can reproduce";
/// What is not claimed.
pub(crate) const UNBOUNDED: &str = "is left out; nothing is claimed of poses at other joint values";
/// What a search for the best order claims.
pub(crate) const ORDERED: &str = "was proven by a search for the best order, which only `calipose plan` can repeat";
/// What a search for a shorter tour claims.
pub(crate) const TRADED: &str =
    "was found or proven by a search among sets of poses, which only `calipose plan` can repeat";
/// What a search for ways claims.
pub(crate) const LED: &str =
    "names views that no safe way was found to, by a search which only `calipose plan` can repeat";
/// What may as well be otherwise.
pub(crate) const TIED: &str = "is one of several orders whose moves take the same times";
/// What a search claims.
pub(crate) const BY_SEARCH: &str = "was found by search, which only `calipose plan` can repeat; the matrix proves less";

impl Unchecked {
    pub(crate) fn all(fields: &[&str], reason: &'static str) -> Vec<Self> {
        fields.iter().map(|&field| Self { field: field.into(), reason }).collect()
    }

    /// Fields of `text`, the content of a `plan.json`, that this program does not know.
    pub fn unknown(text: &str, plan: &Plan) -> Vec<Self> {
        fn walk(path: &str, text: &Value, known: &Value, unknown: &mut Vec<Unchecked>) {
            match (text, known) {
                (Value::Object(text), Value::Object(known)) => {
                    for (key, value) in text {
                        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                        match known.get(key) {
                            Some(known) => walk(&path, value, known, unknown),
                            None if value.is_null() => {}
                            None => {
                                unknown.extend(Unchecked::all(&[&path], "is not known to this version of calipose"));
                            }
                        }
                    }
                }
                (Value::Array(text), Value::Array(known)) => {
                    for (i, (text, known)) in text.iter().zip(known).enumerate() {
                        walk(&format!("{path}[{i}]"), text, known, unknown);
                    }
                }
                _ => {}
            }
        }
        let mut unknown = Vec::new();
        if let (Ok(text), Ok(known)) = (serde_json::from_str(text), serde_json::to_value(plan)) {
            walk("", &text, &known, &mut unknown);
        }
        unknown
    }
}
