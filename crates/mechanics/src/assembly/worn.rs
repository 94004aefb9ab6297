//! Worn chains: longer than their way, and higher on their teeth.

use std::f64::consts::PI;

use chaindrive_geometry::Closing;

use super::Fitting;
use crate::drive::{Layout, Parts, Stop};
use crate::{AssemblyError, Chain};

/// Misfit of the wrapped links \[pitches\] from which on a roller stands over a tip instead of in a gap.
const OVER_A_TIP: f64 = 0.5;

/// Height above the pitch circle, in that of the teeth, above which no equilibrium is looked for. *Assumed*: up to one and a half times the height,
/// chains were seen to settle, after some thousand evaluations.
const HOPELESS: f64 = 2.0;

/// By how much a chain is longer than one of its nominal pitch \[m\]: its slack on centres that were right for it.
pub(super) fn longer(chain: &Chain) -> f64 {
    let links = chain.links() as f64;
    (chain.lengths.iter().sum::<f64>() - links * chain.pitch).max(0.0)
}

/// Refuses a chain that is so worn that it hopelessly leaves its teeth.
pub(super) fn check(
    parts: &Parts,
    stops: &[Stop],
    closing: &Closing,
    pitch: f64,
) -> Result<(), AssemblyError> {
    let seated = closing.seats.iter().map(|seat| seat.pitches);
    rides(parts, stops, seated, pitch, HOPELESS).map_or(Ok(()), Err)
}

/// The error of statics that found no equilibrium in words of wear, where a chain does not stay on its teeth.
pub(super) fn named(
    error: AssemblyError,
    parts: &Parts,
    fittings: &[Option<Fitting>],
) -> AssemblyError {
    if !matches!(error, AssemblyError::NoEquilibrium { .. }) {
        return error;
    }
    let mut chains = parts.chains.iter().zip(fittings);
    let found = chains.find_map(|(placed, fitting)| {
        let Layout::Route { stops, .. } = &placed.layout else {
            return None;
        };
        let lengths = &placed.chain.lengths;
        let pitch = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let seated = fitting.as_ref()?.seated.iter().copied();
        let found = rides(parts, stops, seated, pitch, 1.0)?;
        Some(found.of_chains(std::iter::once(placed.name.as_ref())))
    });
    found.unwrap_or(error)
}

/// The first sprocket that a chain does not stay on, for it rides above its pitch circle by more than so many heights of its teeth.
///
/// ```text
/// r = p′/(2 sin π/z) > r_tip   and   s (p′/p − 1) > ½      p′: pitch of the worn chain, p, z, r_tip: of the sprocket, s: pitches on it
/// ```
///
/// On that circle r the worn chain has rollers as far apart as teeth. Where few links lie on the sprocket, they find room in their gaps instead.
fn rides(
    parts: &Parts,
    stops: &[Stop],
    seated: impl Iterator<Item = u32>,
    pitch: f64,
    heights: f64,
) -> Option<AssemblyError> {
    for (stop, seated) in stops.iter().zip(seated) {
        let Stop::Sprocket(index) = stop else {
            continue;
        };
        let sprocket = &parts.sprockets[*index];
        let gap = &sprocket.gap;
        let half = (PI / f64::from(gap.teeth)).sin();
        let own = 2.0 * gap.pitch_radius * half;
        let worn = pitch / own - 1.0;
        let radius = 0.5 * pitch / half;
        let tip = gap.pitch_radius + heights * (gap.tip_radius - gap.pitch_radius);
        if radius <= tip || f64::from(seated) * worn <= OVER_A_TIP {
            continue;
        }
        let most = 2.0 * gap.tip_radius * half / own - 1.0;
        return Some(AssemblyError::Layout {
            problem: format!(
                "a chain that is {:.2} % longer than the pitch of `{}` rides {:.1} mm above its pitch circle, and its {} teeth reach {:.1} mm: it jumps; they hold a chain worn by less than {:.1} %, fewer teeth hold more",
                worn * 100.0,
                sprocket.name,
                (radius - gap.pitch_radius) * 1e3,
                gap.teeth,
                (gap.tip_radius - gap.pitch_radius) * 1e3,
                most * 100.0,
            ),
        });
    }
    None
}
