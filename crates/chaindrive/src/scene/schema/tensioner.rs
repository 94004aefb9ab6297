//! Tensioners: how they move and what pushes them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_quantities::{
    AngularDamping, AngularStiffness, Damping, Force, Inertia, Length, Mass, Pressure, Ratio,
    Stiffness, Torque, Viscosity, Volume,
};

/// A carrier with one degree of freedom that presses sprockets or guides on the chain.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tensioner {
    /// Name, unique among tensioners. Sprockets and guides refer to it by `support`.
    pub(crate) name: String,
    /// How it moves.
    pub(crate) carrier: Carrier,
    /// Its push.
    pub(crate) push: Push,
}

/// How a tensioner moves.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Carrier {
    /// A straight slide.
    Slider {
        /// Direction in which it is pushed (x, y), of any length.
        direction: [Ratio; 2],
        /// Mass of the slider without the sprockets it carries [kg]; needed unless locked.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        mass: Option<Mass>,
    },
    /// An arm about a pivot.
    Arm {
        /// Pivot (x, y) [m].
        pivot: [Length; 2],
        /// Moment of inertia about the pivot without the sprockets it carries [kg m²]; needed
        /// unless locked.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0))]
        inertia: Option<Inertia>,
        /// Where a plunger pushes; without one the push is a torsion spring.
        #[serde(default)]
        plunger: Option<Plunger>,
    },
}

impl Carrier {
    /// Whether its coordinate is an angle.
    pub(crate) fn turns(&self) -> bool {
        match self {
            Self::Slider { .. } => false,
            Self::Arm { .. } => true,
        }
    }
}

/// A plunger on an arm.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plunger {
    /// Point of the arm on which it pushes (x, y) [m].
    pub(crate) at: [Length; 2],
    /// Direction of the push (x, y), of any length.
    pub(crate) direction: [Ratio; 2],
}

/// Push of a tensioner.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Push {
    /// Nothing: the carrier stays where it was assembled.
    Locked,
    /// A spring with a damper, on a slider or a plunger.
    Spring {
        /// Push in the assembled position [N].
        preload: Force,
        /// Spring rate [N/m]; absent: 0, a constant push.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        stiffness: Stiffness,
        /// Damping [N s/m]; absent: 0.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        damping: Damping,
    },
    /// A torsion spring with a damper, on an arm without a plunger.
    TorsionSpring {
        /// Torque in the assembled position [N m], counter-clockwise positive.
        preload: Torque,
        /// Spring rate [N m/rad]; absent: 0.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        stiffness: AngularStiffness,
        /// Damping [N m s/rad]; absent: 0.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        damping: AngularDamping,
    },
    /// An oil-filled plunger that follows easily and yields only through a leak. Forces are given
    /// directly (`supply`, `relief`, `leak`), or follow from `oil`.
    Hydraulic {
        /// Push of the spring in the assembled position [N].
        preload: Force,
        /// Spring rate [N/m]; absent: 0.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        stiffness: Stiffness,
        /// Damping while it extends [N s/m]; absent: 0.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        extending: Damping,
        /// Damping by the relief valve while it is open [N s/m]; absent: 0, it holds its pressure.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        relieving: Damping,
        /// Push of the supply pressure [N]; instead of `oil`.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        supply: Option<Force>,
        /// Push at which the relief valve opens [N]; instead of `oil`.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        relief: Option<Force>,
        /// Damping by the leak while it is compressed [N s/m]; instead of `oil`.
        #[serde(default)]
        #[schemars(extend("minimum" = 0))]
        leak: Option<Damping>,
        /// Plunger and oil, from which supply, relief and leak are computed.
        #[serde(default)]
        oil: Option<Oil>,
    },
}

/// A plunger that leaks through an annular gap.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Oil {
    /// Plunger diameter [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) diameter: Length,
    /// Length of the gap [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) length: Length,
    /// Radial width of the gap [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) gap: Length,
    /// Dynamic viscosity of the oil [Pa s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) viscosity: Viscosity,
    /// Supply pressure [Pa]; absent: 0.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub(crate) supply: Pressure,
    /// Pressure at which the relief valve opens [Pa].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) relief: Pressure,
    /// Bulk modulus of the oil without air [Pa]: with it the oil can be compressed and has a pressure of its own, and
    /// `volume`, `air`, `extending` and `relieving` are needed; absent: the oil is stiff.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) bulk_modulus: Option<Pressure>,
    /// Volume of the chamber in the assembled position [m³].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) volume: Option<Volume>,
    /// Share of free air in the oil, under the pressure around the drive [–].
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 0.5))]
    pub(crate) air: Option<Ratio>,
}
