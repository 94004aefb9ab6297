//! Laws of your own: friction, elastic laws and pushes that a program adds to the families, by name and revision.
//!
//! The program registers a struct, and scenes name it as the `kind` of a contact's `friction` or `law`, or of a tensioner's `push`. Reader, schema,
//! `describe` and messages treat it as one of ours. Names and revisions stand in the identity of the [`Build`](crate::Build): what was
//! begun with a law is not continued without it.
//!
//! ```
//! use chaindrive::Scene;
//! use chaindrive::laws::friction::{self, FrictionLaw};
//! use chaindrive::laws::quantities::{JsonSchema, Ratio, Speed};
//! use serde::{Deserialize, Serialize};
//!
//! /// Friction that reverses as an arc tangent: f = −(2/π) μ N atan(v/v_s).
//! #[derive(Debug, Serialize, Deserialize, JsonSchema)]
//! #[serde(deny_unknown_fields)]
//! struct ArcTangent {
//!     /// Coefficient of friction μ [–].
//!     #[schemars(with = "Ratio", extend("minimum" = 0))]
//!     coefficient: f64,
//!     /// Slip v_s [m/s] at which half of it is there.
//!     #[schemars(with = "Speed", extend("exclusiveMinimum" = 0))]
//!     half_speed: f64,
//! }
//!
//! impl FrictionLaw for ArcTangent {
//!     fn force(&self, normal: f64, slip: f64) -> f64 {
//!         -std::f64::consts::FRAC_2_PI * self.coefficient * normal * (slip / self.half_speed).atan()
//!     }
//!
//!     fn damping(&self, normal: f64, slip: f64) -> f64 {
//!         let share = slip / self.half_speed;
//!         std::f64::consts::FRAC_2_PI * self.coefficient * normal / (self.half_speed * (1.0 + share * share))
//!     }
//! }
//!
//! friction::register::<ArcTangent>("arc-tangent", 1)?;
//! let scene = Scene::preset("marine_engine_bare")?
//!     .replace("contact.teeth.friction", "{ kind = 'arc-tangent', coefficient = 0.1, half_speed = '1 cm/s' }")?;
//! assert!(scene.drive().is_ok());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use serde_json::Value;

pub use chaindrive_contact::{elastic, friction};
pub use chaindrive_mechanics::pushes;
pub use chaindrive_quantities as quantities;

/// Registered laws as `family:name=revision`. No law can be registered afterwards.
pub(crate) fn revisions() -> Vec<String> {
    let families = [
        ("elastic", elastic::library().revisions()),
        ("friction", friction::library().revisions()),
        ("push", pushes::library().revisions()),
    ];
    let of_family = |(family, laws): (&str, Vec<(&str, u32)>)| {
        let told = laws.into_iter();
        told.map(|(name, revision)| format!("{family}:{name}={revision}"))
            .collect::<Vec<_>>()
    };
    families.into_iter().flat_map(of_family).collect()
}

/// Adds the registered laws to the schema of scenes.
pub(crate) fn put_into(schema: &mut Value) {
    let definitions = &mut schema["$defs"];
    elastic::library().put_into(&mut definitions["Elastic"]);
    friction::library().put_into(&mut definitions["Friction"]);
    pushes::library().put_into(&mut definitions["Push"]);
}
