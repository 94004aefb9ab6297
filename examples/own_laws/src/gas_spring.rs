//! A cylinder of gas behind a tensioner.

use chaindrive::laws::pushes::{PushForce, PushLaw};
use chaindrive::laws::quantities::{Damping, Force, JsonSchema, Length, Ratio};
use serde::{Deserialize, Serialize};

/// A gas spring with a damper.
///
/// ```text
/// F = F₀ rⁿ − c ẋ,   r = l/(l + x)
/// U = F₀ l (rⁿ⁻¹ − 1)/(n − 1),   F₀ l ln r for n = 1
/// ```
///
/// The gas is ideal and follows p Vⁿ = const in a cylinder of constant cross-section, without the air around it. n is 1 where it keeps its temperature, and
/// 1.4 for nitrogen that is compressed too fast for heat to leave. Pushed in to a hundredth of its length, the gas is as stiff as it gets.
///
/// # Source
/// Y. A. Çengel and M. A. Boles, *Thermodynamics: An Engineering Approach*, McGraw-Hill: boundary work of a polytropic process.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GasSpring {
    /// Push in the assembled position F₀ \[N\].
    #[schemars(with = "Force", extend("exclusiveMinimum" = 0))]
    pub preload: f64,
    /// Length of the column of gas at assembly l \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Polytropic exponent n \[–\].
    #[schemars(with = "Ratio", extend("minimum" = 1, "maximum" = 1.67))]
    pub exponent: f64,
    /// Damping c \[N s/m\].
    #[serde(default)]
    #[schemars(with = "Damping", extend("minimum" = 0))]
    pub damping: f64,
}

impl GasSpring {
    /// Length of the column of gas at extension x \[m\].
    fn column(&self, x: f64) -> f64 {
        (self.length + x).max(0.01 * self.length)
    }

    /// Push of the gas \[N\].
    fn gas(&self, x: f64) -> f64 {
        self.preload * (self.length / self.column(x)).powf(self.exponent)
    }
}

impl PushLaw for GasSpring {
    fn unit(&self) -> &'static str {
        "N"
    }

    fn force(&self, x: f64, rate: f64, _: f64) -> PushForce {
        PushForce {
            elastic: self.gas(x),
            damping: -self.damping * rate,
            ..PushForce::default()
        }
    }

    fn energy(&self, x: f64, _: f64) -> f64 {
        // (rⁿ⁻¹ − 1)/(n − 1) = expm1[(n − 1) ln r]/(n − 1), which is ln r for n = 1
        let (logarithm, above) = ((self.length / self.column(x)).ln(), self.exponent - 1.0);
        let grown = if above > 0.0 {
            (above * logarithm).exp_m1() / above
        } else {
            logarithm
        };
        self.preload * self.length * grown
    }

    fn stiffness(&self, x: f64) -> f64 {
        // −∂F/∂x = n F/(l + x)
        self.exponent * self.gas(x) / self.column(x)
    }

    fn damping(&self) -> f64 {
        self.damping
    }
}
