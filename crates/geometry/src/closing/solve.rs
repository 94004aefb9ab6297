//! Unknown that makes a chain of given length close: its strain, or a motion of the wheels.

use super::Closing;
use super::nearest::{Outcome, Search, outward};
use crate::error::Remedy;
use crate::{GeometryError, Route, Wheel};

/// Slack or shortness beyond which a chain is the wrong one rather than a strained one, in pitches.
const MOST_MISFIT: f64 = 0.75;

/// Uniform strain ε \[–\] of the free links with which `links` links close on fixed centres.
///
/// The spans take up the strain, p (1 + ε) a link; seated links keep the pitch of their sprocket.
/// A negative strain is a slack chain laid straight. A strained link does not quite fit a seat, so that
/// in the rare phases at which a seat is about to change a misfit of up to ε p may remain in
/// [`Closing::residual`]. `pitch` \[m\] is the unstrained one; `phase`
/// as in [`Closing::march`].
///
/// # Errors
/// Those of [`Closing::march`]; a chain more than three quarters of a pitch too long or too short.
pub fn close_by_strain(
    wheels: &[Wheel],
    pitch: f64,
    links: u32,
    phase: f64,
) -> Result<(f64, Closing), GeometryError> {
    let unstrained = Closing::march(wheels, pitch, phase)?;
    let excess = unstrained.excess(links);
    if excess.abs() > MOST_MISFIT * pitch {
        return Err(does_not_close(wheels, None, pitch, links)?);
    }
    let free = f64::from(unstrained.spans.iter().sum::<u32>().max(1));
    let mut trial = |strain: f64| {
        let closing = Closing::march(wheels, pitch * (1.0 + strain), phase)?;
        Ok((closing.excess(links), closing))
    };
    // e(ε) ≈ e(0) − Σm p ε
    let estimate = excess / (free * pitch);
    let mut margin = 0.05 / free;
    while margin < 2.0 / free {
        let range = (estimate - margin, estimate + margin);
        if let Some(found) = bisect(&mut trial, range)? {
            return Ok(found);
        }
        margin *= 2.0;
    }
    Err(does_not_close(wheels, None, pitch, links)?)
}

/// Place in a motion of the wheels at which `links` links of a given strain close.
///
/// `moving` gives the wheels at a place q of any motion with one parameter: a coordinate of a centre
/// or the travel of a tensioner \[m\], the angle of an arm \[rad\]. The answer is q within `range`, the
/// wheels there, and the chain. If the motion passes more than one such place, it is one of them.
///
/// # Errors
/// Those of [`Closing::march`] anywhere in the motion; a chain that is too long, or too short, at
/// both ends of the range.
pub fn close_by_motion(
    pitch: f64,
    strain: f64,
    links: u32,
    phase: f64,
    moving: &mut dyn FnMut(f64) -> Vec<Wheel>,
    range: (f64, f64),
) -> Result<(f64, Vec<Wheel>, Closing), GeometryError> {
    GeometryError::finite("begin of the motion", range.0)?;
    GeometryError::finite("end of the motion", range.1)?;
    GeometryError::finite("strain", strain)?;
    let stretched = pitch * (1.0 + strain);
    let mut trial = |place: f64| {
        let wheels = moving(place);
        let closing = Closing::march(&wheels, stretched, phase)?;
        Ok((closing.excess(links), (wheels, closing)))
    };
    if let Some((place, (wheels, closing))) = bisect(&mut trial, range)? {
        return Ok((place, wheels, closing));
    }
    let (at_begin, (begin, _)) = trial(range.0)?;
    let (at_end, (end, _)) = trial(range.1)?;
    let (nearest, farthest) = if at_begin.abs() < at_end.abs() {
        (begin, end)
    } else {
        (end, begin)
    };
    Err(does_not_close(&nearest, Some(&farthest), stretched, links)?)
}

/// Closing strain over one tooth of wheel 0: pairs of phase and strain \[–\], at `samples` even phases in [0, 1).
///
/// Its range times the stiffness of the chain is the tension ripple on rigid centres.
///
/// # Errors
/// Those of [`close_by_strain`].
pub fn closing_strains(
    wheels: &[Wheel],
    pitch: f64,
    links: u32,
    samples: u32,
) -> Result<Vec<(f64, f64)>, GeometryError> {
    (0..samples)
        .map(|i| {
            let phase = f64::from(i) / f64::from(samples);
            close_by_strain(wheels, pitch, links, phase).map(|(strain, _)| (phase, strain))
        })
        .collect()
}

/// Root of a function between two places of opposite sign, with what else it returned there.
pub(super) fn bisect<T>(
    trial: &mut impl FnMut(f64) -> Result<(f64, T), GeometryError>,
    (mut low, mut high): (f64, f64),
) -> Result<Option<(f64, T)>, GeometryError> {
    let (at_low, with_low) = trial(low)?;
    let (at_high, with_high) = trial(high)?;
    let rising = at_low < at_high;
    if (at_low > 0.0 && at_high > 0.0) || (at_low < 0.0 && at_high < 0.0) {
        return Ok(None);
    }
    let mut best = if at_low.abs() < at_high.abs() {
        (at_low, low, with_low)
    } else {
        (at_high, high, with_high)
    };
    // Halving stops where the interval holds no number of its own.
    for _ in 0..200 {
        let middle = low.midpoint(high);
        if middle <= low.min(high) || middle >= low.max(high) {
            break;
        }
        let (value, with) = trial(middle)?;
        if (value > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
        if value.abs() < best.0.abs() {
            best = (value, middle, with);
        }
        if best.0.abs() < f64::MIN_POSITIVE {
            break;
        }
    }
    Ok(Some((best.1, best.2)))
}

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
        reason = "a positive count of links"
    )]
    let below = taut.floor() as u32;
    let above = below + 1;
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
