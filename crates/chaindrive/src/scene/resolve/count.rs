//! The number of links: as given, or from the route for a chain of the catalogue.

use chaindrive_geometry::{Closing, Side, Wheel};

use super::chains::Described;
use super::{Findings, point};
use crate::scene::schema::{self, SceneText};

/// Links of a chain whose number cannot be found: the rest of the scene is checked with it.
const GUESS: usize = 100;

/// Shortage \[pitches\] of a whole chain that the elasticity of its links takes up. New chains are longer than nominal,
/// by up to 0.15 % (ISO 606): a hundred links by seven times as much.
const SHORTAGE: f64 = 0.02;

/// Excess \[pitches\] of a whole chain up to which it is laid, and hangs through between the sprockets.
const EXCESS: f64 = 0.75;

/// How many links there are.
#[derive(Debug)]
pub(super) struct Count {
    pub(super) links: usize,
    /// Why the number is only a guess, so that mistakes elsewhere can be found first.
    pub(super) uncounted: Option<String>,
}

/// The number of links of a chain of this pitch \[m\].
pub(super) fn links(
    scene: &SceneText,
    described: &Described<'_>,
    text: &schema::Chain,
    pitch: f64,
    findings: &mut Findings<'_>,
) -> Option<Count> {
    if let Some(links) = text.links {
        return Some(Count {
            links: links as usize,
            uncounted: None,
        });
    }
    if text.of_type.is_none() || text.ends.is_some() || text.start.is_some() {
        findings.refuse_with("chain.links", "missing", "give the number of links");
        return None;
    }
    Some(match around(scene, described, pitch) {
        Ok(links) => {
            findings.assume("chain.links", links, "follows from the taut route");
            Count {
                links,
                uncounted: None,
            }
        }
        Err(reason) => Count {
            links: text.pitches.as_ref().map_or(GUESS, Vec::len),
            uncounted: Some(reason),
        },
    })
}

/// The number of links of the taut route, or why there is none.
///
/// It is even, because inner and outer links alternate. A chain that nothing adjusts and nothing tightens must
/// not be short, for want of a link would stretch all others; elsewhere the nearest number will do.
fn around(scene: &SceneText, described: &Described<'_>, pitch: f64) -> Result<usize, String> {
    let route = described.route;
    let stops = route.and_then(|route| route.stops.as_ref());
    let names: Vec<&str> = match stops {
        None => {
            let own = described.sprockets.iter();
            own.map(|&i| scene.sprockets[i].name.as_str()).collect()
        }
        Some(names) => names.iter().map(String::as_str).collect(),
    };
    let wheels: Result<Vec<Wheel>, String> =
        names.iter().map(|name| wheel(scene, name, pitch)).collect();
    let phase = route.and_then(|route| route.phase).map_or(0.5, |p| p.0);
    let name = |wheel: usize| format!("`{}`", names.get(wheel).unwrap_or(&"?"));
    let closing = Closing::march(&wheels?, pitch, phase).map_err(|e| e.with_names(&name))?;
    // e(0) = (Σm + Σk) p + residual
    let pitches = closing.excess(0) / pitch;
    let fitted = route.is_some_and(|route| {
        let moves = !matches!(route.adjust, None | Some(schema::Adjust::Nothing));
        moves || route.pretension.0 > 0.0
    });
    let pairs = if fitted {
        (0.5 * pitches).round()
    } else {
        (0.5 * (pitches - SHORTAGE)).ceil()
    };
    let excess = 2.0 * pairs - pitches;
    if !fitted && excess > EXCESS {
        return Err(format!(
            "the taut route takes {pitches:.3} pitches, for which {} links are too few and {} too many; \
             move a sprocket, or say in `route.adjust` what moves",
            2.0 * pairs - 2.0,
            2.0 * pairs
        ));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 2 and 50 000"
    )]
    Ok(2 * pairs.clamp(2.0, 50_000.0) as usize)
}

/// A stop of the route as a wheel.
fn wheel(scene: &SceneText, name: &str, pitch: f64) -> Result<Wheel, String> {
    let sprocket = scene.sprockets.iter().find(|s| s.name == name);
    let sprocket = sprocket.ok_or_else(|| {
        format!("it follows from routes around sprockets alone, and `{name}` is none")
    })?;
    let side = match sprocket.side {
        schema::Side::Left => Side::Left,
        schema::Side::Right => Side::Right,
    };
    let centre = point(sprocket.centre);
    Ok(Wheel::toothed(centre, sprocket.teeth, pitch, side))
}
