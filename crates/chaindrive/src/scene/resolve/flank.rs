//! Flanks of teeth, where they do not answer like the seats.

use chaindrive_contact::elastic::{CylinderLaw, Cylinders, Specification, Surfaces};
use chaindrive_contact::{Elastic, Elasticity};
use chaindrive_geometry::{Piece, ToothGap};
use chaindrive_mechanics::Flank;

use serde_json::Value as Json;

use super::chain::ResolvedChain;
use super::cursor::Cursor;
use super::law::{elastic, steel};
use crate::scene::defaults;
use crate::scene::schema::{self, SceneText};

/// The flank of a sprocket: its own, then the common one, then what follows from the curvature where
/// rigid links leave the law of their teeth open.
pub(super) fn resolve(
    text: &schema::Sprocket,
    scene: &SceneText,
    gap: &ToothGap,
    chain: &ResolvedChain,
    mut at: Cursor<'_, '_>,
) -> Option<Flank> {
    let diameter = chain.chain.roller_diameter;
    let given = match (&text.flank, &scene.contact.flanks) {
        (Some(own), _) => Some((own, at.key("flank"))),
        (None, Some(common)) => Some((common, at.findings.at("contact.flanks"))),
        (None, None) => None,
    };
    if let Some((flank, mut at)) = given {
        let elastic = elastic(&flank.law, chain.roller(), at.key("law"))?;
        let width = at
            .key("width")
            .or_multiple(flank.width, &defaults::FLANK_WIDTH, diameter);
        return Some(Flank { elastic, width });
    }
    let open = text.contact.law.is_none() && scene.contact.teeth.law.is_none();
    if !(chain.is_rigid() && open) {
        return None;
    }
    let mut at = at.key("flank");
    let (elastic, text) = on_bulge(gap, chain, steel())?;
    at.key("law")
        .assume(text, "follows from the curvature of the flank");
    let width = at
        .key("width")
        .or_multiple(None::<f64>, &defaults::FLANK_WIDTH, diameter);
    Some(Flank { elastic, width })
}

/// The enhanced cylindrical law of the roller on the first arc that bulges behind the seat; and as a scene writes it.
fn on_bulge(gap: &ToothGap, chain: &ResolvedChain, steel: Elasticity) -> Option<(Elastic, Json)> {
    let pieces = gap.pieces();
    let hollow = |piece: &Piece| matches!(piece, Piece::Arc(arc) if arc.sweep < 0.0);
    let last = pieces.iter().rposition(hollow)?;
    let behind = pieces.get(last + 1)?;
    let (curvature, other) = match behind {
        Piece::Arc(arc) => (1.0 / arc.radius, Some(arc.radius)),
        Piece::Segment(_) => (0.0, None),
    };
    let roller = chain.roller();
    let (radius, length) = (roller.radius, roller.length?);
    let cap = 0.5 * chain.chain.pitch;
    let pair = Cylinders::on_curve(radius, curvature, length, steel.composite(steel), cap);
    // Below the least sum of radii of the fit the seat's law goes on.
    let law = CylinderLaw::Cylindrical.between(&pair).ok()?;
    let text = Specification::Cylindrical(Surfaces {
        length: Some(length),
        modulus: steel.modulus,
        poisson: steel.poisson,
        radius: Some(radius),
        other_radius: other,
        clearance: None,
        depth_cap: Some(cap),
    });
    Some((law, serde_json::to_value(text).ok()?))
}
