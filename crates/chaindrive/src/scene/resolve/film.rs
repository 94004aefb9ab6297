//! Films of oil, completed from the surfaces that they lie between.

use chaindrive_contact::Film;
use chaindrive_geometry::{Piece, ToothGap};

use super::Findings;
use super::law::Pair;
use crate::scene::defaults;
use crate::scene::schema;

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

/// Film of the text at `path` between such surfaces; none for a refused text.
pub(super) fn resolve(
    text: &schema::Film,
    path: &str,
    strip: Strip,
    findings: &mut Findings<'_>,
) -> Option<Film> {
    let at = |key: &str| format!("{path}.{key}");
    let viscosity = match text.viscosity {
        Some(viscosity) => Some(viscosity.0),
        None => findings.oil_dynamic_viscosity(&at("viscosity")),
    };
    let radius = text.radius.map(|it| it.0);
    let half_width = text.half_width.map(|it| it.0);
    let length = text.length.map(|it| it.0);
    let mut measure = |given: Option<f64>, known: Option<f64>, key: &str, hint: &str| {
        if given.is_none() {
            match known {
                Some(known) => {
                    findings.assume(&at(key), known, "follows from the surfaces");
                }
                None => findings.refuse_with(&at(key), "missing", hint),
            }
        }
        given.or(known)
    };
    let hint = "give the radius of the cylinder beside a plane, r₁ r₂/(r₂ − r₁), such as \"2.7 m\"";
    let radius = measure(radius, strip.radius, "radius", hint);
    let hint = "give it, such as \"14 mm\"";
    let half_width = measure(half_width, strip.half_width, "half_width", hint);
    let length = measure(length, strip.length, "length", hint);
    let (radius, half_width, length) = (radius?, half_width?, length?);
    let mut or_default =
        |given: Option<f64>, key: &str, default| findings.or_default(given, &at(key), default);
    let pressure = text.pressure_coefficient.map(|it| it.0);
    let pressure = or_default(
        pressure,
        "pressure_coefficient",
        &defaults::PRESSURE_VISCOSITY,
    );
    let roughness = text.roughness.map(|it| it.0);
    let roughness = or_default(roughness, "roughness", &defaults::FILM_ROUGHNESS);
    let refill = text.refill_time.map(|it| it.0);
    let refill_time = or_default(refill, "refill_time", &defaults::REFILL_TIME);
    let film = Film {
        viscosity: viscosity?,
        pressure_coefficient: pressure,
        radius,
        half_width,
        length,
        leakage_factor: text.leakage_factor.map(|it| it.0),
        thickness: text.thickness.0,
        roughness,
        refill_time,
    };
    let sound = film.check();
    let sound = sound.map_err(|error| findings.refuse_parameter(path, &error));
    sound.ok().map(|()| film)
}
