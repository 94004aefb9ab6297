//! Tensioners: how they move and what pushes them.

use chaindrive_mechanics::{Carrier, Push};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Force, Written};
use chaindrive_quantities::Length;

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
    /// Forces on the carrier along x, beside its push: the part along its way or about its pivot acts, and its guide or pivot bears the rest. Those
    /// on the sprockets that it carries are theirs.
    #[serde(default)]
    pub(crate) force_x: Vec<Force>,
    /// Forces on the carrier along y.
    #[serde(default)]
    pub(crate) force_y: Vec<Force>,
    /// Point (x, y) of an arm on which they act, as it is described [m]; a slider needs none, since all of it moves alike.
    pub(crate) force_at: Option<[Length; 2]>,
}
