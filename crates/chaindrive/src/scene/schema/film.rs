//! Oil between two surfaces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{Length, PressureCoefficient, Ratio, Time, Viscosity};

/// Film of oil that a roller squeezes out of its seat, a pin out of its bush. An impact begins where surfaces enter the film, and what it
/// leaves is a result: a restitution or damping beside it is refused.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Film {
    /// Thickness of the film that the surfaces meet when they come together [m]. It has been measured by nobody: vary it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) thickness: Length,
    /// Dynamic viscosity [Pa s]; absent: that of the `lubricant`.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) viscosity: Option<Viscosity>,
    /// Pressure coefficient of the viscosity [1/Pa], by Barus.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) pressure_coefficient: Option<PressureCoefficient>,
    /// Radius of the cylinder beside a plane that has the same gap [m]; absent: from roller and seat, pin and bush; on a guide, that of the
    /// roller.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) radius: Option<Length>,
    /// Half of the width on which there is oil [m]; absent: that of the hollow of the tooth gap; in a bore, of 120°; on a guide, half of the
    /// radius, of which a film needs a tenth.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) half_width: Option<Length>,
    /// Length along the axis [m]; absent: that of the roller, or of the joint.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Option<Length>,
    /// Share of the force that flow out of the ends leaves [–]; absent: it follows from the width that bears, and the length.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub(crate) leakage_factor: Option<Ratio>,
    /// Roughness, at which metal bears [m].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) roughness: Option<Length>,
    /// Time constant with which oil comes back between surfaces that have parted within the film [s]; 0: it follows at once.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) refill_time: Option<Time>,
}
