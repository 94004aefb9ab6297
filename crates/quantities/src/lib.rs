//! Quantities with units, and the ranges that parameters may have.
//!
//! A parameter of a law, a motion or a tensioner is written once: as the field of the struct that computes with it. What the field cannot say
//! stands in an attribute above it: its [quantity](self), and its range in the words of JSON Schema. From there
//! the format of scenes, its reader, the reference page and [`check`] take them.
//!
//! ```
//! use chaindrive_quantities::{JsonSchema, check};
//! use serde::Serialize;
//!
//! #[derive(Serialize, JsonSchema)]
//! struct Spring {
//!     /// Rate k.
//!     #[schemars(with = "chaindrive_quantities::Stiffness", extend("exclusiveMinimum" = 0))]
//!     stiffness: f64,
//! }
//!
//! assert!(check(&Spring { stiffness: 2e5 }).is_ok());
//! let refused = check(&Spring { stiffness: -1.0 }).unwrap_err();
//! assert_eq!(refused.to_string(), "stiffness = -1, must be positive [N/m]");
//! ```

mod library;
mod quantity;
mod range;
mod reading;
mod unit;

pub use library::{Handle, Library, RegistrationError};
pub use quantity::*;
pub use range::{ParameterError, Range, check};
pub use reading::{
    CONTACT_STIFFNESS, Complaint, UnitInSi, is_number, read_length, read_time, read_unit,
};
pub use schemars::JsonSchema;

/// Hash of the sources of this crate, a part of the identity of a build.
#[doc(hidden)]
pub const SOURCES: &str = env!("CHAINDRIVE_SOURCES");
