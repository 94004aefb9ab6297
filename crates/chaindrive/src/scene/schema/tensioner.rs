//! Tensioners: how they move and what pushes them.

use chaindrive_mechanics::{Carrier, Push};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Written;

/// A carrier with one degree of freedom that presses sprockets or guides on the chain.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tensioner {
    /// Name, unique among tensioners. Sprockets and guides refer to it by `support`.
    pub(crate) name: String,
    /// How it moves.
    pub(crate) carrier: Written<Carrier>,
    /// Its push.
    pub(crate) push: Written<Push>,
}
