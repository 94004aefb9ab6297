//! Strands side by side, as a drive describes them.

use crate::DriveError;

/// A bush chain of strands side by side on common pins.
///
/// The pins are straight and stiff, so that every joint has one place, and every strand holds them by plates of its own:
///
/// ```text
/// T = Σ T_s,   T_s = k_s (ℓ − p_s),   p_s = λ_s p,   k_s = κ_s k
/// ```
///
/// p, k and the masses are those of the chain: lengths without load, stiffnesses and masses of all strands together.
///
/// Outer plates are pressed on the pins: they push as they pull. Bushes of inner links have play 2 c on their pins at both ends: a
/// strand that is longer than its link hangs loose, and pushes from 4 c below its own length on. Damping belongs to the link as a
/// whole and counts as that of the strands in proportion to their stiffnesses, loose ones included.
///
/// There are no rollers. The bushes meet teeth and guides in the middle of the joint, and turn with their inner link: they rub where
/// a roller would roll.
///
/// # Example
///
/// A new strand beside one that is worn by 0.1 mm, both of 20 kN/mm, under 3 kN:
///
/// ```
/// use chaindrive_mechanics::BushStrands;
///
/// let lengths = [12.7e-3, 12.8e-3];
/// let (strands, [together, stiffness]) = BushStrands::together(&lengths, &[20e6, 20e6]);
/// assert!((together - 12.75e-3).abs() < 1e-15);
/// assert_eq!(stiffness, 40e6);
/// // ℓ = p + T/k,   T_s = κ_s k (ℓ − λ_s p)
/// let length = together + 3e3 / stiffness;
/// let tension = |s: usize| strands[s].stiffness * stiffness * (length - strands[s].length * together);
/// assert!((tension(0) - 2500.0).abs() < 1e-6);
/// assert!((tension(1) - 500.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BushStrands {
    /// The strands, at least one.
    pub strands: Vec<Strand>,
    /// Radial clearance c of the pins in the bushes \[m\], not negative.
    pub clearance: f64,
    /// Whether link 0 is an outer one, without bushes.
    pub outer_first: bool,
}

/// One of the strands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strand {
    /// Length without load λ, in that of all strands together \[–\]: Σ κ λ = 1.
    pub length: f64,
    /// Stiffness κ, in that of all strands together \[–\], positive: Σ κ = 1.
    pub stiffness: f64,
}

/// Relative error that sums over the strands may have.
const ROUNDING: f64 = 1e-9;

impl BushStrands {
    /// The strands of a chain from lengths and stiffnesses in any unit, and what they have together: the length at which they pull
    /// nothing, and the sum of the stiffnesses.
    ///
    /// ```text
    /// k = Σ k_s,   p = Σ k_s p_s/k
    /// ```
    pub fn together(lengths: &[f64], stiffness: &[f64]) -> (Vec<Strand>, [f64; 2]) {
        let sum: f64 = stiffness.iter().sum();
        let pairs = || lengths.iter().zip(stiffness);
        let mean = pairs().map(|(p, k)| k * p).sum::<f64>() / sum;
        let strands = pairs().map(|(p, k)| Strand {
            length: p / mean,
            stiffness: k / sum,
        });
        (strands.collect(), [mean, sum])
    }

    /// Whether link `index` carries the bushes.
    pub(crate) fn is_inner(&self, index: usize) -> bool {
        index.is_multiple_of(2) != self.outer_first
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let mut problems = Vec::new();
        let mut need = |ok: bool, path: &str, value: f64, allowed: &'static str| {
            problems.extend(DriveError::require(ok, path, value, allowed).err());
        };
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let count = self.strands.len();
        need(count > 0, "chain.strands", count as f64, "at least 1");
        for (index, strand) in self.strands.iter().enumerate() {
            let path = |what: &str| format!("chain.strands[{index}].{what}");
            let Strand { length, stiffness } = *strand;
            need(positive(length), &path("length"), length, "positive [–]");
            need(
                positive(stiffness),
                &path("stiffness"),
                stiffness,
                "positive [–]",
            );
        }
        let near_one = |value: f64| (value - 1.0).abs() < ROUNDING;
        let shares: f64 = self.strands.iter().map(|it| it.stiffness).sum();
        need(
            near_one(shares),
            "chain.strands.stiffness",
            shares,
            "1 in sum [–]",
        );
        let mean = self.strands.iter().map(|it| it.stiffness * it.length);
        let mean: f64 = mean.sum();
        need(
            near_one(mean),
            "chain.strands.length",
            mean,
            "1 in the mean [–]",
        );
        need(
            self.clearance >= 0.0 && self.clearance.is_finite(),
            "chain.joint.clearance",
            self.clearance,
            "not negative [m]",
        );
        problems
    }
}
