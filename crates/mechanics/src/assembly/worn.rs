//! Worn chains: longer than their way, and higher on their teeth.

use std::f64::consts::PI;

use chaindrive_geometry::Closing;

use crate::drive::{Parts, Stop};
use crate::{AssemblyError, Chain};

/// Misfit of the wrapped links \[pitches\] from which on a roller stands over a tip instead of in a gap.
const OVER_A_TIP: f64 = 0.5;

/// By how much a chain is longer than one of its nominal pitch \[m\]: its slack on centres that were right for it.
pub(super) fn longer(chain: &Chain) -> f64 {
    let links = chain.links() as f64;
    (chain.lengths.iter().sum::<f64>() - links * chain.pitch).max(0.0)
}

/// Refuses a chain that is so worn that it does not stay on its teeth.
///
/// ```text
/// r = p′/(2 sin π/z) > r_tip   and   s (p′/p − 1) > ½      p′: pitch of the worn chain, p, z, r_tip: of the sprocket, s: pitches on it
/// ```
///
/// On that circle r the worn chain has rollers as far apart as teeth. Where few links lie on the sprocket, they find room in their gaps instead.
pub(super) fn rides(
    parts: &Parts,
    stops: &[Stop],
    closing: &Closing,
    pitch: f64,
) -> Result<(), AssemblyError> {
    for (stop, seat) in stops.iter().zip(&closing.seats) {
        let Stop::Sprocket(index) = stop else {
            continue;
        };
        let sprocket = &parts.sprockets[*index];
        let gap = &sprocket.gap;
        let half = (PI / f64::from(gap.teeth)).sin();
        let own = 2.0 * gap.pitch_radius * half;
        let worn = pitch / own - 1.0;
        let radius = 0.5 * pitch / half;
        if radius <= gap.tip_radius || f64::from(seat.pitches) * worn <= OVER_A_TIP {
            continue;
        }
        let most = 2.0 * gap.tip_radius * half / own - 1.0;
        return Err(AssemblyError::Layout {
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
    Ok(())
}
