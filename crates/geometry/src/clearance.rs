//! Clearance of two curves, or the depth of one in the other.

use crate::{ArcSpline, Piece, Point};

/// The place where a curve comes nearest to a solid, or lies deepest inside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Signed distance \[m\]: the gap where the curve stays clear, minus the depth where it does not.
    pub distance: f64,
    /// The place on the curve \[m\].
    pub point: Point,
    /// Index of the piece of the curve.
    pub piece: usize,
}

/// A stretch of a piece that may still hold the least distance.
struct Stretch {
    piece: usize,
    /// Fractions of the piece's length.
    from: f64,
    to: f64,
    /// No point of the stretch is nearer to the solid than this \[m\].
    bound: f64,
}

impl ArcSpline {
    /// Where `curve` comes nearest to this solid, to within `tolerance` \[m\]; none beyond `reach` \[m\].
    ///
    /// A distance changes by no more than the way travelled, |d(x) − d(y)| ≤ |x − y|, so a stretch of length ℓ about a
    /// point at distance d comes no nearer than d − ℓ/2. Stretches that could beat the best point so far are halved until
    /// none is left. Of two solids that overlap ask both about each other: the tip of one may lie in the other
    /// and the other way round.
    ///
    /// The solid should be closed. Behind an open curve distances are negative as well, as far as its normals reach.
    pub fn clearance(&self, curve: &Self, reach: f64, tolerance: f64) -> Option<Clearance> {
        let mut best: Option<Clearance> = None;
        let mut open: Vec<Stretch> = (0..curve.pieces().len())
            .map(|piece| Stretch {
                piece,
                from: 0.0,
                to: 1.0,
                bound: f64::NEG_INFINITY,
            })
            .collect();
        while let Some(stretch) = open.pop() {
            let least = best.map_or(reach, |best| best.distance);
            if stretch.bound > least - tolerance {
                continue;
            }
            let piece: &Piece = &curve.pieces()[stretch.piece];
            let middle = 0.5 * (stretch.from + stretch.to);
            let half = 0.5 * (stretch.to - stretch.from) * piece.length();
            let point = piece.point(middle);
            // Nothing beyond this could make the stretch interesting.
            let Some(foot) = self.nearest(point, f64::INFINITY) else {
                continue;
            };
            if foot.distance < least {
                best = Some(Clearance {
                    distance: foot.distance,
                    point,
                    piece: stretch.piece,
                });
            }
            let bound = foot.distance - half;
            for (from, to) in [(stretch.from, middle), (middle, stretch.to)] {
                open.push(Stretch {
                    from,
                    to,
                    bound,
                    ..stretch
                });
            }
        }
        best
    }
}
