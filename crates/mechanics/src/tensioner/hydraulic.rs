//! One-way hydraulic tensioner, reduced to a force law.

use super::PushForce;
use crate::DriveError;

/// A plunger behind a check valve: it follows the chain easily and yields only through a leak.
///
/// ```text
/// compressing (ẋ < 0)   F = F₀ − k x + min(p_s A + c_leak |ẋ|, p_r A)
/// extending   (ẋ ≥ 0)   F = F₀ − k x + max(p_s A − c_ext ẋ, 0)
/// c_leak = 12 μ L A² / (π d h³)
/// ```
///
/// The oil column is taken as stiff and inertia-free: valid while the column's own spring
/// β A²/V is much stiffer than the chain that it supports, and at frequencies well below
/// c_leak⁻¹ β A²/V.
///
/// # Source
/// Leakage of an annular gap is Poiseuille flow between plates; the chamber with check,
/// leak and relief flows follows Feng et al. (2023), here without the pressure state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hydraulic {
    /// Spring push at x = 0, F₀ \[N\].
    pub preload: f64,
    /// Spring rate k \[N/m\], not negative.
    pub stiffness: f64,
    /// Push of the supply pressure p_s A \[N\], not negative.
    pub supply: f64,
    /// Push at which the relief valve opens p_r A \[N\], at least the supply.
    pub relief: f64,
    /// Damping while compressing c_leak \[N s/m\], not negative.
    pub leak: f64,
    /// Damping while extending c_ext \[N s/m\], not negative.
    pub extending: f64,
}

impl Hydraulic {
    /// Leak damping 12 μ L A² / (π d h³) \[N s/m\] of an annular gap, A = π d²/4.
    ///
    /// `viscosity` μ \[Pa s\], `length` L, `diameter` d and `gap` h \[m\].
    pub fn leak_damping(viscosity: f64, length: f64, diameter: f64, gap: f64) -> f64 {
        let area = 0.25 * std::f64::consts::PI * diameter * diameter;
        // c_leak = 12 μ L A² / (π d h³)
        12.0 * viscosity * length * area * area / (std::f64::consts::PI * diameter * gap.powi(3))
    }

    pub(super) fn force(&self, x: f64, rate: f64) -> PushForce {
        let oil = if rate < 0.0 {
            (self.supply - self.leak * rate).min(self.relief)
        } else {
            (self.supply - self.extending * rate).max(0.0)
        };
        PushForce {
            elastic: self.preload - self.stiffness * x + self.supply,
            damping: oil - self.supply,
        }
    }

    pub(super) fn energy(&self, x: f64) -> f64 {
        // U = ½ k x² − (F₀ + p_s A) x: the supply line holds its pressure like a weight
        (0.5 * self.stiffness * x - self.preload - self.supply) * x
    }

    pub(super) fn check(&self, path: &str) -> Result<(), DriveError> {
        let range = |name: &str, value: f64, low: f64, allowed| {
            DriveError::require(
                value.is_finite() && value >= low,
                &format!("{path}.{name}"),
                value,
                allowed,
            )
        };
        range("preload", self.preload, f64::MIN, "finite [N]")?;
        range("stiffness", self.stiffness, 0.0, "not negative [N/m]")?;
        range("supply", self.supply, 0.0, "not negative [N]")?;
        range(
            "relief",
            self.relief,
            self.supply,
            "at least the supply push [N]",
        )?;
        range("leak", self.leak, 0.0, "not negative [N s/m]")?;
        range("extending", self.extending, 0.0, "not negative [N s/m]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published example: d = 12 mm, L = 25 mm, μ = 10 mPa s give 302, 65, 15.9 and
    /// 4.7 kN s/m at gaps of 15, 25, 40 and 60 µm (theory: annular leak flow).
    #[test]
    fn leak_damping_follows_the_gap_cubed() {
        for (gap, expected) in [
            (15e-6, 302e3),
            (25e-6, 65e3),
            (40e-6, 15.9e3),
            (60e-6, 4.7e3),
        ] {
            let damping = Hydraulic::leak_damping(0.01, 0.025, 0.012, gap);
            assert!(
                (damping / expected - 1.0).abs() < 0.01,
                "{damping} at {gap}"
            );
        }
    }

    #[test]
    fn yields_slowly_and_follows_easily() {
        let plunger = Hydraulic {
            preload: 40.0,
            stiffness: 2e3,
            supply: 34.0,
            relief: 340.0,
            leak: 65e3,
            extending: 200.0,
        };
        let total = |x, rate| {
            let force = plunger.force(x, rate);
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
