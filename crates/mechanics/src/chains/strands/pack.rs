//! The plates of all strands between two pins: load sharing.
//!
//! ```text
//! e_s = ℓ − p_s,   T_s = k_s (max(e_s, 0) + min(e_s + s, 0)),   s: play of the link
//! T = Σ T_s + d ℓ̇
//! ```

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Array;
use pulp::Simd;

use super::model::BushStrands;
use crate::chains::particles::{Links, Pulls};
use crate::lanes::{Lane, Wide};

/// One strand in flat arrays, whole lanes.
#[derive(Clone, Debug)]
struct Plates {
    /// Length without load beyond that of all strands together p_s − p \[m\].
    longer: Array,
    /// Stiffness k_s \[N/m\].
    stiffness: Array,
    /// Share of the damping of the link \[–\].
    share: f64,
}

/// The plates of all strands.
#[derive(Clone, Debug)]
pub(super) struct Pack {
    strands: Vec<Plates>,
    /// Shortening of a link at which its strand begins to push \[m\].
    play: Array,
}

/// Stretch of the plates, negative where they are compressed \[m\].
fn stretched(longer: f64, play: f64) -> f64 {
    longer.max(0.0) + (longer + play).min(0.0)
}

impl Pack {
    /// `links` are those of all strands together.
    pub(super) fn new(model: &BushStrands, links: &Links) -> Self {
        let each = |values: &Array, factor: f64| -> Array {
            values.iter().map(|value| value * factor).collect()
        };
        let strands = model.strands.iter().map(|strand| Plates {
            longer: each(&links.rest, strand.length - 1.0),
            stiffness: each(&links.stiffness, strand.stiffness),
            share: strand.stiffness,
        });
        let play = |link| {
            // A bush has 2 c on its pin, and an inner link two of them.
            let bushes = if model.is_inner(link) { 2.0 } else { 0.0 };
            2.0 * model.clearance * bushes
        };
        Self {
            strands: strands.collect(),
            play: (0..links.rest.len()).map(play).collect(),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.strands.len()
    }

    /// Tension of every strand of a link without damping \[N\], and its stiffness \[N/m\], zero where it hangs loose.
    fn shares(&self, link: usize, stretch: f64) -> impl Iterator<Item = [f64; 2]> {
        let play = self.play[link];
        self.strands.iter().map(move |plates| {
            let own = stretched(stretch - plates.longer[link], play);
            let bears = own != 0.0 || play <= 0.0;
            let stiffness = plates.stiffness[link];
            [stiffness * own, if bears { stiffness } else { 0.0 }]
        })
    }

    /// Tension T of a link at rest \[N\], and dT/dℓ \[N/m\].
    pub(super) fn answer(&self, links: &Links, link: usize, length: f64) -> [f64; 2] {
        let shares = self.shares(link, length - links.rest[link]);
        shares.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]])
    }

    /// Tension of a link between two pins with their velocities \[N\].
    pub(super) fn tension(&self, links: &Links, link: usize, pins: [(Point, Vector); 2]) -> f64 {
        self.tensions(links, link, pins).sum()
    }

    /// Tension of its strands, each with its share of the damping \[N\].
    pub(super) fn tensions(
        &self,
        links: &Links,
        link: usize,
        [start, end]: [(Point, Vector); 2],
    ) -> impl Iterator<Item = f64> {
        let (d, u) = (end.0 - start.0, end.1 - start.1);
        let length = d.norm();
        let drag = links.damping[link] * d.dot(&u) / length;
        let shares = self.shares(link, length - links.rest[link]);
        let strands = self.strands.iter().zip(shares);
        strands.map(move |(plates, [tension, _])| tension + plates.share * drag)
    }

    /// Elastic energy of a link of some length \[J\].
    pub(super) fn stored(&self, links: &Links, link: usize, length: f64) -> f64 {
        let stretch = length - links.rest[link];
        let strands = self.strands.iter().map(|plates| {
            let own = stretched(stretch - plates.longer[link], self.play[link]);
            // U = ½ k e²
            0.5 * plates.stiffness[link] * own * own
        });
        strands.sum()
    }
}

impl<S: Simd> Pulls<S> for Pack {
    #[inline(always)]
    fn tension(&self, w: Wide<S>, lane: usize, stretch: Lane<S>, drag: Lane<S>) -> Lane<S> {
        let zero = w.splat(0.0);
        let play = w.lanes(&self.play).get(lane);
        // Σ k_s e_s, rounded strand by strand: two equal ones are twice as much to the last bit.
        let mut elastic = zero;
        for plates in &self.strands {
            let (longer, stiffness) = (w.lanes(&plates.longer), w.lanes(&plates.stiffness));
            let own = stretch - longer.get(lane);
            let own = own.max(zero) + (own + play).min(zero);
            elastic += stiffness.get(lane) * own;
        }
        elastic + drag
    }
}
