//! A normal force law: an elastic law and a dissipation.

use serde::{Deserialize, Serialize};

use crate::dissipation::Action;
use crate::elastic::{Curve, Stack};
use crate::error::{require, require_positive};
use crate::{Dissipation, Elastic, ParameterError};

/// Relative position and motion of two surfaces at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Approach {
    /// Penetration δ \[m\]: overlap of the surfaces, zero or negative across a gap.
    pub penetration: f64,
    /// Closing speed δ̇ \[m/s\], positive while the surfaces approach.
    pub rate: f64,
    /// Closing speed \[m/s\] at which this contact began; see [`interpolated_onset`](crate::interpolated_onset).
    pub onset_rate: f64,
}

/// Force of a contact under an approach and its derivatives, from one evaluation of its elastic law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// Normal force F \[N\], compressive, never negative.
    pub force: f64,
    /// Elastic part g \[N\].
    pub elastic: f64,
    /// Stiffness ∂F/∂δ \[N/m\] at constant closing speed; zero where the contact would pull.
    pub stiffness: f64,
    /// Damping ∂F/∂δ̇ \[N s/m\], not negative; zero where a limit holds the force.
    pub damping: f64,
}

/// Normal force law of a contact.
///
/// ```text
/// F = g(δ) clamp(1 + χ δ̇/v, 0, 1 + 4χ),   v = max(δ̇₀, v_c)     hysteretic
/// F = max(0, g(δ) + c δ̇)                                        viscous
/// ```
///
/// g is the force of the elastic law alone, or that of the law and a spring k_s behind it, which dissipation takes as a whole:
///
/// ```text
/// δ = x + g(x)/k_s,   1/k = 1/g′(x) + 1/k_s
/// ```
///
/// F is zero for δ ≤ 0 and never negative. The floor v_c is a parameter of the model: a contact
/// that begins gently, in a pretensioned strand or at assembly, has δ̇₀ ≈ 0, and without the floor would be a rigid
/// dashpot that neither reaches its static penetration nor lets go. Around a preload F₀ the
/// damping ratio is ζ = χ F₀/(2 v m ω); v_c ≥ χ F₀/(2 m ω) keeps a resting contact from overdamping, and
/// the damping constant χ g/v from setting the time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Elastic law g(δ).
    pub elastic: Elastic,
    /// Stiffness k_s \[N/m\] of what lies behind the surfaces and bears their force: plates, a rim; absent: rigid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<f64>,
    /// Dissipation on top of it.
    pub dissipation: Dissipation,
    /// Least speed at onset v_c \[m/s\] a hysteretic dissipation reckons with; positive.
    pub onset_floor: f64,
}

impl Law {
    /// The law with all its constants worked out, for loops.
    pub fn prepared(&self) -> PreparedLaw {
        PreparedLaw {
            stack: self.stack(),
            action: self.dissipation.action(),
            onset_floor: self.onset_floor,
        }
    }

    fn stack(&self) -> Stack {
        Stack::new(self.elastic.curve(), self.series)
    }

    /// Force, stiffness and damping at once; in a loop ask the [prepared](Self::prepared) law.
    #[inline]
    pub fn respond(&self, approach: Approach) -> Response {
        self.prepared().respond(approach)
    }

    /// Normal force F \[N\], compressive.
    #[inline]
    pub fn force(&self, approach: Approach) -> f64 {
        self.dissipation.action().force(
            self.elastic_force(approach.penetration),
            approach.rate,
            self.onset(approach),
        )
    }

    /// Damping ∂F/∂δ̇ \[N s/m\], not negative; zero where a limit holds the force.
    #[inline]
    pub fn damping(&self, approach: Approach) -> f64 {
        self.dissipation.action().slope(
            self.elastic_force(approach.penetration),
            approach.rate,
            self.onset(approach),
        )
    }

    /// Elastic part g \[N\] of the force at the penetration δ \[m\].
    #[inline]
    pub fn elastic_force(&self, penetration: f64) -> f64 {
        self.stack().pair(penetration).0
    }

    /// Tangent stiffness dg/dδ \[N/m\] of the elastic part.
    #[inline]
    pub fn stiffness(&self, penetration: f64) -> f64 {
        self.stack().pair(penetration).1
    }

    /// Stored energy ∫ g dδ \[J\].
    #[inline]
    pub fn energy(&self, penetration: f64) -> f64 {
        self.stack().energy(penetration)
    }

    /// Stored energies \[J\] of several contacts at a time: those of [`energy`](Self::energy) to the last bit.
    #[inline]
    pub fn energies<const N: usize>(&self, penetrations: [f64; N]) -> [f64; N] {
        self.stack().energies(penetrations)
    }

    /// v = max(δ̇₀, v_c) \[m/s\].
    #[inline]
    fn onset(&self, approach: Approach) -> f64 {
        approach.onset_rate.max(self.onset_floor)
    }

    /// Refuses parameters outside their range.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.elastic.check()?;
        if let Some(series) = self.series {
            require_positive("series", series, "positive [N/m]")?;
        }
        self.dissipation.check()?;
        let floor = self.onset_floor;
        require(
            floor >= 0.0 && floor.is_finite(),
            "onset_floor",
            floor,
            "zero or positive [m/s]",
        )?;
        // Only a hysteretic force divides by the speed at onset.
        let divides = matches!(self.dissipation.action(), Action::Hysteretic { .. });
        require(
            floor > 0.0 || !divides,
            "onset_floor",
            floor,
            "positive [m/s] with a hysteretic dissipation",
        )
    }

    /// Every elastic specimen, alone and with a spring behind it, with every dissipation specimen, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        let mut laws = Vec::new();
        for elastic in Elastic::specimens() {
            for dissipation in Dissipation::specimens() {
                for series in [None, Some(5e7)] {
                    laws.push(Self {
                        elastic,
                        series,
                        dissipation,
                        onset_floor: 1e-3,
                    });
                }
            }
        }
        laws
    }
}

/// A [`Law`] with its constants worked out: what a kernel keeps.
///
/// A linear spring costs no power and no logarithm, Hertz's law a square root, a fitted power one power, a
/// logarithmic law two logarithms; the factor of the dissipation is a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedLaw {
    stack: Stack,
    action: Action,
    onset_floor: f64,
}

impl PreparedLaw {
    /// Depth δ \[m\] from which on the elastic law is no more than its own tangent, what lies behind the surfaces included; none
    /// for laws that go on.
    pub fn reach(&self) -> Option<f64> {
        self.stack.reach()
    }

    /// Force, stiffness and damping from one evaluation of the elastic law.
    #[inline]
    pub fn respond(&self, approach: Approach) -> Response {
        let (elastic, slope) = self.stack.pair(approach.penetration);
        // v = max(δ̇₀, v_c)
        let onset = approach.onset_rate.max(self.onset_floor);
        let [force, stiffness, damping] = self.action.respond(elastic, slope, approach.rate, onset);
        Response {
            force,
            elastic,
            stiffness,
            damping,
        }
    }

    /// Stored energy ∫ g dδ \[J\].
    #[inline]
    pub fn energy(&self, penetration: f64) -> f64 {
        self.stack.energy(penetration)
    }

    /// K \[N/mⁿ\] and n of an elastic law g = K δⁿ, for those who take powers of many numbers at a time.
    #[inline]
    pub fn power(&self) -> Option<[f64; 2]> {
        match self.stack.curve()? {
            Curve::Linear(stiffness) => Some([stiffness, 1.0]),
            Curve::Hertz(stiffness) => Some([stiffness, 1.5]),
            Curve::Power(power) => Some([power.stiffness, power.exponent]),
            Curve::Logarithmic(_) | Curve::Plain(_) => None,
        }
    }

    /// K \[N/mⁿ\], n and k_s \[N/m\] of a power with a spring behind it, for the same.
    #[inline]
    pub fn power_and_series(&self) -> Option<[f64; 3]> {
        let (power, series) = self.stack.power_and_series()?;
        Some([power.stiffness, power.exponent, series])
    }

    /// π E* L \[N/m\] and ln δ_max, δ_max in metres, of a logarithmic law, alone or with a spring behind it, for the same. Where it ends
    /// says [`reach`](Self::reach).
    #[inline]
    pub fn logarithm(&self) -> Option<[f64; 2]> {
        match self.stack.curve()? {
            Curve::Logarithmic(law) => Some(law.constants()),
            Curve::Linear(_) | Curve::Hertz(_) | Curve::Power(_) | Curve::Plain(_) => None,
        }
    }

    /// Action of the dissipation, its constants worked out.
    #[inline]
    pub fn action(&self) -> Action {
        self.action
    }

    /// Least speed at onset v_c \[m/s\].
    #[inline]
    pub fn onset_floor(&self) -> f64 {
        self.onset_floor
    }
}
