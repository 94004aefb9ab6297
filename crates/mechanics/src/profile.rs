//! A working surface as a row of features, ready for the inner loop.
//!
//! ```text
//!            tip arc
//!          ╭────────  4            each feature begins at a line across the surface;
//!   corner •  3                    a roller belongs to the last feature whose line it
//!         ╱                        has passed, and touches that one feature only
//!        ╱  flank arc  2
//!   ╲___╱
//!   seat arc  1
//! ```
//!
//! On each feature the gap of a roller is closed form: g = ±(|q − c| − R) − r on an arc or
//! a corner (R = 0), g = n·(q − p) − r on a straight.

use chaindrive_geometry::{Piece, Point, Vector};

/// One arc, straight or corner of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Feature {
    /// Arc centre, corner, or a point of the straight \[m\].
    pub(crate) centre: Point,
    /// Arc radius \[m\], zero at a corner.
    pub(crate) radius: f64,
    /// +1 where the material bulges (and at corners), −1 in a hollow.
    pub(crate) sign: f64,
    /// Outward normal of a straight, zero otherwise.
    pub(crate) straight: Vector,
    /// The feature begins where (q − start)·along > 0.
    pub(crate) start: Point,
    /// Direction of travel at the start.
    pub(crate) along: Vector,
}

/// A row of features in the order of travel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Profile {
    pub(crate) features: Vec<Feature>,
    /// Whether any feature is straight.
    pub(crate) has_straights: bool,
    /// Whether the surface bulges everywhere and turns outward at every joint: convex.
    pub(crate) bulges: bool,
    /// First feature behind a hollow that is not hollow itself: where the flank begins.
    pub(crate) flank: Option<usize>,
}

/// The nearest surface of a profile as one roller sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    /// Distance between the surfaces \[m\], negative in contact.
    pub(crate) gap: f64,
    /// Outward normal of the surface.
    pub(crate) normal: Vector,
    /// Curvature of the level line of the gap through the roller centre \[1/m\], positive around a bulge.
    pub(crate) bend: f64,
    /// Number of the feature.
    pub(crate) feature: usize,
    /// Distance beyond the end of the hollow \[m\].
    pub(crate) beyond: f64,
}

/// Joints that turn by less than this \[rad\] count as tangent.
const TANGENT: f64 = 1e-7;

impl Profile {
    /// The row of `pieces`, material on the left of travel, with corners where the pieces turn
    /// outward and, where asked, at the open ends.
    pub(crate) fn new(pieces: &[Piece], open_start: bool, open_end: bool) -> Self {
        let mut features = Vec::new();
        let mut bulges = true;
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return Self {
                features,
                has_straights: false,
                bulges: false,
                flank: None,
            };
        };
        if open_start {
            features.push(corner(first.start(), -first.start_tangent()));
        }
        for (i, piece) in pieces.iter().enumerate() {
            let mut along = piece.start_tangent();
            if let Some(before) = i.checked_sub(1).map(|b| pieces[b].end_tangent()) {
                let turn = before.x * along.y - before.y * along.x;
                if turn > TANGENT {
                    features.push(corner(piece.start(), before));
                } else if turn < -TANGENT {
                    bulges = false;
                    along = (before + along).normalize();
                }
            }
            features.push(feature(piece, along));
        }
        if open_end {
            features.push(corner(last.end(), last.end_tangent()));
        }
        let has_straights = features.iter().any(|f| f.straight != Vector::zeros());
        let flank = features
            .iter()
            .position(|f| f.sign < 0.0)
            .and_then(|hollow| {
                let behind = features.iter().skip(hollow).position(|f| f.sign > 0.0)?;
                Some(hollow + behind)
            });
        bulges &= features.iter().all(|f| f.sign > 0.0);
        Self {
            features,
            has_straights,
            bulges,
            flank,
        }
    }

    /// How far beyond the end of the hollow a place is \[m\], negative in the hollow; infinite without one.
    pub(crate) fn beyond_hollow(&self, q: Point) -> f64 {
        self.flank.map_or(f64::INFINITY, |index| {
            let start = &self.features[index];
            (q - start.start).dot(&start.along)
        })
    }

    /// The mirror image x → −x, travelled in the same order.
    pub(crate) fn mirrored(mut self) -> Self {
        for f in &mut self.features {
            f.centre.x = -f.centre.x;
            f.straight.x = -f.straight.x;
            f.start.x = -f.start.x;
            f.along.x = -f.along.x;
        }
        self
    }

    /// The surface that a roller of radius `radius` at `q` faces.
    pub(crate) fn probe(&self, q: Point, radius: f64) -> Probe {
        let mut index = 0;
        for (i, f) in self.features.iter().enumerate().skip(1) {
            if (q - f.start).dot(&f.along) <= 0.0 {
                break;
            }
            index = i;
        }
        let f = &self.features[index];
        let from = q - f.centre;
        if f.straight == Vector::zeros() {
            let distance = from.norm().max(f64::MIN_POSITIVE);
            Probe {
                // g = ±(|q − c| − R) − r
                gap: f.sign * (distance - f.radius) - radius,
                normal: from * (f.sign / distance),
                bend: f.sign / distance,
                feature: index,
                beyond: self.beyond_hollow(q),
            }
        } else {
            Probe {
                // g = n·(q − p) − r
                gap: f.straight.dot(&from) - radius,
                normal: f.straight,
                bend: 0.0,
                feature: index,
                beyond: self.beyond_hollow(q),
            }
        }
    }
}

fn corner(at: Point, along: Vector) -> Feature {
    Feature {
        centre: at,
        radius: 0.0,
        sign: 1.0,
        straight: Vector::zeros(),
        start: at,
        along,
    }
}

fn feature(piece: &Piece, along: Vector) -> Feature {
    let start = piece.start();
    match piece {
        Piece::Segment(_) => {
            let tangent = piece.start_tangent();
            Feature {
                centre: start,
                radius: 0.0,
                sign: 1.0,
                straight: Vector::new(tangent.y, -tangent.x),
                start,
                along,
            }
        }
        Piece::Arc(arc) => Feature {
            centre: arc.centre,
            radius: arc.radius,
            sign: arc.sweep.signum(),
            straight: Vector::zeros(),
            start,
            along,
        },
    }
}

/// The tooth gap as the inner loop sees it: the two halves from the bottom outward, in the
/// frame with the gap axis along +y; both are described for x ≥ 0, the left one mirrored.
#[derive(Clone, Debug)]
pub(crate) struct GapHalves {
    pub(crate) right: Profile,
    pub(crate) left: Profile,
    /// One roller may touch both halves at once, or the halves differ: both must be looked at.
    pub(crate) two_sided: bool,
}

impl GapHalves {
    /// Splits a gap, given from the right tip to the left one, at its bottom.
    pub(crate) fn new(pieces: &[Piece], roller_radius: f64) -> Self {
        let left_pieces = left_half(pieces);
        let mirrored: Vec<Piece> = pieces
            .iter()
            .rev()
            .map(|piece| piece.mirrored_x().reversed())
            .collect();
        let right_pieces = left_half(&mirrored);
        let left = Profile::new(&left_pieces, false, false).mirrored();
        let right = Profile::new(&right_pieces, false, false).mirrored();
        let differ = !alike(&left, &right);
        let two_sided = differ || narrow(&right, roller_radius);
        Self {
            right,
            left,
            two_sided,
        }
    }
}

/// The pieces from the bottom to the left tip; the piece across the axis comes first, whole.
fn left_half(pieces: &[Piece]) -> Vec<Piece> {
    let reaches_left = |piece: &Piece| piece.end().x < -1e-12;
    let first = pieces.iter().position(reaches_left).unwrap_or(0);
    pieces[first..].to_vec()
}

fn alike(a: &Profile, b: &Profile) -> bool {
    let close = |p: Point, q: Point| (p - q).norm() < 1e-9;
    a.features.len() == b.features.len()
        && a.features
            .iter()
            .zip(&b.features)
            .enumerate()
            .all(|(i, (f, g))| {
                close(f.centre, g.centre)
                    && (f.radius - g.radius).abs() < 1e-9
                    && (f.straight - g.straight).norm() < 1e-9
                    && (i == 0 || close(f.start, g.start))
            })
}

/// Whether a roller that comes down the axis meets a flank before it meets a seat that
/// crosses the axis.
fn narrow(half: &Profile, roller_radius: f64) -> bool {
    let Some(seat) = half.features.first() else {
        return false;
    };
    let crosses = seat.straight == Vector::zeros() && seat.centre.x.abs() < 1e-9;
    !crosses || (seat.sign < 0.0 && seat.radius <= roller_radius)
}

#[cfg(test)]
mod tests {
    use chaindrive_geometry::{ArcSpline, Seat, Segment, Tip, ToothForm, ToothGap};

    use super::*;

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
                let halves = GapHalves::new(gap.pieces(), 0.5 * chain.1);
                assert!(!halves.two_sided, "{form:?} with {teeth} teeth");
                let outline = ArcSpline::open(gap.pieces()).unwrap();
                let mut compared = 0;
                for q in grid(&gap) {
                    let foot = outline.nearest(q, 10.0).unwrap();
                    if foot.distance < 0.3 * chain.1 || foot.distance > 0.7 * chain.1 {
                        continue;
                    }
                    compared += 1;
                    let probe = halves.right.probe(Point::new(q.x.abs(), q.y), 0.0);
                    let error = (probe.gap - foot.distance).abs();
                    assert!(error < 1e-12, "{form:?}, {teeth} teeth, {q:?}: {error}");
                    // On the axis both halves are equally near.
                    if q.x.abs() < 1e-9 {
                        continue;
                    }
                    let side = q.x.signum();
                    let normal = Vector::new(side * probe.normal.x, probe.normal.y);
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

    /// A roller in a V lies on both flanks: both halves see it, each its own.
    #[test]
    fn a_narrow_gap_is_looked_at_twice() {
        let flank = |x: f64| Point::new(x, 0.6 + x.abs());
        let pieces = [
            Piece::Segment(Segment::new(flank(0.04), flank(0.0))),
            Piece::Segment(Segment::new(flank(0.0), flank(-0.04))),
        ];
        let halves = GapHalves::new(&pieces, 0.01);
        assert!(halves.two_sided);
        let above = Point::new(0.0, 0.6 + 0.01 * std::f64::consts::SQRT_2);
        for half in [&halves.right, &halves.left] {
            assert!(half.probe(above, 0.01).gap.abs() < 1e-15);
        }
    }
}
