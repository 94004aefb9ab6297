//! From the scene as written to the drive: names become indices, choices become models.

mod catalogue;
mod chain;
mod contact;
mod count;
mod flank;
mod guide;
mod law;
mod links;
mod motion;
mod route;
mod scatter;
mod sprocket;
mod start;
mod tensioner;
mod tooth;

use std::collections::HashSet;

use chaindrive_geometry::{Point, Vector};
use chaindrive_mechanics::{Drive, DriveError, Parts, PlacedChain};
use serde_json::{Value as Json, json};

use super::defaults::{self, Default};
use super::error::{Problem, Problems};
use super::quantity::{Length, Ratio};
use super::schema::{SceneText, Version};
use super::suggest::one_of;
use super::tree::Node;

/// Builds the drive of a scene, or collects everything that prevents it.
pub(crate) fn drive(scene: &SceneText, tree: &Node) -> Result<(Drive, Vec<Assumption>), Problems> {
    let mut findings = Findings {
        tree,
        version: scene.defaults.unwrap_or_default(),
        problems: Problems::default(),
        assumptions: Vec::new(),
        assumed: HashSet::new(),
    };
    let names = Names::new(scene, &mut findings);
    let parts = parts(scene, &names, &mut findings);
    let Some((parts, uncounted)) = parts.filter(|_| findings.problems.is_empty()) else {
        return Err(findings.problems);
    };
    match (Drive::new(parts), uncounted) {
        (Ok(drive), None) => return Ok((drive, findings.assumptions)),
        (Err(errors), _) => {
            for error in errors {
                findings.drive_error(error);
            }
        }
        (Ok(_), Some(reason)) => findings.refuse_with("chain.links", "missing", reason),
    }
    Err(findings.problems)
}

/// The parts, and why the number of links is a guess, if it is one.
fn parts(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<(Parts, Option<String>)> {
    let touched = !(scene.sprockets.is_empty() && scene.guides.is_empty());
    let chain = chain::resolve(scene, touched, findings);
    let tensioners = tensioner::resolve_all(scene, findings);
    let gravity = gravity(scene, findings);
    let chain = chain?;
    let sprockets = sprocket::resolve_all(scene, names, &chain, findings);
    let guides = guide::resolve_all(scene, names, &chain, findings);
    let layout = route::layout(scene, names, &chain.chain, gravity, findings);
    let (sprockets, guides) = (sprockets?, guides?);
    let placed = PlacedChain {
        chain: chain.chain,
        layout: layout?,
        sprockets: (0..sprockets.len()).collect(),
        guides: (0..guides.len()).collect(),
    };
    let parts = Parts {
        chains: vec![placed],
        sprockets,
        guides,
        tensioners: tensioners?,
        torsions: Vec::new(),
        settle: scene.settle,
        gravity,
    };
    Some((parts, chain.uncounted))
}

fn gravity(scene: &SceneText, findings: &mut Findings<'_>) -> Vector {
    if let Some([x, y]) = scene.gravity {
        return Vector::new(x.0, y.0);
    }
    let down = defaults::GRAVITY.value(findings.version);
    let remark = defaults::GRAVITY.basis.remark();
    findings.assume("gravity", json!([0.0, down]), remark);
    Vector::new(0.0, down)
}

/// The names by which parts refer to each other.
struct Names<'s> {
    sprockets: Vec<&'s str>,
    guides: Vec<&'s str>,
    tensioners: Vec<&'s str>,
}

impl<'s> Names<'s> {
    fn new(scene: &'s SceneText, findings: &mut Findings<'_>) -> Self {
        let names = Self {
            sprockets: scene.sprockets.iter().map(|s| s.name.as_str()).collect(),
            guides: scene.guides.iter().map(|g| g.name.as_str()).collect(),
            tensioners: scene.tensioners.iter().map(|t| t.name.as_str()).collect(),
        };
        let place = |list: &str, index: usize| format!("{list}[{index}].name");
        let stops = names
            .sprockets
            .iter()
            .enumerate()
            .map(|(i, name)| (place("sprockets", i), *name));
        let guides = names
            .guides
            .iter()
            .enumerate()
            .map(|(i, name)| (place("guides", i), *name));
        let tensioners = names.tensioners.iter().enumerate();
        let tensioners = tensioners.map(|(i, name)| (place("tensioners", i), *name));
        findings.unique(stops.chain(guides));
        findings.unique(tensioners);
        names
    }

    /// Index of the tensioner of this name.
    fn tensioner(&self, name: &str, path: &str, findings: &mut Findings<'_>) -> Option<usize> {
        findings.lookup(&self.tensioners, "tensioner", name, path)
    }
}

/// A value that a scene leaves open, with what is taken for it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Assumption {
    /// Place in the scene, with entries of lists by index.
    pub(crate) path: String,
    /// The value, in SI units.
    pub(crate) value: Json,
    /// Where it comes from.
    pub(crate) remark: String,
}

/// The problems and assumptions found so far, and the tree that knows the lines.
struct Findings<'t> {
    tree: &'t Node,
    /// Whose defaults hold.
    version: Version,
    problems: Problems,
    assumptions: Vec<Assumption>,
    assumed: HashSet<String>,
}

impl Findings<'_> {
    /// Notes what is taken for an absent value; several bodies may share it.
    fn assume(&mut self, path: &str, value: impl Into<Json>, remark: impl Into<String>) {
        if self.assumed.insert(path.to_owned()) {
            self.assumptions.push(Assumption {
                path: path.to_owned(),
                value: value.into(),
                remark: remark.into(),
            });
        }
    }

    /// Notes the member of a family that stands for nothing.
    fn assume_kind(&mut self, path: &str, kind: &str) {
        self.assume(path, json!({"kind": kind}), "not given");
    }

    /// A number, or its default.
    fn or_default(&mut self, given: Option<f64>, path: &str, default: &Default) -> f64 {
        given.unwrap_or_else(|| {
            let value = default.value(self.version);
            self.assume(path, value, default.basis.remark());
            value
        })
    }

    /// A number, or a multiple of another that has its unit.
    fn or_multiple(&mut self, given: Option<f64>, path: &str, default: &Default, of: f64) -> f64 {
        given.unwrap_or_else(|| {
            let factor = default.value(self.version);
            let remark = format!("{factor} {}, {}", default.unit, default.basis.remark());
            self.assume(path, factor * of, remark);
            factor * of
        })
    }

    fn refuse(&mut self, path: &str, message: impl Into<String>) {
        self.problems.push_with(|| {
            let (path, line) = self.tree.locate(path);
            Problem::new(&path, line, message)
        });
    }

    fn refuse_with(&mut self, path: &str, message: impl Into<String>, hint: impl Into<String>) {
        self.problems.push_with(|| {
            let (path, line) = self.tree.locate(path);
            Problem::new(&path, line, message).hint(hint)
        });
    }

    /// Refuses a value that several bodies share, once.
    ///
    /// An empty hint is none.
    fn refuse_once(&mut self, path: &str, message: impl Into<String>, hint: &str) {
        let (place, _) = self.tree.locate(path);
        if self.problems.speak_of(&place) {
            return;
        }
        if hint.is_empty() {
            self.refuse(path, message);
        } else {
            self.refuse_with(path, message, hint);
        }
    }

    /// The value, or its error as a problem of `path`.
    fn keep<T, E: std::fmt::Display>(&mut self, path: &str, result: Result<T, E>) -> Option<T> {
        result
            .map_err(|error| self.refuse(path, error.to_string()))
            .ok()
    }

    fn lookup(&mut self, names: &[&str], kind: &str, name: &str, path: &str) -> Option<usize> {
        let found = names.iter().position(|known| *known == name);
        if found.is_none() {
            self.refuse_with(
                path,
                format!("no {kind} is named `{name}`"),
                one_of(name, names),
            );
        }
        found
    }

    fn unique<'n>(&mut self, names: impl Iterator<Item = (String, &'n str)>) {
        let mut seen = HashSet::new();
        for (path, name) in names {
            if name.trim().is_empty() {
                self.refuse(&path, "the name is empty");
            } else if name.contains(['.', '[', ']']) {
                let hint = "paths such as `sprockets.crank.teeth` use them";
                self.refuse_with(&path, format!("`{name}` has a point or a bracket"), hint);
            } else if seen.contains(name) {
                self.refuse_with(&path, format!("`{name}` is taken"), "names must differ");
            }
            seen.insert(name);
        }
    }

    /// A direction of any length as a unit vector.
    fn direction(&mut self, path: &str, [x, y]: [Ratio; 2]) -> Option<Vector> {
        let direction = Vector::new(x.0, y.0).try_normalize(f64::MIN_POSITIVE);
        if direction.is_none() {
            self.refuse(path, "a direction must not be zero");
        }
        direction.filter(|unit| unit.iter().all(|c| c.is_finite()))
    }

    fn drive_error(&mut self, error: DriveError) {
        match error {
            DriveError::Parameter {
                path,
                value,
                allowed,
            } => self.refuse(&path, format!("{value}, must be {allowed}")),
            DriveError::Law { path, source } => {
                let path = format!("{}.{}", in_scene(&path), source.parameter);
                self.refuse(
                    &path,
                    format!("{}, must be {}", source.value, source.allowed),
                );
            }
            DriveError::Overlap {
                first,
                second,
                overlap,
            } => self.refuse_with(
                &format!("sprockets.{second}.centre"),
                format!("overlaps sprocket `{first}` by {:.1} mm", overlap * 1e3),
                "move the centres apart",
            ),
            DriveError::Conflict { path, problem } => self.refuse(&in_scene(&path), problem),
            other => self.refuse("", other.to_string()),
        }
    }
}

/// Where a scene has the contacts that a drive has in its joints and rollers.
fn in_scene(path: &str) -> String {
    path.replacen("chain.joint.contact", "contact.joints", 1)
        .replacen("chain.roller.contact", "contact.rollers", 1)
}

fn point([x, y]: [Length; 2]) -> Point {
    Point::new(x.0, y.0)
}
