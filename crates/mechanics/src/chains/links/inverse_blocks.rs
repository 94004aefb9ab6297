//! Inverses of the blocks of links: how each gives way under a load, by lanes.

use chaindrive_integrate::{Array, kernel};
use nalgebra::Matrix3;
use pulp::Simd;

use super::Linkage;
use super::by_link::{ByLink, load};
use crate::lanes::{Lane, Wide};

/// Entries (0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2) of the inverse of every block, as [`ByLink`] has its numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct InverseBlocks {
    entries: [Array; 6],
}

impl InverseBlocks {
    /// Inverts the blocks of the links; false if one is singular.
    pub(super) fn invert(&mut self, linkage: &Linkage, blocks: &[Matrix3<f64>]) -> bool {
        for values in &mut self.entries {
            values.resize(linkage.shapes.lanes(), 0.0);
        }
        let places = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];
        for (entries, place) in self.entries.iter_mut().zip(places) {
            for (entry, block) in entries[1..].iter_mut().zip(blocks) {
                *entry = block[place];
            }
        }
        let registers = linkage.series.registers;
        let sound = registers.dispatch(inverted(&mut self.entries, linkage));
        for values in &mut self.entries {
            values[0] = if linkage.series.is_closed() {
                values[linkage.series.links]
            } else {
                0.0
            };
            let first = if linkage.series.is_closed() {
                values[1]
            } else {
                0.0
            };
            values[linkage.series.links + 1..].fill(0.0);
            values[linkage.series.links + 1] = first;
        }
        sound
    }

    /// Entries of the links from a place on.
    #[inline(always)]
    pub(super) fn at<S: Simd>(&self, w: Wide<S>, place: usize) -> [Lane<S>; 6] {
        load_all(w, &self.entries, place)
    }

    /// r ← A⁻¹ r of the links.
    #[inline(always)]
    pub(super) fn yield_to<S: Simd>(&self, w: Wide<S>, linkage: &Linkage, r: &mut ByLink) {
        for link in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            let [x, y, turn] = self.yielding(w, link, load(w, r, link + 1));
            x.store(&mut r.x, link + 1);
            y.store(&mut r.y, link + 1);
            turn.store(&mut r.turn, link + 1);
        }
        r.close(linkage);
    }

    /// A⁻¹ of a load on the links from one on.
    #[inline(always)]
    pub(super) fn yielding<S: Simd>(
        &self,
        w: Wide<S>,
        link: usize,
        [x, y, turn]: [Lane<S>; 3],
    ) -> [Lane<S>; 3] {
        let [xx, yx, yy, tx, ty, tt] = self.at(w, link + 1);
        [
            xx * x + yx * y + tx * turn,
            yx * x + yy * y + ty * turn,
            tx * x + ty * y + tt * turn,
        ]
    }
}

kernel!(
    /// Inverses of the blocks, in their place; false if one is singular.
    fn inverted<'a, S: Simd>(
        w: Wide<S>,
        inverse: &'a mut [Array; 6],
        linkage: &'a Linkage,
    ) -> bool {
        let links = linkage.series.links;
        let one = w.splat(1.0);
        let mut least = one;
        for link in (0..links).step_by(Wide::<S>::COUNT) {
            // [a b c; b d e; c e f]
            let [a, b, d, c, e, f] = load_all(w, inverse, link + 1);
            // The adjoint of a symmetric block over its determinant
            let [xx, yx, tx] = [d * f - e * e, c * e - b * f, b * e - c * d];
            let determinant = a * xx + b * yx + c * tx;
            // Lanes beyond the last link have no block: one stands for their determinant.
            let within = w.first(links - link);
            least = least.min(within.select(determinant.abs(), one));
            let scale = within.select(determinant, one).recip();
            let found = [xx, yx, a * f - c * c, tx, b * c - a * e, a * d - b * b];
            for (found, inverse) in found.into_iter().zip(&mut *inverse) {
                (found * scale).store(inverse, link + 1);
            }
        }
        least.smallest() > 0.0
    }
);

#[inline(always)]
fn load_all<S: Simd>(w: Wide<S>, from: &[Array; 6], place: usize) -> [Lane<S>; 6] {
    let mut block = [w.splat(0.0); 6];
    for k in 0..6 {
        block[k] = w.load(&from[k], place);
    }
    block
}
