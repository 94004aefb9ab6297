//! Friction of a lubricated journal over its Hersey number: boundary, mixed, hydrodynamic.

use std::f64::consts::PI;

use chaindrive_quantities::{JsonSchema, Length, Ratio, Stiffness, Viscosity};
use serde::{Deserialize, Serialize};

use super::Rub;

/// A lubricated journal: metal that bears less and less as oil bears more, with a state, sticking included.
///
/// ```text
/// S  = 2 η |v| L/N                          Hersey number η ω/P of a journal, P = N/(2 r L), v = r ω
/// z′ = z + v h, drawn back to |z′| ≤ μ N/[1 + (S/S_t)²]/k
/// f  = −k z′ − 2 π η L v/ψ                  in steady sliding f/N = −[μ/(1 + (S/S_t)²) + π S/ψ] sgn v
/// ```
///
/// Metal rubs by the coefficient μ, as a [`SpringSlider`](super::SpringSlider) that holds at rest, and by less the faster it slides:
/// at the Hersey number S_t half of it is left. Oil shears in the clearance ψ = c/r of a journal that runs in the middle (Petroff).
/// It needs no load: what a joint without tension loses is that. Between the two lies the minimum.
///
/// # Range
/// Bearings that turn on and on. Pins of chains swing by 2π/z and stand still between, their films are younger than those of the
/// measured bearings; where a pin touches its bush, oil shears in a gap narrower than c, and in less of it.
///
/// # Source
/// R. Stribeck, *Z. VDI* **46**, 1902, 1341 (the curve); M. D. Hersey, *J. Wash. Acad. Sci.* **4**, 1914, 542 (the number); N. Petroff,
/// *Inzhenernyi zhurnal*, 1883 (its hydrodynamic branch). Fading with the square, as measured in
/// lubricated line contacts whose sliding swings: D. P. Hess, A. Soom, *J. Tribol.* **112**, 1990, 147–152, over the speed there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Stribeck {
    /// Coefficient of boundary friction μ \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Hersey number S_t at which metal bears half \[–\].
    #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = 0))]
    pub transition: f64,
    /// Dynamic viscosity η of the oil \[Pa s\].
    #[schemars(with = "Option<Viscosity>", extend("minimum" = 0))]
    pub viscosity: f64,
    /// Length L of the journal \[m\].
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Radial clearance over the radius, ψ \[–\].
    #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = 0))]
    pub relative_clearance: f64,
    /// Stiffness k along the surface, until it slides \[N/m\].
    #[schemars(with = "Option<Stiffness>", extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
}

impl Stribeck {
    /// Dashpot of the oil \[N s/m\].
    #[inline]
    pub fn oil(self) -> f64 {
        // 2 π η L/ψ
        2.0 * PI * self.viscosity * self.length / self.relative_clearance
    }

    /// Force \[N\] per slip \[m/s\] at which metal bears half.
    #[inline]
    pub fn fading(self) -> f64 {
        // S/S_t = (2 η L/S_t) |v|/N
        2.0 * self.viscosity * self.length / self.transition
    }

    /// Friction of metal \[N\] at a speed, and its slope \[N s/m\].
    #[inline]
    fn metal(self, normal: f64, speed: f64) -> [f64; 2] {
        if normal <= 0.0 {
            return [0.0; 2];
        }
        // μ N/(1 + x²),   x = S/S_t
        let fading = self.fading() / normal;
        let x = fading * speed;
        let left = (1.0 + x * x).recip();
        let limit = self.coefficient * normal * left;
        [limit, -2.0 * limit * left * x * fading]
    }

    /// Tangential force \[N\] of steady sliding; zero at rest.
    #[inline]
    pub fn force(self, normal: f64, slip: f64) -> f64 {
        let speed = slip.abs();
        if speed > 0.0 {
            let [metal, _] = self.metal(normal, speed);
            -(metal + self.oil() * speed).copysign(slip)
        } else {
            0.0
        }
    }

    /// Damping \[N s/m\] of steady sliding, zero where the force falls with the slip.
    #[inline]
    pub fn damping(self, normal: f64, slip: f64) -> f64 {
        let [_, slope] = self.metal(normal, slip.abs());
        super::not_below_zero(self.oil() + slope)
    }

    /// Force, damping and deflection at the end of a step, see [`Friction::rub`](super::Friction::rub).
    #[inline]
    pub fn rub(self, normal: f64, slip: f64, state: f64, dt: f64) -> Rub {
        let [metal, _] = self.metal(normal, slip.abs());
        let limit = metal / self.stiffness;
        let tried = state + slip * dt;
        let holds = tried.abs() < limit;
        let deflection = tried.max(-limit).min(limit);
        Rub {
            force: -self.stiffness * deflection - self.oil() * slip,
            // −∂f/∂v = k h while it holds; what falls with the slip does not damp.
            damping: if holds { self.stiffness * dt } else { 0.0 } + self.oil(),
            state: deflection,
        }
    }
}
