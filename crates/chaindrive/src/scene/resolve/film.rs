//! Films of oil, completed from the surfaces that they lie between.

use chaindrive_contact::{Film, Lubricant};
use chaindrive_geometry::{Piece, ToothGap};

use super::cursor::Cursor;
use super::law::Pair;
use crate::scene::schema::Written;

/// Dimensions of the strip between two surfaces, as far as the drive gives them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// Radius of the cylinder beside a plane \[m\].
    radius: Option<f64>,
    half_width: Option<f64>,
    length: Option<f64>,
}

/// Half of the arc of a bore or hollow on which oil bears at most, as a sine. *Assumed*: 120°, where a parabola is not yet a wrong gap.
const OF_A_BORE: f64 = 0.866;
/// Half width on a guide over the radius; the film needs √(2h/R), a tenth or less.
const ON_A_GUIDE: f64 = 0.5;

impl Strip {
    /// Under a roller on a guide.
    pub(super) fn on_guide(roller: Pair) -> Self {
        Self {
            radius: Some(roller.radius),
            half_width: Some(ON_A_GUIDE * roller.radius),
            length: roller.length,
        }
    }

    /// Around a pin, or a bush.
    pub(super) fn in_bore(pair: Pair) -> Self {
        Self {
            radius: pair.bore.and_then(|bore| equivalent(pair.radius, bore)),
            half_width: Some(OF_A_BORE * pair.radius),
            length: pair.length,
        }
    }

    /// Under a roller in the hollow of a gap.
    pub(super) fn in_seat(roller: Pair, gap: &ToothGap) -> Self {
        // The hollow as one circle: arcs of more than one radius have no seat of their own.
        let hollow = |piece: &Piece| match piece {
            Piece::Arc(arc) if arc.sweep < 0.0 => Some(arc.sweep.abs()),
            _ => None,
        };
        let sweeps: Vec<f64> = gap.pieces().iter().filter_map(hollow).collect();
        let half = (!sweeps.is_empty()).then(|| 0.5 * sweeps.iter().sum::<f64>());
        let seat = roller.radius + gap.seat_clearance;
        Self {
            radius: equivalent(roller.radius, seat),
            half_width: half.map(|angle| roller.radius * libm::sin(angle).min(OF_A_BORE)),
            length: roller.length,
        }
    }
}

/// R = r₁ r₂/(r₂ − r₁).
fn equivalent(inner: f64, outer: f64) -> Option<f64> {
    let apart = outer - inner;
    (apart > 0.0).then(|| inner * outer / apart)
}

/// Film of a text between such surfaces; none for a refused text.
pub(super) fn resolve(text: &Written<Film>, strip: Strip, mut at: Cursor<'_, '_>) -> Option<Film> {
    let mut keys = at.completed(text);
    let viscosity = at.fill_viscosity(&mut keys, Lubricant::dynamic_viscosity);
    let hint = "give it, such as \"14 mm\"";
    let of_radius =
        "give the radius of the cylinder beside a plane, r₁ r₂/(r₂ − r₁), such as \"2.7 m\"";
    let measures = [
        ("radius", strip.radius, of_radius),
        ("half_width", strip.half_width, hint),
        ("length", strip.length, hint),
    ];
    let filled = measures.map(|(key, known, hint)| {
        let known = known.zip(Some("follows from the surfaces"));
        at.fill(&mut keys, key, known, hint)
    });
    viscosity.filter(|()| !filled.contains(&None))?;
    at.read(keys, Film::check)
}
