//! Parameters whose type and keys are those of the law itself.

use std::borrow::Cow;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value as Json;

/// The keys of a `T` in a scene, in SI units; those with a default may be absent.
///
/// The struct of a law has name, quantity, range and sentence of every parameter, and the schema of scenes is made from it. Only defaults are a
/// scene's own: they are filled in when the scene is resolved.
#[derive(Debug)]
pub(crate) struct Written<T> {
    pub(crate) keys: Json,
    law: PhantomData<fn() -> T>,
}

impl<T> Written<T> {
    /// The text at one key; no text where it is absent.
    pub(crate) fn word(&self, key: &str) -> &str {
        self.keys[key].as_str().unwrap_or_default()
    }
}

impl<T> Clone for Written<T> {
    fn clone(&self) -> Self {
        Self {
            keys: self.keys.clone(),
            law: PhantomData,
        }
    }
}

impl<T> PartialEq for Written<T> {
    fn eq(&self, other: &Self) -> bool {
        self.keys == other.keys
    }
}

impl<'de, T> Deserialize<'de> for Written<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self {
            keys: Json::deserialize(deserializer)?,
            law: PhantomData,
        })
    }
}

impl<T> Serialize for Written<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.keys.serialize(serializer)
    }
}

impl<T: JsonSchema> JsonSchema for Written<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}
