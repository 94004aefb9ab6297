//! Spring and damper behind a tensioner.

use chaindrive_quantities::{
    AngularDamping, AngularStiffness, Damping, Force, JsonSchema, Stiffness, Torque,
};
use serde::{Deserialize, Serialize};

use super::{PushForce, PushLaw};

macro_rules! springs {
    ($($(#[$doc:meta])* $name:ident in $unit:literal: $preload:literal $force:tt, $rate:literal $stiffness:tt, $loss:literal $damping:tt;)*) => {$(
        $(#[$doc])*
        ///
        /// ```text
        /// F = F₀ − k x − c ẋ
        /// ```
        ///
        /// x is the extension since assembly: the push weakens as the tensioner moves outward.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        #[schemars(inline)]
        pub struct $name {
            #[doc = $preload]
            #[schemars(with = $force)]
            pub preload: f64,
            #[doc = $rate]
            #[serde(default)]
            #[schemars(with = $stiffness, extend("minimum" = 0))]
            pub stiffness: f64,
            #[doc = $loss]
            #[serde(default)]
            #[schemars(with = $damping, extend("minimum" = 0))]
            pub damping: f64,
        }

        impl PushLaw for $name {
            fn unit(&self) -> &'static str {
                $unit
            }

            fn force(&self, x: f64, rate: f64, _: f64) -> PushForce {
                // F = F₀ − k x − c ẋ
                PushForce {
                    elastic: self.preload - self.stiffness * x,
                    damping: -self.damping * rate,
                    ..PushForce::default()
                }
            }

            fn energy(&self, x: f64, _: f64) -> f64 {
                // U = ½ k x² − F₀ x
                (0.5 * self.stiffness * x - self.preload) * x
            }

            fn stiffness(&self, _: f64) -> f64 {
                self.stiffness
            }

            fn damping(&self) -> f64 {
                self.damping
            }
        }
    )*};
}

springs! {
    /// A spring with a damper, on a slider or a plunger.
    Spring in "N":
        "Push in the assembled position F₀ \\[N\\]." "Force",
        "Spring rate k \\[N/m\\]; 0 is a constant push." "Stiffness",
        "Damping c \\[N s/m\\]." "Damping";

    /// A torsion spring with a damper, on an arm without a plunger.
    TorsionSpring in "N m":
        "Torque in the assembled position F₀ \\[N m\\], counter-clockwise positive." "Torque",
        "Spring rate k \\[N m/rad\\]; 0 is a constant torque." "AngularStiffness",
        "Damping c \\[N m s\\]." "AngularDamping";
}
