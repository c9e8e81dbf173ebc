//! The JSON Schema of problem files, and what it says about a key.

use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

use super::file::File;

/// The JSON Schema of problem files, for editors.
pub fn schema_json() -> Value {
    toml_schema::<File>()
}

/// The JSON Schema of TOML files that are read as `T`.
pub(crate) fn toml_schema<T: JsonSchema>() -> Value {
    // The draft that TOML editors know.
    let settings = SchemaSettings::draft07().with_transform(RecursiveTransform(adapt_to_toml));
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// TOML has no null: a key that may be left out is simply not required. Descriptions lose their source's line breaks.
fn adapt_to_toml(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
    if let Some(types) = schema.get_mut("type")
        && let Some(list) = types.as_array_mut()
    {
        list.retain(|name| name != "null");
        if let [only] = &list[..] {
            *types = only.clone();
        }
    }
    if let Some(Value::Array(names)) = schema.get_mut("enum") {
        names.retain(|name| !name.is_null());
    }
    if let Some(Value::Object(keys)) = schema.get_mut("default") {
        keys.retain(|_, value| !value.is_null());
    }
    if schema.get("default").is_some_and(|default| default.is_null() || *default == json!({})) {
        schema.remove("default");
    }
    if let Some(options) = schema.get_mut("anyOf").and_then(Value::as_array_mut) {
        options.retain(|option| *option != json!({ "type": "null" }));
        if let [Value::Object(only)] = &options[..] {
            let only = only.clone();
            schema.remove("anyOf");
            if only.contains_key("$ref") {
                // Draft 7 ignores whatever stands beside a bare reference.
                schema.insert("allOf".into(), json!([only]));
            } else {
                schema.ensure_object().extend(only);
            }
        }
    }
}

/// What the schema of a kind of file says about its keys, for messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vocabulary {
    root: &'static Value,
}

impl Vocabulary {
    /// Of files that `schema` describes.
    pub(crate) fn new(schema: &'static Value) -> Self {
        Self { root: schema }
    }

    /// Of problem files.
    pub(crate) fn of_problems() -> Self {
        /// Made once: a file may have many faults.
        static ROOT: LazyLock<Value> = LazyLock::new(schema_json);
        Self::new(&ROOT)
    }

    /// What the key at the end of this way means: its description in the schema. Names that the file makes up below it, of sets of
    /// limits, share it.
    pub(crate) fn meaning<'k>(self, keys: impl Iterator<Item = &'k str>) -> Option<String> {
        Some(self.node(keys)?.get("description")?.as_str()?.to_owned())
    }

    /// The least and the greatest value of the whole number at the end of this way, where the schema has them.
    pub(crate) fn bounds<'k>(self, keys: impl Iterator<Item = &'k str>) -> (Option<u64>, Option<u64>) {
        let node = self.node(keys);
        let bound = |name: &str| node?.get(name)?.as_u64();
        (bound("minimum"), bound("maximum"))
    }

    /// The part of the schema that describes the key at the end of this way, or the nearest key above that is described.
    fn node<'k>(self, keys: impl Iterator<Item = &'k str>) -> Option<&'static Value> {
        let mut node = self.root;
        for key in keys {
            let Some(properties) = object_below(self.root, node).get("properties") else { break };
            node = properties.get(key)?;
        }
        Some(node)
    }
}

/// The object that `node` refers to, is a list of, or may be.
fn object_below<'s>(root: &'s Value, node: &'s Value) -> &'s Value {
    let referred = node.get("$ref").and_then(Value::as_str).and_then(|name| root.pointer(name.trim_start_matches('#')));
    let either = || {
        let options = node.get("anyOf").or_else(|| node.get("allOf"))?;
        options.as_array()?.iter().find(|option| option.get("$ref").is_some())
    };
    match referred.or_else(|| node.get("items")).or_else(either) {
        Some(below) => object_below(root, below),
        None => node,
    }
}
