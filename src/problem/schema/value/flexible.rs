//! Values of the problem file that may be written in more than one way.
//!
//! Written by hand rather than as untagged enums, whose errors name neither what was found nor what is allowed.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// A list of exactly `N` numbers. Serde's own arrays take longer lists without a word.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

/// `[min, max]`.
pub(crate) type Range = Numbers<2>;

/// `8` or `[8, 4, 8]`.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub(crate) enum NumberOrList {
    Number(f64),
    List(Vec<f64>),
}

/// `[0, 90]` or `{ reference = [0, 90], telemetry = [1, 89] }`.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub(crate) enum RangeOrSets {
    Range(Range),
    Sets(BTreeMap<String, Range>),
}

/// `"name"` or `{ … }`.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub(crate) enum TextOrTable<S, T> {
    Text(S),
    Table(T),
}

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Shape<const N: usize>;
        impl<'de, const N: usize> Visitor<'de> for Shape<N> {
            type Value = Numbers<N>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "a list of {N} numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                let list = Vec::deserialize(SeqAccessDeserializer::new(list))?;
                let numbers = list.try_into().map_err(|list: Vec<f64>| Error::invalid_length(list.len(), &self))?;
                Ok(Numbers(numbers))
            }
        }
        deserializer.deserialize_seq(Shape)
    }
}

impl<const N: usize> Serialize for Numbers<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0)
    }
}

impl<const N: usize> JsonSchema for Numbers<N> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Numbers{N}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": N, "maxItems": N })
    }
}

impl<const N: usize> Default for Numbers<N> {
    fn default() -> Self {
        Self([0.0; N])
    }
}

impl<'de> Deserialize<'de> for NumberOrList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Shape;
        impl<'de> Visitor<'de> for Shape {
            type Value = NumberOrList;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or a list of numbers")
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
                Ok(NumberOrList::Number(number as f64))
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
                Ok(NumberOrList::Number(number))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(NumberOrList::List)
            }
        }
        deserializer.deserialize_any(Shape)
    }
}

impl<'de> Deserialize<'de> for RangeOrSets {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Shape;
        impl<'de> Visitor<'de> for Shape {
            type Value = RangeOrSets;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("[min, max] or a table of such ranges")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, range: A) -> Result<Self::Value, A::Error> {
                Range::deserialize(SeqAccessDeserializer::new(range)).map(RangeOrSets::Range)
            }

            fn visit_map<A: MapAccess<'de>>(self, sets: A) -> Result<Self::Value, A::Error> {
                BTreeMap::deserialize(MapAccessDeserializer::new(sets)).map(RangeOrSets::Sets)
            }
        }
        deserializer.deserialize_any(Shape)
    }
}

impl<'de, S: Deserialize<'de>, T: Deserialize<'de>> Deserialize<'de> for TextOrTable<S, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Shape<S, T>(PhantomData<(S, T)>);
        impl<'de, S: Deserialize<'de>, T: Deserialize<'de>> Visitor<'de> for Shape<S, T> {
            type Value = TextOrTable<S, T>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a name or a table")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                S::deserialize(StrDeserializer::new(text)).map(TextOrTable::Text)
            }

            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<Self::Value, A::Error> {
                T::deserialize(MapAccessDeserializer::new(table)).map(TextOrTable::Table)
            }
        }
        deserializer.deserialize_any(Shape(PhantomData))
    }
}

impl JsonSchema for NumberOrList {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "NumberOrList".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "number" },
            { "type": "array", "items": { "type": "number" } },
        ] })
    }
}

impl JsonSchema for RangeOrSets {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "RangeOrSets".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let range = generator.subschema_for::<Range>();
        json_schema!({ "anyOf": [range, { "type": "object", "additionalProperties": range }] })
    }
}

impl<S: JsonSchema, T: JsonSchema> JsonSchema for TextOrTable<S, T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "TextOrTable".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (text, table) = (generator.subschema_for::<S>(), generator.subschema_for::<T>());
        json_schema!({ "anyOf": [text, table] })
    }
}
