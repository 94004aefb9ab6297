//! Laws from what a scene writes of them: what is absent is filled in, then the law reads itself.

use chaindrive_contact::Lubricant;
use chaindrive_quantities::{JsonSchema, ParameterError};
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::cursor::Cursor;
use crate::scene::defaults;
use crate::scene::format::raw;
use crate::scene::schema::Written;

impl Cursor<'_, '_> {
    /// The keys of a law, completed by the defaults of its type that are values with the unit of the key.
    pub(super) fn completed<T: JsonSchema>(&mut self, text: &Written<T>) -> Json {
        let mut keys = text.keys.clone();
        let kind = keys["kind"].as_str().map(str::to_owned);
        for (key, default) in defaults::of_keys(raw(), &T::schema_name(), kind.as_deref()) {
            if keys.get(key).is_none() {
                keys[key] = self.key(key).or(None::<f64>, default).into();
            }
        }
        keys
    }

    /// Fills in an absent key by what its surroundings know, a value and where it comes from; refused where they know nothing.
    pub(super) fn fill(
        &mut self,
        keys: &mut Json,
        key: &str,
        known: Option<(f64, impl Into<String>)>,
        hint: &str,
    ) -> Option<()> {
        if keys.get(key).is_none() {
            let mut at = self.key(key);
            let Some((value, remark)) = known else {
                at.refuse_once("missing", hint);
                return None;
            };
            at.assume(value, remark);
            keys[key] = value.into();
        }
        Some(())
    }

    /// Fills in an absent `viscosity` by that of the oil.
    pub(super) fn fill_viscosity(
        &mut self,
        keys: &mut Json,
        viscosity: fn(&Lubricant) -> f64,
    ) -> Option<()> {
        if keys.get("viscosity").is_none() {
            keys["viscosity"] = self.key("viscosity").of_oil(viscosity)?.into();
        }
        Some(())
    }

    /// The law whose parameters are all known; `check` is its own.
    pub(super) fn read<T: DeserializeOwned>(
        &mut self,
        keys: Json,
        check: impl FnOnce(&T) -> Result<(), ParameterError>,
    ) -> Option<T> {
        let law = T::deserialize(keys)
            .map_err(|error| self.refuse_once(error.to_string(), ""))
            .ok()?;
        self.sound(check(&law))?;
        Some(law)
    }

    /// Refuses a parameter of a law that several bodies may share, once.
    pub(super) fn sound(&mut self, checked: Result<(), ParameterError>) -> Option<()> {
        let refuse = |error: ParameterError| {
            let message = format!("{}, must be {}", error.value, error.allowed);
            self.key(&error.parameter).refuse_once(message, "");
        };
        checked.map_err(refuse).ok()
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_contact::Friction;
    use serde_json::json;

    use crate::scene::read_friction;

    /// What a law writes of itself is a scene's text.
    #[test]
    fn scenes_know_every_friction() {
        for law in Friction::specimens() {
            assert_eq!(read_friction(&json!(law).to_string()).unwrap(), law);
        }
    }
}
