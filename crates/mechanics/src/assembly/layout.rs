//! Layout of the rollers before any force acts.

use chaindrive_geometry::{Wheel, close_by_motion, close_by_strain};

use super::wheels::{shifted, wheels};
use super::{Fitting, remedies, slack};
use crate::drive::{Adjust, Fit, Layout, Parts, PretensionAt, Stop, Tighten};
use crate::system::{LaidChain, LaidDrive};
use crate::{AssemblyError, Drive};

/// Strain of a chain laid straight below which it is taken as slack rather than compressed.
const SLACK: f64 = -1e-6;

/// Lays the chains as their layouts say, one after the other; what an earlier one has moved stays where it is.
pub(super) fn lay(drive: &Drive) -> Result<(LaidDrive, Vec<Option<Fitting>>), AssemblyError> {
    let mut laid = laid_nothing(drive);
    let chains = 0..laid.parts.chains.len();
    let fittings: Result<_, _> = chains.map(|index| lay_one(&mut laid, index)).collect();
    Ok((laid, fittings?))
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
            let sprockets = laid.parts.sprockets.iter().map(|s| s.name.clone());
            let guides = laid.parts.guides.iter().map(|g| g.name.clone());
            let (sprockets, guides): (Vec<_>, Vec<_>) = (sprockets.collect(), guides.collect());
            let name = |stop: usize| match stops.get(stop) {
                Some(Stop::Sprocket(index)) => format!("`{}`", sprockets[*index]),
                Some(Stop::Guide(index)) => format!("`{}`", guides[*index]),
                None => format!("stop {stop}"),
            };
            let fitting = around(laid, index, stops, *phase, fit);
            let called = laid.parts.chains[index].name.clone();
            let told = |error: AssemblyError, parts: &Parts| {
                let named = remedies::told(error.with_names(&name), parts, index, fit);
                named.of_chains(std::iter::once(called.as_ref()))
            };
            let fitting = fitting.map_err(|error| told(error, &laid.parts))?;
            let grown = grow(laid, index, (stops, *phase, fit), &fitting);
            grown.map_err(|error| told(error, &laid.parts))?;
            Ok(Some(fitting))
        }
    }
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
    let (strain, closing) = close_by_strain(&wheels, pitch, links, phase)?;
    let slack = strain < SLACK && fit.pretension <= 0.0;
    let (positions, closing) = if slack {
        slack::sagging(&wheels, slack_span, (pitch, links), phase, parts.gravity)?
    } else {
        let places = closing.positions(&wheels, pitch * (1.0 + strain))?;
        (
            places.into_iter().map(|place| place.position).collect(),
            closing,
        )
    };

    let mut route = Vec::new();
    for (stop, seat) in stops.iter().zip(&closing.seats) {
        if let Stop::Sprocket(index) = stop {
            laid.gap_angles[*index] = seat.first_angle;
            route.push(*index);
        }
    }
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

/// Shortens the links of a chain whose frame grows after it was fitted.
///
/// ```text
/// ℓ₀ ← ℓ₀ (1 + s ε)/(1 + s ε_apart)      ε: strain of the closing, of the share s of links off the sprockets
/// ```
///
/// To first order that is a frame that has grown around a chain as it was.
fn grow(
    laid: &mut LaidDrive,
    index: usize,
    (stops, phase, fit): (&[Stop], f64, &Fit),
    fitting: &Fitting,
) -> Result<(), AssemblyError> {
    if fit.growth.abs() <= 0.0 {
        return Ok(());
    }
    let chain = &mut laid.parts.chains[index].chain;
    let pitch = chain.pitch;
    let links = u32::try_from(chain.links()).unwrap_or(u32::MAX);
    // s ε
    let stretch = |wheels: &[Wheel], phase: f64| {
        let (strain, closing) = close_by_strain(wheels, pitch, links, phase)?;
        let seats = stops.iter().zip(&closing.seats);
        let on_sprockets = seats.filter(|(stop, _)| matches!(stop, Stop::Sprocket(_)));
        let seated: u32 = on_sprockets.map(|(_, seat)| seat.pitches).sum();
        Ok(strain * (1.0 - f64::from(seated) / f64::from(links)))
    };
    let closes = |wheels: &[Wheel]| {
        if fit.at == PretensionAt::MeanPhase {
            mean_of_phases(|phase| stretch(wheels, phase))
        } else {
            stretch(wheels, phase)
        }
    };
    let apart = |wheel: &Wheel| Wheel {
        centre: wheel.centre * (1.0 + fit.growth),
        ..*wheel
    };
    let apart: Vec<Wheel> = fitting.wheels.iter().map(apart).collect();
    let scale = (1.0 + closes(&fitting.wheels)?) / (1.0 + closes(&apart)?);
    for length in &mut chain.lengths {
        *length *= scale;
    }
    Ok(())
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
