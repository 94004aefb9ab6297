//! Ranges of parameters, as the schema of their struct has them.

use std::any::TypeId;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

/// A parameter outside its range: which one, its value, and what is allowed.
///
/// Reads as the tail of a path, so that a caller can put the place in front:
/// `restitution = 1.4, must be in (0, 1]`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{parameter} = {value}, must be {allowed}")]
pub struct ParameterError {
    /// Name of the parameter, as its field is called; of a term of a list with its place, `terms[2].frequency`.
    pub parameter: Cow<'static, str>,
    /// The value that was refused.
    pub value: f64,
    /// The range it has to be in, with the unit in brackets.
    pub allowed: Cow<'static, str>,
}

/// The limits of a number, read from the schema of its key.
#[derive(Clone, Copy, Debug)]
pub struct Range<'s>(pub &'s Value);

impl Range<'_> {
    /// The allowed range in words with its unit; nothing where the value is in it.
    pub fn refuses(self, value: f64) -> Option<String> {
        let limit = |key: &str| self.0.get(key).and_then(Value::as_f64);
        let words = if let Some(least) = limit("exclusiveMinimum").filter(|least| value <= *least) {
            if least == 0.0 {
                "positive".to_owned()
            } else {
                format!("more than {}", plain(least))
            }
        } else if let Some(least) = limit("minimum").filter(|least| value < *least) {
            if least == 0.0 {
                "not negative".to_owned()
            } else {
                format!("at least {}", plain(least))
            }
        } else if let Some(most) = limit("exclusiveMaximum").filter(|most| value >= *most) {
            format!("less than {}", plain(most))
        } else if let Some(most) = limit("maximum").filter(|most| value > *most) {
            format!("at most {}", plain(most))
        } else if value.is_finite() {
            return None;
        } else {
            "a finite number".to_owned()
        };
        let unit = self.0.get("x-unit").and_then(Value::as_str);
        let unit = unit.filter(|unit| *unit != "1");
        Some(unit.map_or(words.clone(), |unit| format!("{words} [{unit}]")))
    }
}

/// A limit in few digits: 1e-6, not 0.000001.
fn plain(limit: f64) -> String {
    if limit.abs() < 1e-3 && limit != 0.0 {
        format!("{limit:e}")
    } else {
        limit.to_string()
    }
}

/// Refuses parameters outside the ranges that stand above the fields of their struct.
///
/// Parameters that are left out when the struct is serialised are not looked at. NaN and infinity are refused, and both are told as NaN: JSON has
/// neither. Ranges that depend on another parameter are the struct's own business.
///
/// # Errors
/// Names the first parameter outside its range.
///
/// # Panics
/// Where a struct cannot be written as JSON: one whose maps have keys that are no texts.
pub fn check<T: Serialize + JsonSchema + 'static>(parameters: &T) -> Result<(), ParameterError> {
    let values = serde_json::to_value(parameters).expect("parameters are numbers and texts");
    let schema = schema_of::<T>();
    let checked = RangeCheck {
        definitions: schema.get("$defs").and_then(Value::as_object),
    };
    checked.value(&values, schema, "")
}

/// The schema of a type, derived once: assembling a drive asks for it for every law.
fn schema_of<T: JsonSchema + 'static>() -> &'static Value {
    static KNOWN: LazyLock<Mutex<HashMap<TypeId, &'static Value>>> = LazyLock::new(Mutex::default);
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known
        .entry(TypeId::of::<T>())
        .or_insert_with(|| Box::leak(Box::new(schemars::schema_for!(T).to_value())))
}

/// Values held against a schema with its named definitions.
struct RangeCheck {
    definitions: Option<&'static Map<String, Value>>,
}

impl RangeCheck {
    fn value(&self, value: &Value, schema: &'static Value, at: &str) -> Result<(), ParameterError> {
        if let Some(name) = schema.get("$ref").and_then(Value::as_str)
            && let Some(target) = name
                .rsplit('/')
                .next()
                .and_then(|n| self.definitions?.get(n))
        {
            self.value(value, target, at)?;
        }
        if let Some(members) = schema.get("oneOf").and_then(Value::as_array) {
            let of_kind = |member: &&Value| member["properties"]["kind"]["const"] == value["kind"];
            if let Some(member) = members.iter().find(of_kind) {
                self.value(value, member, at)?;
            }
        }
        match value {
            Value::Object(entries) => {
                for (key, entry) in entries {
                    if let Some(property) = schema["properties"].get(key) {
                        let separator = if at.is_empty() { "" } else { "." };
                        self.value(entry, property, &format!("{at}{separator}{key}"))?;
                    }
                }
            }
            Value::Array(entries) => {
                for (i, entry) in entries.iter().enumerate() {
                    if let Some(items) = schema.get("items") {
                        self.value(entry, items, &format!("{at}[{i}]"))?;
                    }
                }
            }
            // JSON has no word for a number that is none.
            Value::Number(_) | Value::Null if schema.get("x-dimension").is_some() => {
                let value = value.as_f64().unwrap_or(f64::NAN);
                if let Some(mut allowed) = Range(schema).refuses(value) {
                    if let Some(remedy) = schema.get("x-remedy").and_then(Value::as_str) {
                        allowed = format!("{allowed}: {remedy}");
                    }
                    return Err(ParameterError {
                        parameter: at.to_owned().into(),
                        value,
                        allowed: allowed.into(),
                    });
                }
            }
            _ => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Length, Ratio};

    #[derive(Serialize, JsonSchema)]
    #[serde(tag = "kind", rename_all = "kebab-case")]
    enum Family {
        Plain(Plain),
        Listed { terms: Vec<Plain> },
    }

    #[derive(Serialize, JsonSchema)]
    struct Plain {
        #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
        radius: f64,
        #[schemars(with = "Option<Ratio>", extend("minimum" = 0, "maximum" = 1))]
        share: f64,
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
        poisson: Option<f64>,
    }

    const SOUND: Plain = Plain {
        radius: 1e-3,
        share: 0.0,
        poisson: None,
    };

    #[test]
    fn ranges_are_those_above_the_fields() {
        check(&SOUND).unwrap();
        for (wrong, words) in [
            (
                Plain {
                    radius: 0.0,
                    ..SOUND
                },
                "radius = 0, must be positive [m]",
            ),
            (
                Plain {
                    radius: f64::INFINITY,
                    ..SOUND
                },
                "radius = NaN, must be a finite number [m]",
            ),
            (
                Plain {
                    share: -0.5,
                    ..SOUND
                },
                "share = -0.5, must be not negative",
            ),
            (
                Plain {
                    share: 1.5,
                    ..SOUND
                },
                "share = 1.5, must be at most 1",
            ),
            (
                Plain {
                    share: f64::NAN,
                    ..SOUND
                },
                "share = NaN, must be a finite number",
            ),
            (
                Plain {
                    poisson: Some(-1.0),
                    ..SOUND
                },
                "poisson = -1, must be more than -1",
            ),
            (
                Plain {
                    poisson: Some(0.5),
                    ..SOUND
                },
                "poisson = 0.5, must be less than 0.5",
            ),
        ] {
            assert_eq!(check(&wrong).unwrap_err().to_string(), words);
            let member = check(&Family::Plain(wrong)).unwrap_err();
            assert_eq!(member.to_string(), words);
        }
    }

    #[test]
    fn terms_of_a_list_are_named_by_their_place() {
        let terms = vec![
            SOUND,
            Plain {
                share: 2.0,
                ..SOUND
            },
        ];
        let refused = check(&Family::Listed { terms }).unwrap_err();
        assert_eq!(refused.parameter, "terms[1].share");
    }
}
