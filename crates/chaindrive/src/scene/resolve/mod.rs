//! From the scene as written to the drive: names become indices, choices become models.

mod action;
mod articulation;
mod body;
mod catalogue;
mod chain;
mod chains;
mod contact;
mod contact_stiffness;
mod cursor;
mod ends;
mod film;
mod flank;
mod force;
mod guide;
mod housing;
mod law;
mod link_count;
mod links;
mod loss;
mod lubricant;
mod motion;
mod on_span;
mod route;
mod scatter;
mod shafts;
mod sprocket;
mod stack;
mod start;
mod strands;
mod tensioner;
mod tooth;
mod tunable;
mod written;

use std::collections::{HashMap, HashSet};

use chaindrive_geometry::{Point, Vector};
use chaindrive_mechanics::{Drive, DriveError, OilSupply, Parts, PlacedChain};
use serde_json::{Value as Json, json};

pub use catalogue::chain_named;
use cursor::Cursor;
use on_span::GuidedChain;
pub use tunable::tunable_places;

use super::defaults;
use super::error::{Problem, Problems};
use super::schema::{Contact, SceneText};
use super::tree::{Node, Value};
use chaindrive_quantities::Length;

/// Builds the drive of a scene, or collects everything that prevents it.
pub(crate) fn drive(scene: &SceneText, tree: &Node) -> Result<(Drive, Vec<Assumption>), Problems> {
    let mut findings = Findings::new(tree);
    let names = Names::new(scene, &mut findings);
    findings.oil = lubricant::resolve(scene, &mut findings);
    let parts = parts(scene, &names, &mut findings);
    let Some((parts, uncounted)) = parts.filter(|_| findings.problems.is_empty()) else {
        return Err(findings.problems);
    };
    match Drive::new(parts) {
        Ok(drive) if uncounted.is_empty() => return Ok((drive, findings.assumptions())),
        Ok(_) => {
            for (chain, reason) in uncounted {
                findings.chain = chain;
                findings.refuse_with("chain.links", "missing", reason);
            }
        }
        Err(errors) => {
            for error in errors {
                findings.drive_error(error);
            }
        }
    }
    Err(findings.problems)
}

/// Refuses the chains of a tree whose type the catalogue does not have, beside what is wrong with its words.
pub(crate) fn refuse_unknown_chains(tree: &Node, problems: &mut Problems) {
    let mut look = |chain: &Node, path: String| {
        if let Some(Node {
            value: Value::Text(name),
            place,
            ..
        }) = chain.get("type")
            && let Err(problem) = chain_named(name)
        {
            let place = *place;
            problems.push(Problem {
                path,
                place,
                ..problem
            });
        }
    };
    if let Some(chain) = tree.get("chain") {
        look(chain, "chain.type".to_owned());
    }
    if let Some(Value::List(chains)) = tree.get("chains").map(|it| &it.value) {
        for (index, chain) in chains.iter().enumerate() {
            look(chain, format!("chains[{index}].type"));
        }
    }
}

/// The friction of a contact that stands in no scene, at `friction` of a tree.
pub(crate) fn friction(
    contact: &Contact,
    tree: &Node,
) -> Result<chaindrive_contact::Friction, Problems> {
    let mut findings = Findings::new(tree);
    let journal = contact::Journal::default();
    let text = contact.friction.as_ref();
    let law = text.and_then(|text| contact::friction(text, journal, findings.at("friction")));
    law.ok_or(findings.problems)
}

/// Why the number of links of a chain is a guess.
type LinkCountGuess = (Option<usize>, String);

/// The parts, and why numbers of links are guesses, where they are.
fn parts(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<(Parts, Vec<LinkCountGuess>)> {
    let described = chains::described(scene, names, findings);
    let mut resolved = Vec::new();
    for (index, chain) in described.iter().flatten().enumerate() {
        findings.chain = chain.name.map(|_| index);
        resolved.push(chain::resolve(scene, chain, findings));
    }
    findings.chain = None;
    let mut tensioners = tensioner::resolve_all(scene, findings);
    let gravity = gravity(scene, findings);
    stack::refuse_elsewhere(scene, findings);
    let turning = shafts::resolve(scene, names, findings);
    let described = described?;
    let resolved: Vec<chain::ResolvedChain> = resolved.into_iter().collect::<Option<_>>()?;
    // Every body has an owner.
    let owner = |owner: Option<usize>| &resolved[owner.unwrap_or(0)];
    let sprockets = sprocket::resolve_all(scene, names, findings, |body| {
        owner(described.iter().position(|it| it.sprockets.contains(&body)))
    });
    let beside = sprockets.as_deref().unwrap_or_default();
    let guides = guide::resolve_all(scene, names, findings, beside, |body| {
        let index = described.iter().position(|it| it.guides.contains(&body));
        let chain = owner(index);
        let made = &chain.chain;
        let size = [made.pitch, made.roller_diameter, made.plate_height];
        let passing = GuidedChain::new(scene, &described[index.unwrap_or(0)], size);
        (chain, passing)
    });
    let mut layouts = Vec::new();
    for (index, (chain, resolved)) in described.iter().zip(&resolved).enumerate() {
        findings.chain = chain.name.map(|_| index);
        let chain = (chain, &resolved.chain);
        layouts.push(route::layout(scene, chain, names, gravity, findings));
    }
    findings.chain = None;
    let layouts: Vec<_> = layouts.into_iter().collect::<Option<_>>()?;
    let (mut sprockets, guides, turning) = (sprockets?, guides?, turning?);
    let bodies = sprockets.iter_mut().zip(turning.forces.sprockets);
    for ((sprocket, forces), shaft) in bodies.zip(turning.of_sprockets) {
        (sprocket.shaft, sprocket.forces) = (shaft, forces);
    }
    let carriers = tensioners.iter_mut().flatten();
    for (tensioner, forced) in carriers.zip(turning.forces.tensioners) {
        (tensioner.forces, tensioner.forced_at) = forced;
    }
    let mut chains = Vec::new();
    let mut uncounted = Vec::new();
    for (index, ((described, chain), layout)) in
        described.into_iter().zip(resolved).zip(layouts).enumerate()
    {
        let place = described.name.map(|_| index);
        uncounted.extend(chain.uncounted.map(|reason| (place, reason)));
        chains.push(PlacedChain {
            name: described.name.map(str::to_owned),
            chain: chain.chain,
            layout,
            sprockets: described.sprockets,
            guides: described.guides,
        });
    }
    let mut parts = Parts {
        chains,
        sprockets,
        guides,
        tensioners: tensioners?,
        shafts: turning.shafts,
        couplings: turning.couplings,
        gears: turning.gears,
        settle: scene.settle,
        gravity,
        oil: findings.oil.take(),
        tunable: Vec::new(),
    };
    parts.tunable = tunable::resolve(scene, &parts, findings);
    Some((parts, uncounted))
}

fn gravity(scene: &SceneText, findings: &mut Findings<'_>) -> Vector {
    if let Some([x, y]) = scene.gravity {
        return Vector::new(x.0, y.0);
    }
    let down = defaults::GRAVITY.value;
    let remark = defaults::GRAVITY.basis.remark();
    findings.assume("gravity", json!([0.0, down]), remark);
    Vector::new(0.0, down)
}

/// The names by which parts refer to each other.
struct Names<'s> {
    chains: Vec<&'s str>,
    shafts: Vec<&'s str>,
    sprockets: Vec<&'s str>,
    guides: Vec<&'s str>,
    tensioners: Vec<&'s str>,
}

impl<'s> Names<'s> {
    fn new(scene: &'s SceneText, findings: &mut Findings<'_>) -> Self {
        let names = Self {
            chains: scene.chains.iter().map(|c| c.name.as_str()).collect(),
            shafts: scene.shafts.iter().map(|s| s.name.as_str()).collect(),
            sprockets: scene.sprockets.iter().map(|s| s.name.as_str()).collect(),
            guides: scene.guides.iter().map(|g| g.name.as_str()).collect(),
            tensioners: scene.tensioners.iter().map(|t| t.name.as_str()).collect(),
        };
        let sprockets = listed("sprockets", &names.sprockets);
        findings.unique(sprockets.chain(listed("guides", &names.guides)));
        // Names in `sprockets` have been looked at.
        findings.unique_beside(&names.sprockets, listed("shafts", &names.shafts));
        findings.unique(listed("tensioners", &names.tensioners));
        findings.unique(listed("chains", &names.chains));
        let couplings: Vec<&str> = scene.couplings.iter().map(|c| c.name.as_str()).collect();
        findings.unique(listed("couplings", &couplings));
        let gears: Vec<&str> = scene.gears.iter().map(|g| g.name.as_str()).collect();
        findings.unique(listed("gears", &gears));
        names
    }

    /// Index of the tensioner of this name.
    fn tensioner(&self, name: &str, mut at: Cursor<'_, '_>) -> Option<usize> {
        if self.tensioners.is_empty() {
            let message = format!("no tensioner is named `{name}`");
            at.refuse(
                message,
                "there are none; describe it as one of `[[tensioners]]`",
            );
            return None;
        }
        at.lookup(&self.tensioners, "tensioner", name)
    }
}

/// The names of a list, each with its place.
fn listed<'n, 's>(
    list: &'static str,
    names: &'n [&'s str],
) -> impl Iterator<Item = (String, &'s str)> + use<'n, 's> {
    let names = names.iter().enumerate();
    names.map(move |(index, name)| (format!("{list}[{index}].name"), *name))
}

/// A value that a scene leaves open, with what is taken for it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Assumption {
    /// Place in the scene, with entries of lists by index.
    pub(crate) path: String,
    /// The value, in SI units.
    pub(crate) value: Json,
    /// Its source, in words.
    pub(crate) remark: String,
}

/// The problems and assumptions found so far, and the tree that knows the lines.
struct Findings<'t> {
    tree: &'t Node,
    /// The chain that `chain` and `route` in paths mean, where there are several.
    chain: Option<usize>,
    /// The oil, and who has asked for it.
    oil: Option<OilSupply>,
    problems: Problems,
    assumptions: Vec<Assumption>,
    /// The assumption at a place; none where chains differ in it.
    assumed: HashMap<String, Option<Json>>,
}

impl<'t> Findings<'t> {
    fn new(tree: &'t Node) -> Self {
        Self {
            tree,
            chain: None,
            oil: None,
            problems: Problems::default(),
            assumptions: Vec::new(),
            assumed: HashMap::new(),
        }
    }
}

impl Findings<'_> {
    /// A path in the scene, with that of the chain in work.
    fn of_chain(&self, path: &str) -> String {
        let within = ["chain", "route"].iter().any(|key| {
            let rest = path.strip_prefix(key);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        });
        match self.chain {
            Some(index) if within => {
                let rest = path.strip_prefix("chain").unwrap_or(path);
                let dot = if rest.starts_with("route") { "." } else { "" };
                format!("chains[{index}]{dot}{rest}")
            }
            _ => path.to_owned(),
        }
    }

    /// Notes what is taken for an absent value; several bodies may share it.
    fn assume(&mut self, path: &str, value: impl Into<Json>, remark: impl Into<String>) {
        let (path, value) = (self.of_chain(path), value.into());
        match self.assumed.get_mut(&path) {
            None => {
                self.assumed.insert(path.clone(), Some(value.clone()));
                let remark = remark.into();
                self.assumptions.push(Assumption {
                    path,
                    value,
                    remark,
                });
            }
            // What follows from chains that differ stays open: it follows from them again.
            Some(known) if known.as_ref().is_some_and(|known| *known != value) => *known = None,
            Some(_) => {}
        }
    }

    /// Everything assumed.
    fn assumptions(self) -> Vec<Assumption> {
        let Self {
            mut assumptions,
            assumed,
            ..
        } = self;
        let stands = |it: &Assumption| assumed.get(&it.path).is_some_and(Option::is_some);
        assumptions.retain(stands);
        assumptions
    }

    /// Notes the member of a family that stands for nothing.
    fn assume_kind(&mut self, path: &str, kind: &str) {
        self.assume(path, json!({"kind": kind}), "not given");
    }

    fn refuse(&mut self, path: &str, message: impl Into<String>) {
        self.refuse_with(path, message, "");
    }

    /// Refuses the value at a path, with a way out; an empty hint is none.
    fn refuse_with(&mut self, path: &str, message: impl Into<String>, hint: impl Into<String>) {
        let path = &self.of_chain(path);
        self.problems.push_with(|| {
            let (path, place) = self.tree.locate(path);
            let (problem, hint) = (Problem::new(&path, place, message), hint.into());
            if hint.is_empty() {
                problem
            } else {
                problem.hint(hint)
            }
        });
    }

    /// Refuses a value that several bodies share, once.
    fn refuse_once(&mut self, path: &str, message: impl Into<String>, hint: &str) {
        let (place, _) = self.tree.locate(&self.of_chain(path));
        if !self.problems.speak_of(&place) {
            self.refuse_with(path, message, hint);
        }
    }

    /// The value, or its error as a problem of `path`.
    fn keep<T, E: std::fmt::Display>(&mut self, path: &str, result: Result<T, E>) -> Option<T> {
        result
            .map_err(|error| self.refuse(path, error.to_string()))
            .ok()
    }

    fn unique<'n>(&mut self, names: impl Iterator<Item = (String, &'n str)>) {
        self.unique_beside(&[], names);
    }

    /// As [`unique`](Self::unique), where some names are taken.
    fn unique_beside<'n>(
        &mut self,
        taken: &[&'n str],
        names: impl Iterator<Item = (String, &'n str)>,
    ) {
        let mut seen: HashSet<&str> = taken.iter().copied().collect();
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

    fn drive_error(&mut self, error: DriveError) {
        match error {
            DriveError::Parameter {
                path,
                value,
                allowed,
            } => self.refuse(&path, format!("{value}, must be {allowed}")),
            DriveError::Law { path, source } => {
                let path = format!("{}.{}", self.in_scene(&path), source.parameter);
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
            DriveError::Conflict { path, problem } => {
                let path = self.in_scene(&path);
                self.refuse(&path, problem);
            }
            other => self.refuse("", other.to_string()),
        }
    }

    /// Path of the contacts of joints and rollers in the scene: with their chain, or for all chains.
    fn in_scene(&self, path: &str) -> String {
        for (own, common) in [
            ("joint.contact", "contact.joints"),
            ("roller.contact", "contact.rollers"),
        ] {
            if let Some((_, rest)) = path.split_once(own)
                && self.tree.find(path).is_none()
            {
                return format!("{common}{rest}");
            }
        }
        path.to_owned()
    }
}

fn point([x, y]: [Length; 2]) -> Point {
    Point::new(x.0, y.0)
}
