//! The chains as written, and which sprockets and guides belong to each.

use super::{Findings, Names};
use crate::scene::schema::{Chain, Route, SceneText};
use crate::scene::suggest::one_of;

/// A chain as written, with its route and all that it can touch.
#[derive(Clone, Debug)]
pub(super) struct ChainDescription<'s> {
    /// Its name; none where there is one chain only.
    pub(super) name: Option<&'s str>,
    pub(super) text: &'s Chain,
    pub(super) route: Option<&'s Route>,
    /// Indices of its sprockets and guides.
    pub(super) sprockets: Vec<usize>,
    pub(super) guides: Vec<usize>,
}

/// The chains of a scene; none where it cannot be told what belongs to which.
pub(super) fn described<'s>(
    scene: &'s SceneText,
    names: &Names<'s>,
    findings: &mut Findings<'_>,
) -> Option<Vec<ChainDescription<'s>>> {
    let Some(text) = &scene.chain else {
        return several(scene, names, findings);
    };
    if !scene.chains.is_empty() {
        let hint =
            "keep one of them: several chains are all `[[chains]]`, each with its `[chains.route]`";
        findings.refuse_with("chains", "`chain` is given too", hint);
        return None;
    }
    for (path, chain) in said(scene) {
        if chain.is_some() {
            let hint = "leave it out, or write `[[chains]]`";
            findings.refuse_with(&path, "there is one chain only, and it has no name", hint);
        }
    }
    Some(vec![ChainDescription {
        name: None,
        text,
        route: scene.route.as_ref(),
        sprockets: (0..scene.sprockets.len()).collect(),
        guides: (0..scene.guides.len()).collect(),
    }])
}

/// Paths at which bodies name the chain that they belong to: sprockets, then guides.
fn said(scene: &SceneText) -> impl Iterator<Item = (String, Option<&String>)> {
    let sprockets = scene.sprockets.iter().enumerate();
    let sprockets = sprockets.map(|(i, it)| (format!("sprockets[{i}].chain"), it.chain.as_ref()));
    let guides = scene.guides.iter().enumerate();
    let guides = guides.map(|(i, it)| (format!("guides[{i}].chain"), it.chain.as_ref()));
    sprockets.chain(guides)
}

fn several<'s>(
    scene: &'s SceneText,
    names: &Names<'s>,
    findings: &mut Findings<'_>,
) -> Option<Vec<ChainDescription<'s>>> {
    if scene.route.is_some() {
        let hint = "every chain has its own: `[chains.route]` after its `[[chains]]`";
        findings.refuse_with("route", "several chains have no common route", hint);
    }
    // One entry a body, sprockets first.
    let bodies: Vec<&str> = names
        .sprockets
        .iter()
        .chain(&names.guides)
        .copied()
        .collect();
    let mut owners: Vec<Option<usize>> = vec![None; bodies.len()];
    let mut sound = true;
    for (index, chain) in scene.chains.iter().enumerate() {
        let stops = chain.route.iter().filter_map(|route| route.stops.as_ref());
        for (i, stop) in stops.flatten().enumerate() {
            let Some(body) = bodies.iter().position(|name| name == stop) else {
                // The route itself is resolved later, and refused then.
                continue;
            };
            match owners[body] {
                Some(other) if other != index => {
                    let path = format!("chains[{index}].route.stops[{i}]");
                    let message =
                        format!("`{stop}` is on the route of `{}` too", names.chains[other]);
                    let hint =
                        "a sprocket has one chain: put two of them on one of the `[[shafts]]`";
                    findings.refuse_with(&path, message, hint);
                    sound = false;
                }
                _ => owners[body] = Some(index),
            }
        }
    }
    for ((path, chain), owner) in said(scene).zip(&mut owners) {
        let Some(chain) = chain else {
            if owner.is_none() {
                let hint = format!("say which chain it belongs to: {}", names.chains.join(", "));
                findings.refuse_with(&path, "missing: no route passes it", hint);
                sound = false;
            }
            continue;
        };
        let found = findings.at(&*path).lookup(&names.chains, "chain", chain);
        match (found, *owner) {
            (None, _) => sound = false,
            (Some(found), Some(passed)) if found != passed => {
                let message = format!("the route of `{}` passes it", names.chains[passed]);
                let hint = one_of(names.chains[passed], &names.chains);
                findings.refuse_with(&path, message, hint);
                sound = false;
            }
            (found, _) => *owner = found,
        }
    }
    let of = |owners: &[Option<usize>], chain: usize| -> Vec<usize> {
        let all = owners.iter().enumerate();
        all.filter(|(_, owner)| **owner == Some(chain))
            .map(|(body, _)| body)
            .collect()
    };
    let (sprockets, guides) = owners.split_at(scene.sprockets.len());
    let described = scene
        .chains
        .iter()
        .enumerate()
        .map(|(index, chain)| ChainDescription {
            name: Some(&chain.name),
            text: &chain.chain,
            route: chain.route.as_ref(),
            sprockets: of(sprockets, index),
            guides: of(guides, index),
        });
    sound.then(|| described.collect())
}
