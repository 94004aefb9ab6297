//! Tensioners.

use chaindrive_mechanics::pushes::Oil;
use chaindrive_mechanics::{Carrier, Forces, Push, Tensioner};
use chaindrive_quantities::{Ratio, check};
use serde::Deserialize;
use serde_json::{Value as Json, json};

use super::Findings;
use super::cursor::Cursor;
use crate::scene::schema::{self, GuideSupport, SceneText, Support};

pub(super) fn resolve_all(
    scene: &SceneText,
    findings: &mut Findings<'_>,
) -> Option<Vec<Tensioner>> {
    let mut tensioners = Vec::new();
    for (i, text) in scene.tensioners.iter().enumerate() {
        let mut at = findings.at(format!("tensioners[{i}]"));
        let sprockets = scene
            .sprockets
            .iter()
            .any(|s| matches!(&s.support, Some(Support::Tensioner { name }) if *name == text.name));
        let guides = scene.guides.iter().any(
            |g| matches!(&g.support, Some(GuideSupport::Tensioner { name }) if *name == text.name),
        );
        if !(sprockets || guides) {
            let hint = "let a sprocket or guide say `support = { kind = \"tensioner\", name = … }`";
            at.refuse(format!("`{}` carries nothing", text.name), hint);
        }
        tensioners.push(resolve(text, at));
    }
    tensioners.into_iter().collect()
}

fn resolve(text: &schema::Tensioner, mut at: Cursor<'_, '_>) -> Option<Tensioner> {
    let mut of_carrier = at.key("carrier");
    let keys = unit_vectors(text.carrier.keys.clone(), of_carrier.again());
    let carrier = keys.and_then(|keys| of_carrier.read(keys, check::<Carrier>));
    let push = push(text, carrier.as_ref(), at.key("push"));
    let (carrier, push) = (carrier?, push?);
    if let (key, None) = carrier.inertia()
        && push != Push::Locked
    {
        let hint = format!("give the {key} of a tensioner that is not locked");
        at.key("carrier").key(key).refuse("missing", hint);
    }
    Some(Tensioner {
        name: text.name.clone(),
        carrier,
        push,
        // Found where the shafts are known.
        forces: Forces::default(),
        forced_at: None,
    })
}

/// The keys of a carrier, each `direction` with the length of one.
fn unit_vectors(mut keys: Json, mut at: Cursor<'_, '_>) -> Option<Json> {
    for (key, value) in keys.as_object_mut()? {
        let mut at = at.key(key);
        if key == "direction" {
            let given = <[Ratio; 2]>::deserialize(&*value).ok()?;
            *value = json!(at.direction(given)?);
        } else if value.is_object() {
            *value = unit_vectors(value.take(), at)?;
        }
    }
    Some(keys)
}

/// A push on a carrier, if that is known.
fn push(
    text: &schema::Tensioner,
    carrier: Option<&Carrier>,
    mut at: Cursor<'_, '_>,
) -> Option<Push> {
    let mut keys = text.push.keys.clone();
    if text.push.word("kind") == "hydraulic" {
        keys = forces_of_oil(keys, at.again())?;
    }
    let push: Push = at.read(keys, |push| match push {
        Push::Registered(law) => law.check(),
        own => check(own),
    })?;
    if let Push::Hydraulic(plunger) = &push
        && plunger.relief < plunger.supply
    {
        let given = text.push.keys.get("oil").map_or("relief", |_| "oil.relief");
        let message = "the relief valve opens below the supply pressure";
        at.key(given).refuse(message, "");
        return None;
    }
    match (push.unit(), carrier?.push_unit()) {
        (Some("N"), "N m") => {
            let hint = "give the arm a `plunger`, or take a `torsion-spring`";
            at.refuse("a force needs a place on the arm", hint);
            None
        }
        (Some("N m"), "N") => {
            let hint = "take a `spring`, or an arm without a plunger";
            let message = "a torsion spring turns an arm and nothing else";
            at.refuse(message, hint);
            None
        }
        _ => Some(push),
    }
}

/// The keys of a plunger, with the forces that follow from its oil in place of it.
fn forces_of_oil(mut keys: Json, mut at: Cursor<'_, '_>) -> Option<Json> {
    let direct = ["supply", "relief", "leak"];
    let Some(oil) = keys.as_object_mut()?.shift_remove("oil") else {
        let absent = direct.iter().filter(|key| keys.get(**key).is_none());
        let absent: Vec<_> = absent.collect();
        for key in &absent {
            let hint = "give `supply`, `relief` and `leak`, or `oil`, from which they follow";
            at.key(key).refuse("missing", hint);
        }
        return absent.is_empty().then_some(keys);
    };
    for key in direct.iter().filter(|key| keys.get(**key).is_some()) {
        let hint = "keep one of them";
        at.key(key).refuse("`oil` is given too", hint);
    }
    let oil: Oil = at.key("oil").read(oil, check)?;
    // F = p A
    keys["supply"] = (oil.supply * oil.area()).into();
    keys["relief"] = (oil.relief * oil.area()).into();
    keys["leak"] = oil.leak_damping().into();
    let given = [
        ("bulk_modulus", oil.bulk_modulus),
        ("volume", oil.volume),
        ("air", oil.air),
    ];
    if given.iter().all(|(_, value)| value.is_none()) {
        return Some(keys);
    }
    for (key, _) in given.iter().filter(|(_, value)| value.is_none()) {
        let hint = "oil that can be compressed needs `bulk_modulus`, `volume` and `air`";
        at.key("oil").key(key).refuse("missing", hint);
    }
    let mut resists = true;
    for key in ["extending", "relieving"] {
        if keys
            .get(key)
            .and_then(Json::as_f64)
            .is_none_or(|c| c <= 0.0)
        {
            let hint = "give the damping by the valve, such as \"200 N s/m\"";
            let message = "oil that can be compressed needs a valve with a resistance";
            at.key(key).refuse(message, hint);
            resists = false;
        }
    }
    keys["column"] = json!(oil.column().filter(|_| resists)?);
    Some(keys)
}
