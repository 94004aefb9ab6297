//! Pins and bushes as short beams.

use std::f64::consts::PI;

use chaindrive_contact::Elasticity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Support of the ends of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BeamEnds {
    /// They keep their place and may turn.
    Supported,
    /// They neither move nor turn.
    Clamped,
}

/// A round bar or tube under a load that is even along its length, held at its ends.
///
/// ```text
/// δ/F = β l³/(E I) + κ l/(12 G A),   β = 1/120 supported, 1/720 clamped
/// κ = [(7 + 6ν)(1 + m²)² + (20 + 12ν) m²] / [6 (1 + ν)(1 + m²)²],   m = r_i/r_o
/// ```
///
/// δ is the mean deflection under the load, so that ½ F δ is the energy.
///
/// Elasticity in full, of a solid bar whose load enters evenly at its surface, differs by 0.2 % (supported) and 1 % (clamped) at l = 2.3 d, by 3
/// and 7 % at l = 1.5 d. Clamped sections do not warp: no plate holds stiffer.
///
/// # Source
/// S. P. Timoshenko, *Phil. Mag.* **41**, 1921, 744–746; κ: G. R. Cowper, *J. Appl. Mech.* **33**, 1966, 335–340.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Outer radius r_o \[m\].
    pub outer_radius: f64,
    /// Inner radius r_i \[m\], zero for a bar.
    pub inner_radius: f64,
    /// Length l \[m\], loaded from end to end.
    pub length: f64,
    /// Support of its ends.
    pub ends: BeamEnds,
    /// Material.
    pub material: Elasticity,
}

impl Beam {
    /// Compliance δ/F \[m/N\].
    pub fn compliance(&self) -> f64 {
        let Self {
            outer_radius: outer,
            inner_radius: inner,
            length,
            ends,
            material: Elasticity { modulus, poisson },
        } = *self;
        let bending = match ends {
            BeamEnds::Supported => 1.0 / 120.0,
            BeamEnds::Clamped => 1.0 / 720.0,
        };
        let inertia = 0.25 * PI * (outer.powi(4) - inner.powi(4));
        let area = PI * (outer * outer - inner * inner);
        let shear_modulus = modulus / (2.0 * (1.0 + poisson));
        // κ = [(7 + 6ν)(1 + m²)² + (20 + 12ν) m²] / [6 (1 + ν)(1 + m²)²]
        let squared = (inner / outer).powi(2);
        let sum = (1.0 + squared).powi(2);
        let shape = ((7.0 + 6.0 * poisson) * sum + (20.0 + 12.0 * poisson) * squared)
            / (6.0 * (1.0 + poisson) * sum);
        // δ/F = β l³/(E I) + κ l/(12 G A)
        bending * length.powi(3) / (modulus * inertia)
            + shape * length / (12.0 * shear_modulus * area)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use nalgebra::{DMatrix, DVector};

    /// Radius of the pin of 56B \[m\].
    const RADIUS: f64 = 17.16e-3;

    fn pin(length: f64, ends: BeamEnds) -> Beam {
        Beam {
            outer_radius: RADIUS,
            inner_radius: 0.0,
            length,
            ends,
            material: Elasticity::STEEL,
        }
    }

    /// Deflections of Timoshenko's beam, integrated along it: ψ' = M/(E I), w' = ψ + κ V/(G A), and their mean.
    #[test]
    fn a_beam_is_the_integral_of_its_curvature_and_shear() {
        let length = 80.34e-3;
        for ends in [BeamEnds::Supported, BeamEnds::Clamped] {
            let tube = Beam {
                inner_radius: 12e-3,
                ..pin(length, ends)
            };
            let second = 0.25 * PI * (RADIUS.powi(4) - 12e-3_f64.powi(4));
            let area = PI * (RADIUS.powi(2) - 12e-3_f64.powi(2));
            let (modulus, m2) = (207e9, (12e-3 / RADIUS).powi(2));
            // Cowper's table, ν = 0.3: k = 6 (1 + ν)(1 + m²)²/[(7 + 6ν)(1 + m²)² + (20 + 12ν) m²]
            let k = 7.8 * (1.0 + m2).powi(2) / (8.8 * (1.0 + m2).powi(2) + 23.6 * m2);
            let shear = modulus / 2.6 * area * k;
            let steps = 20_000;
            let dx = length / f64::from(steps);
            let held = match ends {
                BeamEnds::Supported => 0.0,
                BeamEnds::Clamped => -length / 12.0,
            };
            // From the end to the middle, which does not turn; the unit load is 1/l.
            let (mut turned, mut mean) = (0.0, 0.0);
            let moment = |x: f64| held + 0.5 * x - 0.5 * x * x / length;
            for i in 0..steps / 2 {
                turned += moment((f64::from(i) + 0.5) * dx) * dx / (modulus * second);
            }
            let mut deflection = 0.0;
            for i in 0..steps / 2 {
                let x = (f64::from(i) + 0.5) * dx;
                let before = turned;
                turned -= moment(x) * dx / (modulus * second);
                let slope = 0.5 * (before + turned) + (0.5 - x / length) / shear;
                mean += 2.0 * (deflection + 0.5 * slope * dx) * dx / length;
                deflection += slope * dx;
            }
            let found = tube.compliance();
            assert!(
                (found / mean - 1.0).abs() < 1e-6,
                "{ends:?}: {found} {mean}"
            );
        }
    }

    /// Legendre's polynomial of a degree and its derivative.
    fn legendre(degree: usize, x: f64) -> [f64; 2] {
        let (mut before, mut value) = ([0.0, 0.0], [1.0, 0.0]);
        for n in 0..degree {
            let n = n as f64;
            let next = ((2.0 * n + 1.0) * x * value[0] - n * before[0]) / (n + 1.0);
            let slope = before[1] + (2.0 * n + 1.0) * value[0];
            (before, value) = (value, [next, slope]);
        }
        value
    }

    /// Places and weights of the middle rule in (−1, 1), dense enough for what is integrated here.
    fn middles(count: usize) -> Vec<[f64; 2]> {
        let width = 2.0 / count as f64;
        let place = |i| width * (f64::from(i) + 0.5) - 1.0;
        (0..u32::try_from(count).unwrap_or(0))
            .map(|i| [place(i), width])
            .collect()
    }

    /// Compliance of a bar by elasticity in full: the least energy over displacements
    ///
    /// ```text
    /// u_x = A + (x² − y²) B,   u_y = 2 x y B,   u_z = x C
    /// ```
    ///
    /// with polynomials A, B, C in r² and z, whose strains go with cos θ and sin θ around the axis. What is left is an integral over r and z. The
    /// load is spread evenly over the surface, along x.
    fn by_elasticity(length: f64, ends: BeamEnds, [across, along]: [usize; 2]) -> f64 {
        let Elasticity { modulus, poisson } = Elasticity::STEEL;
        let shear = 0.5 * modulus / (1.0 + poisson);
        let lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
        let size = 3 * across * along;
        let mut stiffness = DMatrix::zeros(size, size);
        let mut load = DVector::zeros(size);
        // In z: even for A and B, odd for C, and zero at the ends where they are held.
        let profile = |kind: usize, degree: usize, zeta: f64| {
            let odd = usize::from(kind == 2);
            let [value, slope] = legendre(2 * degree + odd, zeta);
            if kind == 2 && ends == BeamEnds::Supported {
                return [value, slope];
            }
            let held = 1.0 - zeta * zeta;
            [held * value, held * slope - 2.0 * zeta * value]
        };
        let each = |i: usize| (i / (across * along), i / along % across, i % along);
        for [zeta, of_z] in middles(200) {
            for (i, entry) in load.iter_mut().enumerate() {
                let (kind, _, degree) = each(i);
                if kind == 0 {
                    // All of Legendre's polynomials are 1 at the surface.
                    *entry += 0.5 * of_z * profile(0, degree, zeta)[0];
                }
            }
            for [place, of_r] in middles(60) {
                let r = 0.5 * RADIUS * (place + 1.0);
                let weight = PI * r * 0.5 * RADIUS * of_r * 0.5 * length * of_z;
                let strains = DMatrix::from_fn(6, size, |row, i| {
                    let (kind, degree_r, degree_z) = each(i);
                    let s = 2.0 * (r / RADIUS).powi(2) - 1.0;
                    let [p, dp] = legendre(degree_r, s);
                    let dp = dp * 4.0 * r / (RADIUS * RADIUS);
                    let [g, dg] = profile(kind, degree_z, zeta);
                    let [f, f_r, f_z] = [p * g, dp * g, p * dg * 2.0 / length];
                    // ε_rr, ε_θθ, ε_zz with cos θ, γ_rθ with sin θ, γ_rz with cos θ, γ_θz with sin θ.
                    let strains = match kind {
                        0 => [f_r, 0.0, 0.0, -f_r, f_z, -f_z],
                        1 => {
                            let rr = r * r / (RADIUS * RADIUS);
                            let round = 2.0 * r * f / (RADIUS * RADIUS);
                            let [r_r, r_z] = [rr * f_r, rr * f_z];
                            [r_r + round, round, 0.0, r_r, r_z, r_z]
                        }
                        _ => {
                            let x = r / RADIUS;
                            [0.0, 0.0, x * f_z, 0.0, f / RADIUS + x * f_r, -f / RADIUS]
                        }
                    };
                    strains[row]
                });
                let moduli = DVector::from_vec(vec![
                    2.0 * shear,
                    2.0 * shear,
                    2.0 * shear,
                    shear,
                    shear,
                    shear,
                ]);
                let swelling = strains.rows(0, 3).row_sum();
                stiffness +=
                    strains.transpose() * DMatrix::from_diagonal(&(moduli * weight)) * &strains;
                stiffness += swelling.transpose() * swelling * (lame * weight);
            }
        }
        let deflection = stiffness.cholesky().map(|it| it.solve(&load));
        deflection.map_or(f64::NAN, |it| it.dot(&load))
    }

    /// A pin as short as that of 56B, 2.3 diameters, bends as a beam within 0.5 % where its ends turn and 1 % where they are clamped.
    /// The displacements are few, so that the compliance comes from below; more of them change it by 0.4 %.
    #[test]
    fn a_pin_is_a_short_beam() {
        for (diameters, ends, off) in [
            (2.34, BeamEnds::Supported, 0.005),
            (2.34, BeamEnds::Clamped, 0.01),
            (1.5, BeamEnds::Supported, 0.04),
            (1.5, BeamEnds::Clamped, 0.07),
            (4.0, BeamEnds::Supported, 0.005),
            (4.0, BeamEnds::Clamped, 0.03),
        ] {
            let length = diameters * 2.0 * RADIUS;
            let exact = by_elasticity(length, ends, [3, 5]);
            let found = pin(length, ends).compliance();
            assert!(
                (found / exact - 1.0).abs() < off,
                "{diameters} {ends:?}: {}",
                found / exact
            );
        }
    }
}
