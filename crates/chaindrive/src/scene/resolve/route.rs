//! Layout of the chain at the start.

use chaindrive_geometry::Vector;
use chaindrive_mechanics::{Adjust, Chain, Fit, Layout, Stop, Tighten};

use super::chains::ChainDescription;
use super::cursor::Cursor;
use super::{Findings, Names, housing, start};
use crate::scene::defaults;
use crate::scene::schema::{self, Route, SceneText};
use crate::scene::suggest::one_of;

/// The layout of a chain: as `chain.start` says, or else along the route.
pub(super) fn layout(
    scene: &SceneText,
    (described, chain): (&ChainDescription<'_>, &Chain),
    names: &Names<'_>,
    gravity: Vector,
    findings: &mut Findings<'_>,
) -> Option<Layout> {
    if let Some(start) = &described.text.start {
        if described.route.is_some() {
            let hint = "keep one of them";
            findings.refuse_with("route", "`chain.start` lays the chain already", hint);
        }
        return start::layout(start, chain, gravity, findings);
    }
    if described.text.ends.is_some() {
        let hint = "say where an open strand lies: `line`, `hang` or `points`";
        findings.refuse_with("chain.start", "missing", hint);
        if described.route.is_some() {
            findings.refuse("route", "an open strand has no route");
        }
        return None;
    }
    let absent = Route::default();
    let route = described.route.unwrap_or(&absent);
    if described.route.is_none() {
        findings.assume("route.pretension", 0.0, "not given");
        findings.assume("route.tighten", "rest-length", "not given");
    }
    let stops = stops(route, &described.sprockets, names, findings);
    let adjust = adjust(route, scene, names, findings);
    let adjust = adjust?;
    let tighten = route.tighten;
    if tighten == Tighten::Travel && adjust == Adjust::Nothing {
        let hint = format!(
            "give {}, or take `rest-length`",
            way_to_move(scene, described)
        );
        findings.refuse_with("route.tighten", "nothing is there to travel", hint);
    }
    if route.sag.is_some() {
        if adjust == Adjust::Nothing {
            let hint = format!("give {}", way_to_move(scene, described));
            findings.refuse_with("route.sag", "nothing is moved to make it", hint);
        }
        if route.pretension.0 > 0.0 {
            let hint = "keep one of them: a chain that sags has no pretension";
            findings.refuse_with("route.sag", "`route.pretension` is given too", hint);
        }
    }
    let stops = stops?;
    let slack = slack_span(route, &stops, names, findings);
    Some(Layout::Route {
        stops,
        start: findings
            .at("route.start")
            .or_chosen(route.start, &defaults::SPAN_START),
        phase: findings.at("route.phase").or(route.phase, &defaults::PHASE),
        fit: Fit {
            adjust,
            growth: housing::growth(scene, findings),
            pretension: route.pretension.0,
            tighten,
            sag: route.sag.map(f64::from),
            slack,
            at: findings
                .at("route.pretension_at")
                .or_chosen(route.pretension_at, &defaults::PRETENSION_AT),
        },
    })
}

/// An entry of a route that lets something move: the first tensioner, or else the last sprocket.
fn way_to_move(scene: &SceneText, described: &ChainDescription<'_>) -> String {
    let (kind, name, more) = if let Some(tensioner) = scene.tensioners.first() {
        (tensioner.carrier.word("kind"), tensioner.name.as_str(), "")
    } else {
        let last = described.sprockets.last();
        let last = last.map_or("…", |&index| scene.sprockets[index].name.as_str());
        ("sprocket", last, ", direction = [1, 0]")
    };
    let within = if kind == "arm" { "5 deg" } else { "5 mm" };
    format!(
        "`adjust = {{ kind = \"{kind}\", name = \"{name}\"{more}, within = \"{within}\" }}` beside it, which says what moves"
    )
}

/// The stop that the slack span leaves, where one is named; a wrong name is a finding.
fn slack_span(
    route: &Route,
    stops: &[Stop],
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<usize> {
    let wanted = route.slack_span.as_ref()?;
    let name = |stop: &Stop| match stop {
        Stop::Sprocket(index) => names.sprockets[*index],
        Stop::Guide(index) => names.guides[*index],
    };
    let next = stops.iter().cycle().skip(1);
    let spans = stops.iter().zip(next);
    let spans: Vec<String> = spans
        .map(|(from, to)| format!("{}-{}", name(from), name(to)))
        .collect();
    let found = spans.iter().position(|span| span == wanted);
    if found.is_none() {
        let known: Vec<&str> = spans.iter().map(String::as_str).collect();
        let message = format!("no span is named `{wanted}`");
        findings.refuse_with("route.slack_span", message, one_of(wanted, &known));
    }
    found
}

fn stops(
    route: &Route,
    own: &[usize],
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<Vec<Stop>> {
    let Some(stops) = &route.stops else {
        let count = own.len();
        if count < 2 {
            let message = format!("{count} sprockets, but a closed chain runs around at least two");
            let hint = "add a sprocket, or make the chain a strand with `chain.ends`";
            findings.refuse_with("sprockets", message, hint);
            return None;
        }
        let remark = "all sprockets, in the order of the text";
        let passed: Vec<&str> = own.iter().map(|&i| names.sprockets[i]).collect();
        findings.assume("route.stops", passed, remark);
        return Some(own.iter().copied().map(Stop::Sprocket).collect());
    };
    let mut found = Vec::new();
    let mut complete = true;
    for (i, name) in stops.iter().enumerate() {
        let mut at = findings.at(format!("route.stops[{i}]"));
        let sprocket = names.sprockets.iter().position(|known| known == name);
        let guide = || names.guides.iter().position(|known| known == name);
        let stop = sprocket
            .map(Stop::Sprocket)
            .or_else(|| guide().map(Stop::Guide));
        let Some(stop) = stop else {
            let known: Vec<&str> = names
                .sprockets
                .iter()
                .chain(&names.guides)
                .copied()
                .collect();
            let message = format!("no sprocket or guide is named `{name}`");
            at.refuse(message, one_of(name, &known));
            complete = false;
            continue;
        };
        if found.contains(&stop) {
            let message = format!("`{name}` stands twice");
            at.refuse(message, "the chain passes it once");
        } else if i == 0 && sprocket.is_none() {
            let hint = "begin the list with any of the sprockets";
            at.refuse("the first stop must be a sprocket", hint);
        }
        found.push(stop);
    }
    if stops.len() < 2 {
        let message = format!("{} stops, but a closed chain has at least two", stops.len());
        findings.refuse("route.stops", message);
    }
    complete.then_some(found)
}

fn adjust(
    route: &Route,
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<Adjust> {
    let mut at = findings.at("route.adjust");
    let tensioner = |name: &str, kind: &str, mut at: Cursor<'_, '_>| {
        let index = names.tensioner(name, at.again())?;
        let other = scene.tensioners[index].carrier.word("kind");
        if other != kind {
            let hint = format!("take `kind = \"{other}\"`");
            at.refuse(format!("`{name}` is of the kind {other}"), hint);
            return None;
        }
        Some(index)
    };
    match &route.adjust {
        None => {
            at.assume_kind("nothing");
            Some(Adjust::Nothing)
        }
        Some(schema::Adjust::Nothing) => Some(Adjust::Nothing),
        Some(schema::Adjust::Sprocket {
            name,
            direction,
            within,
        }) => {
            let sprocket = at.key("name").lookup(&names.sprockets, "sprocket", name);
            let direction = at.key("direction").direction(*direction);
            Some(Adjust::Sprocket {
                sprocket: sprocket?,
                direction: direction?,
                within: within.0,
            })
        }
        Some(schema::Adjust::Slider { name, within }) => Some(Adjust::Tensioner {
            tensioner: tensioner(name, "slider", at.key("name"))?,
            within: within.0,
        }),
        Some(schema::Adjust::Arm { name, within }) => Some(Adjust::Tensioner {
            tensioner: tensioner(name, "arm", at.key("name"))?,
            within: within.0,
        }),
    }
}
