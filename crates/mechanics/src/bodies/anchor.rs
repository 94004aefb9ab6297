//! Cosine and sine of an angle that turns little, without a trigonometric function.

use serde::{Deserialize, Serialize};

/// An angle whose cosine and sine are known.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Anchor {
    angle: f64,
    turn: [f64; 2],
}

/// Coefficients of the series: 1/(2k)! and 1/(2k+1)!.
const COSINE: [f64; 7] = [
    1.0,
    1.0 / 2.0,
    1.0 / 24.0,
    1.0 / 720.0,
    1.0 / 40_320.0,
    1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
];
const SINE: [f64; 6] = [
    1.0,
    1.0 / 6.0,
    1.0 / 120.0,
    1.0 / 5040.0,
    1.0 / 362_880.0,
    1.0 / 39_916_800.0,
];

impl Anchor {
    pub(crate) fn at(angle: f64) -> Self {
        Self {
            angle,
            turn: [angle.cos(), angle.sin()],
        }
    }

    /// Cosine and sine of an angle near the anchor, without a trigonometric function.
    ///
    /// Taylor's series to the twelfth power: exact to rounding for |Δ| ≤ 0.35.
    #[inline(always)]
    pub(crate) fn turn(&self, angle: f64) -> [f64; 2] {
        let d = angle - self.angle;
        if d.abs() > 0.35 {
            return [angle.cos(), angle.sin()];
        }
        // cos Δ = Σ (−Δ²)ᵏ/(2k)!,   sin Δ = Δ Σ (−Δ²)ᵏ/(2k+1)!
        let s = -d * d;
        let series = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, term| sum * s + term);
        let cosine = series(&COSINE);
        let sine = d * series(&SINE);
        let [c, si] = self.turn;
        [c * cosine - si * sine, si * cosine + c * sine]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_anchor_turns_as_exactly_as_the_functions() {
        for start in [-250.0, 0.0, 1.3] {
            let anchor = Anchor::at(start);
            for i in -40..=40 {
                let angle = start + 0.01 * f64::from(i);
                let [cosine, sine] = anchor.turn(angle);
                assert!((cosine - angle.cos()).abs() < 4e-16, "{start}, {i}");
                assert!((sine - angle.sin()).abs() < 4e-16, "{start}, {i}");
            }
        }
    }
}
