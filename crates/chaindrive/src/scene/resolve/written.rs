//! Laws from what a scene writes of them: defaults are filled in, then the law reads itself.

use chaindrive_quantities::ParameterError;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::Findings;
use crate::scene::defaults;
use crate::scene::format::raw;

impl Findings<'_> {
    /// The keys at `path`, completed by the defaults of their type in the schema of scenes that are values with the unit of the key.
    pub(super) fn completed(&mut self, mut keys: Json, of_type: &str, path: &str) -> Json {
        let kind = keys["kind"].as_str().map(str::to_owned);
        for (key, default) in defaults::of_keys(raw(), of_type, kind.as_deref()) {
            if keys.get(key).is_none_or(Json::is_null) {
                keys[key] = self
                    .or_default(None, &format!("{path}.{key}"), default)
                    .into();
            }
        }
        keys
    }

    /// The law whose parameters are all known; `check` is its own.
    pub(super) fn read<T: DeserializeOwned>(
        &mut self,
        keys: Json,
        path: &str,
        check: impl FnOnce(&T) -> Result<(), ParameterError>,
    ) -> Option<T> {
        let law = T::deserialize(keys)
            .map_err(|error| self.refuse_once(path, error.to_string(), ""))
            .ok()?;
        let sound = check(&law).map_err(|error| self.refuse_parameter(path, &error));
        sound.ok().map(|()| law)
    }

    /// Refuses a parameter of a law that several bodies may share, once.
    pub(super) fn refuse_parameter(&mut self, path: &str, error: &ParameterError) {
        let message = format!("{}, must be {}", error.value, error.allowed);
        self.refuse_once(&format!("{path}.{}", error.parameter), message, "");
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
