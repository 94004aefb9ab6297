//! The conditions under which a chain was laid.

use chaindrive_geometry::{Point, Vector};

/// The layout that a chain model starts from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainAsLaid<'a> {
    pub(crate) chain: &'a crate::Chain,
    /// Tension that it was laid with \[N\].
    pub(crate) pretension: f64,
    /// Whether it runs around sprockets.
    pub(crate) on_route: bool,
    /// Sprockets that it can touch.
    pub(crate) sprockets: &'a [usize],
    pub(crate) gravity: Vector,
}

/// Length of a chain of so many links through its joints \[m\]; a closed one has as many joints as links.
pub(crate) fn length_through(joints: &[Point], links: usize) -> f64 {
    let ends = |link: usize| [joints[link], joints[(link + 1) % joints.len()]];
    let lengths = (0..links).map(|link| {
        let [a, b] = ends(link);
        (b - a).norm()
    });
    lengths.sum()
}
