//! Exact polygonal closing: a chain of whole links laid link by link into the teeth.
//!
//! The chain is a closed polygon of equal sides. On every wheel its corners sit on the circle of
//! roller centres, one pitch angle apart; between wheels it is straight over a whole number of
//! links. A span may leave or reach a roller only between the directions of the two polygon edges
//! that meet there, otherwise it would cut through the next tooth. With the phase of the first
//! wheel given, these rules determine the chain, and one number is left over: the misfit of the
//! last span. It vanishes for a chain that closes, see [`close_by_strain`] and [`close_by_motion`].
//!
//! A closed chain of a tight drive has no slack to give: with the tooth phase its strain varies,
//! which is what makes drives on rigid centres strain their chains periodically.
//!
//! # Source
//! Own derivation. The periodic variation of the wrapping length is the subject of N. Fuglede and
//! J. J. Thomsen, *J. Sound Vib.* **366**, 2016, 447.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::route::WheelKind;
use crate::{GeometryError, Point, Route, Wheel};

mod known;
mod misfit;
mod nearest;
mod search;
mod solve;

pub use nearest::{LinkCounts, close_nearest};
pub use search::Search;
pub use solve::{close_by_motion, close_by_strain, close_with_slack, closing_strains};

/// The rollers that one wheel carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seating {
    /// Angle of the first seated roller about the centre of the wheel \[rad\], in [0, 2π).
    pub first_angle: f64,
    /// Number of pitches wrapped \[–\]: one less than the number of rollers seated.
    pub pitches: u32,
}

/// A roller of the closed chain: its centre, and its seat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollerPlace {
    /// Centre of the roller \[m\].
    pub position: Point,
    /// Wheel, and ordinal of the seat counted from the first seated roller; none in a free span.
    pub on: Option<(usize, u32)>,
}

/// A chain of whole links around a set of wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct Closing {
    /// The seated rollers of every wheel.
    pub seats: Vec<Seating>,
    /// Number of links in every span; span i leads from wheel i to wheel i + 1.
    pub spans: Vec<u32>,
    /// Number of links in all \[–\].
    pub links: u32,
    /// Length of the last span beyond that of its links \[m\]; zero if the chain closes.
    pub residual: f64,
    /// Pitch of the links in the spans, stretched if the chain is \[m\].
    pub pitch: f64,
}

impl Closing {
    /// Lays a chain of a pitch \[m\] once around `wheels`, in the order in which it passes them.
    ///
    /// A sprocket keeps its own pitch angle 2π/z and radius even if the pitch is a stretched one;
    /// a guide has rollers one such pitch apart.
    ///
    /// `phase` \[–\] places the last seated roller of wheel 0 relative to the point of tangency:
    /// half a pitch angle beyond it at 0, on it at 0.5, half a pitch angle before it at 1, where
    /// the next tooth has taken the place of the first. It is periodic with 1.
    ///
    /// # Errors
    /// Those of [`Route::taut`]; a pitch or phase out of range; no way of seating the chain.
    pub fn march(wheels: &[Wheel], pitch: f64, phase: f64) -> Result<Self, GeometryError> {
        known::known(wheels, pitch, phase, || {
            Self::march_anew(wheels, pitch, phase)
        })
    }

    fn march_anew(wheels: &[Wheel], pitch: f64, phase: f64) -> Result<Self, GeometryError> {
        check_pitch(wheels, pitch)?;
        GeometryError::finite("tooth phase", phase)?;
        let route = Route::taut(wheels)?;
        let taut = route.pitches(pitch);
        if taut > MOST_PITCHES {
            let most = MOST_PITCHES;
            return Err(GeometryError::TooLong { taut, most });
        }
        let n = wheels.len();

        let first = &wheels[0];
        let leaving = route.spans[0].direction - first.sense() * FRAC_PI_2;
        let half = 0.5 * first.pitch_angle(pitch);
        let origin = leaving + first.sense() * (0.5 - phase.rem_euclid(1.0)) * 2.0 * half;
        let start = Lattice {
            wheel: first,
            half,
            origin,
        };

        let mut lattice = start;
        let mut guess = 0;
        let mut least = -1;
        let mut left_first = 0;
        let mut seats = Vec::with_capacity(n);
        let mut spans = Vec::with_capacity(n);
        for (next, wheel) in wheels.iter().enumerate().skip(1) {
            let unreachable = GeometryError::NoSeat {
                from: next - 1,
                to: next,
            };
            let expected = route.spans[next - 1].length / pitch;
            let reach = Reach {
                wheel,
                pitch,
                expected,
            };
            let bridge = lattice.reach(guess, least, &reach).ok_or(unreachable)?;
            if next == 1 {
                left_first = bridge.leaves;
            } else {
                seats.push(lattice.seating(0, bridge.leaves));
            }
            spans.push(bridge.links);

            let half = 0.5 * wheel.pitch_angle(pitch);
            lattice = Lattice {
                wheel,
                half,
                origin: bridge.angle,
            };
            least = 0;
            guess = lattice.ordinal(route.spans[next].direction).max(0);
        }

        // Wheel 0 again: both lattices are fixed, and the span between them is what it is.
        let arriving = -whole(route.wraps[0] / (2.0 * start.half));
        let unreachable = GeometryError::NoSeat { from: n - 1, to: 0 };
        let joined = lattice.join(&start, guess, arriving);
        let (leaves, arrives) = joined
            .filter(|&(_, arrives)| arrives <= left_first)
            .ok_or(unreachable)?;
        seats.push(lattice.seating(0, leaves));
        seats.insert(0, start.seating(arrives, left_first));
        let distance = (start.at(arrives) - lattice.at(leaves)).norm();
        let last = whole(distance / pitch);
        spans.push(count(last));

        let counts = spans
            .iter()
            .copied()
            .chain(seats.iter().map(|seat| seat.pitches));
        let links = counts.fold(0, u32::saturating_add);
        let residual = distance - last as f64 * pitch;
        Ok(Self {
            seats,
            spans,
            links,
            residual,
            pitch,
        })
    }

    /// Length of the route beyond that of a chain of `links` links \[m\]: positive if the chain is too short.
    ///
    /// ```text
    /// e(N) = (Σm + Σk − N) p + residual
    /// ```
    ///
    /// Continuous in the geometry and in the phase, although counts of single spans jump.
    pub fn excess(&self, links: u32) -> f64 {
        // e(N) = (Σm + Σk − N) p + residual
        (f64::from(self.links) - f64::from(links)) * self.pitch + self.residual
    }

    /// All rollers in path order, beginning with the first seated roller of wheel 0.
    ///
    /// `wheels` and `pitch` must be those of [`march`](Self::march). Rollers of a span divide it
    /// evenly, so that in a chain that does not close the last span shows the residual.
    ///
    /// # Errors
    /// A number of wheels other than that of the chain; a pitch out of range.
    pub fn positions(
        &self,
        wheels: &[Wheel],
        pitch: f64,
    ) -> Result<Vec<RollerPlace>, GeometryError> {
        if wheels.len() != self.seats.len() {
            let (what, got) = ("wheels of a closed chain", wheels.len());
            return Err(GeometryError::Count {
                what,
                got,
                expected: self.seats.len().to_string(),
            });
        }
        check_pitch(wheels, pitch)?;
        let lattice = |i: usize| {
            let (wheel, origin) = (&wheels[i], self.seats[i].first_angle);
            Lattice {
                wheel,
                half: 0.5 * wheel.pitch_angle(pitch),
                origin,
            }
        };
        let mut places = Vec::with_capacity(self.links as usize);
        for (i, (seat, &links)) in self.seats.iter().zip(&self.spans).enumerate() {
            let seats = lattice(i);
            for q in 0..=seat.pitches {
                places.push(RollerPlace {
                    position: seats.at(i64::from(q)),
                    on: Some((i, q)),
                });
            }
            let from = seats.at(i64::from(seat.pitches));
            let to = lattice((i + 1) % wheels.len()).at(0);
            for q in 1..links {
                let position = from + (to - from) * (f64::from(q) / f64::from(links));
                places.push(RollerPlace { position, on: None });
            }
        }
        Ok(places)
    }
}

/// Longest route that is laid, in pitches: ten times the longest chain, and a second of work where rails have a bend of a kilometre.
const MOST_PITCHES: f64 = 1e6;

/// Refuses a pitch that does not belong to the wheels.
fn check_pitch(wheels: &[Wheel], pitch: f64) -> Result<(), GeometryError> {
    GeometryError::positive("pitch [m]", pitch)?;
    for (index, wheel) in wheels.iter().enumerate() {
        wheel.check(index)?;
        // Toothed: the chord between neighbouring seats is the pitch, or nearly so; smooth: it fits three times.
        let (what, value, allowed) = match wheel.kind {
            WheelKind::Toothed { .. } => {
                let chord = 2.0 * wheel.radius * (PI / wheel.teeth(pitch)).sin();
                ("chord between two teeth / pitch", chord / pitch, 0.8..=1.25)
            }
            WheelKind::Smooth => (
                "radius of the guide / pitch",
                wheel.radius / pitch,
                0.6..=f64::INFINITY,
            ),
        };
        if !allowed.contains(&value) {
            let allowed = "0.8 to 1.25 for a sprocket, 0.6 or more for a guide";
            let source = Box::new(GeometryError::OutOfRange {
                what,
                value,
                allowed,
            });
            return Err(GeometryError::Wheel {
                wheel: index,
                source,
            });
        }
    }
    Ok(())
}

/// The places on one wheel where rollers can sit, numbered along the chain.
#[derive(Clone, Copy)]
pub(crate) struct Lattice<'a> {
    pub(crate) wheel: &'a Wheel,
    /// Half a pitch angle, π/z \[rad\].
    pub(crate) half: f64,
    /// Angle of seat 0 \[rad\].
    pub(crate) origin: f64,
}

/// A wheel to be reached by a straight span, its tooth phase still free.
struct Reach<'a> {
    wheel: &'a Wheel,
    pitch: f64,
    /// Length of the smooth tangent in pitches.
    expected: f64,
}

/// A span from a seat to a wheel whose phase it determines.
#[derive(Clone, Copy)]
struct Bridge {
    leaves: i64,
    links: u32,
    /// Angle of the seat where it arrives \[rad\].
    angle: f64,
    /// Distance to the nearer end of the window, the smaller of both ends of the span \[rad\].
    depth: f64,
}

impl Lattice<'_> {
    fn angle(&self, seat: i64) -> f64 {
        // ψ_q = ψ_0 + s q 2π/z
        self.origin + self.wheel.sense() * seat as f64 * 2.0 * self.half
    }

    pub(crate) fn at(&self, seat: i64) -> Point {
        self.wheel.at(self.angle(seat))
    }

    /// The seat whose window contains a span of this direction, as far as rounding allows.
    pub(crate) fn ordinal(&self, direction: f64) -> i64 {
        let turned =
            self.wheel.sense() * (direction - self.wheel.sense() * FRAC_PI_2 - self.origin);
        // Just past the first seat counts as the first seat, not as the end of a full turn.
        let ahead = (turned + 2.0 * self.half).rem_euclid(TAU) - 2.0 * self.half;
        whole(ahead / (2.0 * self.half))
    }

    /// How far a span direction lies inside the window of a seat \[rad\]; negative outside.
    fn depth(&self, seat: i64, direction: f64) -> f64 {
        depth(self.wheel, self.half, self.angle(seat), direction)
    }

    fn seating(&self, first: i64, last: i64) -> Seating {
        Seating {
            first_angle: self.angle(first).rem_euclid(TAU),
            pitches: count(last - first),
        }
    }

    /// The span to a wheel of free phase, leaving this one at a seat near `guess` and not before `least`.
    ///
    /// The span arrives up to half a pitch angle off the smooth tangent. On a shoe of large radius that may be many
    /// seats, or links: where none near the guess has the span in its window, the search goes on as long as it comes nearer.
    fn reach(&self, guess: i64, least: i64, to: &Reach<'_>) -> Option<Bridge> {
        let mut best: Option<Bridge> = None;
        for leaves in (guess - 1).max(least)..=guess + 1 {
            let Some(bridge) = self.reach_from(leaves, to) else {
                continue;
            };
            if best.is_none_or(|b| bridge.depth > b.depth) {
                best = Some(bridge);
            }
        }
        let mut best = best?;
        for step in [-1, 1] {
            while best.depth < 0.0 && best.leaves + step >= least {
                match self.reach_from(best.leaves + step, to) {
                    Some(next) if next.depth > best.depth => best = next,
                    _ => break,
                }
            }
        }
        Some(best)
    }

    fn reach_from(&self, leaves: i64, to: &Reach<'_>) -> Option<Bridge> {
        let mut best: Option<Bridge> = None;
        for links in whole(to.expected - 2.5).max(1)..=whole(to.expected + 2.5) {
            let bridge = self.bridge(leaves, links, to);
            if let Some(bridge) = bridge.filter(|new| best.is_none_or(|b| new.depth > b.depth)) {
                best = Some(bridge);
            }
        }
        let mut best = best?;
        for step in [-1, 1] {
            while best.depth < 0.0 && i64::from(best.links) + step >= 1 {
                match self.bridge(leaves, i64::from(best.links) + step, to) {
                    Some(next) if next.depth > best.depth => best = next,
                    _ => break,
                }
            }
        }
        // A lone link more or less shifts the seat by a whole window; far outside there is no chain.
        let half = 0.5 * to.wheel.pitch_angle(to.pitch);
        (best.depth > -half.max(self.half)).then_some(best)
    }

    /// The span of some links to wherever on the circle it ends.
    fn bridge(&self, leaves: i64, links: i64, to: &Reach<'_>) -> Option<Bridge> {
        let (from, wheel) = (self.at(leaves), to.wheel);
        let line = from - wheel.centre;
        let (distance, bearing) = (line.norm(), line.y.atan2(line.x));
        let half = 0.5 * wheel.pitch_angle(to.pitch);
        let length = links as f64 * to.pitch;
        // |A B| = m p with B on the circle: m² p² = (D − R)² + 4 D R sin²((ψ − ψ_A)/2). The cosine law says the
        // same, but loses the digits of a short link on a large circle.
        let radial = distance - wheel.radius;
        let squared = (length - radial) * (length + radial) / (4.0 * distance * wheel.radius);
        if !(0.0..=1.0).contains(&squared) {
            return None;
        }
        let turned = 2.0 * squared.sqrt().asin();
        // The chain arrives before it turns: past the bearing in the sense of the wheel.
        let ends = [bearing + turned, bearing - turned].map(|angle| {
            let span = wheel.at(angle) - from;
            let direction = span.y.atan2(span.x);
            let depth = depth(wheel, half, angle, direction).min(self.depth(leaves, direction));
            Bridge {
                leaves,
                links: count(links),
                angle,
                depth,
            }
        });
        let [first, second] = ends;
        Some(if second.depth > first.depth {
            second
        } else {
            first
        })
    }

    /// The seats of the span that joins this lattice to another one, both fixed: the common tangent of two convex polygons.
    ///
    /// From the two guesses the seat whose window the span misses by more moves on, forward where the span is turned
    /// beyond the window, until both windows hold it. There is one such span, unless it would leave before seat 0.
    pub(crate) fn join(&self, to: &Lattice<'_>, leaving: i64, arriving: i64) -> Option<(i64, i64)> {
        let (mut leaves, mut arrives) = (leaving.max(0), arriving);
        let mut best = None;
        let mut deepest = -self.half.max(to.half);
        // Nobody is a full turn of both wheels off, nor farther than any route is long.
        for _ in 0..whole((TAU / self.half + TAU / to.half).min(MOST_PITCHES)) {
            let span = to.at(arrives) - self.at(leaves);
            let direction = span.y.atan2(span.x);
            let beyond = [(self, leaves), (to, arrives)]
                .map(|(at, seat)| at.wheel.sense() * off(at.wheel, at.angle(seat), direction));
            let depths = [self.half - beyond[0].abs(), to.half - beyond[1].abs()];
            let depth = depths[0].min(depths[1]);
            if depth > deepest {
                deepest = depth;
                best = Some((leaves, arrives));
            }
            if depth >= 0.0 {
                break;
            }
            let first = leaves == 0 && beyond[0] < 0.0;
            if depths[0] < depths[1] && !first || depths[1] >= 0.0 {
                leaves = (leaves + whole(beyond[0].signum())).max(0);
            } else {
                arrives += whole(beyond[1].signum());
            }
        }
        best
    }
}

/// How far a span direction lies between the two polygon edges at a seat \[rad\]; negative outside.
///
/// The edges at ψ point along ψ + s (π/2 ∓ π/z) for a chain that turns with sense s.
fn depth(wheel: &Wheel, half: f64, angle: f64, direction: f64) -> f64 {
    half - off(wheel, angle, direction).abs()
}

/// Angle from the tangent at a place on the circle to a span direction \[rad\], within half a turn.
fn off(wheel: &Wheel, angle: f64, direction: f64) -> f64 {
    let off = direction - angle - wheel.sense() * FRAC_PI_2;
    (off + PI).rem_euclid(TAU) - PI
}

/// Nearest whole number.
#[expect(clippy::cast_possible_truncation, reason = "counts of links are small")]
fn whole(number: f64) -> i64 {
    number.round() as i64
}

/// A count that cannot be negative.
fn count(links: i64) -> u32 {
    u32::try_from(links).unwrap_or(0)
}
