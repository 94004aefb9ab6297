//! Working face of a guide, as rows that each turn by no more than a quarter turn.
//!
//! The lines at which features begin have no end. On a face that turns by half a turn the first of them cuts the roller off
//! that leaves at the other end, and gives it to the wrong end:
//!
//! ```text
//!            ╭────────╮
//!          ╭╯          ╰╮                 cut into rows of a quarter turn, each with an edge
//!    end   │            │   start         at both ends, the face is the nearest of them
//!    ──── o ─────────────────── line
//!         a roller here has not passed it
//! ```
//!
//! The distance from a union is the least of the distances from its parts, and a cut adds points of the face only: so the cuts
//! are not felt. Distances are compared without their sign, since whoever stands before one side of a hairpin stands behind the
//! other.

use std::f64::consts::FRAC_PI_2;

use chaindrive_geometry::{Arc, Piece, Point, Vector};
use chaindrive_integrate::kernel;
use pulp::Simd;

use super::{Feature, Nearest, Probe, Profile};
use crate::lanes::{LANES, Lane, Wide, rarely};

/// Working face of a guide.
#[derive(Clone, Debug)]
pub(crate) struct RailFace {
    first: Profile,
    /// The other rows of a face that turns by more than a quarter turn.
    others: Box<[Profile]>,
}

/// Turning \[rad\] that rounding may add to a quarter turn.
const ROUNDING: f64 = 1e-9;

impl RailFace {
    /// The face of `pieces`, material on the left of travel, with an edge at either end.
    pub(crate) fn new(pieces: &[Piece]) -> Self {
        let mut rows = rows(pieces).into_iter();
        let row = |pieces: Vec<Piece>| Profile::new(&pieces, true, true);
        Self {
            first: row(rows.next().unwrap_or_default()),
            others: rows.map(row).collect(),
        }
    }

    /// Whether the gap of a roller in straight motion is convex in time.
    ///
    /// Of rows whose least counts that cannot be said: at the mouth between two ends the nearest of them changes.
    pub(crate) fn bulges(&self) -> bool {
        self.others.is_empty() && self.first.bulges
    }

    /// The surface that circles of some radius at (x, y) face.
    #[inline(always)]
    pub(crate) fn nearest<S: Simd>(&self, w: Wide<S>, at: [Lane<S>; 2], radius: f64) -> Nearest<S> {
        let nearest = self.first.nearest(w, at, radius);
        if self.others.is_empty() {
            return nearest;
        }
        rarely();
        let found = w.call(other_rows(
            &self.others,
            at.map(Lane::numbers),
            radius,
            nearest.lanes().map(Lane::numbers),
        ));
        Nearest::of(found.map(|numbers| w.load(&numbers, 0)))
    }

    /// The surface that a circle of radius `radius` at `q` faces: one lane of one.
    pub(crate) fn probe(&self, q: Point, radius: f64) -> Probe {
        let w = Wide(pulp::Scalar);
        let at = [w.splat(q.x), w.splat(q.y)];
        let Nearest { gap, nx, ny, bend } = self.nearest(w, at, radius);
        Probe::of([gap, nx, ny, bend, w.splat(f64::MAX)])
    }

    /// Number of rows, at least one.
    pub(crate) fn rows(&self) -> usize {
        1 + self.others.len()
    }

    /// One of them.
    #[inline(always)]
    pub(crate) fn row(&self, index: usize) -> &Profile {
        index
            .checked_sub(1)
            .map_or(&self.first, |other| &self.others[other])
    }

    /// The features that a straight line from `a` to `b` passes.
    pub(crate) fn features_along(&self, a: Point, b: Point) -> impl Iterator<Item = &Feature> {
        std::iter::once(&self.first)
            .chain(&self.others)
            .flat_map(move |row| &row.features[row.features_along(a, b)])
    }
}

kernel!(
    /// The nearest of the other rows, where they are nearer than the first.
    ///
    /// It is a call of its own, compiled for the kind of processor that asks, so that the inner loop stays short for guides of
    /// one row. Such a call takes numbers, not lanes.
    fn other_rows<'a, S: Simd>(
        w: Wide<S>,
        rows: &'a [Profile],
        at: [[f64; LANES]; 2],
        radius: f64,
        nearest: [[f64; LANES]; 4],
    ) -> [[f64; LANES]; 4] {
        let at = at.map(|numbers| w.load(&numbers, 0));
        let mut nearest = Nearest::of(nearest.map(|numbers| w.load(&numbers, 0)));
        let wide_radius = w.splat(radius);
        for row in rows {
            let other = row.nearest(w, at, radius);
            let distance = (nearest.gap + wide_radius).abs();
            let nearer = distance.greater((other.gap + wide_radius).abs());
            nearest = Nearest {
                gap: nearer.select(other.gap, nearest.gap),
                nx: nearer.select(other.nx, nearest.nx),
                ny: nearer.select(other.ny, nearest.ny),
                bend: nearer.select(other.bend, nearest.bend),
            };
        }
        nearest.lanes().map(Lane::numbers)
    }
);

impl<S: Simd> Nearest<S> {
    #[inline(always)]
    fn lanes(self) -> [Lane<S>; 4] {
        [self.gap, self.nx, self.ny, self.bend]
    }

    #[inline(always)]
    fn of([gap, nx, ny, bend]: [Lane<S>; 4]) -> Self {
        Self { gap, nx, ny, bend }
    }
}

/// Cuts pieces into rows whose headings stay within a quarter turn.
fn rows(pieces: &[Piece]) -> Vec<Vec<Piece>> {
    let mut rows: Vec<Vec<Piece>> = Vec::new();
    // Heading since the row began, and its least and largest.
    let mut heading = [0.0_f64; 3];
    let mut arriving: Option<Vector> = None;
    for piece in pieces.iter().flat_map(quarters) {
        let sweep = match piece {
            Piece::Segment(_) => 0.0,
            Piece::Arc(arc) => arc.sweep,
        };
        let along = piece.start_tangent();
        let joint = arriving.map_or(0.0, |before| before.perp(&along).atan2(before.dot(&along)));
        let mut next = heading;
        for turning in [joint, sweep] {
            next[0] += turning;
            next[1] = next[1].min(next[0]);
            next[2] = next[2].max(next[0]);
        }
        match rows.last_mut() {
            Some(row) if next[2] - next[1] <= FRAC_PI_2 + ROUNDING => {
                row.push(piece);
                heading = next;
            }
            _ => {
                rows.push(vec![piece]);
                heading = [sweep, sweep.min(0.0), sweep.max(0.0)];
            }
        }
        arriving = Some(piece.end_tangent());
    }
    rows
}

/// An arc of more than a quarter turn as equal ones that turn by less; anything else as it is.
fn quarters(piece: &Piece) -> Vec<Piece> {
    match piece {
        Piece::Arc(arc) if arc.sweep.abs() > FRAC_PI_2 + ROUNDING => {
            // A full turn at most: four.
            let count = (1..4_u32)
                .find(|&count| arc.sweep.abs() <= f64::from(count) * FRAC_PI_2 + ROUNDING)
                .unwrap_or(4);
            let sweep = arc.sweep / f64::from(count);
            let part = |k: u32| {
                Piece::Arc(Arc {
                    start_angle: arc.start_angle + f64::from(k) * sweep,
                    sweep,
                    ..*arc
                })
            };
            (0..count).map(part).collect()
        }
        _ => vec![*piece],
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use chaindrive_geometry::{ArcSpline, Segment, bar, rail};

    use super::*;

    const RADIUS: f64 = 0.01;

    /// Places beside a face and around its ends where its distance is not what the exact curve says, and all that were asked.
    fn wrong(face: &ArcSpline, depth: f64) -> [usize; 2] {
        let rows = RailFace::new(face.pieces());
        let [mut asked, mut wrong] = [0; 2];
        let mut ask = |q: Point| {
            let Some(exact) = face.nearest(q, 1.5 * RADIUS) else {
                return;
            };
            // Behind the face there is material, and no roller.
            if exact.distance < 0.0 {
                return;
            }
            asked += 1;
            let found = rows.probe(q, RADIUS);
            let apart = (found.gap - (exact.distance - RADIUS)).abs();
            let turned = (found.normal - exact.normal).norm();
            wrong += usize::from(apart > 1e-12 || turned > 1e-9);
        };
        for piece in face.pieces() {
            for k in 0..=100 {
                let s = f64::from(k) / 100.0;
                ask(piece.point(s) + piece.normal(s) * (RADIUS - depth));
            }
        }
        for end in [0.0, face.length()] {
            for k in 0..360 {
                let angle = (f64::from(k) + 0.5).to_radians();
                let around = Vector::new(angle.cos(), angle.sin());
                ask(face.point_at(end) + around * (RADIUS - depth));
            }
        }
        [wrong, asked]
    }

    /// Rollers find arcs of any sweep, bars whose ends are bent round, and hairpins where the exact curve has them, over the face and
    /// around the edges at its ends (theory).
    #[test]
    fn faces_that_turn_by_any_angle_are_found() {
        let arc = |sweep: f64| {
            let piece = Piece::Arc(Arc {
                centre: Point::new(0.3, -0.2),
                radius: 0.1,
                start_angle: 0.4,
                sweep,
            });
            ArcSpline::open(&[piece]).expect("an arc")
        };
        let degrees = [
            4.0, 89.0, 90.0, 91.0, 150.0, 179.5, 180.0, 181.0, 270.0, 345.0,
        ];
        let mut faces: Vec<ArcSpline> = degrees.iter().map(|d: &f64| arc(d.to_radians())).collect();
        // A ring that is open to the inside, as wide as ten rollers.
        faces.push(arc(-0.9 * TAU));
        for angle in [30.0_f64, 90.0, 120.0, 170.0] {
            let ends = [0.0, 0.5].map(|x| Point::new(x, 0.0));
            faces.push(bar(ends[1], ends[0], 0.06, angle.to_radians()).expect("a bar"));
        }
        let points =
            [[0.0, 0.0], [0.5, 0.0], [0.5, 0.2], [0.0, 0.2]].map(|[x, y]| Point::new(x, y));
        faces.push(rail(&points, &[0.1, 0.1]).expect("a hairpin"));
        faces.push(rail(&points, &[0.0, 0.0]).expect("a hairpin with edges"));
        for (which, face) in faces.iter().enumerate() {
            for depth in [-1e-3, 0.0, 1e-6, 1e-3] {
                let [wrong, asked] = wrong(face, depth);
                assert!(asked > 300, "{asked} places asked");
                assert_eq!(
                    wrong, 0,
                    "of {asked} places of face {which}, {depth} m deep"
                );
            }
        }
    }

    /// What turns by a quarter turn or less stays one row, so that ordinary guides cost what they did.
    #[test]
    fn faces_of_a_quarter_turn_stay_whole() {
        let ends = [1.0, 0.0].map(|x| Point::new(x, 0.0));
        let face = bar(ends[0], ends[1], 0.5, 0.25 * std::f64::consts::PI).expect("a bar");
        let rows = RailFace::new(face.pieces());
        assert!(rows.others.is_empty() && rows.bulges());
        let line = [Piece::Segment(Segment::new(ends[0], ends[1]))];
        assert!(RailFace::new(&line).bulges());
        let round = bar(ends[0], ends[1], 0.5, 3.0).expect("a bar");
        let round = RailFace::new(round.pieces());
        assert!(round.others.len() > 1 && !round.bulges());
    }
}
