//! Laws that other programs add to a family, by name and revision.
//!
//! A family is an enum of its own members and one variant `Registered` that holds a [`Handle`]; `L` is the trait that its laws have. A registered
//! law is a struct with its parameters, read, checked and described as those of own members.
//!
//! ```text
//! enter::<T>(name, revision) ─► shelf ─┬─► kinds of the schema          put_into
//!                                      ├─► laws of the build            revisions
//!                                      └─► laws that a scene describes  read
//! ```
//!
//! The first question closes the shelf: what was answered remains true.

use std::collections::HashMap;
use std::fmt;
use std::ops::Deref;
use std::sync::{Mutex, MutexGuard, PoisonError};

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};

use crate::{ParameterError, check};

/// The registered laws of a family.
pub struct Library<L: ?Sized + 'static> {
    family: &'static str,
    own: fn() -> Schema,
    rule: fn(&L) -> Result<(), ParameterError>,
    shelf: Mutex<Shelf<L>>,
}

struct Shelf<L: ?Sized + 'static> {
    members: Vec<Member<L>>,
    closed: bool,
}

struct Member<L: ?Sized + 'static> {
    name: &'static str,
    revision: u32,
    schema: Value,
    read: Box<dyn Fn(Value) -> Result<Entry<L>, serde_json::Error> + Send + Sync>,
    /// Handles by the text of their keys.
    handles: HashMap<String, Handle<L>>,
}

/// A law with its parameters.
struct Entry<L: ?Sized + 'static> {
    keys: Value,
    sound: Result<(), ParameterError>,
    law: Box<L>,
}

/// Why a law is not taken into a family.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum RegistrationError {
    /// It cannot be the kind of a scene.
    #[error(
        "{family} `{name}`: a name has small letters, digits and single hyphens, a letter first, such as `gas-spring`"
    )]
    Name {
        family: &'static str,
        name: &'static str,
    },

    /// Another member has the name.
    #[error("{family} `{name}`: the name is taken, as are {taken}; choose another")]
    Taken {
        family: &'static str,
        name: &'static str,
        taken: String,
    },

    /// A scene was read, or the identity of the build was asked for.
    #[error(
        "{family} `{name}`: too late, a scene was read or the build asked for already; register before, first thing in `main`"
    )]
    Late {
        family: &'static str,
        name: &'static str,
    },

    /// Its type has no keys.
    #[error(
        "{family} `{name}`: parameters are the named fields of a struct, none of them `kind`; `struct Law {{}}` has none"
    )]
    Keys {
        family: &'static str,
        name: &'static str,
    },
}

/// A registered law with its parameters, as small as a reference.
///
/// Equal parameters of one name are one law, which lives as long as the program: some hundred bytes for each set of parameters.
pub struct Handle<L: ?Sized + 'static>(&'static Entry<L>);

impl<L: ?Sized + Send + Sync + 'static> Library<L> {
    /// An empty one: what the family is called, the schema of its own members, and the rule of a law about several of its parameters.
    pub const fn new(
        family: &'static str,
        own: fn() -> Schema,
        rule: fn(&L) -> Result<(), ParameterError>,
    ) -> Self {
        Self {
            family,
            own,
            rule,
            shelf: Mutex::new(Shelf {
                members: Vec::new(),
                closed: false,
            }),
        }
    }

    /// Takes in the laws of a type; `boxed` is `|law| Box::new(law)`.
    ///
    /// # Errors
    /// A name that is none or is taken, a type without keys, and any after the first scene.
    pub fn enter<T: Serialize + DeserializeOwned + JsonSchema + 'static>(
        &self,
        name: &'static str,
        revision: u32,
        boxed: fn(T) -> Box<L>,
    ) -> Result<(), RegistrationError> {
        let family = self.family;
        let mut shelf = self.shelf();
        if shelf.closed {
            return Err(RegistrationError::Late { family, name });
        }
        if !is_kind(name) {
            return Err(RegistrationError::Name { family, name });
        }
        let own = (self.own)().to_value();
        let mut taken: Vec<&str> = kinds(&own).collect();
        taken.extend(shelf.members.iter().map(|member| member.name));
        if taken.contains(&name) {
            let taken = taken.join(", ");
            return Err(RegistrationError::Taken {
                family,
                name,
                taken,
            });
        }
        let schema = of_kind::<T>(name).ok_or(RegistrationError::Keys { family, name })?;
        let rule = self.rule;
        let read = move |mut keys: Value| {
            let kind = keys
                .as_object_mut()
                .and_then(|keys| keys.shift_remove("kind"));
            let law: T = serde_json::from_value(keys)?;
            let mut keys = Map::from_iter([("kind".to_owned(), kind.unwrap_or(name.into()))]);
            if let Value::Object(parameters) = serde_json::to_value(&law)? {
                keys.extend(parameters);
            }
            let ranges = check(&law);
            let law = boxed(law);
            Ok(Entry {
                keys: keys.into(),
                sound: ranges.and_then(|()| rule(&law)),
                law,
            })
        };
        shelf.members.push(Member {
            name,
            revision,
            schema,
            read: Box::new(read),
            handles: HashMap::new(),
        });
        Ok(())
    }

    /// Names and revisions, in the order of the names. Closes the library.
    pub fn revisions(&self) -> Vec<(&'static str, u32)> {
        let shelf = self.closed();
        let members = shelf.members.iter();
        let mut found: Vec<_> = members.map(|it| (it.name, it.revision)).collect();
        found.sort_unstable();
        found
    }

    /// Adds its members to the schema of the family. Closes the library.
    pub fn put_into(&self, family: &mut Value) {
        let shelf = self.closed();
        if let Some(kinds) = family.get_mut("oneOf").and_then(Value::as_array_mut) {
            kinds.extend(shelf.members.iter().map(|member| member.schema.clone()));
        }
    }

    /// The law that keys describe; none where their `kind` is no name of it. Closes the library.
    ///
    /// # Errors
    /// As the type of the law has them: a key that is missing or unknown.
    pub fn read(&self, keys: &Value) -> Option<Result<Handle<L>, serde_json::Error>> {
        let kind = keys.get("kind")?.as_str()?;
        let mut shelf = self.closed();
        let member = shelf.members.iter_mut().find(|it| it.name == kind)?;
        let entry = match (member.read)(keys.clone()) {
            Ok(entry) => entry,
            Err(error) => return Some(Err(error)),
        };
        let handle = member.handles.entry(entry.keys.to_string());
        Some(Ok(
            *handle.or_insert_with(|| Handle(Box::leak(Box::new(entry))))
        ))
    }

    /// A registered law, or else one of the own members. For [`takes_registered`](crate::takes_registered).
    ///
    /// # Errors
    /// As the type of the law has them.
    #[doc(hidden)]
    pub fn read_or<'de, D: Deserializer<'de>, F>(
        &self,
        keys: D,
        registered: fn(Handle<L>) -> F,
        own: fn(Value) -> Result<F, serde_json::Error>,
    ) -> Result<F, D::Error> {
        let keys = Value::deserialize(keys)?;
        let law = match self.read(&keys) {
            Some(law) => law.map(registered),
            None => own(keys),
        };
        law.map_err(D::Error::custom)
    }

    fn closed(&self) -> MutexGuard<'_, Shelf<L>> {
        let mut shelf = self.shelf();
        shelf.closed = true;
        shelf
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf<L>> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether a name can be the kind of a scene.
fn is_kind(name: &str) -> bool {
    let part = |part: &str| {
        let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit();
        !part.is_empty() && part.chars().all(fits)
    };
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.split('-').all(part)
}

/// The kinds of a family.
fn kinds(family: &Value) -> impl Iterator<Item = &str> {
    let members = family.get("oneOf").and_then(Value::as_array);
    let kind = |member| Value::pointer(member, "/properties/kind/const")?.as_str();
    members.into_iter().flatten().filter_map(kind)
}

/// The schema of a struct as a member of a family; none where it cannot be one.
fn of_kind<T: JsonSchema>(name: &str) -> Option<Value> {
    let settings = SchemaSettings::draft2020_12().with(|it| {
        it.inline_subschemas = true;
        it.meta_schema = None;
    });
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    let schema = schema.ensure_object();
    if schema.get("type")? != "object" {
        return None;
    }
    let mut properties =
        Map::from_iter([("kind".to_owned(), json!({"type": "string", "const": name}))]);
    if let Some(Value::Object(own)) = schema.get("properties") {
        if own.contains_key("kind") {
            return None;
        }
        properties.extend(own.clone());
    }
    let mut required = vec![json!("kind")];
    if let Some(Value::Array(own)) = schema.get("required") {
        required.extend(own.iter().cloned());
    }
    schema.remove("title");
    schema.insert("properties".to_owned(), properties.into());
    schema.insert("additionalProperties".to_owned(), false.into());
    schema.insert("required".to_owned(), required.into());
    Some(Value::Object(schema.clone()))
}

impl<L: ?Sized> Handle<L> {
    /// Refuses parameters outside the ranges above their fields, and those that do not go together.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.0.sound.clone()
    }
}

impl<L: ?Sized> Clone for Handle<L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L: ?Sized> Copy for Handle<L> {}

impl<L: ?Sized> Deref for Handle<L> {
    type Target = L;

    fn deref(&self) -> &L {
        &self.0.law
    }
}

impl<L: ?Sized> PartialEq for Handle<L> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl<L: ?Sized> fmt::Debug for Handle<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Handle({})", self.0.keys)
    }
}

impl<L: ?Sized> Serialize for Handle<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.keys.serialize(serializer)
    }
}

impl<L: ?Sized> fmt::Debug for Library<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Library({})", self.family)
    }
}

/// Reads and writes an enum with a variant `Registered`; its own members are derived beside it, with `#[serde(remote = "Self")]`.
#[macro_export]
macro_rules! takes_registered {
    ($($family:ident: $library:expr;)*) => {$(
        impl serde::Serialize for $family {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                match self {
                    Self::Registered(law) => law.serialize(serializer),
                    own => Self::serialize(own, serializer),
                }
            }
        }

        impl<'de> serde::Deserialize<'de> for $family {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $library.read_or(deserializer, Self::Registered, Self::deserialize)
            }
        }
    )*};
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Length, Ratio};

    trait Law: Send + Sync {
        fn answer(&self) -> f64;

        fn check(&self) -> Result<(), ParameterError> {
            Ok(())
        }
    }

    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(tag = "kind", rename_all = "kebab-case", remote = "Self")]
    enum Laws {
        Own(Half),
        #[serde(skip)]
        Registered(Handle<dyn Law>),
    }

    static LAWS: Library<dyn Law> = Library::new("law", || schemars::schema_for!(Laws), Law::check);

    takes_registered! {
        Laws: LAWS;
    }

    /// Half of a length.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    struct Half {
        /// Length \[m\].
        #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
        length: f64,
        /// Share of it \[–\].
        #[serde(default)]
        #[schemars(with = "Ratio", extend("minimum" = 0))]
        share: f64,
    }

    impl Law for Half {
        fn answer(&self) -> f64 {
            0.5 * self.length
        }

        fn check(&self) -> Result<(), ParameterError> {
            if self.share <= self.length {
                return Ok(());
            }
            Err(ParameterError {
                parameter: "share".into(),
                value: self.share,
                allowed: "at most the length".into(),
            })
        }
    }

    fn read(keys: Value) -> Result<Laws, String> {
        serde_json::from_value(keys).map_err(|error| error.to_string())
    }

    fn library() -> Library<dyn Law> {
        Library::new("law", || schemars::schema_for!(Laws), Law::check)
    }

    /// Registered and own members are read, written, compared and asked alike; the library then takes no more.
    #[test]
    fn a_registered_law_is_a_member() {
        LAWS.enter::<Half>("other", 3, |law| Box::new(law)).unwrap();
        let keys = json!({"kind": "other", "length": 2.0, "share": 0.5});
        let law = read(keys.clone()).unwrap();
        let Laws::Registered(handle) = law else {
            panic!("{law:?}")
        };
        assert!((handle.answer() - 1.0).abs() < 1e-15);
        assert_eq!(handle.check(), Ok(()));
        assert_eq!(json!(law), keys);
        assert_eq!(read(json!(law)), Ok(law));
        assert_ne!(read(json!({"kind": "other", "length": 3.0})), Ok(law));
        let own = read(json!({"kind": "own", "length": 2.0})).unwrap();
        assert!(matches!(own, Laws::Own(Half { .. })));
        assert_eq!(json!(own)["kind"], "own");

        let missing = read(json!({"kind": "other"})).unwrap_err();
        assert_eq!(missing, "missing field `length`");
        let unknown = read(json!({"kind": "none"})).unwrap_err();
        assert_eq!(unknown, "unknown variant `none`, expected `own`");
        let late = LAWS.enter::<Half>("third", 1, |law| Box::new(law));
        let (family, name) = ("law", "third");
        assert_eq!(late, Err(RegistrationError::Late { family, name }));
        assert_eq!(LAWS.revisions(), [("other", 3)]);
    }

    #[test]
    fn parameters_are_refused_as_those_of_own_members() {
        let library = library();
        library
            .enter::<Half>("half", 1, |law| Box::new(law))
            .unwrap();
        for (length, share, words) in [
            (0.0, 0.0, "length = 0, must be positive [m]"),
            (1.0, 2.0, "share = 2, must be at most the length"),
        ] {
            let keys = json!({"kind": "half", "length": length, "share": share});
            let law = library.read(&keys).unwrap().unwrap();
            assert_eq!(law.check().unwrap_err().to_string(), words);
        }
    }

    #[test]
    fn the_schema_has_kind_keys_and_ranges() {
        let library = library();
        library
            .enter::<Half>("half", 1, |law| Box::new(law))
            .unwrap();
        let mut schema = schemars::schema_for!(Laws).to_value();
        library.put_into(&mut schema);
        let [own, other] = [0, 1].map(|member| schema["oneOf"][member].clone());
        assert_eq!(other["properties"]["kind"]["const"], "half");
        assert_eq!(other["properties"]["length"], own["properties"]["length"]);
        assert_eq!(other["required"], own["required"]);
        assert_eq!(other["additionalProperties"], own["additionalProperties"]);
        assert_eq!(other["description"], "Half of a length.");
    }

    #[test]
    fn what_cannot_be_a_member_is_refused_with_what_can() {
        #[derive(Serialize, Deserialize, JsonSchema)]
        struct Number(f64);

        #[derive(Serialize, Deserialize, JsonSchema)]
        struct Kind {
            kind: f64,
        }

        let library = library();
        for name in [
            "", "Half", "a_half", "-half", "half-", "a--half", "2-halves",
        ] {
            let refused = library.enter::<Half>(name, 1, |law| Box::new(law));
            assert!(
                matches!(refused, Err(RegistrationError::Name { .. })),
                "{name}"
            );
        }
        let taken = library
            .enter::<Half>("own", 1, |law| Box::new(law))
            .unwrap_err();
        assert_eq!(
            taken.to_string(),
            "law `own`: the name is taken, as are own; choose another"
        );
        let boxed = |_| unreachable!("nothing is read");
        let keys = [
            library.enter::<Number>("number", 1, |_| unreachable!("nothing is read")),
            library.enter::<Kind>("kind", 1, boxed),
        ];
        for refused in keys {
            assert!(matches!(refused, Err(RegistrationError::Keys { .. })));
        }
    }
}
