//! The family of dissipations: what the closing speed makes of an elastic force.
//!
//! To add a member write one file with its parameters, its constants and its range, and enter it
//! in the places of this file: `mod`, the variant, the arm of `hysteretic!` or those of
//! [`action`](Dissipation::action) and [`check`](Dissipation::check), and
//! [`specimens`](Dissipation::specimens). A hysteretic member is complete with its factor χ: the force
//! is [`Action`]'s.
//!
//! | dissipation | `kind` | factor χ | delivers, asked for 0.5 |
//! |---|---|---|---|
//! | none | `none` | | 1 |
//! | [`Exact`] | `exact` | χ (1 + e) = ln\[(1 + χ)/(1 − χe)\] | 0.500 |
//! | [`HuntCrossley`] | `hunt-crossley` | ³⁄₂ (1 − e) | 0.663 |
//! | [`LankaraniNikravesh`] | `lankarani-nikravesh` | ¾ (1 − e²) | 0.725 |
//! | [`LeeWang`] | `lee-wang` | ¾ (1 − e) | 0.799 |
//! | [`HerbertMcWhannell`] | `herbert-mcwhannell` | 6 (1 − e)/\[(2e − 1)² + 3\] | 0.594 |
//! | [`Gonthier`] | `gonthier` | (1 − e²)/e | 0.488 |
//! | [`ZhiyingQishao`] | `zhiying-qishao` | ¾ (1 − e²) exp\[2 (1 − e)\] | 0.483 |
//! | [`Flores`] | `flores` | 8 (1 − e)/(5e) | 0.470 |
//! | [`HuGuo`] | `hu-guo` | 3 (1 − e)/(2e) | 0.488 |
//! | [`Viscous`]: Kelvin–Voigt | `viscous` | a dashpot c beside the spring | depends on mass and speed |

mod action;
mod exact;
mod flores;
mod gonthier;
mod herbert_mcwhannell;
mod hu_guo;
mod hunt_crossley;
mod lankarani_nikravesh;
mod lee_wang;
mod viscous;
mod zhiying_qishao;

pub use action::{Action, RATIO_LIMIT};
pub use exact::Exact;
pub use flores::Flores;
pub use gonthier::Gonthier;
pub use herbert_mcwhannell::HerbertMcWhannell;
pub use hu_guo::HuGuo;
pub use hunt_crossley::HuntCrossley;
pub use lankarani_nikravesh::LankaraniNikravesh;
pub use lee_wang::LeeWang;
pub use viscous::Viscous;
pub use zhiying_qishao::ZhiyingQishao;

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::no_parameters;

/// Closing speed \[m/s\] up to which a restitution that does not depend on the speed is reckoned with.
///
/// *Assumed*: steel that strikes steel begins to yield at some tenths of a metre a second, and its restitution then falls by the fourth
/// root of the speed (K. L. Johnson, *Contact Mechanics*, 1985, § 11.5); over a decade that is a factor of two, which no single number
/// stands for.
pub const FASTEST_IMPACT: f64 = 3.0;

/// Least restitution where the factor is infinite at zero. *Assumed*: a millionth of a speed is no rebound that anybody sees, and a contact with the
/// factor of less is stiffer than any step can follow.
const LEAST: f64 = 1e-6;
const POSITIVE: &str =
    "in [1e-6, 1]: at 0 the factor is infinite, take 0.02 for an almost plastic impact";

/// A dissipation, chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Dissipation {
    /// No loss: the contact returns what it stored.
    #[serde(deserialize_with = "no_parameters")]
    None,
    /// Hysteretic, with the factor that delivers what it is asked for.
    Exact(Exact),
    /// Hysteretic, χ = ³⁄₂ (1 − e).
    HuntCrossley(HuntCrossley),
    /// Hysteretic, χ = ¾ (1 − e²), for nearly elastic impacts.
    LankaraniNikravesh(LankaraniNikravesh),
    /// Hysteretic, χ = ¾ (1 − e).
    LeeWang(LeeWang),
    /// Hysteretic, χ = 6 (1 − e)/\[(2e − 1)² + 3\].
    #[serde(rename = "herbert-mcwhannell")]
    HerbertMcWhannell(HerbertMcWhannell),
    /// Hysteretic, χ = (1 − e²)/e.
    Gonthier(Gonthier),
    /// Hysteretic, χ = ¾ (1 − e²) exp\[2 (1 − e)\].
    ZhiyingQishao(ZhiyingQishao),
    /// Hysteretic, χ = 8 (1 − e)/(5e).
    Flores(Flores),
    /// Hysteretic, χ = 3 (1 − e)/(2e).
    HuGuo(HuGuo),
    /// A dashpot beside the elastic law: Kelvin–Voigt.
    Viscous(Viscous),
}

/// Runs an expression on the hysteretic member behind the enum, or another on the rest.
macro_rules! hysteretic {
    ($dissipation:expr, $member:ident => $answer:expr, $($other:tt)+) => {
        match $dissipation {
            Self::Exact($member) => $answer,
            Self::HuntCrossley($member) => $answer,
            Self::LankaraniNikravesh($member) => $answer,
            Self::LeeWang($member) => $answer,
            Self::HerbertMcWhannell($member) => $answer,
            Self::Gonthier($member) => $answer,
            Self::ZhiyingQishao($member) => $answer,
            Self::Flores($member) => $answer,
            Self::HuGuo($member) => $answer,
            $($other)+
        }
    };
}

impl Dissipation {
    /// The dissipation with its constants worked out; ask once, outside a loop.
    #[inline]
    pub fn action(&self) -> Action {
        hysteretic!(self, member => Action::Hysteretic { factor: member.factor() },
            Self::None => Action::None,
            Self::Viscous(member) => Action::Viscous { damping: member.damping },
        )
    }

    /// Damping factor χ \[–\] of a hysteretic member.
    pub fn factor(&self) -> Option<f64> {
        match self.action() {
            Action::Hysteretic { factor } => Some(factor),
            Action::None | Action::Viscous { .. } => None,
        }
    }

    /// Coefficient of restitution \[–\] a hysteretic member is asked for.
    pub fn restitution(&self) -> Option<f64> {
        hysteretic!(self, member => Some(member.restitution),
            Self::None | Self::Viscous(_) => None,
        )
    }

    /// Refuses parameters outside the range of the member.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        hysteretic!(self, member => member.check(),
            Self::None => Ok(()),
            Self::Viscous(member) => member.check(),
        )
    }

    /// Every hysteretic member, asked for one coefficient of restitution \[–\].
    pub fn hysteretic(restitution: f64) -> [Self; 9] {
        [
            Self::Exact(Exact { restitution }),
            Self::HuntCrossley(HuntCrossley { restitution }),
            Self::LankaraniNikravesh(LankaraniNikravesh { restitution }),
            Self::LeeWang(LeeWang { restitution }),
            Self::HerbertMcWhannell(HerbertMcWhannell { restitution }),
            Self::Gonthier(Gonthier { restitution }),
            Self::ZhiyingQishao(ZhiyingQishao { restitution }),
            Self::Flores(Flores { restitution }),
            Self::HuGuo(HuGuo { restitution }),
        ]
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
