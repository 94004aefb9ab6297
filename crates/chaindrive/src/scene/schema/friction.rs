//! How surfaces rub.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::quantity::{Damping, Force, PerLength, Ratio, Slowness, Speed, Stiffness};

/// The friction of a table without `kind`.
pub(crate) const PLAIN: &str = "coulomb";

/// A friction law. A table without `kind` is Coulomb's.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(extend("x-default-kind" = PLAIN))]
pub(crate) enum Friction {
    /// No friction.
    None,
    /// Coulomb friction, made smooth around standstill.
    Coulomb {
        /// Coefficient of friction [–].
        #[schemars(extend("minimum" = 0))]
        coefficient: Ratio,
        /// Speed of slip around which the friction changes sign [m/s]; absent: 0.05 m/s.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        slip_speed: Option<Speed>,
    },
    /// Coulomb friction that fades in between two speeds of slip, after Ambrósio.
    Ambrosio {
        /// Coefficient of friction [–].
        #[schemars(extend("minimum" = 0))]
        coefficient: Ratio,
        /// Speed of slip up to which there is no friction [m/s].
        #[schemars(extend("minimum" = 0))]
        lower_speed: Speed,
        /// Speed of slip from which the friction is whole [m/s].
        #[schemars(extend("exclusiveMinimum" = 0))]
        upper_speed: Speed,
    },
    /// Coulomb friction approached exponentially, after Threlfall.
    Threlfall {
        /// Coefficient of friction [–].
        #[schemars(extend("minimum" = 0))]
        coefficient: Ratio,
        /// Speed of slip at which the friction reaches 95 % [m/s]; absent: 0.05 m/s.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        slip_speed: Option<Speed>,
    },
    /// A parabola up to static friction and a decay to kinetic friction, after Bengisu and Akay.
    BengisuAkay {
        /// Coefficient of static friction [–].
        #[schemars(extend("minimum" = 0))]
        static_coefficient: Ratio,
        /// Coefficient of kinetic friction [–].
        #[schemars(extend("minimum" = 0))]
        coefficient: Ratio,
        /// Speed of slip of the greatest friction [m/s]; absent: 0.05 m/s.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        slip_speed: Option<Speed>,
        /// Decay from static to kinetic friction [s/m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        decay: Slowness,
    },
    /// Static, kinetic and viscous friction in one smooth curve, after Brown and McPhee.
    BrownMcphee {
        /// Coefficient of static friction [–].
        #[schemars(extend("minimum" = 0))]
        static_coefficient: Ratio,
        /// Coefficient of kinetic friction [–].
        #[schemars(extend("minimum" = 0))]
        coefficient: Ratio,
        /// Speed of slip of the greatest friction [m/s]; absent: 0.05 m/s.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        slip_speed: Option<Speed>,
        /// Viscous friction [N s/m]; absent: none.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        viscosity: Damping,
        /// Normal force at which viscous friction is whole [N]; absent: 1 N.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        transition_force: Option<Force>,
    },
    /// Bristles that bend, the LuGre model: friction that sticks, with a state.
    Lugre {
        /// Coefficient of static friction [–].
        #[schemars(extend("minimum" = 0))]
        static_coefficient: Ratio,
        /// Coefficient of kinetic friction [–].
        #[schemars(extend("exclusiveMinimum" = 0))]
        coefficient: Ratio,
        /// Stribeck speed [m/s]; absent: 0.05 m/s.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        slip_speed: Option<Speed>,
        /// Stiffness of the bristles per normal force [1/m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: PerLength,
        /// Damping of the bristles per normal force [s/m]; absent: none.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        damping: Slowness,
        /// Viscous friction per normal force [s/m]; absent: none.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        viscosity: Slowness,
    },
    /// A spring and a slider in series: Coulomb friction that holds elastically, sharp at any speed, with a state.
    SpringSlider {
        /// Coefficient of friction [–].
        #[schemars(extend("minimum" = 0))]
        coefficient: Ratio,
        /// Stiffness along the surface until it slides [N/m]; in joints of a chain whose links have a stiffness it may be
        /// absent: a tenth of a link's, seen from its ends, or where pins have play four fifths of a link's.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        stiffness: Option<Stiffness>,
    },
}
