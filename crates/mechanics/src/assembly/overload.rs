//! The chain that a load would break: named where no equilibrium was found, and before one is looked for where none can be.

use crate::bodies::TurnedBy;
use crate::drive::{Parts, Stop};
use crate::{AssemblyError, Layout, System};

/// Pull \[–\], in breaking loads, beyond which no equilibrium is looked for. *Assumed*: a design errs by less, and where springs stretch by so much the
/// chain leaves its teeth, which the statics would find after hundreds of iterations.
const HOPELESS: f64 = 10.0;

/// A sprocket that asks its chain for more than its breaking load.
struct Overload {
    /// The pull in breaking loads.
    share: f64,
    /// Whether nothing but the chain can bear the torque: nobody drives the shaft, and nothing joins it with another.
    is_borne_by_the_chain: bool,
    error: AssemblyError,
}

/// Refuses what is hopeless.
pub(super) fn check(system: &System, parts: &Parts) -> Result<(), AssemblyError> {
    match worst(system, parts) {
        Some(it) if it.is_borne_by_the_chain && it.share > HOPELESS => Err(it.error),
        _ => Ok(()),
    }
}

/// The error in words of the load, where a torque asks a chain for more than its breaking load.
pub(super) fn named(error: AssemblyError, system: &System, parts: &Parts) -> AssemblyError {
    match error {
        AssemblyError::NoEquilibrium { stage: "load", .. } => {
            worst(system, parts).map_or(error, |it| it.error)
        }
        error => error,
    }
}

/// The greatest overload.
///
/// ```text
/// T = |M|/R      M: torque on the shaft of a sprocket, R: its pitch radius
/// ```
fn worst(system: &System, parts: &Parts) -> Option<Overload> {
    let mut worst: Option<Overload> = None;
    for placed in &parts.chains {
        let (Layout::Route { stops, .. }, Some(breaking)) =
            (&placed.layout, placed.chain.strength.breaking_load)
        else {
            continue;
        };
        for stop in stops {
            let Stop::Sprocket(index) = stop else {
                continue;
            };
            let wheel = &system.bodies.wheels[*index];
            let shaft = &system.bodies.shafts[wheel.shaft];
            let torques = shaft.torques().map(|it| it.mean(system.begin, 0.0));
            let torque = torques.sum::<f64>().abs();
            let pull = torque / wheel.pitch_radius;
            let share = pull / breaking;
            if share > 1.0 && worst.as_ref().is_none_or(|it| share > it.share) {
                let error = AssemblyError::Overloaded {
                    sprocket: wheel.name.clone(),
                    torque,
                    pull,
                    breaking,
                };
                worst = Some(Overload {
                    share,
                    is_borne_by_the_chain: is_alone(system, wheel.shaft),
                    error: error.of_chains(std::iter::once(placed.name.as_ref())),
                });
            }
        }
    }
    worst
}

/// Whether a shaft turns freely, and no gear or coupling joins it with another.
fn is_alone(system: &System, shaft: usize) -> bool {
    let bodies = &system.bodies;
    let TurnedBy::Coordinate(own) = bodies.shafts[shaft].turn.by else {
        return false;
    };
    let turned =
        |it: &&crate::bodies::Shaft| it.turn.turned_by().is_some_and(|(dof, _)| dof == own);
    let coupled = bodies.couplings.iter().any(|it| it.shafts.contains(&shaft));
    bodies.shafts.iter().filter(turned).count() == 1 && !coupled
}
