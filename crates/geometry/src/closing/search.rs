//! Search for the place in a motion of the wheels at which a chain closes.

use super::Closing;
use crate::{GeometryError, Wheel};

/// Start and range of a search for a position that closes.
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
