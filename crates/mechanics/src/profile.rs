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

mod gap;
mod lookup;
mod rail;

use chaindrive_geometry::{Piece, Point, Vector};
use pulp::Simd;

pub(crate) use gap::{Extent, GapFace, Stretch};
pub(crate) use rail::RailFace;

use crate::lanes::{Lane, Wide, rarely};

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
    /// The feature begins where q·along > start·along.
    pub(crate) start: Point,
    /// Direction of travel at the start.
    pub(crate) along: Vector,
    /// start·along \[m\].
    pub(crate) begin: f64,
}

/// A row of features in the order of travel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Profile {
    pub(crate) features: Vec<Feature>,
    /// Whether any feature is straight.
    pub(crate) has_straights: bool,
    /// Whether the surface bulges everywhere and turns outward at every joint: convex.
    pub(crate) bulges: bool,
    /// First feature after a hollow that is not hollow itself: where the flank begins.
    pub(crate) flank: Option<usize>,
    /// Where every reach ends, of rows that are looked up; empty for short ones.
    reaches: Box<[usize]>,
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
    /// Distance beyond the end of the hollow \[m\].
    pub(crate) beyond: f64,
}

/// The nearest surface as the circles of a lane see it.
pub(crate) struct Nearest<S: Simd> {
    /// Distance between the surfaces \[m\], negative in contact.
    pub(crate) gap: Lane<S>,
    /// Outward normal of the surface; nothing where a circle is concentric with the arc.
    pub(crate) nx: Lane<S>,
    pub(crate) ny: Lane<S>,
    /// Curvature of the level line of the gap \[1/m\].
    pub(crate) bend: Lane<S>,
}

/// The features that the circles of a lane belong to.
#[derive(Clone, Copy)]
struct LaneFeatures<S: Simd> {
    centre: [Lane<S>; 2],
    radius: Lane<S>,
    sign: Lane<S>,
    straight: [Lane<S>; 2],
}

/// Joints that turn by less than this \[rad\] count as tangent.
const TANGENT: f64 = 1e-7;

/// Largest curvature of a level line \[1/m\] that is reckoned with. Around the centre of a seat as wide as the roller it grows
/// without bound, while the force that it multiplies vanishes.
pub(crate) const SHARPEST: f64 = 1e12;

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
                reaches: Box::default(),
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
        let reaches = if features.len() > lookup::FEW {
            lookup::reaches(&features)
        } else {
            Box::default()
        };
        Self {
            features,
            has_straights,
            bulges,
            flank,
            reaches,
        }
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

    /// The surface that circles of some radius at (x, y) face.
    #[inline(always)]
    pub(crate) fn nearest<S: Simd>(
        &self,
        w: Wide<S>,
        [x, y]: [Lane<S>; 2],
        radius: f64,
    ) -> Nearest<S> {
        let chosen = if self.features.len() > lookup::LONG {
            rarely();
            self.looked_up(w, [x, y])
        } else {
            self.passed(w, [x, y])
        };
        self.facing(w, [x, y], chosen, radius)
    }

    /// The surface of the features that circles of some radius at (x, y) belong to.
    #[inline(always)]
    fn facing<S: Simd>(
        &self,
        w: Wide<S>,
        [x, y]: [Lane<S>; 2],
        chosen: LaneFeatures<S>,
        radius: f64,
    ) -> Nearest<S> {
        let zero = w.splat(0.0);
        let LaneFeatures {
            centre: [cx, cy],
            radius: r,
            sign,
            straight: [mx, my],
        } = chosen;
        let (ex, ey) = (x - cx, y - cy);
        let [distance, inverse] = (ex * ex).plus(ey, ey).roots();
        let scale = sign * inverse;
        let contact_radius = w.splat(radius);
        // g = ±(|q − c| − R) − r
        let mut gap = (-contact_radius).plus(sign, distance - r);
        let (mut nx, mut ny, mut bend) = (scale * ex, scale * ey, scale);
        if self.has_straights {
            // g = n·(q − p) − r
            let straight = (mx * mx + my * my).greater(zero);
            gap = straight.select((mx * ex).plus(my, ey) - contact_radius, gap);
            nx = straight.select(mx, nx);
            ny = straight.select(my, ny);
            bend = straight.select(zero, bend);
        }
        Nearest { gap, nx, ny, bend }
    }

    /// The last features whose starting lines circles at (x, y) have passed, one line after the other.
    #[inline(always)]
    fn passed<S: Simd>(&self, w: Wide<S>, at: [Lane<S>; 2]) -> LaneFeatures<S> {
        let zero = w.splat(0.0);
        let first = &self.features[0];
        let mut cx = w.splat(first.centre.x);
        let mut cy = w.splat(first.centre.y);
        let mut r = w.splat(first.radius);
        let mut sign = w.splat(first.sign);
        let mut mx = w.splat(first.straight.x);
        let mut my = w.splat(first.straight.y);
        let mut passed = w.first(Wide::<S>::COUNT);
        for index in 1..self.features.len() {
            let f = &self.features[index];
            passed = passed & self.ahead(w, index, at).greater(zero);
            if !passed.any() {
                break;
            }
            cx = passed.select(w.splat(f.centre.x), cx);
            cy = passed.select(w.splat(f.centre.y), cy);
            r = passed.select(w.splat(f.radius), r);
            sign = passed.select(w.splat(f.sign), sign);
            if self.has_straights {
                mx = passed.select(w.splat(f.straight.x), mx);
                my = passed.select(w.splat(f.straight.y), my);
            }
        }
        LaneFeatures {
            centre: [cx, cy],
            radius: r,
            sign,
            straight: [mx, my],
        }
    }

    /// Distance of places beyond the end of the hollow \[m\], negative in the hollow; without a hollow, beyond any measure.
    #[inline(always)]
    pub(crate) fn beyond_hollow<S: Simd>(&self, w: Wide<S>, at: [Lane<S>; 2]) -> Lane<S> {
        match self.flank {
            Some(index) => self.ahead(w, index, at),
            None => w.splat(f64::MAX),
        }
    }

    /// How far beyond the line where a feature begins \[m\].
    #[inline(always)]
    fn ahead<S: Simd>(&self, w: Wide<S>, index: usize, [x, y]: [Lane<S>; 2]) -> Lane<S> {
        let f = &self.features[index];
        (x * w.splat(f.along.x) - w.splat(f.begin)).plus(y, w.splat(f.along.y))
    }
}

impl Probe {
    /// One lane of one: gap, normal, bend and distance beyond the hollow.
    pub(crate) fn of(lanes: [Lane<pulp::Scalar>; 5]) -> Self {
        let [gap, x, y, bend, beyond] = lanes.map(Lane::sum);
        Self {
            gap,
            normal: Vector::new(x, y),
            bend: bend.clamp(-SHARPEST, SHARPEST),
            beyond,
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
        begin: at.coords.dot(&along),
    }
}

fn feature(piece: &Piece, along: Vector) -> Feature {
    let start = piece.start();
    let begin = start.coords.dot(&along);
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
                begin,
            }
        }
        Piece::Arc(arc) => Feature {
            centre: arc.centre,
            radius: arc.radius,
            sign: arc.sweep.signum(),
            straight: Vector::zeros(),
            start,
            along,
            begin,
        },
    }
}
