//! The surfaces that lanes of rollers face on a profile.
//!
//! A roller that is carried over the tip of a tooth leaves one gap and enters the next before the axis that is remembered for it
//! changes. Its contact with the tip is one stretch of both:
//!
//! ```text
//!   gap to the left │ remembered gap │ gap to the right
//!    m−1  …   1   0 │ m−1  …   1   0 │ m−1  …   1   0      stretches, from the right tip to the left one
//!                 ╰──╯            ╰───╯                    the same contact
//! ```
//!
//! The sides of the remembered gap serve its neighbours too: stretch j of the gap to the right is kept as side j + 1, stretch j
//! of the gap to the left as side j − 1, counted round.

use chaindrive_geometry::Point;
use chaindrive_integrate::kernel;
use pulp::Simd;

use super::{Contacts, Frame, Shape, Teeth};
use crate::lanes::{LANES, Lane, Mask, Wide, rarely};
use crate::profile::{Extent, Nearest, Probe, Profile, RailFace, Stretch};

/// Roller centres in gap frames, and the gap axes in the world.
pub(super) struct GapPlaces<S: Simd> {
    at: [Lane<S>; 2],
    ax: Lane<S>,
    ay: Lane<S>,
    /// Which rollers have left the gap that is remembered for them, to the right and to the left, if any has.
    over: Option<[Mask<S>; 2]>,
}

/// Surface that one side of the slots faces.
#[derive(Clone, Copy)]
pub(super) enum View<'a> {
    Rail(&'a RailFace),
    /// A stretch of the remembered gap.
    Gap(&'a [Stretch], usize),
}

/// The surface that rollers face, in the world.
#[derive(Clone, Copy)]
pub(super) struct FacedSurface<S: Simd> {
    pub(super) gap: Lane<S>,
    pub(super) nx: Lane<S>,
    pub(super) ny: Lane<S>,
    /// Curvature of the level line of the gap.
    pub(super) bend: Lane<S>,
    /// Distance of the rollers beyond the hollow, where it was asked for.
    pub(super) beyond: Lane<S>,
}

impl<S: Simd> GapPlaces<S> {
    /// In the frames of the gaps that rollers at d from the centre of the teeth are nearest to; with cos and sin of the turns to the gaps on their
    /// right and on their left.
    #[inline(always)]
    pub(super) fn in_gap(
        w: Wide<S>,
        teeth: &Teeth,
        frame: &Frame,
        [ex, ey]: [Lane<S>; 2],
        [dx, dy]: [Lane<S>; 2],
        [right_c, right_s, left_c, left_s]: [Lane<S>; 4],
    ) -> Self {
        let (c, s) = (w.splat(frame.turn[0]), w.splat(frame.turn[1]));
        // a = R(θ) e,   x = d × a,   y = d · a. Rounded alike on every processor: a last place of d is one of the gap.
        let ax = c * ex - s * ey;
        let ay = s * ex + c * ey;
        let x = dx * ay - dy * ax;
        let y = dx * ax + dy * ay;
        let beyond = x.abs().greater(y * w.splat(teeth.tan_half));
        if !beyond.any() {
            return Self {
                at: [x, y],
                ax,
                ay,
                over: None,
            };
        }
        // Beyond the middle of a tooth the next gap is meant: turn the axis there.
        let (one, zero) = (w.splat(1.0), w.splat(0.0));
        let to_the_right = x.greater(zero);
        let sign = to_the_right.select(one, -one);
        let cosine = to_the_right.select(right_c, left_c);
        let sine = to_the_right.select(right_s, left_s);
        let cp = beyond.select(cosine, one);
        let sp = beyond.select(sign * sine, zero);
        let ax2 = cp * ax + sp * ay;
        let ay2 = cp * ay - sp * ax;
        Self {
            at: [dx * ay2 - dy * ax2, dx * ax2 + dy * ay2],
            ax: ax2,
            ay: ay2,
            over: Some([beyond & to_the_right, beyond & zero.greater(x)]),
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
            at: [
                c * dx + s * dy + w.splat(reference.x),
                c * dy - s * dx + w.splat(reference.y),
            ],
            ax: -s,
            ay: c,
            over: None,
        }
    }
}

impl<S: Simd> GapPlaces<S> {
    /// Whether some rollers face another stretch than that of their side, or the other way of one that is divided.
    #[inline(always)]
    fn needs_more(&self, w: Wide<S>, stretches: &[Stretch], side: usize) -> bool {
        if stretches.len() > 1
            && let Some([right, left]) = self.over
            && (right.any() || left.any())
        {
            return true;
        }
        match &stretches[side].extent {
            Extent::Divided(divide) => w.splat(divide.at).greater(self.at[0]).any(),
            Extent::Folded | Extent::Outward => false,
        }
    }
}

kernel!(
    /// What rollers face of which [`GapPlaces::needs_more`] is true: rare, and long.
    ///
    /// It is a call of its own, compiled for the kind of processor that asks, so that the inner loop stays short. Such a call takes
    /// numbers, not lanes.
    fn elsewhere<'a, S: Simd>(
        w: Wide<S>,
        stretches: &'a [Stretch],
        side: usize,
        at: [[f64; LANES]; 2],
        /// Positive for rollers that have left their gap to the right, and to the left.
        over: Option<[[f64; LANES]; 2]>,
        radius: f64,
        measured: bool,
        /// What they would face on their own side.
        faced: [[f64; LANES]; 5],
    ) -> [[f64; LANES]; 5] {
        let at = at.map(|numbers| w.load(&numbers, 0));
        let mut faced = FacedSurface::of(faced.map(|numbers| w.load(&numbers, 0)));
        let all = w.first(Wide::<S>::COUNT);
        faced = stretches[side].other_way(w, all, faced, at, radius, measured);
        if let (Some(over), true) = (over, stretches.len() > 1) {
            let count = stretches.len();
            for (over, neighbour) in over.iter().zip([count - 1, 1]) {
                let over = w.load(over, 0).greater(w.splat(0.5));
                if over.any() {
                    let stretch = &stretches[(side + neighbour) % count];
                    let there = stretch.face(w, at, radius, measured);
                    faced = there.where_of(over, faced);
                    faced = stretch.other_way(w, over, faced, at, radius, measured);
                }
            }
        }
        faced.lanes().map(Lane::numbers)
    }
);

impl View<'_> {
    /// The surfaces that circles of some radius face; how far beyond the hollow they are only if `measured`.
    #[inline(always)]
    pub(super) fn faced<S: Simd>(
        self,
        w: Wide<S>,
        place: &GapPlaces<S>,
        radius: f64,
        measured: bool,
    ) -> FacedSurface<S> {
        let faced = match self {
            View::Rail(face) => FacedSurface::whole(w, face.nearest(w, place.at, radius)),
            View::Gap(stretches, side) => {
                let faced = stretches[side].face(w, place.at, radius, measured);
                if place.needs_more(w, stretches, side) {
                    rarely();
                    let yes = |mask: Mask<S>| mask.select(w.splat(1.0), w.splat(0.0)).numbers();
                    let found = w.call(elsewhere(
                        stretches,
                        side,
                        place.at.map(Lane::numbers),
                        place.over.map(|over| over.map(yes)),
                        radius,
                        measured,
                        faced.lanes().map(Lane::numbers),
                    ));
                    FacedSurface::of(found.map(|numbers| w.load(&numbers, 0)))
                } else {
                    faced
                }
            }
        };
        // The gap's x axis is its y axis turned by −90°.
        FacedSurface {
            nx: (faced.nx * place.ay).plus(faced.ny, place.ax),
            ny: (faced.ny * place.ay).minus(faced.nx, place.ax),
            ..faced
        }
    }
}

impl Stretch {
    /// Surface that rollers face which pass it to the right, or either way where it is symmetric.
    #[inline(always)]
    fn face<S: Simd>(
        &self,
        w: Wide<S>,
        [x, y]: [Lane<S>; 2],
        radius: f64,
        measured: bool,
    ) -> FacedSurface<S> {
        let one = w.splat(1.0);
        let (x, sign) = match self.extent {
            Extent::Folded => (x.abs(), x.greater(w.splat(0.0)).select(one, -one)),
            Extent::Outward | Extent::Divided(_) => (x, one),
        };
        face(w, &self.profile, [x, y], sign, radius, measured)
    }

    /// The same, for those of some rollers that pass it to the left.
    #[inline(always)]
    fn other_way<S: Simd>(
        &self,
        w: Wide<S>,
        some: Mask<S>,
        faced: FacedSurface<S>,
        [x, y]: [Lane<S>; 2],
        radius: f64,
        measured: bool,
    ) -> FacedSurface<S> {
        let Extent::Divided(divide) = &self.extent else {
            return faced;
        };
        let to_the_left = w.splat(divide.at).greater(x) & some;
        if !to_the_left.any() {
            return faced;
        }
        let left = face(w, &divide.left, [x, y], w.splat(1.0), radius, measured);
        left.where_of(to_the_left, faced)
    }
}

/// Surface that circles face at places mirrored by `sign`, in the frame of the profile.
#[inline(always)]
fn face<S: Simd>(
    w: Wide<S>,
    profile: &Profile,
    at: [Lane<S>; 2],
    sign: Lane<S>,
    radius: f64,
    measured: bool,
) -> FacedSurface<S> {
    let Nearest { gap, nx, ny, bend } = profile.nearest(w, at, radius);
    let beyond = if measured {
        profile.beyond_hollow(w, at)
    } else {
        w.splat(0.0)
    };
    FacedSurface {
        gap,
        nx: sign * nx,
        ny,
        bend,
        beyond,
    }
}

impl<S: Simd> FacedSurface<S> {
    /// Of a face without a hollow to be beyond.
    #[inline(always)]
    fn whole(w: Wide<S>, Nearest { gap, nx, ny, bend }: Nearest<S>) -> Self {
        Self {
            gap,
            nx,
            ny,
            bend,
            beyond: w.splat(f64::MAX),
        }
    }

    #[inline(always)]
    fn lanes(self) -> [Lane<S>; 5] {
        [self.gap, self.nx, self.ny, self.bend, self.beyond]
    }

    #[inline(always)]
    fn of([gap, nx, ny, bend, beyond]: [Lane<S>; 5]) -> Self {
        Self {
            gap,
            nx,
            ny,
            bend,
            beyond,
        }
    }

    /// This in some lanes, another in the rest.
    #[inline(always)]
    fn where_of(self, some: Mask<S>, other: Self) -> Self {
        Self {
            gap: some.select(self.gap, other.gap),
            nx: some.select(self.nx, other.nx),
            ny: some.select(self.ny, other.ny),
            bend: some.select(self.bend, other.bend),
            beyond: some.select(self.beyond, other.beyond),
        }
    }
}

impl Contacts {
    #[inline(always)]
    pub(super) fn view(&self, side: usize) -> View<'_> {
        match &self.shape {
            Shape::Rail { face, .. } => View::Rail(face),
            Shape::Teeth(teeth) => View::Gap(&teeth.face.stretches, side),
        }
    }

    /// The surfaces that a roller at `at` faces, one for every side, with normals in the world: one lane of one.
    pub(crate) fn probes(&self, frame: &Frame, roller: usize, at: Point) -> Vec<Probe> {
        let w = Wide(pulp::Scalar);
        let d = at - frame.centre();
        let lanes = [w.splat(d.x), w.splat(d.y)];
        let place = match &self.shape {
            Shape::Rail { reference, .. } => GapPlaces::at_rail(w, *reference, frame, lanes),
            Shape::Teeth(teeth) => {
                let reach = teeth.tip_radius + self.largest;
                if d.norm_squared() > reach * reach {
                    return Vec::new();
                }
                let axis = teeth.gap_axis(frame.turn, d, None);
                let turns = teeth.turns(axis).map(|it| w.splat(it));
                GapPlaces::in_gap(w, teeth, frame, axis.map(|e| w.splat(e)), lanes, turns)
            }
        };
        let sides = 0..self.sides();
        let probe = |side| {
            let mut faced = self.view(side).faced(w, &place, self.radius, true);
            faced.gap = faced.gap - w.splat(self.larger(roller));
            Probe::of(faced.lanes())
        };
        sides.map(probe).collect()
    }
}
