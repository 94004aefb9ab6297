//! Parts behind the teeth.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use chaindrive_mechanics::BeamEnds;
use chaindrive_quantities::Ratio;

/// Parts behind the surface of teeth that yield when a roller strikes: roller on bush, their walls, bending and shear of bush and pin, bush on
/// pin, and the rim of a sprocket that has a `rim`. Each follows from the dimensions of the chain; those that its model moves are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stack {
    /// How the outer plates hold the ends of the pins: between the two.
    pub(crate) pin_ends: Option<BeamEnds>,
    /// Force on the tooth, in breaking loads, at which contacts of roller, bush and pin become springs [–].
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub(crate) load: Option<Ratio>,
}
