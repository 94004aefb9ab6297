//! Unknown that makes a chain of given length close: its strain, or a motion of the wheels.

use super::Closing;
use super::misfit::does_not_close;
use super::search::{Outcome, Search, bisect, outward};
use crate::{GeometryError, Wheel};

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
    close_with_slack(wheels, pitch, (links, 0.0), phase)
}

/// The same of a chain that is known to be longer than its way: by `slack` \[m\] more than one that [closes by strain](close_by_strain) may be.
///
/// # Errors
/// Those of [`close_by_strain`], beyond that slack.
pub fn close_with_slack(
    wheels: &[Wheel],
    pitch: f64,
    (links, slack): (u32, f64),
    phase: f64,
) -> Result<(f64, Closing), GeometryError> {
    let unstrained = Closing::march(wheels, pitch, phase)?;
    let excess = unstrained.excess(links);
    if excess > MOST_MISFIT * pitch || -excess > MOST_MISFIT * pitch + slack {
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
    let found = match bisect(&mut trial, range) {
        Ok(found) => found,
        // Where no chain can be laid at an end of the range, it may still be near the middle.
        Err(error) => {
            let within = 0.5 * (range.1 - range.0);
            let search = Search {
                start: range.0.midpoint(range.1),
                step: within / 16.0,
                within,
            };
            return match outward(stretched, links, phase, moving, search).map_err(|_| error)? {
                Outcome::Closes(place, wheels, closing) => Ok((place, wheels, closing)),
                Outcome::Nowhere { nearest, farthest } => {
                    Err(does_not_close(&nearest, Some(&farthest), stretched, links)?)
                }
            };
        }
    };
    if let Some((place, (wheels, closing))) = found {
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
