//! Where lanes of rollers are on a profile.

use chaindrive_geometry::Point;
use pulp::Simd;

use super::window::FAR;
use super::{Contacts, Frame, Shape, Teeth};
use crate::lanes::{Lane, Wide};
use crate::profile::Profile;

/// Roller centres in gap frames, and the gap axes in the world.
pub(super) struct Place<S: Simd> {
    x: Lane<S>,
    y: Lane<S>,
    ax: Lane<S>,
    ay: Lane<S>,
}

/// The surface that rollers face, in the frame of the profile.
pub(super) struct Found<S: Simd> {
    gap: Lane<S>,
    nx: Lane<S>,
    ny: Lane<S>,
    bend: Lane<S>,
}

/// The same in the world.
pub(super) struct Hit<S: Simd> {
    pub(super) gap: Lane<S>,
    pub(super) nx: Lane<S>,
    pub(super) ny: Lane<S>,
    /// Curvature of the level line of the gap.
    pub(super) bend: Lane<S>,
}

/// What a side of the slots looks at: the whole rail, the half of a symmetric gap on the roller's side, or one half of a gap
/// that must be looked at twice.
pub(super) struct Half<'a> {
    profile: &'a Profile,
    mirror: Mirror,
    /// Whether the first feature lies across the axis and belongs to the other half where x < 0.
    seat_across: bool,
}

/// How places come to the half that a profile describes, at x ≥ 0.
#[derive(Clone, Copy)]
enum Mirror {
    Never,
    Always,
    /// Where x < 0.
    Nearest,
}

/// The profile that a lane looks at, and from where.
pub(super) struct Face<'a, S: Simd> {
    half: &'a Half<'a>,
    x: Lane<S>,
    y: Lane<S>,
    /// −1 where mirrored.
    sign: Lane<S>,
}

impl<S: Simd> Place<S> {
    /// In the frames of the gaps that rollers at d from the wheel's centre are nearest to.
    #[inline(always)]
    pub(super) fn in_gap(
        w: Wide<S>,
        teeth: &Teeth,
        frame: &Frame,
        [ex, ey]: [Lane<S>; 2],
        [dx, dy]: [Lane<S>; 2],
    ) -> Self {
        let (c, s) = (w.splat(frame.turn[0]), w.splat(frame.turn[1]));
        // a = R(θ) e,   x = d × a,   y = d · a
        let ax = c * ex - s * ey;
        let ay = s * ex + c * ey;
        let x = dx * ay - dy * ax;
        let y = dx * ax + dy * ay;
        let beyond = x.abs().greater(y * w.splat(teeth.tan_half));
        if !beyond.any() {
            return Self { x, y, ax, ay };
        }
        // Beyond the middle of a tooth the next gap is meant: turn the axis by one pitch.
        let (one, zero) = (w.splat(1.0), w.splat(0.0));
        let sign = x.greater(zero).select(one, -one);
        let cp = beyond.select(w.splat(teeth.pitch_turn[0]), one);
        let sp = beyond.select(sign * w.splat(teeth.pitch_turn[1]), zero);
        let ax2 = cp * ax + sp * ay;
        let ay2 = cp * ay - sp * ax;
        Self {
            x: dx * ay2 - dy * ax2,
            y: dx * ax2 + dy * ay2,
            ax: ax2,
            ay: ay2,
        }
    }

    /// In the frame of a rail.
    #[inline(always)]
    pub(super) fn at_rail(
        w: Wide<S>,
        reference: Point,
        frame: &Frame,
        [dx, dy]: [Lane<S>; 2],
    ) -> Self {
        // q' = reference + Rᵀ d; the frame's y axis is (−s, c)
        let (c, s) = (w.splat(frame.turn[0]), w.splat(frame.turn[1]));
        Self {
            x: c * dx + s * dy + w.splat(reference.x),
            y: c * dy - s * dx + w.splat(reference.y),
            ax: -s,
            ay: c,
        }
    }

    #[inline(always)]
    pub(super) fn world(&self, found: &Found<S>) -> Hit<S> {
        // The gap's x axis is its y axis turned by −90°.
        Hit {
            gap: found.gap,
            nx: found.nx * self.ay + found.ny * self.ax,
            ny: found.ny * self.ay - found.nx * self.ax,
            bend: found.bend,
        }
    }
}

impl Contacts {
    #[inline(always)]
    pub(super) fn half(&self, side: usize) -> Half<'_> {
        let (profile, mirror) = match &self.shape {
            Shape::Rail { profile, .. } => (profile, Mirror::Never),
            Shape::Teeth(Teeth { halves, .. }) => match (halves.two_sided, side) {
                (false, _) => (&halves.right, Mirror::Nearest),
                (true, 0) => (&halves.right, Mirror::Never),
                (true, _) => (&halves.left, Mirror::Always),
            },
        };
        Half {
            profile,
            mirror,
            seat_across: self.sides() > 1 && profile.features[0].sign < 0.0,
        }
    }
}

impl Half<'_> {
    #[inline(always)]
    pub(super) fn face<S: Simd>(&self, w: Wide<S>, place: &Place<S>) -> Face<'_, S> {
        let (one, x) = (w.splat(1.0), place.x);
        let (x, sign) = match self.mirror {
            Mirror::Never => (x, one),
            Mirror::Always => (-x, -one),
            Mirror::Nearest => (x.abs(), x.greater(w.splat(0.0)).select(one, -one)),
        };
        Face {
            half: self,
            x,
            y: place.y,
            sign,
        }
    }
}

impl<S: Simd> Face<'_, S> {
    /// Gap, normal and bend.
    #[inline(always)]
    pub(super) fn look(&self, w: Wide<S>, radius: f64) -> Found<S> {
        let (profile, x, y) = (self.half.profile, self.x, self.y);
        let zero = w.splat(0.0);
        let first = &profile.features[0];
        let mut cx = w.splat(first.centre.x);
        let mut cy = w.splat(first.centre.y);
        let mut r = w.splat(first.radius);
        let mut sign = w.splat(first.sign);
        let mut mx = w.splat(first.straight.x);
        let mut my = w.splat(first.straight.y);
        let mut passed = w.first(Wide::<S>::COUNT);
        for index in 1..profile.features.len() {
            let f = &profile.features[index];
            passed = passed & self.ahead(w, index).greater(zero);
            if !passed.any() {
                break;
            }
            cx = passed.select(w.splat(f.centre.x), cx);
            cy = passed.select(w.splat(f.centre.y), cy);
            r = passed.select(w.splat(f.radius), r);
            sign = passed.select(w.splat(f.sign), sign);
            if profile.has_straights {
                mx = passed.select(w.splat(f.straight.x), mx);
                my = passed.select(w.splat(f.straight.y), my);
            }
        }
        let (ex, ey) = (x - cx, y - cy);
        let [distance, inverse] = (ex * ex + ey * ey).roots();
        let scale = sign * inverse;
        let contact_radius = w.splat(radius);
        // g = ±(|q − c| − R) − r
        let mut gap = sign * (distance - r) - contact_radius;
        let (mut nx, mut ny, mut bend) = (scale * ex, scale * ey, scale);
        if profile.has_straights {
            // g = n·(q − p) − r
            let straight = (mx * mx + my * my).greater(zero);
            gap = straight.select(mx * ex + my * ey - contact_radius, gap);
            nx = straight.select(mx, nx);
            ny = straight.select(my, ny);
            bend = straight.select(zero, bend);
        }
        if self.half.seat_across {
            // A seat across the axis belongs to the right half alone.
            let mut wrong = zero.greater(x);
            if profile.features.len() > 1 {
                wrong = wrong & zero.greater(self.ahead(w, 1));
            }
            gap = wrong.select(w.splat(FAR), gap);
        }
        Found {
            gap,
            nx: self.sign * nx,
            ny,
            bend,
        }
    }

    /// How far beyond the hollow the rollers are; infinite where there is none.
    #[inline(always)]
    pub(super) fn beyond_hollow(&self, w: Wide<S>) -> Lane<S> {
        match self.half.profile.flank {
            Some(index) => self.ahead(w, index),
            None => w.splat(f64::MAX),
        }
    }

    /// How far beyond the line where a feature begins.
    #[inline(always)]
    fn ahead(&self, w: Wide<S>, index: usize) -> Lane<S> {
        let f = &self.half.profile.features[index];
        (self.x - w.splat(f.start.x)) * w.splat(f.along.x)
            + (self.y - w.splat(f.start.y)) * w.splat(f.along.y)
    }
}
