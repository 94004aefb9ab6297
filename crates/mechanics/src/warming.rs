//! Steady temperature of a chain in air.

use crate::Chain;

/// Kinematic viscosity ν \[m²/s\], conductivity λ \[W/(m K)\] and Prandtl number of air at 40 °C: VDI Heat Atlas.
const AIR: [f64; 3] = [17.0e-6, 0.0271, 0.711];
/// Least product of Reynolds and Prandtl number for which the heat transfer is known.
const LEAST: f64 = 0.2;
/// By how much the heat transfer may be less or more. *Assumed*: a link is no cylinder, oil and sprockets carry heat as well, housings hold it.
const RANGE: f64 = 2.0;

/// By how much a chain that loses a power \[W\] at a speed \[m/s\] is warmer than the air around it in the long run \[K\]: from, to.
/// None where it hardly moves.
///
/// ```text
/// ΔT = P/(h A),   A = 4 p h_p n: both faces of the two plates of every link
/// h = Nu λ/h_p,   Nu = 0.3 + 0.62 √Re ∛Pr/[1 + (0.4/Pr)^⅔]^¼ · [1 + (Re/282000)^⅝]^⅘,   Re = v h_p/ν
/// ```
///
/// The height h_p of the plates stands for the diameter of a cylinder in cross-flow. What a joint is warmer than the plates beside it is not in it.
///
/// # Source
/// S. W. Churchill and M. Bernstein, *J. Heat Transfer* **99**, 1977, 300–306 (cylinders in cross-flow, Re Pr > 0.2).
pub fn warming(chain: &Chain, power: f64, speed: f64) -> Option<[f64; 2]> {
    let [viscosity, conductivity, prandtl] = AIR;
    let height = chain.plate_height;
    // Re = v h_p/ν
    let reynolds = speed.abs() * height / viscosity;
    let known = reynolds * prandtl > LEAST;
    // A = 4 p h_p n
    let area = 4.0 * chain.pitch * height * chain.links() as f64;
    // ΔT = P/(h A)
    let warmer = power / (nusselt(reynolds, prandtl) * conductivity / height * area);
    known.then_some([warmer / RANGE, warmer * RANGE])
}

/// Heat transfer of a cylinder in cross-flow over that of conduction across its diameter.
fn nusselt(reynolds: f64, prandtl: f64) -> f64 {
    // Nu = 0.3 + 0.62 √Re ∛Pr/[1 + (0.4/Pr)^⅔]^¼ · [1 + (Re/282000)^⅝]^⅘
    let laminar = 0.62 * reynolds.sqrt() * prandtl.cbrt()
        / (1.0 + (0.4 / prandtl).powf(2.0 / 3.0)).powf(0.25);
    0.3 + laminar * (1.0 + (reynolds / 282e3).powf(0.625)).powf(0.8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cylinder of 12.7 mm in air of 10 m/s: F. P. Incropera and D. P. DeWitt, *Fundamentals of Heat and Mass Transfer*, example 7.4.
    #[test]
    fn cylinders_cool_as_the_textbook_has_it() {
        assert!((nusselt(6071.0, 0.70) - 40.6).abs() < 0.1);
    }
}
