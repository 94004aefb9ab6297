//! A tree of boxes that finds the pieces worth asking.

use parry2d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry2d_f64::math::Vector;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

use super::to_parry;
use crate::closest::PiecePart;
use crate::{BoundingBox, Point};

/// Boxes around the pieces of a curve.
#[derive(Clone, Debug)]
pub(crate) struct Tree(Bvh);

impl Tree {
    /// Tree of boxes, each loosened by a margin \[m\].
    pub(crate) fn new(boxes: &[BoundingBox], margin: f64) -> Self {
        let leaves: Vec<_> = boxes
            .iter()
            .map(|b| Aabb::new(to_parry(b.min), to_parry(b.max)).loosened(margin))
            .collect();
        Self(Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves))
    }

    /// The piece with the smallest distance that `ask` reports, looking no farther than about
    /// `reach` \[m\].
    pub(crate) fn best(
        &self,
        p: Point,
        reach: f64,
        ask: impl Fn(usize) -> Option<(PiecePart, f64)>,
    ) -> Option<(usize, (PiecePart, f64))> {
        let p = to_parry(p);
        // Squares save the roots; the tree compares strictly, so let the limit itself pass.
        let limit = if reach >= 0.0 {
            (reach * reach * (1.0 + 1e-12)).next_up()
        } else {
            return None;
        };
        self.0
            .find_best(
                limit,
                |node, _| distance_squared(node, p),
                |i, _| ask(i as usize).map(|(place, d)| (d * d, (place, d))),
            )
            .map(|(i, (_, found))| (i as usize, found))
    }

    /// Calls `visit` with every pair of pieces, one of each curve, whose boxes overlap.
    pub(crate) fn pairs(&self, other: &Self, mut visit: impl FnMut(usize, usize)) {
        let pairs = self.0.leaf_pairs(&other.0, BvhNode::intersects);
        for (first, second) in pairs {
            visit(first as usize, second as usize);
        }
    }

    /// Calls `visit` with every piece whose box comes within `reach` \[m\] of `p`.
    pub(crate) fn within(&self, p: Point, reach: f64, mut visit: impl FnMut(usize)) {
        let p = to_parry(p);
        let limit = reach * reach;
        for i in self.0.leaves(|node| distance_squared(node, p) <= limit) {
            visit(i as usize);
        }
    }
}

/// Square of the distance from a point to a box, zero inside.
fn distance_squared(node: &BvhNode, p: Vector) -> f64 {
    let outside = (node.mins() - p).max(p - node.maxs()).max(Vector::ZERO);
    outside.length_squared()
}
