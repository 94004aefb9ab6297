//! Contact laws: what a sprocket or guide says, completed by what holds for all.

use chaindrive_contact::dissipation::{LankaraniNikravesh, Viscous};
use chaindrive_contact::elastic::{Johnson, Power};
use chaindrive_contact::friction::Coulomb;
use chaindrive_contact::{Dissipation, Elastic, Elasticity, Friction, Law};
use chaindrive_mechanics::{Chain, Surface};

use super::Findings;
use crate::scene::schema::{self, Contact};

/// What a contact falls back on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fallback {
    /// Place of the contact that holds for all.
    path: &'static str,
    /// Stiffness \[link stiffnesses\].
    stiffness: f64,
    restitution: f64,
}

/// Teeth of steel: stiffer than a link, which bends its pins.
pub(super) const TEETH: Fallback = Fallback {
    path: "contact.teeth",
    stiffness: 5.0,
    restitution: 0.8,
};

/// Guides lined with rubber or plastic.
pub(super) const GUIDES: Fallback = Fallback {
    path: "contact.guides",
    stiffness: 1.0,
    restitution: 0.5,
};

/// Least speed at onset \[m/s\].
const ONSET_FLOOR: f64 = 0.05;

/// The surface of one body: its own contact at `path`, then the common one, then the fallback.
pub(super) fn surface(
    own: &Contact,
    path: &str,
    common: &Contact,
    fallback: Fallback,
    chain: &Chain,
    findings: &mut Findings<'_>,
) -> Option<Surface> {
    let (law, place) = match (&own.law, &common.law) {
        (Some(law), _) => (Some(law), path),
        (None, Some(law)) => (Some(law), fallback.path),
        (None, None) => (None, fallback.path),
    };
    let elastic = match law {
        Some(law) => elastic(law, chain, &format!("{place}.law"), findings)?,
        None => Elastic::Power(Power::linear(
            fallback.stiffness * chain.stiffness.iter().sum::<f64>() / chain.links() as f64,
        )),
    };
    let (dissipating, place) = if own.restitution.is_some() || own.damping.is_some() {
        (own, path)
    } else {
        (common, fallback.path)
    };
    let dissipation = match (dissipating.restitution, dissipating.damping) {
        (Some(_), Some(_)) => {
            let place = format!("{place}.damping");
            // The common contact is completed for every body; say it once.
            if !findings
                .problems
                .iter()
                .any(|problem| problem.path == place)
            {
                findings.refuse_with(&place, "`restitution` is given too", "keep one of them");
            }
            return None;
        }
        (None, Some(damping)) => Dissipation::Viscous(Viscous { damping: damping.0 }),
        (restitution, None) => Dissipation::LankaraniNikravesh(LankaraniNikravesh {
            restitution: restitution.map_or(fallback.restitution, |e| e.0),
        }),
    };
    let friction = own
        .friction
        .or(common.friction)
        .map_or(Friction::None, |friction| {
            Friction::Coulomb(Coulomb {
                coefficient: friction.coefficient.0,
                slip_speed: friction.slip_speed.0,
            })
        });
    Some(Surface {
        law: Law {
            elastic,
            dissipation,
            onset_floor: own
                .onset_floor
                .or(common.onset_floor)
                .map_or(ONSET_FLOOR, |v| v.0),
        },
        friction,
    })
}

fn elastic(
    law: &schema::Elastic,
    chain: &Chain,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Elastic> {
    let roller = 0.5 * chain.roller_diameter;
    let steel = |modulus: f64, poisson: f64| {
        let body = Elasticity { modulus, poisson };
        body.composite(body)
    };
    // Two radii make a contact when the second is a flat, another cylinder, or a wider hollow.
    let mut hollow = |radius: f64, other: Option<f64>| match other {
        Some(other) if other == 0.0 || (other < 0.0 && -other <= radius) => {
            let message = format!("{other}, must be a radius, or a hollow wider than {radius} [m]");
            let hint = "leave it out for a flat; hollows are negative";
            let path = format!("{path}.other_radius");
            if !findings.problems.iter().any(|problem| problem.path == path) {
                findings.refuse_with(&path, message, hint);
            }
            None
        }
        other => Some(other),
    };
    Some(match law {
        schema::Elastic::Linear { stiffness } => Elastic::Power(Power::linear(stiffness.0)),
        schema::Elastic::Power {
            stiffness,
            exponent,
        } => Elastic::Power(Power {
            stiffness: stiffness.0,
            exponent: exponent.0,
        }),
        schema::Elastic::Hertz {
            modulus,
            poisson,
            radius,
            other_radius,
        } => {
            let radius = radius.map_or(roller, |r| r.0);
            let other = hollow(radius, other_radius.map(|r| r.0))?;
            let modulus = steel(modulus.0, poisson.0);
            Elastic::Power(Power::hertz_pair(
                radius,
                other.unwrap_or(f64::INFINITY),
                modulus,
            ))
        }
        schema::Elastic::Johnson {
            length,
            modulus,
            poisson,
            radius,
            other_radius,
            clearance,
        } => {
            let radius = radius.map_or(roller, |r| r.0);
            let other = hollow(radius, other_radius.map(|r| r.0))?;
            let modulus = steel(modulus.0, poisson.0);
            if let (Some(_), Some(_)) = (clearance, other) {
                let hint = "keep one of them";
                findings.refuse_with(
                    &format!("{path}.clearance"),
                    "`other_radius` is given too",
                    hint,
                );
                return None;
            }
            Elastic::Johnson(match (clearance, other) {
                (Some(clearance), _) => Johnson::internal(clearance.0, 0.0, length.0, modulus),
                (None, None) => Johnson::flat(radius, length.0, modulus),
                (None, Some(other)) if other < 0.0 => {
                    Johnson::internal(-other, radius, length.0, modulus)
                }
                (None, Some(other)) => Johnson::external(radius, other, length.0, modulus),
            })
        }
    })
}
