//! The ends of a strand.

use chaindrive_geometry::Point;

use super::chain::{Chain, End, Ends};

/// An end roller whose motion or load is given.
#[derive(Clone, Debug)]
pub(crate) struct HeldEnd {
    pub(crate) roller: usize,
    pub(crate) end: End,
    /// Position as laid.
    pub(crate) place: Point,
}

/// The ends of a strand, and where they were laid.
pub(super) fn held_ends(chain: &Chain, places: &[Point]) -> Vec<HeldEnd> {
    match &chain.ends {
        Ends::Closed => Vec::new(),
        Ends::Open(ends) => [0, chain.rollers() - 1]
            .into_iter()
            .zip(ends)
            .map(|(roller, end)| HeldEnd {
                roller,
                end: end.clone(),
                place: places[roller],
            })
            .collect(),
    }
}
