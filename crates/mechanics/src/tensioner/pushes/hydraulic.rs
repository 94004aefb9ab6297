//! One-way hydraulic tensioner, reduced to a force law.

use chaindrive_quantities::{Damping, Force, JsonSchema, ParameterError, Stiffness, check};
use serde::{Deserialize, Serialize};

use super::{Oil, OilColumn, Push, PushForce, PushLaw, Slopes};

/// A plunger behind a check valve: it follows the chain easily and yields only through a leak.
///
/// ```text
/// F = F₀ − k x + F_oil,   flow u of oil into the chamber, as a speed of the plunger:
/// F_oil > p_s A   u = −(F_oil − p_s A)/c_leak − max(F_oil − p_r A, 0)/c_rel
/// F_oil < p_s A   u = (p_s A − F_oil)/c_ext
/// c_leak = 12 μ L A² / (π d h³)
/// ```
///
/// Without a column of oil that can be compressed, ẋ = u: the oil is stiff and has no inertia. F_oil is then a function of ẋ, and never
/// negative; c_ext = 0 is a check valve without resistance and c_rel = 0 a relief valve that holds its pressure. That is valid while the
/// oil's own spring K A²/V is much stiffer than the chain that it supports, and at frequencies well below K A²/(V c_leak).
///
/// With a [column](OilColumn), F_oil is the pressure of the oil in its chamber, z grows at the speed u, and what flows through a leak
/// or valve is lost. A column of K → ∞ is the law without one, but for the air around, which pushes a plunger in from which the oil has
/// torn off.
///
/// # Source
/// Leakage of an annular gap is Poiseuille flow between plates; the chamber with check,
/// leak and relief flows follows Feng et al. (2023).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub struct Hydraulic {
    /// Push of the spring in the assembled position F₀ \[N\].
    #[schemars(with = "Force")]
    pub preload: f64,
    /// Spring rate k \[N/m\].
    #[serde(default)]
    #[schemars(with = "Stiffness", extend("minimum" = 0))]
    pub stiffness: f64,
    /// Damping by the check valve while it extends c_ext \[N s/m\].
    #[serde(default)]
    #[schemars(with = "Damping", extend("minimum" = 0))]
    pub extending: f64,
    /// Damping by the relief valve while it is open c_rel \[N s/m\]; 0: it holds its pressure.
    #[serde(default)]
    #[schemars(with = "Damping", extend("minimum" = 0))]
    pub relieving: f64,
    /// Push of the supply pressure p_s A \[N\]; instead of `oil`.
    #[schemars(with = "Option<Force>", extend("minimum" = 0))]
    pub supply: f64,
    /// Push at which the relief valve opens p_r A \[N\]; instead of `oil`.
    #[schemars(with = "Option<Force>", extend("minimum" = 0))]
    pub relief: f64,
    /// Damping by the leak while it is compressed c_leak \[N s/m\]; instead of `oil`.
    #[schemars(with = "Option<Damping>", extend("minimum" = 0))]
    pub leak: f64,
    /// Oil that can be compressed; without it the oil is stiff.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(
        rename = "oil",
        with = "Option<Oil>",
        description = "Plunger and oil, from which supply, relief and leak are computed."
    )]
    pub column: Option<OilColumn>,
}

impl Hydraulic {
    /// Push of stiff oil at a rate ẋ.
    fn stiff(&self, rate: f64) -> f64 {
        if rate >= 0.0 {
            return (self.supply - self.extending * rate).max(0.0);
        }
        let oil = self.supply - self.leak * rate;
        if oil <= self.relief {
            return oil;
        }
        // −ẋ = (F − p_s A)/c_leak + (F − p_r A)/c_rel,   F − p_r A = (F_leak − p_r A) c_rel/(c_rel + c_leak)
        let share = self.relieving / (self.relieving + self.leak);
        self.relief + (oil - self.relief) * share
    }

    /// Speed u at which oil of a push comes in, and −∂u/∂F.
    fn inflow(&self, oil: f64) -> [f64; 2] {
        if oil < self.supply {
            return [(self.supply - oil) / self.extending, 1.0 / self.extending];
        }
        let (mut flow, mut slope) = ((self.supply - oil) / self.leak, 1.0 / self.leak);
        if oil > self.relief {
            flow -= (oil - self.relief) / self.relieving;
            slope += 1.0 / self.relieving;
        }
        [flow, slope]
    }
}

impl PushLaw for Hydraulic {
    fn unit(&self) -> &'static str {
        "N"
    }

    fn force(&self, x: f64, rate: f64, z: f64) -> PushForce {
        let spring = self.preload - self.stiffness * x;
        let Some(column) = &self.column else {
            return PushForce {
                elastic: spring + self.supply,
                damping: self.stiff(rate) - self.supply,
                ..PushForce::default()
            };
        };
        let oil = column.at(x, z, self.supply);
        let [flow, _] = self.inflow(oil.force);
        PushForce {
            elastic: spring + oil.force,
            damping: 0.0,
            flow,
            // P = −∂U/∂z ż
            loss: -oil.effort * flow,
        }
    }

    fn energy(&self, x: f64, z: f64) -> f64 {
        let Some(column) = &self.column else {
            // U = ½ k x² − (F₀ + p_s A) x: the supply line holds its pressure like a weight
            return (0.5 * self.stiffness * x - self.preload - self.supply) * x;
        };
        let spring = (0.5 * self.stiffness * x - self.preload) * x;
        spring + column.at(x, z, self.supply).energy
    }

    fn stiffness(&self, _: f64) -> f64 {
        self.stiffness
    }

    fn damping(&self) -> f64 {
        match self.column {
            None => self.leak.max(self.extending),
            Some(_) => 0.0,
        }
    }

    fn settled(&self, x: f64) -> Option<f64> {
        // The oil is under the pressure of the supply: z = x.
        self.column.map(|_| x)
    }

    fn relaxed(&self) -> Option<Push> {
        Some(Push::Hydraulic(Self {
            column: None,
            ..*self
        }))
    }

    fn slopes(&self, x: f64, z: f64) -> Slopes {
        let Some(column) = &self.column else {
            return Slopes::default();
        };
        let oil = column.at(x, z, self.supply);
        let [_, slope] = self.inflow(oil.force);
        let [stiffness, stiffest] = oil.stiffness;
        let widest = (1.0 / self.leak + 1.0 / self.relieving).max(1.0 / self.extending);
        // F and u depend on x and z by the pressure: ∂F/∂z = −(V/V_s) ∂F/∂x
        Slopes {
            stiffness,
            by_state: stiffness * oil.ratio,
            flow: slope * stiffness,
            settling: slope * stiffness * oil.ratio,
            largest: [stiffest, stiffest * oil.ratio.max(1.0) * widest],
        }
    }

    fn pressure(&self, x: f64, z: f64) -> Option<f64> {
        let column = self.column.as_ref()?;
        Some(column.at(x, z, self.supply).pressure)
    }

    fn outward(&self) -> [f64; 2] {
        [self.extending, self.stiffness]
    }

    fn check(&self) -> Result<(), ParameterError> {
        let require = |fine: bool, parameter: &'static str, value: f64, allowed: &'static str| {
            let refused = ParameterError {
                parameter: parameter.into(),
                value,
                allowed: allowed.into(),
            };
            if fine { Ok(()) } else { Err(refused) }
        };
        let opens = self.relief >= self.supply;
        require(opens, "relief", self.relief, "at least the supply push [N]")?;
        let Some(column) = &self.column else {
            return Ok(());
        };
        let allowed = "positive [N s/m] where oil can be compressed";
        for (name, value) in [
            ("leak", self.leak),
            ("extending", self.extending),
            ("relieving", self.relieving),
        ] {
            require(value > 0.0, name, value, allowed)?;
        }
        check(column).map_err(|mut refused| {
            refused.parameter = format!("oil.{}", refused.parameter).into();
            refused
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yields_slowly_and_follows_easily() {
        let plunger = Hydraulic {
            preload: 40.0,
            stiffness: 2e3,
            supply: 34.0,
            relief: 340.0,
            leak: 65e3,
            extending: 200.0,
            relieving: 0.0,
            column: None,
        };
        let total = |x, rate| {
            let force = plunger.force(x, rate, 0.0);
            force.elastic + force.damping
        };
        assert!((total(0.0, 0.0) - 74.0).abs() < 1e-12);
        assert!((total(0.0, -1e-3) - 139.0).abs() < 1e-9);
        assert!(
            (total(0.0, -1.0) - 380.0).abs() < 1e-9,
            "the relief valve caps it"
        );
        assert!((total(0.0, 0.1) - 54.0).abs() < 1e-9);
        assert!((total(0.0, 1.0) - 40.0).abs() < 1e-9, "oil cannot pull");
    }
}
