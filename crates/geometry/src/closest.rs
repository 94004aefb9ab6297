//! Places nearest to a point: every locally nearest place of a curve within reach.
//!
//! Walking along a curve, let f = (p − x) · t tell whether the point p lies ahead (f ≥ 0) or
//! behind (f < 0). The distance is locally smallest exactly where f turns from ahead to behind:
//!
//! ```text
//!    ahead │ behind         at a corner x:         f_in ≥ 0 and f_out < 0
//!  ────────┼────────▶       inside a piece:        f_start ≥ 0 and f_end < 0
//!          x                arc beyond half turn:  f_start ≥ 0 or  f_end < 0
//! ```
//!
//! Where two pieces meet tangentially both read the same point and the same tangent, so that the
//! test at the end of one and at the start of the next cannot disagree: such a joint yields
//! neither two hits nor none. No angle is computed until a place has been found.

use crate::piece::right_of;
use crate::{Piece, Point, Vector};

/// The place on a curve locally nearest to a point p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// The place x itself \[m\].
    pub point: Point,
    /// Unit vector n out of the material: the gradient of the distance, so that p = x + d n.
    pub normal: Vector,
    /// Signed distance d \[m\], positive in the void, negative inside the material.
    pub distance: f64,
    /// Signed curvature κ \[1/m\] of the curve at x: positive where the material is convex.
    /// Infinite at a vertex: +∞ at a convex corner or an open end, −∞ at a re-entrant corner.
    pub curvature: f64,
    /// Index of the piece x lies on; at a corner, of the piece that starts there.
    pub piece: usize,
    /// Fraction of the length of that piece, in [0, 1].
    pub parameter: f64,
}

impl Foot {
    /// How fast the normal turns when p moves along the tangent \[1/m\].
    ///
    /// ```text
    /// ∂n/∂p = c t tᵀ,   c = κ / (1 + κ d),   c = 1 / d at a vertex
    /// ```
    ///
    /// This is the whole second derivative of the distance.
    pub fn normal_rate(&self) -> f64 {
        if self.curvature.is_infinite() {
            1.0 / self.distance
        } else {
            self.curvature / (1.0 + self.curvature * self.distance)
        }
    }
}

/// Joint between two neighbouring pieces, or the end of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Joint {
    /// No change of direction.
    Tangent,
    /// A turn to the left: an edge of the material.
    Convex,
    /// A turn to the right: an inner corner.
    Reentrant,
    /// The end of an open curve.
    Free,
}

/// The point where two pieces meet and a direction of travel there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gate {
    pub(crate) point: Point,
    pub(crate) tangent: Vector,
}

impl Gate {
    /// Whether `p` lies ahead: f = (p − x) · t ≥ 0.
    fn is_ahead(&self, p: Point) -> bool {
        (p - self.point).dot(&self.tangent) >= 0.0
    }
}

/// A piece with what its neighbours say about its ends, ready to be asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    pub(crate) piece: Piece,
    /// The joint before the piece.
    pub(crate) joint: Joint,
    /// Direction of travel just before the joint.
    pub(crate) arriving: Vector,
    pub(crate) start: Gate,
    pub(crate) end: Gate,
    /// Whether the curve stops after this piece.
    pub(crate) last: bool,
}

/// Where on a piece the distance is locally smallest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PiecePart {
    Start,
    Inside,
    End,
}

impl Station {
    /// Calls `found` with every place of this piece locally nearest to `p` and its signed distance.
    ///
    /// The joint before the piece counts as its own, the one after it only at an open end.
    pub(crate) fn visit(&self, p: Point, mut found: impl FnMut(PiecePart, f64)) {
        let after_start = self.start.is_ahead(p);
        let after_end = self.end.is_ahead(p);
        if !after_start {
            let before = Gate {
                tangent: self.arriving,
                ..self.start
            };
            let distance = || (p - self.start.point).norm();
            match self.joint {
                Joint::Free => found(PiecePart::Start, distance()),
                Joint::Convex if before.is_ahead(p) => found(PiecePart::Start, distance()),
                Joint::Reentrant if before.is_ahead(p) => found(PiecePart::Start, -distance()),
                _ => {}
            }
        }
        match &self.piece {
            Piece::Segment(_) => {
                if after_start && !after_end {
                    let normal = right_of(self.start.tangent);
                    found(PiecePart::Inside, (p - self.start.point).dot(&normal));
                }
            }
            Piece::Arc(arc) => {
                let radial = (p - arc.centre).norm();
                let within = if arc.sweep.abs() <= std::f64::consts::PI {
                    after_start && !after_end
                } else {
                    after_start || !after_end
                };
                // d = ρ − r about convex material, r − ρ in a concave seat
                if within || is_centre(radial, arc.centre, arc.radius) {
                    found(
                        PiecePart::Inside,
                        (radial - arc.radius) * arc.sweep.signum(),
                    );
                }
            }
        }
        if self.last && after_end {
            found(PiecePart::End, (p - self.end.point).norm());
        }
    }

    /// The smallest distance of a place of this piece, if it has a locally nearest one.
    pub(crate) fn nearest(&self, p: Point) -> Option<(PiecePart, f64)> {
        let mut best: Option<(PiecePart, f64)> = None;
        self.visit(p, |place, distance| {
            if best.is_none_or(|(_, least)| distance.abs() < least.abs()) {
                best = Some((place, distance));
            }
        });
        best
    }

    /// Everything about a place found by [`visit`](Self::visit).
    pub(crate) fn foot(&self, index: usize, p: Point, place: PiecePart, distance: f64) -> Foot {
        let vertex = |point: Point, parameter: f64| Foot {
            point,
            normal: (p - point) / distance,
            distance,
            curvature: if distance < 0.0 {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            },
            piece: index,
            parameter,
        };
        let (normal, parameter) = match (place, &self.piece) {
            (PiecePart::Start, _) => return vertex(self.start.point, 0.0),
            (PiecePart::End, _) if distance > 0.0 => return vertex(self.end.point, 1.0),
            // The very end of the curve itself: no direction to the point, take the face's.
            (PiecePart::End, _) => (right_of(self.end.tangent), 1.0),
            (PiecePart::Inside, Piece::Segment(segment)) => {
                let along = (p - segment.start).dot(&self.start.tangent) / segment.length();
                (right_of(self.start.tangent), along.clamp(0.0, 1.0))
            }
            (PiecePart::Inside, Piece::Arc(arc)) => {
                let spoke = p - arc.centre;
                let radial = spoke.norm();
                let sign = arc.sweep.signum();
                if is_centre(radial, arc.centre, arc.radius) {
                    // Every point is equally near: take the middle.
                    (arc.spoke(0.5) * sign, 0.5)
                } else {
                    let parameter = arc.parameter(p).clamp(0.0, 1.0);
                    (spoke * (sign / radial), parameter)
                }
            }
        };
        Foot {
            point: p - normal * distance,
            normal,
            distance,
            curvature: self.piece.curvature(),
            piece: index,
            parameter,
        }
    }
}

/// Whether a point at this distance from the centre is the centre, as far as rounding can tell.
fn is_centre(radial: f64, centre: Point, radius: f64) -> bool {
    radial <= 4.0 * f64::EPSILON * (radius + centre.coords.amax())
}
