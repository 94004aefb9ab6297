//! The oil film that a cylinder squeezes out of its seat.
//!
//! A run computes it for lanes of contacts at once, in `contact/film.rs` of the crate `mechanics`: a change of the law is made in both, and tests
//! hold them against each other.

use std::f64::consts::SQRT_2;

use chaindrive_quantities::{
    JsonSchema, Length, ParameterError, PressureCoefficient, Ratio, Time, Viscosity, check,
};
use serde::{Deserialize, Serialize};

/// A film between two cylinders, one in the other or beside a plane, that drains under force.
///
/// ```text
/// H(x) = h + x²/2R                                    |x| ≤ b, pressure zero at both ends
/// d/dx(H³/η dp/dx) = −12 v,   η = η₀ e^(αp)           v = −ḣ (Reynolds, Barus)
/// q = (1 − e^(−αp))/α = 6 η₀ v R (1/H² − 1/H_b²)      the pressure of constant viscosity
/// F = λ L ∫ p dx
/// ```
///
/// The law is the speed v of the film's thinning under a force. η₀ is the viscosity at the pressure of the air, α its pressure coefficient, b the
/// half width, L the length, and R the radius of the cylinder beside a plane: r₁ r₂/(r₂ − r₁) of one in the other. λ is the share of the force beside flow out of the ends, see
/// [`Film::leakage`]. Oil does not pull. From the roughness down metal bears.
///
/// # Range
/// H is a parabola, so b is to be well below the radius of the cylinder. Oil has neither mass nor compressibility here, and both surfaces
/// keep their shape under pressure.
///
/// # Source
/// O. Reynolds, *Phil. Trans. R. Soc.* **177**, 1886, 157–234; C. Barus, *Am. J. Sci.* **45**, 1893, 87–96.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    description = "Film of oil that a roller squeezes out of its seat, a pin out of its bush. An impact begins where surfaces enter the film, and what it\n\
                   leaves is a result: a restitution or damping beside it is refused."
)]
pub struct Film {
    /// Thickness of the film that the surfaces meet when they come together \[m\]. It has been measured by nobody: vary it.
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub thickness: f64,
    /// Dynamic viscosity \[Pa s\]; absent: that of the `lubricant`.
    #[schemars(with = "Option<Viscosity>", extend("exclusiveMinimum" = 0))]
    pub viscosity: f64,
    /// Pressure coefficient of the viscosity \[1/Pa\], by Barus.
    #[schemars(with = "Option<PressureCoefficient>", extend("minimum" = 0))]
    pub pressure_coefficient: f64,
    /// Radius of the cylinder beside a plane that has the same gap \[m\]; absent: from roller and seat, pin and bush; on a guide, that of the
    /// roller.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Half of the width on which there is oil \[m\]; absent: that of the hollow of the tooth gap; in a bore, of 120°; on a guide, half of the
    /// radius, of which a film needs a tenth.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    pub half_width: f64,
    /// Length along the axis \[m\]; absent: that of the roller, or of the joint.
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Share of the force that flow out of the ends leaves \[–\]; absent: it follows from the width that bears, and the length.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Ratio>", extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub leakage_factor: Option<f64>,
    /// Roughness, at which metal bears \[m\].
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    pub roughness: f64,
    /// Time constant with which oil comes back between surfaces that have parted within the film \[s\]; 0: it follows at once.
    #[schemars(with = "Option<Time>", extend("minimum" = 0))]
    pub refill_time: f64,
}

/// Speed of draining, and its change with the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draining {
    /// v \[m/s\]
    pub speed: f64,
    /// ∂v/∂F \[m/s/N\]
    pub by_force: f64,
}

impl Film {
    /// Checks the parameters.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        check(self)
    }

    /// Share λ of the force of one dimension that is left where oil flows out of the ends of a film of some shape.
    ///
    /// ```text
    /// λ = 1 − 0.63 n (1 − n⁴/12),   n = 2 b_e/L ≤ 1;   λ(1/n)/n² beyond
    /// b_e = (0.82 + 0.18 w) ¾ b/((1 + s) Y)
    /// ```
    ///
    /// Exact for parallel plates, which are 2 b wide: w = 1, Y = ¾. Else the strip is narrower: the parabola with the peak and the force of
    /// the film's pressure, and 0.82 of it where oil has no end. Two-dimensional solutions for 1 to 270 µm agree within 4 %.
    ///
    /// # Source
    /// Plates obey the equation of the torsion of a bar with that section: W. C. Young, R. G. Budynas, *Roark's Formulas for Stress and
    /// Strain*, table 10.1. The factor 0.82: fitted to the two-dimensional solutions.
    pub fn leakage(&self, t: f64, shape: Shape) -> f64 {
        if let Some(given) = self.leakage_factor {
            return given;
        }
        let parabola = 0.75 * self.half_width * (1.0 - t) / shape.peak;
        let strip = (0.82 + 0.18 * shape.flatness) * parabola;
        let wide = |n: f64| 1.0 - 0.63 * n * (1.0 - n.powi(4) / 12.0);
        let n = 2.0 * strip / self.length;
        if n <= 1.0 {
            wide(n)
        } else {
            wide(1.0 / n) / (n * n)
        }
    }

    /// Speed of draining under a force \[N\], at a thickness \[m\] that includes the roughness.
    pub fn drain(&self, force: f64, film: f64) -> Draining {
        // s = b/√(2Rh)
        let reach = self.half_width / (2.0 * self.radius * film).sqrt();
        let t = reach / (1.0 + reach);
        let shape = Shape::of(t);
        let leakage_factor = self.leakage(t, shape);
        let Self {
            viscosity,
            length,
            half_width,
            ..
        } = *self;
        // v/F = h³ (1 + s)³ W/(8 η₀ λ L b³)
        let bearing = 8.0 * viscosity * leakage_factor * length * half_width.powi(3);
        let mobility = (film * (1.0 + reach)).powi(3) * shape.mobility / bearing;
        // P = α q_max = α F (1 + s) Y/(λ L b)
        let pressing = self.pressure_coefficient * (1.0 + reach) * shape.peak
            / (leakage_factor * length * half_width);
        let [level, slope] = shape.thickening(pressing * force);
        Draining {
            speed: mobility * force * level,
            by_force: mobility * slope,
        }
    }
}

/// Pressure over a strip of a film as a shape: functions of t = s/(1 + s), where s = b/√(2Rh) says how far oil reaches beyond the strip that bears.
///
/// With t = 0 the surfaces are parallel plates, with t = 1 the oil has no end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// W = (8/3) s³/((1 + s)³ S₁), where S₁ = ∫ (q/q₀) ds and q₀ = 6 η₀ v R/h².
    pub mobility: f64,
    /// Y = (1 − κ) s/((1 + s) S₁), where κ = (1 + s²)⁻²: greatest pressure over the mean one on b (1 − t).
    pub peak: f64,
    /// Place between the two limits of α: 1 for plates, 0 for oil without an end.
    pub flatness: f64,
}

/// P at which the pressure grows without bound, of the two limits.
pub const BOUNDS: [f64; 2] = [4.0 * (2.0 - SQRT_2), 3.0];

/// m(P) = P (1 − a P + b P² − c P³) of the two limits, where m = α q_max and P is what it would be without α.
///
/// ```text
/// oil without an end   P = 4 (2 − √(1−√m) − √(1+√m))        so m = P (1 − P/8)² (1 − P/16)
/// plates               P = 3 (1 − k atan(1/k)), k² = 1/m − 1     by a polynomial of the same bounds: to 1 %
/// ```
pub const THICKENING: [[f64; 3]; 2] = [
    [5.0 / 16.0, 1.0 / 32.0, 1.0 / 1024.0],
    [0.4, 2.2 / 27.0, 0.2 / 27.0],
];

/// Intervals of Simpson's rule for the integrals of a shape.
const INTERVALS: u32 = 2000;

impl Shape {
    /// The shape at t, in (0, 1).
    pub fn of(t: f64) -> Self {
        let s = t / (1.0 - t);
        let kappa = (1.0 + s * s).powi(-2);
        // x/√(2Rh) = tan φ:   q/q₀ = cos⁴φ − κ
        let width = s.atan() / f64::from(INTERVALS);
        let mut sums = [0.0; 2];
        for i in 0..=INTERVALS {
            let cosine = (f64::from(i) * width).cos();
            let level = cosine.powi(4) - kappa;
            let weight = match i {
                0 | INTERVALS => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let weight = 2.0 * weight * width / 3.0 / (cosine * cosine);
            sums[0] += weight * level;
            sums[1] += weight * level * level;
        }
        let [first, second] = sums;
        let peak = 1.0 - kappa;
        // m = P − A P² + …,   A = S₂/(2 S₁ q_max)
        let bend = second / (2.0 * first * peak);
        let [endless, plates] = THICKENING.map(|[a, ..]| a);
        Self {
            mobility: 8.0 / 3.0 * t.powi(3) / first,
            peak: peak * t / first,
            flatness: (bend - endless) / (plates - endless),
        }
    }

    /// m/P, and dm/dP: what pressure leaves of the speed, and of its change with the force.
    pub fn thickening(&self, pressing: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        let weights = [1.0 - self.flatness, self.flatness];
        for ((bound, [a, b, c]), weight) in BOUNDS.into_iter().zip(THICKENING).zip(weights) {
            let p = pressing.min(bound);
            // Beyond the bound the film drains no faster, whatever the force.
            let beyond = if pressing > bound {
                bound / pressing
            } else {
                1.0
            };
            sums[0] += weight * beyond * (1.0 - p * (a - p * (b - p * c)));
            if pressing < bound {
                sums[1] += weight * (1.0 - p * (2.0 * a - p * (3.0 * b - p * 4.0 * c)));
            }
        }
        sums
    }
}
