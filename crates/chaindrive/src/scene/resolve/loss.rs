//! Losses of shafts.

use chaindrive_mechanics::{Bearing, BearingLaw, ShaftDrag, ShaftLoss, SkfBearing};

use super::Findings;
use crate::scene::defaults;
use crate::scene::schema::{self, BearingFeed};
use crate::scene::suggest::one_of;

/// The losses at one place of a shaft.
pub(super) fn resolve(
    bearing: Option<&schema::Bearing>,
    drag: Option<&schema::ShaftDrag>,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<ShaftLoss> {
    let drag = drag.map(|drag| {
        let exponent = drag.exponent.map(|it| it.0);
        let place = format!("{path}.drag.exponent");
        ShaftDrag {
            torque: drag.torque.0,
            speed: drag.speed.0,
            exponent: findings.or_default(exponent, &place, &defaults::DRAG_EXPONENT),
        }
    });
    let bearing = match bearing {
        None => None,
        Some(text) => Some(of_bearing(text, &format!("{path}.bearing"), findings)?),
    };
    Some(ShaftLoss { bearing, drag })
}

fn of_bearing(text: &schema::Bearing, path: &str, findings: &mut Findings<'_>) -> Option<Bearing> {
    let (law, creep_speed) = match text {
        schema::Bearing::Torque {
            torque,
            creep_speed,
        } => (BearingLaw::Torque { torque: torque.0 }, creep_speed),
        schema::Bearing::Coefficient {
            coefficient,
            diameter,
            creep_speed,
        } => {
            let law = BearingLaw::Coefficient {
                coefficient: coefficient.0,
                diameter: diameter.0,
            };
            (law, creep_speed)
        }
        schema::Bearing::Skf {
            series,
            bore,
            outside_diameter,
            viscosity,
            feed,
            boundary_coefficient,
            full_film_coefficient,
            creep_speed,
        } => {
            let constants = SkfBearing::series(series);
            if constants.is_none() {
                let known = SkfBearing::known_series();
                let message = format!("no deep-groove series is called `{series}`");
                findings.refuse_with(&format!("{path}.series"), message, one_of(series, &known));
            }
            let viscosity = viscosity.map(|it| it.0);
            let viscosity =
                viscosity.or_else(|| findings.oil_viscosity(&format!("{path}.viscosity")));
            let mut share = |given: &Option<chaindrive_quantities::Ratio>, key: &str, default| {
                let given = given.map(|it| it.0);
                findings.or_default(given, &format!("{path}.{key}"), default)
            };
            let boundary_coefficient = share(
                boundary_coefficient,
                "boundary_coefficient",
                &defaults::BEARING_BOUNDARY,
            );
            let full_film_coefficient = share(
                full_film_coefficient,
                "full_film_coefficient",
                &defaults::BEARING_FILM,
            );
            let law = BearingLaw::Skf(SkfBearing {
                bore: bore.0,
                outside_diameter: outside_diameter.0,
                constants: constants?,
                viscosity: viscosity?,
                replenishment: match feed {
                    BearingFeed::Bath => 3e-8,
                    BearingFeed::Grease => 6e-8,
                },
                boundary_coefficient,
                full_film_coefficient,
            });
            (law, creep_speed)
        }
    };
    let creep_speed = creep_speed.map(|it| it.0);
    let place = format!("{path}.creep_speed");
    Some(Bearing {
        law,
        creep_speed: findings.or_default(creep_speed, &place, &defaults::CREEP_SPEED),
    })
}
