//! Elastic laws: what a scene says, completed by the surfaces that touch.

use chaindrive_contact::elastic::{
    CurveOrBodies, CylinderLaw, Cylinders, Johnson, Power, Specification, Surfaces,
};
use chaindrive_contact::{Elastic, Elasticity, ParameterError};
use serde_json::json;

use super::cursor::Cursor;
use crate::scene::defaults::{self, Default};
use crate::scene::schema::Written;

/// The two surfaces of a contact, as far as the drive gives them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// Radius of the roller or pin \[m\].
    pub(super) radius: f64,
    /// Radius of the bore that surrounds it \[m\]; none on teeth and guides.
    pub(super) bore: Option<f64>,
    /// Length on which they touch \[m\], where the chain gives it.
    pub(super) length: Option<f64>,
}

/// Material that surfaces are assumed to be of.
pub(super) fn steel() -> Elasticity {
    Elasticity {
        modulus: defaults::MODULUS.value,
        poisson: defaults::POISSON.value,
    }
}

/// The enhanced cylindrical law of steel in a hollow that is wider by `clearance` \[m\].
pub(super) fn cylindrical(
    pair: Pair,
    clearance: f64,
    length: f64,
    steel: Elasticity,
) -> Result<Elastic, ParameterError> {
    let hollow = pair.radius + clearance;
    CylinderLaw::Cylindrical.between(&Cylinders::pin_in_hole(
        hollow,
        pair.radius,
        length,
        steel.composite(steel),
    ))
}

/// A spring with a multiple of a stiffness \[N/m\], for a law that a scene leaves open.
pub(super) fn linear(stiffness: f64, default: &Default, mut at: Cursor<'_, '_>) -> Elastic {
    let (stiffness, remark) = default.multiple(stiffness);
    at.assume(json!({"kind": "linear", "stiffness": stiffness}), remark);
    Elastic::Power(Power::linear(stiffness))
}

/// The law that a scene describes.
pub(super) fn elastic(
    law: &Written<Specification>,
    pair: Pair,
    mut at: Cursor<'_, '_>,
) -> Option<Elastic> {
    let keys = at.completed(law);
    let law: Specification = at.read(keys, Specification::check)?;
    match law.given() {
        CurveOrBodies::Curve(law) => Some(law),
        CurveOrBodies::Bodies(CylinderLaw::Hertz, bodies) => {
            let Sides {
                radius,
                other,
                modulus,
            } = Sides::of(&bodies, pair, at)?;
            let other = other.unwrap_or(f64::INFINITY);
            Some(Power::hertz_pair(radius, other, modulus).into())
        }
        CurveOrBodies::Bodies(kind, bodies) => cylinders(kind, &bodies, pair, at),
    }
}

fn cylinders(
    kind: CylinderLaw,
    text: &Surfaces,
    pair: Pair,
    mut at: Cursor<'_, '_>,
) -> Option<Elastic> {
    let length = match (text.length, pair.length) {
        (Some(length), _) => length,
        (None, Some(length)) => {
            at.key("length")
                .assume(length, "length of the roller or joint");
            length
        }
        (None, None) => {
            at.key("length")
                .refuse_once("missing", "give the length of the contact");
            return None;
        }
    };
    let Sides {
        radius,
        other,
        modulus,
    } = Sides::of(text, pair, at.again())?;
    if kind == CylinderLaw::Johnson {
        return Some(Elastic::Johnson(match (text.clearance, other) {
            (Some(clearance), _) => Johnson::internal(clearance, 0.0, length, modulus),
            (None, None) => Johnson::flat(radius, length, modulus),
            (None, Some(other)) if other < 0.0 => {
                Johnson::internal(-other, radius, length, modulus)
            }
            (None, Some(other)) => Johnson::external(radius, other, length, modulus),
        }));
    }
    let cap = text.depth_cap;
    let cylinders = match other {
        // D = 4 r, as Johnson's law on a flat.
        None => Cylinders::on_curve(radius, 0.0, length, modulus, cap.unwrap_or(radius)),
        Some(other) => {
            let cap = cap.unwrap_or(other.abs());
            Cylinders::on_curve(radius, 1.0 / other, length, modulus, cap)
        }
    };
    match kind.between(&cylinders) {
        Ok(law) => Some(law),
        Err(error) => {
            // The second cylinder is given by its own radius, or by the clearance.
            let key = match error.parameter.as_ref() {
                key @ ("length" | "modulus" | "radius") => key,
                _ if text.other_radius.is_some() => "other_radius",
                _ => "clearance",
            };
            let message = format!("{}, must be {}", error.value, error.allowed);
            at.key(key).refuse_once(message, "or take another law");
            None
        }
    }
}

/// Two cylinders: a radius, the other one (negative for a hollow, none for a flat), and the modulus.
struct Sides {
    radius: f64,
    other: Option<f64>,
    modulus: f64,
}

impl Sides {
    fn of(text: &Surfaces, pair: Pair, mut at: Cursor<'_, '_>) -> Option<Self> {
        let body = Elasticity {
            modulus: text.modulus,
            poisson: text.poisson,
        };
        let modulus = body.composite(body);
        if let Some(bore) = pair.bore {
            for (key, given) in [
                ("radius", text.radius),
                ("other_radius", text.other_radius),
                ("clearance", text.clearance),
            ] {
                if given.is_some() {
                    let hint = "leave it out; the radii are those of the chain";
                    at.key(key).refuse_once("not for a joint", hint);
                    return None;
                }
            }
            return Some(Self {
                radius: pair.radius,
                other: Some(-bore),
                modulus,
            });
        }
        let radius = text.radius.unwrap_or_else(|| {
            at.key("radius").assume(pair.radius, "that of the roller");
            pair.radius
        });
        let other = text.other_radius;
        if let Some(other) = other
            && (other == 0.0 || (other < 0.0 && -other <= radius))
        {
            let message = format!("{other}, must be a radius, or a hollow wider than {radius} [m]");
            let hint = "leave it out for a flat; hollows are negative";
            at.key("other_radius").refuse_once(message, hint);
            return None;
        }
        if let (Some(_), Some(_)) = (text.clearance, other) {
            let message = "`other_radius` is given too";
            at.key("clearance").refuse_once(message, "keep one of them");
            return None;
        }
        let hollow = text.clearance.map(|clearance| -(radius + clearance));
        Some(Self {
            radius,
            other: other.or(hollow),
            modulus,
        })
    }
}
