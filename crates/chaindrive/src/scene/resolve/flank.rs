//! Flanks of teeth, where they do not answer like the seats.

use chaindrive_contact::Elastic;
use chaindrive_contact::elastic::{CylinderLaw, Cylinders};
use chaindrive_geometry::{Piece, ToothGap};
use chaindrive_mechanics::Flank;

use super::Findings;
use super::chain::Resolved;
use super::law::{elastic, steel};
use crate::scene::schema::{self, SceneText};

/// Half-width of the passage from seat to flank \[roller diameters\].
const WIDTH: f64 = 0.05;

/// The flank of a sprocket: its own, then the common one, then what follows from the curvature where
/// rigid links leave the law of their teeth open.
pub(super) fn resolve(
    text: &schema::Sprocket,
    path: &str,
    scene: &SceneText,
    gap: &ToothGap,
    chain: &Resolved,
    findings: &mut Findings<'_>,
) -> Option<Flank> {
    let width = WIDTH * chain.chain.roller_diameter;
    let given = match (&text.flank, &scene.contact.flanks) {
        (Some(own), _) => Some((own, format!("{path}.flank"))),
        (None, Some(common)) => Some((common, "contact.flanks".to_owned())),
        (None, None) => None,
    };
    if let Some((flank, path)) = given {
        let elastic = elastic(&flank.law, chain.roller(), &format!("{path}.law"), findings)?;
        return Some(Flank {
            elastic,
            width: flank.width.map_or(width, |width| width.0),
        });
    }
    let open = text.contact.law.is_none() && scene.contact.teeth.law.is_none();
    let follows = if chain.is_rigid() && open {
        on_bulge(gap, chain)
    } else {
        None
    };
    follows.map(|elastic| Flank { elastic, width })
}

/// The enhanced cylindrical law of the roller on the first arc that bulges behind the seat.
fn on_bulge(gap: &ToothGap, chain: &Resolved) -> Option<Elastic> {
    let pieces = gap.pieces();
    let hollow = |piece: &Piece| matches!(piece, Piece::Arc(arc) if arc.sweep < 0.0);
    let last = pieces.iter().rposition(hollow)?;
    let behind = pieces.get(last + 1)?;
    let curvature = match behind {
        Piece::Arc(arc) => 1.0 / arc.radius,
        Piece::Segment(_) => 0.0,
    };
    let roller = chain.roller();
    let (radius, length) = (roller.radius, roller.length?);
    let cap = 0.5 * chain.chain.pitch;
    let pair = Cylinders::on_curve(radius, curvature, length, steel(), cap);
    // Below the least sum of radii of the fit the seat's law goes on.
    CylinderLaw::Cylindrical.between(&pair).ok()
}
