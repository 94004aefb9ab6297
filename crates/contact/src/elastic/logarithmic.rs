//! The curve behind every logarithmic law of two parallel cylinders, solved explicitly for the force.

use std::f64::consts::{E, PI};

use super::lambert::minus_w_lower;

/// Fraction of δ_max at which a law goes on as a straight line.
const KNEE: f64 = 0.9;

/// u at the knee: the root of u − ln u = 1 − ln 0.9.
const KNEE_RATIO: f64 = 1.531_811_608_389_611_6;

/// Depth below which logarithms would overflow \[m\]; far below an atom.
const LEAST_DEPTH: f64 = 1e-290;

/// Penetration as load times logarithm of load, with the length D that tells the laws apart.
///
/// ```text
/// δ = p [ln(D/p) − 1],   p = g/(π E* L)
///
/// g = π E* L δ/u,   k = π E* L/(u − 1),   U = π E* L p² (2u − 1)/4,
/// u = −W₋₁(−e δ/D),  that is  u − ln u = 1 + ln(δ_max/δ),   δ_max = D/e²
/// ```
///
/// From 0.9 δ_max on it continues as its own tangent, with the stiffness 1.88 π E* L.
///
/// A spring k_s in series makes the curve of a longer D, and leaves the load at the knee:
///
/// ```text
/// δ + g/k_s = p [ln(D eᶜ/p) − 1],   c = π E* L/k_s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Logarithmic {
    /// π E* L \[N/m\], what all stiffnesses are measured with.
    scale: f64,
    /// ln δ_max, δ_max in metres.
    end: f64,
    /// δ at the knee \[m\].
    knee: f64,
    /// u at the knee.
    knee_ratio: f64,
}

impl Logarithmic {
    /// The curve of the length D \[m\] and the modulus E* L \[N/m\].
    #[inline]
    pub(super) fn new(length_scale: f64, modulus_length: f64) -> Self {
        let end = greatest_penetration(length_scale);
        Self {
            scale: PI * modulus_length,
            end: end.ln(),
            knee: KNEE * end,
            knee_ratio: KNEE_RATIO,
        }
    }

    /// The curve with a spring in series.
    pub(super) fn with_series(self, stiffness: f64) -> Self {
        let shift = self.scale / stiffness;
        let p = self.knee / self.knee_ratio;
        Self {
            end: self.end + shift,
            knee: self.knee + shift * p,
            knee_ratio: self.knee_ratio + shift,
            ..self
        }
    }

    /// π E* L \[N/m\] and ln δ_max, δ_max in metres.
    pub(crate) fn constants(self) -> [f64; 2] {
        [self.scale, self.end]
    }

    /// Depth \[m\] from which on it is its own tangent.
    pub(super) fn reach(self) -> f64 {
        self.knee
    }

    /// u = δ/p below the knee.
    #[inline]
    fn ratio(self, penetration: f64) -> f64 {
        // u − ln u = 1 + ln(δ_max/δ)
        minus_w_lower(self.end - penetration.max(LEAST_DEPTH).ln())
    }

    /// Force beyond the knee: g = g_k + k_k (δ − δ_k).
    #[inline]
    fn straight(self, penetration: f64) -> f64 {
        let ratio = self.knee_ratio;
        self.scale * (self.knee / ratio + (penetration - self.knee) / (ratio - 1.0))
    }

    #[inline]
    pub(super) fn force(self, penetration: f64) -> f64 {
        if penetration <= 0.0 {
            0.0
        } else if penetration < self.knee {
            // g = π E* L δ/u
            self.scale * penetration / self.ratio(penetration)
        } else {
            self.straight(penetration)
        }
    }

    #[inline]
    pub(super) fn stiffness(self, penetration: f64) -> f64 {
        self.pair(penetration).1
    }

    /// Force and stiffness from one u.
    #[inline]
    pub(super) fn pair(self, penetration: f64) -> (f64, f64) {
        if penetration <= 0.0 {
            (0.0, 0.0)
        } else if penetration < self.knee {
            // g = π E* L δ/u,   k = π E* L/(u − 1)
            let u = self.ratio(penetration);
            (self.scale * penetration / u, self.scale / (u - 1.0))
        } else {
            (
                self.straight(penetration),
                self.scale / (self.knee_ratio - 1.0),
            )
        }
    }

    #[inline]
    pub(super) fn energy(self, penetration: f64) -> f64 {
        if penetration <= 0.0 {
            return 0.0;
        }
        let depth = penetration.min(self.knee);
        let ratio = if penetration < self.knee {
            self.ratio(depth)
        } else {
            self.knee_ratio
        };
        // U = π E* L p² (2u − 1)/4,   p = δ/u
        let p = depth / ratio;
        let below = self.scale * p * p * (2.0 * ratio - 1.0) / 4.0;
        // U = U_k + ½ (g_k + g) (δ − δ_k)
        let beyond = penetration - depth;
        below + self.scale * beyond * (p + 0.5 * beyond / (ratio - 1.0))
    }
}

/// δ_max = D/e² \[m\], where the stiffness of the curve becomes infinite.
#[inline]
pub(super) fn greatest_penetration(length_scale: f64) -> f64 {
    length_scale / (E * E)
}

/// The elastic law of a type with a `length_scale` and a `modulus_length`.
macro_rules! follows_the_logarithm {
    ($law:ty) => {
        impl $law {
            /// Penetration δ_max = D/e² \[m\] at which the theory ends.
            pub fn greatest_penetration(self) -> f64 {
                $crate::elastic::logarithmic::greatest_penetration(self.length_scale)
            }

            #[inline]
            fn logarithm(self) -> $crate::elastic::logarithmic::Logarithmic {
                $crate::elastic::logarithmic::Logarithmic::new(
                    self.length_scale,
                    self.modulus_length,
                )
            }
        }

        impl $crate::elastic::ElasticLaw for $law {
            #[inline]
            fn force(&self, penetration: f64) -> f64 {
                self.logarithm().force(penetration)
            }

            #[inline]
            fn stiffness(&self, penetration: f64) -> f64 {
                self.logarithm().stiffness(penetration)
            }

            #[inline]
            fn energy(&self, penetration: f64) -> f64 {
                self.logarithm().energy(penetration)
            }

            #[inline]
            fn pair(&self, penetration: f64) -> (f64, f64) {
                self.logarithm().pair(penetration)
            }
        }

        impl $crate::elastic::Member for $law {
            fn curve(&self) -> $crate::elastic::Curve {
                $crate::elastic::Curve::Logarithmic(self.logarithm())
            }
        }
    };
}

pub(super) use follows_the_logarithm;
