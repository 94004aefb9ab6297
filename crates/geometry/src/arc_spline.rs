//! A chain of arcs and segments, open or closed.

use crate::closest::{Foot, Gate, Joint, Station};
use crate::parry::Tree;
use crate::{BoundingBox, GeometryError, Piece, Point, Vector};

/// Joints that turn by less than this \[rad\] count as tangent.
///
/// Generous against the rounding of imported coordinates, and far below any corner worth a
/// contact of its own.
const TANGENT: f64 = 1e-6;

/// Joints may gape by this fraction of the size of the curve.
pub(crate) const GAP: f64 = 1e-9;

/// A chain of arcs and segments with the material on the left of travel.
///
/// Distances, normals and curvatures are exact, without facets. An open curve is the face of
/// something larger, such as a guide rail: beyond its ends the distance is that from the end
/// point, positive on either side. A closed curve is the border of a solid.
///
/// Tangent joints (turning by less than 10⁻⁶ rad) are smooth for every query; the others are
/// corners.
#[derive(Clone, Debug)]
pub struct ArcSpline {
    pieces: Vec<Piece>,
    /// Arc length at the start of each piece, and at the end of the last \[m\].
    pub(crate) lengths: Vec<f64>,
    pub(crate) stations: Vec<Station>,
    pub(crate) tree: Tree,
    bounds: BoundingBox,
    closed: bool,
}

/// A joint where the curve changes direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Index of the piece that starts here.
    pub joint: usize,
    /// Where \[m\].
    pub point: Point,
    /// Change of direction \[rad\], in (−π, π], positive to the left: an edge of the material.
    pub turning: f64,
}

impl PartialEq for ArcSpline {
    fn eq(&self, other: &Self) -> bool {
        self.closed == other.closed && self.pieces == other.pieces
    }
}

impl ArcSpline {
    /// Curve with two ends.
    ///
    /// # Errors
    /// No pieces; numbers that are not finite or not allowed in a piece; a piece too short to have
    /// a direction; neighbours more than 10⁻⁹ of the curve's size apart.
    pub fn open(pieces: &[Piece]) -> Result<Self, GeometryError> {
        Self::new(pieces, false)
    }

    /// Border of a solid; must run counter-clockwise and must not cross itself.
    ///
    /// # Errors
    /// As [`open`](Self::open), also for the joint from the last piece to the first; and a signed
    /// area that is not positive. Crossings that leave the area positive are not detected.
    pub fn closed(pieces: &[Piece]) -> Result<Self, GeometryError> {
        let curve = Self::new(pieces, true)?;
        let area = curve.area();
        if area > 0.0 {
            Ok(curve)
        } else {
            Err(GeometryError::Clockwise { area })
        }
    }

    fn new(pieces: &[Piece], closed: bool) -> Result<Self, GeometryError> {
        for (piece, each) in pieces.iter().enumerate() {
            each.check().map_err(|source| GeometryError::Piece {
                piece,
                source: Box::new(source),
            })?;
        }
        let bounds = pieces
            .iter()
            .map(Piece::aabb)
            .reduce(|a, b| a.merged(&b))
            .ok_or(GeometryError::NoPieces)?;
        let allowed = GAP * bounds.diagonal();
        for (piece, each) in pieces.iter().enumerate() {
            let length = each.length();
            if length <= allowed {
                return Err(GeometryError::ShortPiece {
                    piece,
                    length,
                    least: allowed,
                });
            }
        }
        let first = usize::from(!closed);
        for joint in first..pieces.len() {
            let before = pieces[(joint + pieces.len() - 1) % pieces.len()];
            let gap = (pieces[joint].start() - before.end()).norm();
            if gap > allowed {
                return Err(GeometryError::OpenJoint {
                    joint,
                    gap,
                    allowed,
                });
            }
        }
        let lengths = std::iter::once(0.0)
            .chain(pieces.iter().scan(0.0, |sum, piece| {
                *sum += piece.length();
                Some(*sum)
            }))
            .collect();
        // A box must also hold the joints, which lie midway in the gaps allowed above.
        let boxes: Vec<_> = pieces.iter().map(Piece::aabb).collect();
        Ok(Self {
            lengths,
            stations: stations(pieces, closed),
            tree: Tree::new(&boxes, 2.0 * allowed),
            bounds,
            closed,
            pieces: pieces.to_vec(),
        })
    }

    /// The pieces in order of travel.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Whether the curve is the border of a solid.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Length along the curve \[m\].
    pub fn length(&self) -> f64 {
        self.lengths[self.pieces.len()]
    }

    /// The smallest box around the curve.
    pub fn aabb(&self) -> BoundingBox {
        self.bounds
    }

    /// The joints that are not tangent, in order of travel.
    pub fn corners(&self) -> Vec<Corner> {
        self.stations
            .iter()
            .enumerate()
            .filter(|(_, s)| matches!(s.joint, Joint::Convex | Joint::Reentrant))
            .map(|(joint, s)| Corner {
                joint,
                point: s.start.point,
                turning: turning(s.arriving, s.start.tangent),
            })
            .collect()
    }

    /// Point at an arc length from the start \[m\].
    ///
    /// A closed curve goes round and round; an open one stops at its ends.
    pub fn point_at(&self, arc_length: f64) -> Point {
        let s = if self.closed {
            arc_length.rem_euclid(self.length())
        } else {
            arc_length.clamp(0.0, self.length())
        };
        let index = self
            .lengths
            .partition_point(|&start| start <= s)
            .clamp(1, self.pieces.len())
            - 1;
        let piece = &self.pieces[index];
        piece.point((s - self.lengths[index]) / piece.length())
    }

    /// The place nearest to `p` among those at most `reach` away \[m\]; infinity for any distance.
    ///
    /// None when nothing is within reach, or when `p` is not finite.
    pub fn nearest(&self, p: Point, reach: f64) -> Option<Foot> {
        if !is_finite(p) {
            return None;
        }
        let (index, (place, distance)) = self
            .tree
            .best(p, reach, |i| self.stations[i].nearest(p))
            .filter(|(_, (_, distance))| distance.abs() <= reach)?;
        Some(self.stations[index].foot(index, p, place, distance))
    }

    /// Every place locally nearest to `p` and at most `reach` away \[m\], in order of travel.
    ///
    /// A roller in a tooth gap touches both flanks: each contact has its own foot. `found` is
    /// emptied first; a point that is not finite leaves it empty.
    pub fn local_minima(&self, p: Point, reach: f64, found: &mut Vec<Foot>) {
        found.clear();
        if !is_finite(p) {
            return;
        }
        self.tree.within(p, reach, |index| {
            let station = &self.stations[index];
            station.visit(p, |place, distance| {
                if distance.abs() <= reach {
                    found.push(station.foot(index, p, place, distance));
                }
            });
        });
        found.sort_by(|a, b| (a.piece.cmp(&b.piece)).then(a.parameter.total_cmp(&b.parameter)));
    }

    /// [`nearest`](Self::nearest) by asking every piece: slow, and what the tests compare with.
    pub fn nearest_by_exhaustion(&self, p: Point, reach: f64) -> Option<Foot> {
        let mut found = Vec::new();
        self.local_minima_by_exhaustion(p, reach, &mut found);
        found
            .into_iter()
            .min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()))
    }

    /// [`local_minima`](Self::local_minima) by asking every piece: slow, for tests.
    pub fn local_minima_by_exhaustion(&self, p: Point, reach: f64, found: &mut Vec<Foot>) {
        found.clear();
        if !is_finite(p) {
            return;
        }
        for (index, station) in self.stations.iter().enumerate() {
            station.visit(p, |place, distance| {
                if distance.abs() <= reach {
                    found.push(station.foot(index, p, place, distance));
                }
            });
        }
    }

    /// Whether `p` lies in the solid or on its border; never for an open curve.
    pub fn contains(&self, p: Point) -> bool {
        self.closed
            && self.bounds.contains(p)
            && self
                .nearest(p, f64::INFINITY)
                .is_some_and(|foot| foot.distance <= 0.0)
    }
}

/// Facts about its neighbours that each piece needs.
fn stations(pieces: &[Piece], closed: bool) -> Vec<Station> {
    let n = pieces.len();
    let joints: Vec<_> = (0..n)
        .map(|i| {
            let here = pieces[i];
            if i == 0 && !closed {
                let gate = Gate {
                    point: here.start(),
                    tangent: here.start_tangent(),
                };
                return (Joint::Free, gate, gate);
            }
            let before = pieces[(i + n - 1) % n];
            let point = nalgebra::center(&before.end(), &here.start());
            let (arriving, leaving) = (before.end_tangent(), here.start_tangent());
            let angle = turning(arriving, leaving);
            let gate = |tangent| Gate { point, tangent };
            if angle.abs() < TANGENT {
                let common = gate((arriving + leaving).normalize());
                (Joint::Tangent, common, common)
            } else if angle > 0.0 {
                (Joint::Convex, gate(arriving), gate(leaving))
            } else {
                (Joint::Reentrant, gate(arriving), gate(leaving))
            }
        })
        .collect();
    (0..n)
        .map(|i| {
            let (joint, arriving, start) = joints[i];
            let last = !closed && i + 1 == n;
            let end = if last {
                Gate {
                    point: pieces[i].end(),
                    tangent: pieces[i].end_tangent(),
                }
            } else {
                joints[(i + 1) % n].1
            };
            Station {
                piece: pieces[i],
                joint,
                arriving: arriving.tangent,
                start,
                end,
                last,
            }
        })
        .collect()
}

/// Angle from one direction to another \[rad\], in (−π, π].
fn turning(from: Vector, to: Vector) -> f64 {
    from.perp(&to).atan2(from.dot(&to))
}

fn is_finite(p: Point) -> bool {
    p.x.is_finite() && p.y.is_finite()
}
