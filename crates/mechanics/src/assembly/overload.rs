//! The chain that a load would break, named where no equilibrium was found.

use crate::drive::{Parts, Stop};
use crate::{AssemblyError, Layout, System};

/// The error in words of the load, where a torque asks a chain for more than its breaking load.
///
/// ```text
/// T = |M|/R      M: torque on the shaft of a sprocket, R: its pitch radius
/// ```
pub(super) fn named(error: AssemblyError, system: &System, parts: &Parts) -> AssemblyError {
    if !matches!(error, AssemblyError::NoEquilibrium { stage: "load", .. }) {
        return error;
    }
    let mut worst: Option<(f64, AssemblyError)> = None;
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
            if pull > breaking
                && worst
                    .as_ref()
                    .is_none_or(|(share, _)| pull / breaking > *share)
            {
                let named = AssemblyError::Overloaded {
                    sprocket: wheel.name.clone(),
                    torque,
                    pull,
                    breaking,
                };
                let named = named.of_chains(std::iter::once(placed.name.as_ref()));
                worst = Some((pull / breaking, named));
            }
        }
    }
    worst.map_or(error, |(_, named)| named)
}
