//! Scenes: drives described in a text.
//!
//! ```text
//! text ──parse──► tree ──validate──► normalised tree ──serde──► Scene ──resolve──► Drive
//! ```
//!
//! A scene is TOML, or JSON when the text begins with `{`. The format is described by the types
//! in `schema` and, from these, by [`schema()`]. Everything wrong with a text is
//! reported at once, with its place: see [`SceneError`].
//!
//! # Example
//!
//! ```
//! use chaindrive::scene::Scene;
//!
//! let scene = Scene::from_text(
//!     r#"
//!     title = "Two sprockets"
//!
//!     [chain]
//!     pitch = "25.4 mm"
//!     links = 78
//!     mass = "68.8 g"
//!     stiffness = "161 MN/m"
//!     roller_diameter = "15.88 mm"
//!
//!     [[sprockets]]
//!     name = "driver"
//!     teeth = 19
//!     centre = ["0 mm", "0 mm"]
//!     motion = { kind = "constant", speed = "300 rpm" }
//!
//!     [[sprockets]]
//!     name = "driven"
//!     teeth = 19
//!     centre = ["749.3 mm", "0 mm"]
//!     inertia = "0.05 kg m^2"
//!     load = [{ kind = "constant", torque = "-40 N m" }]
//!     "#,
//!     "two_sprockets.toml",
//! )?;
//! let drive = scene.drive()?;
//! assert_eq!(drive.chains[0].chain.links(), 78);
//!
//! let longer = scene.replace("chain.links", "80")?;
//! assert_eq!(longer.drive()?.chains[0].chain.links(), 80);
//!
//! let error = Scene::from_text("[chain]\npitch = '12 rpm'", "bad.toml").unwrap_err();
//! assert!(error.to_string().starts_with("bad.toml:2:9: chain.pitch: `12 rpm` is an angular speed"));
//! # Ok::<(), chaindrive::scene::SceneError>(())
//! ```

mod accuracy;
mod datum;
mod defaults;
mod diff;
mod edit;
mod error;
mod expected;
mod format;
mod json;
mod keys;
mod limits;
mod path;
mod presets;
mod read;
mod resolve;
mod resolved;
mod run_in;
mod schema;
mod suggest;
mod text_span;
mod titles;
mod tree;
mod validate;

use std::sync::Arc;

use chaindrive_contact::Friction;
use chaindrive_mechanics::Drive;
use serde::Deserialize;

pub use datum::Datum;
pub use diff::{Difference, diff};
pub(crate) use edit::Edit;
pub use error::{Problem, SceneError};
pub use format::schema;
pub use limits::read_file;
pub use presets::presets;
pub use schema::RunDefaults;
pub use text_span::TextSpan;

pub use accuracy::{ACCURACY, Quantity};
pub(crate) use chaindrive_quantities::is_number;
pub use chaindrive_quantities::{UnitInSi, read_length, read_time, read_unit};
pub use resolve::{chain_named, tunable_places};
pub use run_in::RunIn;
use schema::{Contact, SceneText};
pub(crate) use schema::{EVERY, STEPPING_KEYS, TOLERANCE, UNTIL};
use tree::Node;

/// Reads a friction law as scenes have them, `{"kind": "coulomb", "coefficient": 0.1}`, with their units and defaults.
///
/// # Errors
/// Everything that is wrong with the text; paths begin at the law.
///
/// # Example
///
/// ```
/// use chaindrive::scene::read_friction;
///
/// let law = read_friction(r#"{"kind": "coulomb", "coefficient": 0.1, "slip_speed": "50 mm/s"}"#)?;
/// assert_eq!(law, read_friction(r#"{"kind": "coulomb", "coefficient": 0.1}"#)?);
/// let error = read_friction(r#"{"kind": "coulomb", "coeficient": 0.1}"#).unwrap_err();
/// assert_eq!(error.problems[0].hint.as_deref(), Some("did you mean `coefficient`?"));
/// # Ok::<(), chaindrive::scene::SceneError>(())
/// ```
pub fn read_friction(text: &str) -> Result<Friction, SceneError> {
    let refuse = |problems: Vec<Problem>| {
        let below = |mut problem: Problem| {
            let path = problem.path.trim_start_matches('.');
            let path = path.strip_prefix("friction").unwrap_or(path);
            problem.path = path.trim_start_matches('.').to_owned();
            problem
        };
        SceneError::new("friction", problems.into_iter().map(below).collect()).nowhere()
    };
    // A friction stands in a contact.
    let text = format!("{{\"friction\": {text}}}");
    let mut tree = Node::parse_json(&text).map_err(|problem| refuse(vec![problem]))?;
    let problems = validate::validate_part(&mut tree, format::raw(), "Contact");
    if !problems.is_empty() {
        return Err(refuse(problems.of("friction").problems));
    }
    let contact = Contact::deserialize(tree.to_json());
    let contact = contact.map_err(|error| refuse(vec![unreadable(&error)]))?;
    resolve::friction(&contact, &tree).map_err(|problems| refuse(problems.of("friction").problems))
}

/// A drive as described: well-formed, with every key of the right type and dimension.
///
/// Whether the parts go together is the question of [`Scene::drive`].
#[derive(Clone, Debug)]
pub struct Scene {
    name: String,
    text: String,
    /// The text that was read, before single values were changed: places in messages are its.
    read: Arc<str>,
    tree: Node,
    content: SceneText,
}

/// Scenes of one name and text: all else follows, but for the places of a text that was changed after it was read.
impl PartialEq for Scene {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.text == other.text
    }
}

impl Scene {
    /// Reads TOML, or JSON when the text begins with `{`; `name` is what messages call it.
    ///
    /// # Errors
    /// Everything that is wrong with the text.
    pub fn from_text(text: &str, name: &str) -> Result<Self, SceneError> {
        Self::parsed(Node::parse, text, name)
    }

    /// Reads TOML.
    ///
    /// # Errors
    /// Everything that is wrong with the text.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, SceneError> {
        Self::parsed(Node::parse_toml, text, name)
    }

    /// Reads JSON.
    ///
    /// # Errors
    /// Everything that is wrong with the text.
    pub fn from_json(text: &str, name: &str) -> Result<Self, SceneError> {
        Self::parsed(Node::parse_json, text, name)
    }

    /// Takes JSON that a program made and nobody sees: mistakes in it have a path, and no line.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    ///
    /// # Example
    ///
    /// ```
    /// use chaindrive::Scene;
    ///
    /// let scene = serde_json::json!({ "chain": { "pitch": "3 rpm" } });
    /// let error = Scene::from_data(&scene.to_string(), "mine").unwrap_err();
    /// assert!(error.problems.iter().all(|problem| problem.place.is_none()));
    /// ```
    pub fn from_data(json: &str, name: &str) -> Result<Self, SceneError> {
        let placeless = |text: &str| {
            let mut tree = Node::parse_json(text)?;
            tree.take_places(None);
            Ok(tree)
        };
        Self::parsed(placeless, json, name).map_err(SceneError::nowhere)
    }

    fn parsed(
        parse: fn(&str) -> Result<Node, Problem>,
        text: &str,
        name: &str,
    ) -> Result<Self, SceneError> {
        let source = Source {
            name,
            read: text.into(),
        };
        match parse(text) {
            Ok(tree) => Self::from_tree(tree, text, &source),
            Err(problem) => Err(source.refuse(vec![problem])),
        }
    }

    fn from_tree(tree: Node, text: &str, source: &Source<'_>) -> Result<Self, SceneError> {
        validate::known_version(&tree).map_err(|problem| source.refuse(vec![problem]))?;
        let refused = tree.control_characters();
        if !refused.is_empty() {
            return Err(source.refuse(refused));
        }
        let mut normalised = tree.clone();
        normalised.expand_chain();
        let mut problems = validate::validate(&mut normalised, format::raw());
        if !problems.is_empty() {
            // Alone they are told with what else does not go together.
            resolve::refuse_unknown_chains(&normalised, &mut problems);
            return Err(problems.of(source.name).within(&source.read));
        }
        let content = SceneText::deserialize(normalised.to_json())
            .map_err(|error| source.refuse(vec![unreadable(&error)]))?;
        Ok(Self {
            name: source.name.to_owned(),
            text: text.to_owned(),
            read: Arc::clone(&source.read),
            tree,
            content,
        })
    }

    fn source(&self) -> Source<'_> {
        Source {
            name: &self.name,
            read: Arc::clone(&self.read),
        }
    }

    /// Builds the drive.
    ///
    /// # Errors
    /// Every part out of range and every pair of parts that do not go together.
    pub fn drive(&self) -> Result<Drive, SceneError> {
        let drive = resolve::drive(&self.content, &self.tree);
        let drive = drive.map_err(|problems| problems.of(&self.name).within(&self.read))?;
        Ok(drive.0)
    }

    /// Title of the scene, in a line; may be empty.
    pub fn title(&self) -> &str {
        &self.content.title
    }

    /// Name of the scene in messages: its file or preset.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text that reproduces this scene, TOML or JSON as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The scene as JSON, as it was written: quantities may be texts with a unit.
    pub fn json(&self) -> serde_json::Value {
        self.tree.to_json()
    }

    /// Settings of a run and channels to record, unless the caller gives others.
    pub fn run_defaults(&self) -> RunDefaults {
        self.content.run.suggestions()
    }
}

/// Name of a text in messages, and the text that their places belong to.
struct Source<'a> {
    name: &'a str,
    read: Arc<str>,
}

impl Source<'_> {
    fn refuse(&self, problems: Vec<Problem>) -> SceneError {
        SceneError::new(self.name, problems).within(&self.read)
    }
}

/// The validator has let something pass that serde does not: our mistake, not the user's.
fn unreadable(error: &serde_json::Error) -> Problem {
    let problem = Problem::new("", None, format!("the scene could not be read: {error}"));
    problem.hint("please report this scene as a bug")
}
