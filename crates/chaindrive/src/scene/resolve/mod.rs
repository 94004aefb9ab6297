//! From the scene as written to the drive: names become indices, choices become models.

mod catalogue;
mod chain;
mod contact;
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

use chaindrive_geometry::{Point, Vector};
use chaindrive_mechanics::{Drive, DriveError, Parts, PlacedChain};

use super::error::Problem;
use super::quantity::{Length, Ratio};
use super::schema::SceneText;
use super::suggest::one_of;
use super::tree::Node;

/// Builds the drive of a scene, or collects everything that prevents it.
pub(crate) fn drive(scene: &SceneText, tree: &Node) -> Result<Drive, Vec<Problem>> {
    let mut findings = Findings {
        tree,
        problems: Vec::new(),
    };
    let names = Names::new(scene, &mut findings);
    let parts = parts(scene, &names, &mut findings);
    let Some(parts) = parts.filter(|_| findings.problems.is_empty()) else {
        return Err(findings.problems);
    };
    Drive::new(parts).map_err(|errors| {
        for error in errors {
            findings.drive_error(error);
        }
        findings.problems
    })
}

fn parts(scene: &SceneText, names: &Names<'_>, findings: &mut Findings<'_>) -> Option<Parts> {
    let touched = !(scene.sprockets.is_empty() && scene.guides.is_empty());
    let chain = chain::resolve(scene, touched, findings);
    let tensioners = tensioner::resolve_all(scene, findings);
    let gravity = scene
        .gravity
        .map_or_else(|| Vector::new(0.0, -9.81), |[x, y]| Vector::new(x.0, y.0));
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
    Some(Parts {
        chains: vec![placed],
        sprockets,
        guides,
        tensioners: tensioners?,
        torsions: Vec::new(),
        settle: scene.settle,
        gravity,
    })
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

/// The problems found so far, and the tree that knows their lines.
struct Findings<'t> {
    tree: &'t Node,
    problems: Vec<Problem>,
}

impl Findings<'_> {
    fn refuse(&mut self, path: &str, message: impl Into<String>) {
        let (path, line) = self.tree.locate(path);
        self.problems.push(Problem::new(&path, line, message));
    }

    fn refuse_with(&mut self, path: &str, message: impl Into<String>, hint: impl Into<String>) {
        let (path, line) = self.tree.locate(path);
        self.problems
            .push(Problem::new(&path, line, message).hint(hint));
    }

    /// Refuses a value that several bodies share, once.
    ///
    /// An empty hint is none.
    fn refuse_once(&mut self, path: &str, message: impl Into<String>, hint: &str) {
        let (place, _) = self.tree.locate(path);
        if self.problems.iter().any(|problem| problem.path == place) {
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
        let mut seen = Vec::new();
        for (path, name) in names {
            if name.trim().is_empty() {
                self.refuse(&path, "the name is empty");
            } else if name.contains(['.', '[', ']']) {
                let hint = "paths such as `sprockets.crank.teeth` use them";
                self.refuse_with(&path, format!("`{name}` has a point or a bracket"), hint);
            } else if seen.contains(&name) {
                self.refuse_with(&path, format!("`{name}` is taken"), "names must differ");
            }
            seen.push(name);
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
