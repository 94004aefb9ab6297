//! The number of links: as given, or from the route.

use chaindrive_geometry::{Closing, Route, Search, Wheel, close_nearest};

use super::Findings;
use super::chains::ChainDescription;
use super::on_span::GuidedChain;
use crate::scene::defaults;
use crate::scene::schema::{self, SceneText};

/// Links of a chain whose number cannot be found: the rest of the scene is checked with it.
const GUESS: usize = 100;

/// Shortage \[pitches\] of a whole chain that the elasticity of its links takes up. New chains are longer than nominal,
/// by up to 0.15 % (ISO 606): a hundred links by seven times as much.
const SHORTAGE: f64 = 0.02;

/// Excess \[pitches\] of a whole chain up to which it is laid, and hangs through between the sprockets.
const EXCESS: f64 = 0.75;

/// Number of links, and its source.
#[derive(Debug)]
pub(super) struct Count {
    pub(super) links: usize,
    /// Why the number is only a guess, so that mistakes elsewhere can be found first.
    pub(super) uncounted: Option<String>,
}

/// The number of links of a chain of this pitch \[m\].
pub(super) fn links(
    scene: &SceneText,
    described: &ChainDescription<'_>,
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
    let nowhere = text.of_type.is_none() && described.sprockets.is_empty();
    if nowhere || text.ends.is_some() || text.start.is_some() {
        findings.refuse_with("chain.links", "missing", "give the number of links");
        return None;
    }
    let usual = pitch * defaults::ROLLER_DIAMETER.value;
    let roller_diameter = text.roller_diameter.map_or(usual, f64::from);
    let usual = roller_diameter * defaults::PLATE_HEIGHT.value;
    let plate_height = text.plate_height.map_or(usual, f64::from);
    Some(
        match around(scene, described, [pitch, roller_diameter, plate_height]) {
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
        },
    )
}

/// The number of links of the taut route, or why there is none.
///
/// It is even, because inner and outer links alternate. A chain that nothing adjusts and nothing tightens must
/// not be short, for want of a link would stretch all others; elsewhere the nearest number will do, where one is near enough.
fn around(
    scene: &SceneText,
    described: &ChainDescription<'_>,
    size: [f64; 3],
) -> Result<usize, String> {
    let route = described.route;
    let passing = GuidedChain::new(scene, described, size);
    let [pitch, ..] = size;
    let phase = passing.phase().unwrap_or(0.5);
    let name = |wheel: usize| format!("`{}`", passing.stops.get(wheel).unwrap_or(&"?"));
    let wheels = passing.plan()?.lay().map_err(|e| e.with_names(&name))?;
    let closing = Closing::march(&wheels, pitch, phase).map_err(|e| e.with_names(&name))?;
    // e(0) = (Σm + Σk) p + residual
    let pitches = closing.excess(0) / pitch;
    let moves =
        route.is_some_and(|route| !matches!(route.adjust, None | Some(schema::Adjust::Nothing)));
    let tightened = route.is_some_and(|route| route.pretension.0 > 0.0);
    let pairs = if moves || tightened {
        (0.5 * pitches).round()
    } else {
        (0.5 * (pitches - SHORTAGE)).ceil()
    };
    // A tightened chain is made to fit, but not by the better part of a link.
    let excess = 2.0 * pairs - pitches;
    if !moves && excess.abs() > EXCESS {
        let few = if excess > 0.0 { pairs - 1.0 } else { pairs };
        let counts = [few, few + 1.0].map(even);
        let [few, many] = counts;
        let places = counts.map(|links| place(&wheels, pitch, links, phase, &name));
        let places: Vec<_> = places.into_iter().flatten().collect();
        return Err(format!(
            "the taut route takes {pitches:.3} pitches, for which {few} links are too few and {many} too many; {}, \
             or say in `route.adjust` what moves",
            if places.is_empty() {
                "move a sprocket".to_owned()
            } else {
                places.join(" or ")
            }
        ));
    }
    Ok(even(pairs) as usize)
}

/// Position of a sprocket at which a number of links closes.
fn place(
    wheels: &[Wheel],
    pitch: f64,
    links: u32,
    phase: f64,
    name: &dyn Fn(usize) -> String,
) -> Option<String> {
    let (wheel, direction) = Route::taut(wheels).ok()?.most_effective()?;
    let mut moving = |travel: f64| {
        let mut wheels = wheels.to_vec();
        wheels[wheel].centre += direction * travel;
        wheels
    };
    let search = Search {
        start: 0.0,
        step: 0.1 * pitch,
        within: 4.0 * pitch,
    };
    let (_, moved, _) = close_nearest(pitch, 0.0, links, phase, &mut moving, search).ok()?;
    let centre = moved[wheel].centre;
    Some(format!(
        "move {} to ({:.4}, {:.4}) mm for {links}",
        name(wheel),
        centre.x * 1e3,
        centre.y * 1e3
    ))
}

/// Links of so many pairs.
fn even(pairs: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 2 and 50 000"
    )]
    let pairs = pairs.clamp(2.0, 50_000.0) as u32;
    2 * pairs
}
