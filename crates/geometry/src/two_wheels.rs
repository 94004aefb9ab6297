//! Smooth formulas of the open drive with two sprockets.
//!
//! They serve to choose a centre distance or a number of links. Both forms, the exact one and the
//! approximation printed in chain catalogues, count a wrapped tooth as one pitch and know no tooth
//! phase; [`close_by_motion`](crate::close_by_motion) finds the centre distance that closes exactly.

use std::f64::consts::{PI, TAU};

use crate::GeometryError;
use crate::route::check_teeth;

/// An open drive: two sprockets on the same side of one chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoWheels {
    /// Numbers of teeth z₁, z₂ \[–\], each at least 3.
    pub teeth: [u32; 2],
    /// Pitch p \[m\].
    pub pitch: f64,
}

impl TwoWheels {
    /// Number of links of the taut route \[–\], not whole, at a centre distance C \[m\].
    ///
    /// ```text
    /// X = (2/p) √(C² − (R₂−R₁)²) + z₁ (½ − b/π) + z₂ (½ + b/π),   sin b = (R₂−R₁)/C
    /// ```
    ///
    /// # Errors
    /// Parameters out of range; a centre distance at which the sprockets overlap.
    pub fn links(&self, centre_distance: f64) -> Result<f64, GeometryError> {
        let [r1, r2] = self.check()?;
        GeometryError::finite("centre distance [m]", centre_distance)?;
        if centre_distance <= r1 + r2 {
            return Err(GeometryError::WheelsOverlap {
                first: 0,
                second: 1,
                distance: centre_distance,
                least: r1 + r2,
            });
        }
        Ok(self.links_unchecked(centre_distance).0)
    }

    /// Number of links by the catalogue approximation \[–\], a few thousandths of a link too small.
    ///
    /// ```text
    /// X ≈ 2C/p + (z₁+z₂)/2 + ((z₂−z₁)/2π)² p/C
    /// ```
    pub fn links_catalogue(&self, centre_distance: f64) -> f64 {
        let [z1, z2] = self.teeth.map(f64::from);
        // X ≈ 2C/p + (z₁+z₂)/2 + ((z₂−z₁)/2π)² p/C
        2.0 * centre_distance / self.pitch
            + 0.5 * (z1 + z2)
            + ((z2 - z1) / TAU).powi(2) * self.pitch / centre_distance
    }

    /// Centre distance \[m\] at which the taut route takes `links` links: the exact inverse of [`links`](Self::links).
    ///
    /// # Errors
    /// Parameters out of range; fewer links than two touching sprockets need.
    pub fn centre_distance(&self, links: f64) -> Result<f64, GeometryError> {
        let [r1, r2] = self.check()?;
        let touching = r1 + r2;
        let (least, _) = self.links_unchecked(touching);
        GeometryError::finite("number of links", links)?;
        if links <= least {
            return Err(GeometryError::TooFewLinks { links, least });
        }
        // X(C) is increasing and never flat: Newton, kept to the right of contact.
        let mut centre = self.centre_distance_catalogue(links).max(touching);
        if !centre.is_finite() {
            centre = touching + 0.5 * (links - least) * self.pitch;
        }
        for _ in 0..64 {
            let (count, slope) = self.links_unchecked(centre);
            let next = (centre - (count - links) / slope).max(touching);
            if (next - centre).abs() <= 4.0 * f64::EPSILON * centre {
                return Ok(next);
            }
            centre = next;
        }
        Ok(centre)
    }

    /// Centre distance by the catalogue approximation \[m\], within some 20 µm of the exact one.
    ///
    /// ```text
    /// C ≈ (p/8) [2X−z₁−z₂ + √((2X−z₁−z₂)² − (8/π²)(z₂−z₁)²)]
    /// ```
    ///
    /// Not a number if the links are too few for the two sprockets.
    pub fn centre_distance_catalogue(&self, links: f64) -> f64 {
        let [z1, z2] = self.teeth.map(f64::from);
        let q = 2.0 * links - z1 - z2;
        // C ≈ (p/8) [2X−z₁−z₂ + √((2X−z₁−z₂)² − (8/π²)(z₂−z₁)²)]
        0.125 * self.pitch * (q + (q * q - 8.0 / (PI * PI) * (z2 - z1).powi(2)).sqrt())
    }

    /// Pitch radii \[m\], or the parameter that is out of range.
    fn check(&self) -> Result<[f64; 2], GeometryError> {
        GeometryError::positive("pitch [m]", self.pitch)?;
        for teeth in self.teeth {
            check_teeth(teeth)?;
        }
        Ok(self.radii())
    }

    fn radii(&self) -> [f64; 2] {
        self.teeth
            .map(|z| 0.5 * self.pitch / (PI / f64::from(z)).sin())
    }

    /// X(C) and dX/dC.
    fn links_unchecked(&self, centre_distance: f64) -> (f64, f64) {
        let [z1, z2] = self.teeth.map(f64::from);
        let [r1, r2] = self.radii();
        let step = r2 - r1;
        let tangent = ((centre_distance - step) * (centre_distance + step)).sqrt();
        let b = (step / centre_distance).asin();
        // X = (2/p) √(C² − (R₂−R₁)²) + z₁ (½ − b/π) + z₂ (½ + b/π)
        let links = 2.0 * tangent / self.pitch + z1 * (0.5 - b / PI) + z2 * (0.5 + b / PI);
        // dX/dC = 2C/(p L) − (z₂−z₁) (R₂−R₁) / (π C L)
        let slope = 2.0 * centre_distance / (self.pitch * tangent)
            - (z2 - z1) * step / (PI * centre_distance * tangent);
        (links, slope)
    }
}
