//! A pin in a hole whose contact is no longer narrow against the radii.

use std::f64::consts::{E, PI};

use chaindrive_quantities::{JsonSchema, Length, Stiffness};
use serde::{Deserialize, Serialize};

use super::lambert::minus_w_lower;
use super::{Cylinders, Elastic, ElasticLaw, Johnson, Member, OfCylinders};
use crate::ParameterError;
use crate::restitution::logarithmic_excess;

/// First coefficient of the fit \[–\].
const RISE: f64 = 2.5964;

/// Second coefficient of the fit \[–\].
const BEND: f64 = 0.9753;

/// q at which the fit ends and the law goes on as a straight line.
const END_LOAD: f64 = 0.92;

/// δ/ΔR there.
const END_DEPTH: f64 = 1.590_390_386_062_958_2;

/// d(δ/ΔR)/dq there.
const END_SLOPE: f64 = 1.392_273_015_603_925;

/// δ/ΔR up to which Johnson's load is the better start.
const NARROW: f64 = 0.25;

/// Depth below which logarithms would overflow \[–\].
const LEAST_DEPTH: f64 = 1e-280;

/// Johnson's law for a pin in a hole, extended to wide contacts.
///
/// ```text
/// δ/ΔR = q [ln(4/q) − 1] + c₀ q²/(1 + c₂ q),   q = g/(π E* L ΔR)
///
/// k = π E* L/s,   s = ln(4/q) − 2 + c₀ q (2 + c₂ q)/(1 + c₂ q)²
/// U = g δ − ∫ δ dg
/// ```
///
/// The first term is [`Johnson`](super::Johnson)'s law. The second is **a fit of this project**, c₀ = 2.5964 and
/// c₂ = 0.9753, to the plane-strain solution of a disk in a hole of the same material, found by collocation:
/// within 0.30 % in δ up to q = 0.92, that is δ = 1.59 ΔR. The solution's loads agree with
/// Persson's to 1e-8; a rigid displacement in proportion to the load is free in it, and was
/// chosen so that light loads give Johnson's law. The stiffness is finite everywhere: the singularity of
/// Johnson's law at 0.541 ΔR is one of its approximation. Beyond q = 0.92 the law continues as its own
/// tangent. `examples/contact_laws.py` solves the problem again.
///
/// The force is inverted by Halley's third-order form of Newton's method from Johnson's load, whose
/// logarithm is known: one to two steps to rounding.
///
/// It speaks of a solid disk in an infinite plane; the wall of a thin bushing ovalises and is softer.
///
/// # Source
/// The fit is ours; the solution it was compared with: A. Persson, *On the Stress Distribution of Cylindrical
/// Elastic Bodies in Contact*, Chalmers, 1964, in the form of M. Ciavarella and P. Decuzzi,
/// *Int. J. Solids Struct.* **38**, 2001, 4507–4523.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Conformal {
    /// Clearance ΔR \[m\], hole radius less pin radius.
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub clearance: f64,
    /// Composite modulus times length of the contact, E* L \[N/m\].
    #[schemars(with = "Stiffness", extend("exclusiveMinimum" = 0))]
    pub modulus_length: f64,
}

impl Conformal {
    /// A pin in a hole: radii and contact length \[m\], composite modulus \[Pa\].
    pub fn internal(hole: f64, pin: f64, length: f64, composite_modulus: f64) -> Self {
        Self {
            clearance: hole - pin,
            modulus_length: composite_modulus * length,
        }
    }

    /// Depth \[m\] at which the fit ends.
    fn end(self) -> f64 {
        END_DEPTH * self.clearance
    }

    /// π E* L \[N/m\].
    #[inline]
    fn scale(self) -> f64 {
        PI * self.modulus_length
    }
}

/// Load q and slope d(δ/ΔR)/dq at the depth x = δ/ΔR, 0 < x < `END_DEPTH`.
#[inline]
fn load(x: f64) -> (f64, f64) {
    // Start with Johnson's load, ln(4/q) = u + 1, or a cubic through the fit; 2.4 % at worst.
    let (mut q, mut logarithm) = if x < NARROW {
        let u = minus_w_lower((4.0 / (E * E) / x.max(LEAST_DEPTH)).ln());
        (x / u, u + 1.0)
    } else {
        let q = -0.032_105_056 + x * (0.400_032_1 + x * (0.184_035_79 - x * 0.037_331_916));
        (q, (4.0 / q).ln())
    };
    loop {
        let c = 1.0 / (1.0 + BEND * q);
        // s = ln(4/q) − 2 + c₀ q (2 + c₂ q)/(1 + c₂ q)²
        let slope =
            |logarithm: f64, q: f64, c: f64| logarithm - 2.0 + RISE * q * (2.0 + BEND * q) * c * c;
        let excess = q * (logarithm - 1.0) + RISE * q * q * c - x;
        let s = slope(logarithm, q, c);
        let curvature = 2.0 * RISE * c * c * c - 1.0 / q;
        // q ← q − f/(f′ − ½ f f″/f′)
        let change = excess / (s - 0.5 * excess * curvature / s);
        q -= change;
        // The error of the next is of third order in this one's.
        if change.abs() <= 1e-5 * q {
            // ln(4/q′) = ln(4/q) + ln(1 + ε),   ε = q/q′ − 1: three terms are exact to rounding
            let e = change / q;
            logarithm += e * (1.0 - e * (0.5 - e / 3.0));
            return (q, slope(logarithm, q, 1.0 / (1.0 + BEND * q)));
        }
        logarithm = (4.0 / q).ln();
    }
}

impl ElasticLaw for Conformal {
    #[inline]
    fn force(&self, penetration: f64) -> f64 {
        self.pair(penetration).0
    }

    #[inline]
    fn stiffness(&self, penetration: f64) -> f64 {
        self.pair(penetration).1
    }

    fn energy(&self, penetration: f64) -> f64 {
        if penetration <= 0.0 {
            return 0.0;
        }
        let x = penetration / self.clearance;
        let depth = x.min(END_DEPTH);
        let q = if x < END_DEPTH {
            load(depth).0
        } else {
            END_LOAD
        };
        // ∫ x dq = ½ q² [ln(4/q) − ½] + c₀/c₂³ [½ y² − y + ln(1 + y)],   y = c₂ q
        let y = BEND * q;
        let wide = RISE / BEND.powi(3) * (0.5 * y * y - logarithmic_excess(y));
        let complement = 0.5 * q * q * ((4.0 / q).ln() - 0.5) + wide;
        // U = π E* L ΔR² (q x − ∫ x dq), and the trapezium beyond
        let beyond = x - depth;
        let energy = q * depth - complement + beyond * (q + 0.5 * beyond / END_SLOPE);
        self.scale() * self.clearance * self.clearance * energy
    }

    #[inline]
    fn pair(&self, penetration: f64) -> (f64, f64) {
        if penetration <= 0.0 {
            return (0.0, 0.0);
        }
        let x = penetration / self.clearance;
        let (q, slope) = if x < END_DEPTH {
            load(x)
        } else {
            (END_LOAD + (x - END_DEPTH) / END_SLOPE, END_SLOPE)
        };
        // g = π E* L ΔR q,   k = π E* L/s
        (self.scale() * self.clearance * q, self.scale() / slope)
    }

    fn reach(&self) -> Option<f64> {
        Some(self.end())
    }
}

impl Member for Conformal {}

impl OfCylinders for Conformal {
    fn between(pair: &Cylinders) -> Result<Elastic, ParameterError> {
        if pair.curvature >= 0.0 {
            return Johnson::between(pair);
        }
        Ok(Self {
            clearance: pair.effective_radii(),
            modulus_length: pair.modulus * pair.length,
        }
        .into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The load put back into the fit gives the depth, from an atom to the end.
    #[test]
    fn satisfies_the_fit() {
        let mut x = 1e-12;
        while x < END_DEPTH {
            let (q, _) = load(x);
            let back = q * ((4.0 / q).ln() - 1.0) + RISE * q * q / (1.0 + BEND * q);
            assert!(
                (back / x - 1.0).abs() < 1e-14,
                "{x:e}: {:e}",
                back / x - 1.0
            );
            x *= 1.01;
        }
    }

    /// The constants at the end of the fit are those of the fit.
    #[test]
    fn continues_as_its_tangent() {
        let law = Conformal {
            clearance: 1e-4,
            modulus_length: 5e8,
        };
        let (below, above) = (
            END_DEPTH * 1e-4 * (1.0 - 1e-12),
            END_DEPTH * 1e-4 * (1.0 + 1e-12),
        );
        for (a, b) in [
            (law.force(below), law.force(above)),
            (law.stiffness(below), law.stiffness(above)),
            (law.energy(below), law.energy(above)),
        ] {
            assert!((a / b - 1.0).abs() < 1e-11, "{a} {b}");
        }
    }
}
