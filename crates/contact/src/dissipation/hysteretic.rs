//! Hysteretic members: F = g(δ) (1 + χ δ̇/δ̇₀), with the factor χ over the restitution e that is asked for.
//!
//! To add one write its entry in the table: nothing else names the members one by one.

use chaindrive_quantities::{JsonSchema, Ratio, check};
use serde::{Deserialize, Serialize};

use super::{Action, Viscous};
use crate::ParameterError;
use crate::error::no_parameters;
use crate::restitution::factor_for;

macro_rules! members {
    ($($(#[$doc:meta])* $name:ident, $formula:literal = |$e:ident| $factor:expr, least $least:literal;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            pub struct $name {
                /// Coefficient of restitution e \[–\] asked for.
                #[schemars(with = "Ratio", extend("minimum" = $least, "maximum" = 1, "x-remedy" = remedy($least)))]
                pub restitution: f64,
            }

            impl $name {
                /// Damping factor χ \[–\].
                #[inline]
                pub fn factor(self) -> f64 {
                    let $e = self.restitution;
                    $factor
                }
            }
        )*

        /// A dissipation, chosen at run time.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum Dissipation {
            /// No loss: the contact returns what it stored.
            #[serde(deserialize_with = "no_parameters")]
            None,
            $(
                #[doc = $formula]
                $name($name),
            )*
            /// A dashpot beside the elastic law: Kelvin–Voigt.
            Viscous(Viscous),
        }

        /// How a restitution becomes a force: the factor χ of F = g(δ) (1 + χ δ̇/v).
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        #[schemars(rename = "Dissipation")]
        pub enum Hysteresis {
            /// No loss; without a restitution.
            None,
            $(#[doc = $formula] $name,)*
        }

        impl Dissipation {
            /// The dissipation that is asked for a coefficient of restitution \[–\].
            pub fn with_restitution(hysteresis: Hysteresis, restitution: f64) -> Self {
                match hysteresis {
                    Hysteresis::None => Self::None,
                    $(Hysteresis::$name => Self::$name($name { restitution }),)*
                }
            }

            /// Every hysteretic member, asked for one coefficient of restitution \[–\].
            pub fn hysteretic(restitution: f64) -> Vec<Self> {
                vec![$(Self::$name($name { restitution })),*]
            }

            /// The dissipation with its constants worked out; ask once, outside a loop.
            #[inline]
            pub fn action(&self) -> Action {
                match self {
                    Self::None => Action::None,
                    $(Self::$name(member) => Action::Hysteretic { factor: member.factor() },)*
                    Self::Viscous(member) => Action::Viscous { damping: member.damping },
                }
            }

            /// Coefficient of restitution \[–\] a hysteretic member is asked for.
            pub fn restitution(&self) -> Option<f64> {
                match self {
                    $(Self::$name(member) => Some(member.restitution),)*
                    Self::None | Self::Viscous(_) => None,
                }
            }

            /// Refuses parameters outside the range of the member.
            ///
            /// # Errors
            /// Names the first parameter outside its range.
            pub fn check(&self) -> Result<(), ParameterError> {
                match self {
                    Self::None => Ok(()),
                    $(Self::$name(member) => check(member),)*
                    Self::Viscous(member) => check(member),
                }
            }
        }
    };
}

members! {
    /// Hysteretic damping with the factor that delivers the restitution exactly.
    ///
    /// ```text
    /// χ (1 + e) = ln[(1 + χ)/(1 − χ e)]
    /// ```
    ///
    /// Whatever the elastic law, the mass and the speed: a free impact asked for e returns e. The factor is found
    /// by Newton's method, once where a law is [prepared](crate::Law::prepared); every other member
    /// is an approximation of it.
    ///
    /// # Source
    /// Integration of the separable equation of motion, see [`restitution`](crate::restitution); same
    /// content as Y. Gonthier et al., *Multibody Syst. Dyn.* **11**, 2004, 209–233.
    Exact, "The factor that delivers the restitution asked for." = |e| factor_for(e), least 1e-6;

    /// Hysteretic damping of Hunt and Crossley.
    ///
    /// The tangent of the exact factor at e = 1, and the first law whose damping vanishes with the penetration: asked for
    /// e = 0.8 it returns 0.833, for e = 0.5 it returns 0.663, and never less than 0.488.
    ///
    /// # Source
    /// K. H. Hunt and F. R. E. Crossley, *J. Appl. Mech.* **42**(2), 1975, 440–445,
    /// <https://doi.org/10.1115/1.3423596>.
    HuntCrossley, "χ = ³⁄₂ (1 − e)." = |e| 1.5 * (1.0 - e), least 0.0;

    /// Hysteretic damping of Lankarani and Nikravesh.
    ///
    /// Meant for nearly elastic impacts: asked for e = 0.8 it returns 0.847, for e = 0.5 it returns 0.725, whatever the mass and the elastic law, and never less
    /// than 0.663. In contacts that begin without an impact δ̇₀ is no more than the floor of the [`Law`](crate::Law).
    ///
    /// # Source
    /// H. M. Lankarani and P. E. Nikravesh, *J. Mech. Des.* **112**(3), 1990, 369–376,
    /// <https://doi.org/10.1115/1.2912617>.
    LankaraniNikravesh, "χ = ¾ (1 − e²), for nearly elastic impacts." = |e| 0.75 * (1.0 - e * e), least 0.0;

    /// Hysteretic damping of Lee and Wang.
    ///
    /// Half of [`HuntCrossley`]'s, and so half of what even a nearly elastic impact needs: asked for
    /// e = 0.8 it returns 0.909, for e = 0.5 it returns 0.799, and never less than 0.663.
    ///
    /// # Source
    /// T. W. Lee and A. C. Wang, *J. Mech. Transm. Autom. Des.* **105**(3), 1983, 534–540.
    LeeWang, "χ = ¾ (1 − e)." = |e| 0.75 * (1.0 - e), least 0.0;

    /// Hysteretic damping of Herbert and McWhannell.
    ///
    /// Good for nearly elastic impacts: asked for e = 0.8 it returns 0.807, for e = 0.5 it returns 0.594, and
    /// never less than 0.488.
    ///
    /// # Source
    /// R. G. Herbert and D. C. McWhannell, *J. Eng. Ind.* **99**(3), 1977, 513–518.
    HerbertMcwhannell, "χ = 6 (1 − e)/\\[(2e − 1)² + 3\\]." = |e| 6.0 * (1.0 - e) / ((2.0 * e - 1.0).powi(2) + 3.0), least 0.0;

    /// Hysteretic damping of Gonthier and others.
    ///
    /// The best of the explicit factors over the whole range, within 4.3 % for 0.1 ≤ e ≤ 1: asked for e = 0.8 it returns
    /// 0.768, for e = 0.5 it returns 0.488.
    ///
    /// # Source
    /// Y. Gonthier, J. McPhee, C. Lange and J.-C. Piedbœuf, *Multibody Syst. Dyn.* **11**, 2004, 209–233.
    Gonthier, "χ = (1 − e²)/e." = |e| (1.0 - e * e) / e, least 1e-6;

    /// Hysteretic damping of Zhiying and Qishao.
    ///
    /// [`LankaraniNikravesh`] with a correction for hard losses: asked for e = 0.8 it returns
    /// 0.787, for e = 0.5 it returns 0.483, and never less than 0.179.
    ///
    /// # Source
    /// Z. Qin and Q. Lu, *J. Dyn. Control* **4**(4), 2006, 294–298.
    ZhiyingQishao, "χ = ¾ (1 − e²) exp\\[2 (1 − e)\\]." = |e| 0.75 * (1.0 - e * e) * (2.0 * (1.0 - e)).exp(), least 0.0;

    /// Hysteretic damping of Flores, Machado, Silva and Martins.
    ///
    /// For soft and hard contacts: asked for e = 0.8 it returns 0.789, for e = 0.5 it returns 0.470, for
    /// e = 0.1 it returns 0.069.
    ///
    /// # Source
    /// P. Flores, M. Machado, M. T. Silva and J. M. Martins, *Multibody Syst. Dyn.* **25**, 2011, 357–375,
    /// <https://doi.org/10.1007/s11044-010-9237-4>.
    Flores, "χ = 8 (1 − e)/(5e)." = |e| 8.0 * (1.0 - e) / (5.0 * e), least 1e-6;

    /// Hysteretic damping of Hu and Guo.
    ///
    /// Right in both limits, and within 2.5 % for e ≥ 0.5: asked for e = 0.8 it returns 0.799, for e = 0.5 it returns
    /// 0.488, for e = 0.1 it returns 0.074.
    ///
    /// # Source
    /// S. Hu and X. Guo, *Multibody Syst. Dyn.* **35**, 2015, 131–151. The constant is the one that has the exact
    /// limit for e → 1; a program in circulation has half of it.
    HuGuo, "χ = 3 (1 − e)/(2e)." = |e| 1.5 * (1.0 - e) / e, least 1e-6;
}

/// Advice where the factor is infinite at zero. *Assumed*: a millionth of a speed is no rebound that anybody sees, and a contact with the
/// factor of less is stiffer than any step can follow.
fn remedy(least: f64) -> Option<&'static str> {
    (least > 0.0).then_some("at 0 the factor is infinite, take 0.02 for an almost plastic impact")
}

impl Dissipation {
    /// Damping factor χ \[–\] of a hysteretic member.
    pub fn factor(&self) -> Option<f64> {
        match self.action() {
            Action::Hysteretic { factor } => Some(factor),
            Action::None | Action::Viscous { .. } => None,
        }
    }

    /// At least one dissipation of every kind, for tests and benchmarks.
    pub fn specimens() -> Vec<Self> {
        let mut specimens = vec![
            Self::None,
            Self::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.3 }),
            Self::Viscous(Viscous { damping: 250.0 }),
        ];
        specimens.extend(Self::hysteretic(0.9));
        specimens
    }
}
