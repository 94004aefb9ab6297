//! Parameters whose type and keys are those of the law itself.

use std::borrow::Cow;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

/// The keys of a `T` in a scene, in SI units; those with a default may be absent.
///
/// The struct of a law has name, quantity, range and sentence of every parameter, and the schema of scenes is made from it. Only defaults are a
/// scene's own: they are filled in when the scene is resolved.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(transparent, bound = "")]
pub(crate) struct Written<T> {
    pub(crate) keys: Json,
    #[serde(skip)]
    law: PhantomData<fn() -> T>,
}

impl<T> Written<T> {
    /// The text at one key; no text where it is absent.
    pub(crate) fn word(&self, key: &str) -> &str {
        self.keys[key].as_str().unwrap_or_default()
    }
}

impl<T> Default for Written<T> {
    fn default() -> Self {
        Self {
            keys: Json::default(),
            law: PhantomData,
        }
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
