//! The face of a tooth gap, cut into stretches with one contact each.
//!
//! A roller touches a gap where its distance from the surface, as a function of the place on the surface, is locally least.
//! How many such places there can be is a matter of the hollow parts:
//!
//! ```text
//!   a hollow wider than the roller          a hollow narrower than the roller, or an edge inward
//!
//!   tip ╮                    ╭ tip           tip ╮                    ╭ tip
//!        ╲        q         ╱                     ╲        q         ╱
//!         ╲       ↓        ╱                       ╲     ↙   ↘      ╱
//!          ╲ _____•______ ╱                         •              •
//!              M seat                                 ╲ ________ ╱
//!                                                       ╲      ╱
//!   one stretch, one contact: it wanders              ┄┄┄╲┄┄╱┄┄┄  tangents for the hollow
//!   over seat and flanks, across the axis               two stretches, two contacts
//! ```
//!
//! - Where every hollow is wider than the roller (R ≥ r) and no joint turns inward, the roller's centre can reach every point
//!   of the offset of the surface, and near it one place of the surface is nearest. The whole gap is one *stretch*. Its features
//!   are passed outward from the lowest point M of the bottom, to the right or to the left of the line upward through M, which
//!   is the normal there: no roller that touches has its centre on one side of the line and its foot on the other. The
//!   feature at M is the same for both ways, so nothing changes where a roller passes from one to the other, and a seat as wide as
//!   the roller (R = r) needs no exception: about its centre the depth and the force vanish.
//! - A narrow hollow (R < r) is never touched inside: the roller lies on its two ends. Tangents there continue the flanks
//!   beneath it. They meet in an edge inward, at which each of the two flanks bears the roller by itself, also when it is
//!   pressed so deep that its centre passes that of the hollow. Such edges cut the gap into stretches, and each
//!   stretch has a contact and a memory of its own.
//! - An edge inward that hardly turns divides nothing: feet that are closer than the indentation is wide are one contact,
//!   on the nearer of the two features.
//!
//! So every point of the surface belongs to one feature, every feature to one stretch, and a stretch is at most one contact.
//! The tip of a tooth belongs to the last stretch of one gap and the first of the next: a contact that is carried over it keeps
//! its memory (see `contact/faced_surface.rs`).

use chaindrive_geometry::{Piece, Point, Segment, Vector};

use super::{Profile, TANGENT};

/// The face of a tooth gap in the frame with the gap axis along +y, as stretches from the right tip to the left one.
#[derive(Clone, Debug)]
pub(crate) struct GapFace {
    pub(crate) stretches: Vec<Stretch>,
}

/// A part of the face on which a roller has at most one contact.
#[derive(Clone, Debug)]
pub(crate) struct Stretch {
    /// The features from the edge or the middle outward; of two ways the one to the right.
    pub(crate) profile: Profile,
    pub(crate) extent: Extent,
}

/// Ways to pass the features of a stretch.
#[derive(Clone, Debug)]
pub(crate) enum Extent {
    /// All of them one way.
    Outward,
    /// Both ways from the axis, which is one of symmetry.
    Folded,
    /// Both ways from a line along the axis that is not.
    Divided(Box<Divide>),
}

/// Part of a stretch that is passed to the left instead.
#[derive(Clone, Debug)]
pub(crate) struct Divide {
    pub(crate) left: Profile,
    /// To the left of this x \[m\].
    pub(crate) at: f64,
}

/// Edges inward that turn by more than this \[rad\] bear a roller on two sides.
const SEPARATE: f64 = 0.1;

/// Share of the roller's radius by which a seat may be narrower for want of digits.
const ROUNDING: f64 = 1e-9;

/// Tangents that would reach deeper than this many radii of the roller are joined by a floor.
const DEEPEST: f64 = 4.0;

impl GapFace {
    /// Cuts a gap, given from the right tip to the left one, into stretches.
    pub(crate) fn new(pieces: &[Piece], roller_radius: f64) -> Self {
        let (pieces, ends) = without_narrow_hollows(pieces, roller_radius);
        let cuts: Vec<usize> = (1..pieces.len())
            .filter(|&joint| turn(&pieces[joint - 1], &pieces[joint]) < -SEPARATE)
            .collect();
        let (Some(&first), Some(&last)) = (cuts.first(), cuts.last()) else {
            return Self {
                stretches: vec![whole(&pieces)],
            };
        };
        let outward = |mut profile: Profile, end: bool| {
            // After a tangent that stands for a hollow the flank begins.
            if end && profile.features.len() > 1 {
                profile.flank = Some(1);
            }
            Stretch {
                profile,
                extent: Extent::Outward,
            }
        };
        let mut stretches = vec![outward(to_the_right(&pieces[..first]), ends[first - 1])];
        for between in cuts.windows(2) {
            stretches.push(divided(&pieces[between[0]..between[1]]));
        }
        stretches.push(outward(to_the_left(&pieces[last..]), ends[last]));
        Self { stretches }
    }
}

/// A gap with one contact.
fn whole(pieces: &[Piece]) -> Stretch {
    let left = half(pieces);
    let mirrored = reversed(pieces);
    let right = half(&mirrored);
    let (left_profile, right_profile) = (to_the_left(&left), to_the_left(&right).mirrored());
    let bottom = pieces.len() - left.len();
    let edge = left.len() + right.len() == pieces.len()
        && bottom > 0
        && turn(&pieces[bottom - 1], &pieces[bottom]) > TANGENT;
    if !edge && alike(&left_profile, &right_profile) {
        return Stretch {
            profile: right_profile,
            extent: Extent::Folded,
        };
    }
    divided(pieces)
}

/// A stretch whose features are passed both ways from its lowest point.
fn divided(pieces: &[Piece]) -> Stretch {
    let mut lowest = (0, pieces[0].start());
    for (index, piece) in pieces.iter().enumerate() {
        let mut points = vec![piece.end()];
        if let Piece::Arc(arc) = piece {
            let beneath = arc.centre - Vector::y() * arc.radius;
            points.extend(arc.foot(beneath).map(|s| arc.point(s)));
        }
        for point in points {
            if point.y < lowest.1.y {
                lowest = (index, point);
            }
        }
    }
    let (middle, point) = lowest;
    // A stretch that rises all the way is passed from its lower end.
    let (first, last) = (pieces[0].start(), pieces[pieces.len() - 1].end());
    if point == first || point == last {
        return Stretch {
            profile: if point == first {
                to_the_left(pieces)
            } else {
                to_the_right(pieces)
            },
            extent: Extent::Outward,
        };
    }
    Stretch {
        profile: to_the_right(&pieces[..=middle]),
        extent: Extent::Divided(Box::new(Divide {
            left: to_the_left(&pieces[middle..]),
            at: point.x,
        })),
    }
}

fn to_the_left(pieces: &[Piece]) -> Profile {
    Profile::new(pieces, false, false)
}

fn to_the_right(pieces: &[Piece]) -> Profile {
    Profile::new(&reversed(pieces), false, false).mirrored()
}

/// The mirror image, travelled from its right to its left again.
fn reversed(pieces: &[Piece]) -> Vec<Piece> {
    let backward = pieces.iter().rev();
    backward
        .map(|piece| piece.mirrored_x().reversed())
        .collect()
}

/// The pieces from the bottom to the left tip; the piece across the axis comes first, whole.
fn half(pieces: &[Piece]) -> Vec<Piece> {
    let reaches_left = |piece: &Piece| piece.end().x < -1e-12;
    let first = pieces.iter().position(reaches_left).unwrap_or(0);
    pieces[first..].to_vec()
}

/// By how much a face turns at a joint \[rad\], negative inward.
fn turn(before: &Piece, after: &Piece) -> f64 {
    let (a, b) = (before.end_tangent(), after.start_tangent());
    (a.x * b.y - a.y * b.x).atan2(a.dot(&b))
}

/// Puts tangents in the place of hollows that the roller cannot reach into; tells which pieces are such tangents.
fn without_narrow_hollows(pieces: &[Piece], roller_radius: f64) -> (Vec<Piece>, Vec<bool>) {
    let narrow = |piece: &Piece| match piece {
        Piece::Arc(arc) => arc.sweep < 0.0 && arc.radius < roller_radius * (1.0 - ROUNDING),
        Piece::Segment(_) => false,
    };
    let mut open = Vec::new();
    let mut ends = Vec::new();
    let mut at = 0;
    while at < pieces.len() {
        // Narrow arcs that follow each other without an edge are one hollow.
        let smooth = |k: &usize| {
            narrow(&pieces[*k]) && (*k == at || turn(&pieces[k - 1], &pieces[*k]).abs() < SEPARATE)
        };
        let count = (at..pieces.len()).take_while(smooth).count();
        if count == 0 {
            open.push(pieces[at]);
            ends.push(false);
            at += 1;
            continue;
        }
        let tangents = beneath(&pieces[at], &pieces[at + count - 1], roller_radius);
        ends.extend(tangents.iter().map(|_| true));
        open.extend(tangents);
        at += count;
    }
    (open, ends)
}

/// The tangents at both ends of a hollow as far as they meet, or a floor between them.
fn beneath(first: &Piece, last: &Piece, roller_radius: f64) -> Vec<Piece> {
    let (start, end) = (first.start(), last.end());
    let (down, up) = (first.start_tangent(), last.end_tangent());
    // start + a down = end − b up
    let across = down.x * up.y - down.y * up.x;
    let chord = end - start;
    let reach = [
        (chord.x * up.y - chord.y * up.x) / across,
        (chord.y * down.x - chord.x * down.y) / across,
    ];
    let deepest = DEEPEST * roller_radius;
    let line = |from: Point, to: Point| Piece::Segment(Segment::new(from, to));
    if reach.iter().all(|a| *a > 0.0 && *a < deepest) {
        let edge = start + down * reach[0];
        vec![line(start, edge), line(edge, end)]
    } else {
        let floor = [start + down * deepest, end - up * deepest];
        vec![
            line(start, floor[0]),
            line(floor[0], floor[1]),
            line(floor[1], end),
        ]
    }
}

fn alike(a: &Profile, b: &Profile) -> bool {
    let close = |p: Point, q: Point| (p - q).norm() < 1e-9;
    a.features.len() == b.features.len()
        && a.features
            .iter()
            .zip(&b.features)
            .enumerate()
            .all(|(i, (f, g))| {
                let mirror = |p: Point| Point::new(-p.x, p.y);
                close(f.centre, mirror(g.centre))
                    && (f.radius - g.radius).abs() < 1e-9
                    && (f.straight - Vector::new(-g.straight.x, g.straight.y)).norm() < 1e-9
                    && (i == 0 || close(f.start, mirror(g.start)))
            })
}

#[cfg(test)]
mod tests {
    use chaindrive_geometry::{ArcSpline, Seat, Tip, ToothForm, ToothGap};

    use super::*;
    use crate::lanes::Wide;

    /// Points on a grid over one gap, from the root to above the tips.
    fn grid(gap: &ToothGap) -> Vec<Point> {
        let half = std::f64::consts::PI / f64::from(gap.teeth);
        let mut points = Vec::new();
        for i in -40..=40 {
            for k in 0..=60 {
                let angle = half * f64::from(i) / 40.5;
                let share = f64::from(k) / 60.0;
                let low = gap.root_radius + 0.3 * gap.roller_diameter;
                let high = gap.tip_radius + 0.6 * gap.roller_diameter;
                let radius = low + (high - low) * share;
                points.push(Point::new(radius * angle.sin(), radius * angle.cos()));
            }
        }
        points
    }

    /// Passing from feature to feature finds what an exhaustive search over the exact outline finds,
    /// wherever a roller is near the surface.
    #[test]
    fn features_find_the_nearest_surface() {
        let chain = (0.0889, 0.05398);
        let iso = |gap| ToothForm::Iso606 {
            gap,
            tip: Tip::Mid,
            seat: Seat::Bottom,
        };
        let forms = [
            iso(0.0),
            iso(0.5),
            iso(1.0),
            ToothForm::AsaTypeII { tip: Tip::Mid },
            ToothForm::Circular {
                seat_radius: 0.02726,
                tip: Tip::Mid,
                seat: Seat::Bottom,
            },
        ];
        for form in &forms {
            for teeth in [9, 24, 48, 120] {
                let gap = ToothGap::new(teeth, chain.0, chain.1, form).unwrap();
                let face = GapFace::new(gap.pieces(), 0.5 * chain.1);
                let [
                    Stretch {
                        profile,
                        extent: Extent::Folded,
                    },
                ] = &face.stretches[..]
                else {
                    panic!("{form:?} with {teeth} teeth");
                };
                let outline = ArcSpline::open(gap.pieces()).unwrap();
                let mut compared = 0;
                for q in grid(&gap) {
                    let foot = outline.nearest(q, 10.0).unwrap();
                    if foot.distance < 0.3 * chain.1 || foot.distance > 0.7 * chain.1 {
                        continue;
                    }
                    compared += 1;
                    let w = Wide(pulp::Scalar);
                    let found = profile.nearest(w, [w.splat(q.x.abs()), w.splat(q.y)], 0.0);
                    let error = (found.gap.sum() - foot.distance).abs();
                    assert!(error < 1e-12, "{form:?}, {teeth} teeth, {q:?}: {error}");
                    // On the axis both halves are equally near.
                    if q.x.abs() < 1e-9 {
                        continue;
                    }
                    let side = q.x.signum();
                    let normal = Vector::new(side * found.nx.sum(), found.ny.sum());
                    assert!(
                        (normal - foot.normal).norm() < 1e-9,
                        "{form:?}, {teeth}, {q:?}"
                    );
                }
                assert!(
                    compared > 300,
                    "{compared} points of {form:?} with {teeth} teeth"
                );
            }
        }
    }
}
