//! Numbers of links that close around a set of wheels, and the nearest position of a moved wheel at which a number closes.

use super::Closing;
use super::misfit::does_not_close;
use super::search::{Outcome, Search, outward};
use crate::{GeometryError, Route, Wheel};

/// A misfit below this part of a pitch \[–\] is rounding: the count fits as it is.
const FITS: f64 = 1e-9;

/// Numbers of links of a closed chain around wheels that stand where they are.
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
