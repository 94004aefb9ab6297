//! The family of dissipations: what the closing speed makes of an elastic force.
//!
//! | dissipation | `kind` | factor χ | delivers, asked for 0.5 |
//! |---|---|---|---|
//! | none | `none` | | 1 |
//! | [`Exact`] | `exact` | χ (1 + e) = ln\[(1 + χ)/(1 − χe)\] | 0.500 |
//! | [`HuntCrossley`] | `hunt-crossley` | ³⁄₂ (1 − e) | 0.663 |
//! | [`LankaraniNikravesh`] | `lankarani-nikravesh` | ¾ (1 − e²) | 0.725 |
//! | [`LeeWang`] | `lee-wang` | ¾ (1 − e) | 0.799 |
//! | [`HerbertMcwhannell`] | `herbert-mcwhannell` | 6 (1 − e)/\[(2e − 1)² + 3\] | 0.594 |
//! | [`Gonthier`] | `gonthier` | (1 − e²)/e | 0.488 |
//! | [`ZhiyingQishao`] | `zhiying-qishao` | ¾ (1 − e²) exp\[2 (1 − e)\] | 0.483 |
//! | [`Flores`] | `flores` | 8 (1 − e)/(5e) | 0.470 |
//! | [`HuGuo`] | `hu-guo` | 3 (1 − e)/(2e) | 0.488 |
//! | [`Viscous`]: Kelvin–Voigt | `viscous` | a dashpot c beside the spring | depends on mass and speed |

mod action;
mod hysteretic;
mod viscous;

pub use action::{Action, RATIO_LIMIT};
pub use hysteretic::{
    Dissipation, Exact, Flores, Gonthier, HerbertMcwhannell, HuGuo, HuntCrossley, Hysteresis,
    LankaraniNikravesh, LeeWang, ZhiyingQishao,
};
pub use viscous::Viscous;

/// Closing speed \[m/s\] up to which a restitution that does not depend on the speed is reckoned with.
///
/// *Assumed*: steel that strikes steel begins to yield at some tenths of a metre a second, and its restitution then falls by the fourth
/// root of the speed (K. L. Johnson, *Contact Mechanics*, 1985, § 11.5); over a decade that is a factor of two, which no single number
/// stands for.
pub const FASTEST_IMPACT: f64 = 3.0;
