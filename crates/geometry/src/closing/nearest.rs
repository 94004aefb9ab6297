//! How many links a set of wheels takes, and the nearest place in a motion at which a number of them closes.

use super::Closing;
use super::solve::{bisect, does_not_close};
use crate::{GeometryError, Route, Wheel};

/// A misfit below this part of a pitch \[–\] is rounding: the count fits as it is.
const FITS: f64 = 1e-9;

/// How many links a closed chain can have around wheels that stand where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkCounts {
    /// Length of the exact polygon in pitches, which is whole for a chain that closes \[–\].
    pub pitches: f64,
    /// Length of the smooth taut route in pitches \[–\].
    pub smooth: f64,
    /// Greatest whole number of links that is not too long.
    pub below: u32,
    /// Least whole number of links that is not too short.
    pub above: u32,
    /// Greatest even number of links that is not too long: a chain without an offset link.
    pub even_below: u32,
    /// Least even number of links that is not too short.
    pub even_above: u32,
}

impl LinkCounts {
    /// Counts the links around `wheels` for a pitch \[m\], at a tooth phase as in [`Closing::march`].
    ///
    /// ```text
    /// X = Σm + Σk + e/p
    /// ```
    ///
    /// # Errors
    /// Those of [`Closing::march`].
    pub fn around(wheels: &[Wheel], pitch: f64, phase: f64) -> Result<Self, GeometryError> {
        let smooth = Route::taut(wheels)?.pitches(pitch);
        // X = Σm + Σk + e/p
        let pitches = Closing::march(wheels, pitch, phase)?.excess(0) / pitch;
        let below = |step: f64| whole(((pitches + FITS) / step).floor() * step);
        let above = |step: f64| whole(((pitches - FITS) / step).ceil() * step);
        Ok(Self {
            pitches,
            smooth,
            below: below(1.0),
            above: above(1.0),
            even_below: below(2.0),
            even_above: above(2.0),
        })
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a positive count of links"
)]
fn whole(links: f64) -> u32 {
    links as u32
}

/// Where a search for a place that closes begins, and how far it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Where it begins \[m or rad\].
    pub start: f64,
    /// First step either way \[m or rad\], positive; it grows by half from step to step.
    pub step: f64,
    /// How far it goes either way \[m or rad\].
    pub within: f64,
}

/// One way of a search.
struct Way {
    sense: f64,
    /// The last place that could be laid, and the misfit there.
    last: (f64, f64),
    step: f64,
    /// A place beyond which nothing can be laid.
    refused: bool,
}

/// Place in a motion nearest to its start at which `links` links close.
///
/// As [`close_by_motion`](super::close_by_motion), with no need to know a range: the search goes outward either way, and where
/// the wheels cannot be laid any more, as where two of them overlap, it ends.
///
/// # Errors
/// Those of [`Closing::march`] at the start; a chain that closes nowhere.
///
/// # Example
///
/// ```
/// use chaindrive_geometry::{Point, Search, Side, Wheel, close_nearest};
///
/// # fn main() -> Result<(), chaindrive_geometry::GeometryError> {
/// let sprocket = |x, teeth| Wheel::toothed(Point::new(x, 0.0), teeth, 25.4e-3, Side::Left);
/// let mut moving = |x: f64| vec![sprocket(0.0, 19), sprocket(x, 57)];
/// let search = Search { start: 1.0, step: 1e-3, within: 0.2 };
/// let (x, _, closing) = close_nearest(25.4e-3, 0.0, 120, 0.5, &mut moving, search)?;
/// assert!((x - 1.029929958).abs() < 1e-9 && closing.excess(120).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
pub fn close_nearest(
    pitch: f64,
    strain: f64,
    links: u32,
    phase: f64,
    moving: &mut dyn FnMut(f64) -> Vec<Wheel>,
    search: Search,
) -> Result<(f64, Vec<Wheel>, Closing), GeometryError> {
    GeometryError::finite("begin of the search", search.start)?;
    GeometryError::finite("strain", strain)?;
    GeometryError::positive("step of the search", search.step)?;
    GeometryError::positive("reach of the search", search.within)?;
    let stretched = pitch * (1.0 + strain);
    match outward(stretched, links, phase, moving, search)? {
        Outcome::Closes(place, wheels, closing) => Ok((place, wheels, closing)),
        Outcome::Nowhere { nearest, farthest } => {
            Err(does_not_close(&nearest, Some(&farthest), stretched, links)?)
        }
    }
}

/// The end of a search.
pub(super) enum Outcome {
    /// The place, the wheels there and the chain.
    Closes(f64, Vec<Wheel>, Closing),
    /// Nowhere; the wheels where least is missing, and where most is.
    Nowhere {
        nearest: Vec<Wheel>,
        farthest: Vec<Wheel>,
    },
}

/// Searches outward from the start, either way.
pub(super) fn outward(
    pitch: f64,
    links: u32,
    phase: f64,
    moving: &mut dyn FnMut(f64) -> Vec<Wheel>,
    search: Search,
) -> Result<Outcome, GeometryError> {
    let mut trial = |place: f64| {
        let wheels = moving(place);
        let closing = Closing::march(&wheels, pitch, phase)?;
        Ok((closing.excess(links), (wheels, closing)))
    };
    let (misfit, (wheels, closing)) = trial(search.start)?;
    if misfit.abs() < f64::MIN_POSITIVE {
        return Ok(Outcome::Closes(search.start, wheels, closing));
    }
    let mut nearest = (misfit, wheels.clone());
    let mut farthest = (misfit, wheels);
    let mut ways = [1.0, -1.0].map(|sense| Way {
        sense,
        last: (search.start, misfit),
        step: search.step,
        refused: false,
    });
    let goes_on = |way: &Way| {
        way.step > 1e-9 * search.step && (way.last.0 - search.start).abs() < search.within
    };
    while ways.iter().any(goes_on) {
        for way in ways.iter_mut().filter(|way| goes_on(way)) {
            let (from, misfit) = way.last;
            let gone = (from - search.start).abs() + way.step;
            let to = search.start + way.sense * gone.min(search.within);
            let Ok((found, (wheels, _))) = trial(to) else {
                // What cannot be laid lies between: come nearer to it.
                way.step *= 0.5;
                way.refused = true;
                continue;
            };
            if (found > 0.0) != (misfit > 0.0)
                && let Some((place, (wheels, closing))) =
                    bisect(&mut trial, (from.min(to), from.max(to)))?
            {
                return Ok(Outcome::Closes(place, wheels, closing));
            }
            if found.abs() < nearest.0.abs() {
                nearest = (found, wheels);
            } else if found.abs() > farthest.0.abs() {
                farthest = (found, wheels);
            }
            way.last = (to, found);
            way.step *= if way.refused { 0.5 } else { 1.5 };
        }
    }
    Ok(Outcome::Nowhere {
        nearest: nearest.1,
        farthest: farthest.1,
    })
}
