//! The message about a chain that does not close, and what would make it close.

use super::search::{Outcome, Search, outward};
use crate::error::Remedy;
use crate::{GeometryError, Route, Wheel};

/// The message for a designer: how far off, which counts fit better, and where a wheel would have to stand.
/// Wheels that move are given where least is missing, and where most is.
pub(super) fn does_not_close(
    wheels: &[Wheel],
    farthest: Option<&[Wheel]>,
    pitch: f64,
    links: u32,
) -> Result<GeometryError, GeometryError> {
    let route = Route::taut(wheels)?;
    let taut = route.pitches(pitch);
    let other = farthest.map(Route::taut).transpose()?;
    let reach = other.map(|other| {
        let other = other.pitches(pitch);
        Box::new([taut.min(other), taut.max(other)])
    });
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive count of links, which saturates"
    )]
    let below = taut.floor() as u32;
    let above = below.saturating_add(1);
    Ok(GeometryError::DoesNotClose {
        links,
        taut,
        slack: (f64::from(links) - taut) * pitch,
        reach,
        below,
        short: (taut - f64::from(below)) * pitch,
        above,
        long: (f64::from(above) - taut) * pitch,
        remedy: remedy(&route, pitch, links).map(Box::new),
    })
}

/// The most effective wheel, where the links asked for close.
fn remedy(route: &Route, pitch: f64, links: u32) -> Option<Remedy> {
    let wheels = &route.wheels;
    let (wheel, direction) = route.most_effective()?;
    let two = wheels.len() == 2;
    let mut moving = |travel: f64| {
        let mut wheels = wheels.clone();
        wheels[wheel].centre += direction * travel;
        wheels
    };
    let missing = (f64::from(links) - route.pitches(pitch)).abs() * pitch;
    let search = Search {
        start: 0.0,
        step: 0.25 * pitch,
        within: 4.0 * missing + pitch,
    };
    match outward(pitch, links, 0.5, &mut moving, search).ok()? {
        Outcome::Closes(travel, moved, _) => Some(Remedy {
            wheel,
            travel,
            centre: moved[wheel].centre,
            centre_distance: two.then(|| (moved[1].centre - moved[0].centre).norm()),
        }),
        Outcome::Nowhere { .. } => None,
    }
}
