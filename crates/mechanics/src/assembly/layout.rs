//! Layout of the rollers before any force acts.

use chaindrive_geometry::{
    Closing, Point, Vector, Wheel, close_by_motion, close_by_strain, close_with_slack,
};

use super::wheels::{grown, shifted, wheels};
use super::{Fitting, remedies, slack, worn};
use crate::drive::{Adjust, Fit, Layout, Parts, PretensionAt, Stop, Tighten};
use crate::system::{LaidChain, LaidDrive};
use crate::{AssemblyError, Drive};

/// Strain of a chain laid straight below which it is taken as slack rather than compressed.
const SLACK: f64 = -1e-6;

/// Lays the chains as their layouts say, one after the other; what an earlier one has moved stays where it is.
///
/// A frame that grows does so when all of them are fitted: its bodies move apart, and the links keep their lengths.
pub(super) fn lay(drive: &Drive) -> Result<(LaidDrive, Vec<Option<Fitting>>), AssemblyError> {
    let mut laid = laid_nothing(drive);
    let chains = 0..laid.parts.chains.len();
    let fittings: Result<Vec<_>, _> = chains.map(|index| lay_one(&mut laid, index)).collect();
    let mut fittings = fittings?;
    let mut growths = drive.chains.iter().map(|placed| placed.layout.growth());
    if let Some(growth) = growths.find(|growth| *growth != 0.0) {
        laid.parts = grown(&laid.parts, growth)?;
        for (index, fitting) in fittings.iter_mut().enumerate() {
            if let Some(fitting) = fitting {
                lay_again(&mut laid, index, fitting)?;
            }
        }
    }
    Ok((laid, fittings))
}

/// A drive before its chains are laid.
pub(super) fn laid_nothing(drive: &Drive) -> LaidDrive {
    let parts = drive.parts().clone();
    LaidDrive {
        gap_angles: parts.sprockets.iter().map(|s| s.gap_angle).collect(),
        chains: Vec::new(),
        parts,
        begin: drive.begin,
    }
}

/// Lays the next chain.
pub(super) fn lay_one(
    laid: &mut LaidDrive,
    index: usize,
) -> Result<Option<Fitting>, AssemblyError> {
    let layout = laid.parts.chains[index].layout.clone();
    match &layout {
        Layout::Points { positions, .. } => {
            laid.chains.push(LaidChain {
                route: Vec::new(),
                positions: positions.clone(),
            });
            Ok(None)
        }
        Layout::Route {
            stops, phase, fit, ..
        } => {
            let fitting = around(laid, index, stops, *phase, fit);
            let fitting =
                fitting.map_err(|error| named(error, &laid.parts, index, (stops, fit)))?;
            Ok(Some(fitting))
        }
    }
}

/// An error that calls the chain and the stops of its route by their names, with what would mend it.
fn named(
    error: AssemblyError,
    parts: &Parts,
    index: usize,
    (stops, fit): (&[Stop], &Fit),
) -> AssemblyError {
    let name = |stop: usize| match stops.get(stop) {
        Some(Stop::Sprocket(index)) => format!("`{}`", parts.sprockets[*index].name),
        Some(Stop::Guide(index)) => format!("`{}`", parts.guides[*index].name),
        None => format!("stop {stop}"),
    };
    let called = parts.chains[index].name.as_ref();
    let told = remedies::told(error.with_names(&name), parts, index, fit);
    told.of_chains(std::iter::once(called))
}

/// Lays a chain of the lengths that it has around stops that have moved since it was fitted.
fn lay_again(
    laid: &mut LaidDrive,
    index: usize,
    fitting: &mut Fitting,
) -> Result<(), AssemblyError> {
    let layout = laid.parts.chains[index].layout.clone();
    let Layout::Route {
        stops, phase, fit, ..
    } = &layout
    else {
        return Ok(());
    };
    let again = |parts: &Parts| {
        let chain = &parts.chains[index].chain;
        let wheels = wheels(parts, chain, stops)?;
        let slack_span = match fit.slack {
            Some(span) => span,
            None => slack::span(parts, index, stops, &wheels)?,
        };
        let links = u32::try_from(chain.links()).unwrap_or(u32::MAX);
        let pitch = chain.lengths.iter().sum::<f64>() / f64::from(links);
        let longer = worn::longer(chain);
        let closed = close(&wheels, (pitch, links, longer, *phase), |strain| {
            (strain < SLACK).then_some((slack_span, parts.gravity))
        })?;
        Ok((wheels, closed))
    };
    let (wheels, closed) =
        again(&laid.parts).map_err(|error| named(error, &laid.parts, index, (stops, fit)))?;
    seat(laid, stops, &closed.closing);
    laid.chains[index].positions = closed.positions;
    fitting.seated = closed.closing.seats.iter().map(|it| it.pitches).collect();
    fitting.spans = closed.closing.spans;
    fitting.wheels = wheels;
    Ok(())
}

/// A chain of so many links around wheels.
struct Closed {
    /// Strain that closes its links \[–\].
    strain: f64,
    closing: Closing,
    /// Its rollers \[m\].
    positions: Vec<Point>,
}

/// Closes a chain of a pitch \[m\] and so many links, too long by up to a known length \[m\], at a phase around wheels: straight, or with a bow where
/// `slack` names the span and gravity for the strain.
fn close(
    wheels: &[Wheel],
    (pitch, links, longer, phase): (f64, u32, f64, f64),
    slack: impl Fn(f64) -> Option<(usize, Vector)>,
) -> Result<Closed, AssemblyError> {
    let (strain, closing) = close_with_slack(wheels, pitch, (links, longer), phase)?;
    let (positions, closing) = if let Some((span, gravity)) = slack(strain) {
        slack::sagging(wheels, span, (pitch, links), phase, gravity)?
    } else {
        let places = closing.positions(wheels, pitch * (1.0 + strain))?;
        (
            places.into_iter().map(|place| place.position).collect(),
            closing,
        )
    };
    Ok(Closed {
        strain,
        closing,
        positions,
    })
}

/// Turns the sprockets of a route to where the rollers sit on them, and names them.
fn seat(laid: &mut LaidDrive, stops: &[Stop], closing: &Closing) -> Vec<usize> {
    let mut route = Vec::new();
    for (stop, seat) in stops.iter().zip(&closing.seats) {
        if let Stop::Sprocket(index) = stop {
            laid.gap_angles[*index] = seat.first_angle;
            route.push(*index);
        }
    }
    route
}

fn around(
    laid: &mut LaidDrive,
    index: usize,
    stops: &[Stop],
    phase: f64,
    fit: &Fit,
) -> Result<Fitting, AssemblyError> {
    let parts = &laid.parts;
    let chain = &parts.chains[index].chain;
    let pitch = chain.lengths.iter().sum::<f64>() / chain.links() as f64;
    let links = u32::try_from(chain.links()).map_err(|_| AssemblyError::Layout {
        problem: format!("{} links are more than a chain can have", chain.links()),
    })?;
    let mean_stiffness =
        chain.links() as f64 / chain.stiffness.iter().map(|k| 1.0 / k).sum::<f64>();
    // ε₀ = T₀ / (k p)
    let tightening = fit.pretension / (mean_stiffness * pitch);
    let by_travel = fit.tighten == Tighten::Travel || fit.sag.is_some();

    let over_a_tooth = fit.at == PretensionAt::MeanPhase && fit.pretension > 0.0;

    let at_rest = wheels(parts, chain, stops)?;
    let slack_span = match fit.slack {
        Some(span) => span,
        None => slack::span(parts, index, stops, &at_rest)?,
    };
    let travel_at = |phase: f64| {
        let within = match &fit.adjust {
            Adjust::Sprocket { within, .. } | Adjust::Tensioner { within, .. } => *within,
            Adjust::Nothing => return Ok(0.0),
        };
        // The wheels move without failing where the parts at rest have made wheels. No wheels at all is an error of the
        // closing, never a wrong place.
        let mut moving = |travel: f64| {
            shifted(parts, &fit.adjust, travel)
                .and_then(|moved| wheels(&moved, chain, stops))
                .unwrap_or_default()
        };
        let range = (-within, within);
        let Some(sag) = fit.sag else {
            let strain = if by_travel { tightening } else { 0.0 };
            let (travel, ..) = close_by_motion(pitch, strain, links, phase, &mut moving, range)?;
            return Ok(travel);
        };
        // The chord of the bow changes with the travel, and little.
        let mut travel = 0.0;
        for _ in 0..3 {
            let strain = slack::strain(&moving(travel), slack_span, sag, (chain, parts.gravity))?;
            (travel, ..) = close_by_motion(pitch, strain, links, phase, &mut moving, range)?;
        }
        Ok(travel)
    };
    let travel = if over_a_tooth {
        mean_of_phases(travel_at)?
    } else {
        travel_at(phase)?
    };
    let moved = shifted(parts, &fit.adjust, travel)?;
    let wheels = match fit.adjust {
        Adjust::Nothing => at_rest,
        _ => wheels(&moved, chain, stops)?,
    };
    let gravity = parts.gravity;
    // A pretension by shorter links takes no slack.
    let longer = if fit.pretension > 0.0 {
        0.0
    } else {
        worn::longer(chain)
    };
    let Closed {
        strain,
        closing,
        positions,
    } = close(&wheels, (pitch, links, longer, phase), |strain| {
        (strain < SLACK && fit.pretension <= 0.0).then_some((slack_span, gravity))
    })?;
    worn::check(parts, stops, &closing, pitch)?;
    let route = seat(laid, stops, &closing);
    let mut moved = moved;
    if fit.pretension > 0.0 && !by_travel {
        let closed = if over_a_tooth {
            mean_of_phases(|phase| Ok(close_by_strain(&wheels, pitch, links, phase)?.0))?
        } else {
            strain
        };
        // Σ ℓ₀ᵢ = n p (1 + ε) − T₀ Σ 1/kᵢ: the laid chain then carries T₀, in the mean of the phases with the mean of ε.
        let scale = 1.0 + closed - tightening;
        if scale <= 0.0 {
            return Err(AssemblyError::Layout {
                problem: format!(
                    "a pretension of {:.4e} N would stretch links of {mean_stiffness:.4e} N/m by {:.0} %; lower the pretension, or give stiffer links",
                    fit.pretension,
                    tightening * 100.0,
                ),
            });
        }
        for length in &mut moved.chains[index].chain.lengths {
            *length *= scale;
        }
    }
    laid.parts = moved;
    laid.chains.push(LaidChain { positions, route });
    Ok(Fitting {
        seated: closing.seats.iter().map(|seat| seat.pitches).collect(),
        spans: closing.spans.clone(),
        strain,
        travel,
        wheels,
    })
}

/// Phases that the mean over a tooth is taken of.
const PHASES: u32 = 8;

/// Mean of a value over the phases of a tooth.
fn mean_of_phases(
    mut value: impl FnMut(f64) -> Result<f64, AssemblyError>,
) -> Result<f64, AssemblyError> {
    let mut sum = 0.0;
    for place in 0..PHASES {
        sum += value((f64::from(place) + 0.5) / f64::from(PHASES))?;
    }
    Ok(sum / f64::from(PHASES))
}
